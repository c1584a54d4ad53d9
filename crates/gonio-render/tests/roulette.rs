//! Russian roulette that judges by efficiency: the same expectation, for less work where that can be.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_render::integrator::{Path, Roulette};
use gonio_render::{Exposure, Integrator, RenderOptions, expose};
use gonio_scene::{Camera, Light, Scene, SceneBuilder, Shape};
use std::ops::ControlFlow;
use support::*;

/// Bright walls around a lamp, with things of metal, glass and paint: light of many reflections.
fn room() -> Scene {
    let mut scene = SceneBuilder::new("room");
    let wall = material("lambertian:reflectance=0.8/0.6/0.5");
    add(&mut scene, Shape::Rectangle, floor(0.0, 2.0), wall.clone());
    add(
        &mut scene,
        Shape::Rectangle,
        ceiling(2.6, 2.0),
        wall.clone(),
    );
    let upright =
        Affine3::scale(Vec3::splat(2.0)).then(&Affine3::translation(Vec3::new(0.0, 1.0, -1.5)));
    add(&mut scene, Shape::Rectangle, upright, wall);
    for (k, spec) in [
        "ggx:metal=gold,alpha=0.2",
        "coat(lambertian:reflectance=0.5)",
        "glass:ior=1.5",
    ]
    .into_iter()
    .enumerate()
    {
        let at = Vec3::new(k as f32 - 1.0, 0.45, 0.0);
        let placed = Affine3::scale(Vec3::splat(0.45)).then(&Affine3::translation(at));
        add(&mut scene, Shape::Sphere, placed, material(spec));
    }
    let lamp = emitter("lambertian:reflectance=0.2", [4.0, 3.0, 2.0]);
    add(&mut scene, Shape::Rectangle, ceiling(2.5, 0.5), lamp);
    scene.light(Light::Environment(Environment::uniform([0.1; 3])));
    scene.build().unwrap()
}

/// Two lamps in a dark ball: nearly all of the noise is in the first reflection, and no path ever leaves.
fn cave() -> Scene {
    let mut scene = SceneBuilder::new("cave");
    let wall = material("lambertian:reflectance=0.25");
    let wide = Affine3::scale(Vec3::splat(6.0));
    add(&mut scene, Shape::Sphere, wide, wall);
    for at in [Vec3::new(-2.0, 2.0, -2.0), Vec3::new(2.5, 1.0, -1.0)] {
        let lamp = emitter("lambertian:reflectance=0.25", [8.0, 7.0, 6.0]);
        let placed = Affine3::scale(Vec3::splat(0.7)).then(&Affine3::translation(at));
        add(&mut scene, Shape::Sphere, placed, lamp);
    }
    scene.build().unwrap()
}

/// A white hall without a way out: light makes many reflections, and energy alone does not tell which of them matter.
fn hall() -> Scene {
    let mut scene = SceneBuilder::new("hall");
    let wall = material("lambertian:reflectance=0.85");
    let wide = Affine3::scale(Vec3::splat(6.0));
    add(&mut scene, Shape::Sphere, wide, wall);
    let lamp = emitter("lambertian:reflectance=0", [20.0; 3]);
    let above =
        Affine3::scale(Vec3::splat(0.5)).then(&Affine3::translation(Vec3::new(0.0, 4.5, 0.0)));
    add(&mut scene, Shape::Sphere, above, lamp);
    scene.build().unwrap()
}

/// A picture of 32 × 32 pixels with what it cost.
fn shot(scene: &Scene, path: Path, seed: u64) -> Exposure {
    let camera = Camera::look_at(
        Vec3::new(0.0, 1.6, 4.0),
        Vec3::new(0.0, 0.6, 0.0),
        Vec3::new(0.0, 1.0, 0.0),
        45.0,
    )
    .unwrap();
    let options = RenderOptions {
        seed,
        ..options(Integrator::Path(path), SAMPLERS[0], 32, 128)
    };
    let mut exposure = Exposure::new(32, 32, 0).unwrap();
    expose(scene, &camera, &options, &mut exposure, |_, _| {
        ControlFlow::Continue(())
    })
    .unwrap();
    assert_eq!(exposure.film.rejected().count, 0);
    exposure
}

/// The probability that two pictures differ as much by chance, of a channel, by a t-test over the pixels; `scale` for the second.
fn alike(a: &Exposure, b: &Exposure, channel: usize, scale: f64) -> f64 {
    p_of_difference(&b.film, &a.film, channel, scale)
}

/// The controls: a picture that is 3 % brighter, and one without the light of the last reflections, which a roulette loses that doesn't let the paths that go on
/// carry the others' share.
#[test]
fn the_same_picture() {
    for scene in [room(), cave()] {
        let throughput = Path {
            max_bounces: 8,
            ..Path::default()
        };
        let plain = shot(&scene, throughput, 1);
        for (seed, splitting) in [(2, 1), (3, 4)] {
            let path = Path {
                roulette: Roulette::Efficiency,
                splitting,
                ..throughput
            };
            let judged = shot(&scene, path, seed);
            for c in 0..3 {
                let p = alike(&plain, &judged, c, 1.0);
                println!("{}, {splitting} paths, channel {c}: p {p:.3}", scene.name);
                assert!(p > FALSE_POSITIVE, "channel {c}");
                assert!(
                    alike(&plain, &judged, c, 1.03) < FALSE_POSITIVE,
                    "the control passed"
                );
            }
        }
    }
    let short = Path {
        max_bounces: 3,
        ..Path::default()
    };
    let (whole, lost) = (shot(&room(), Path::default(), 1), shot(&room(), short, 2));
    assert!(alike(&whole, &lost, 0, 1.0) < FALSE_POSITIVE);
}

/// Paths that will find as much light as others are not ended because they carry less: the variance of a pixel times the rays is little more than half at most. Of the pixels the one in
/// the middle of their order, which those at the lamp's border don't move. Of 1024 pixels of 128 samples it is known to some per cent, as the control shows, the
/// other roulette against itself.
#[test]
fn less_work_for_the_same_noise() {
    let cost = |exposure: &Exposure| {
        let pixels = exposure.film.pixels().iter();
        let relative = pixels.map(|p| {
            let (mean, variance) = (p.mean()[0], p.variance_of_mean()[0]);
            variance / (mean * mean + 1e-4)
        });
        let mut relative: Vec<f64> = relative.collect();
        relative.sort_unstable_by(f64::total_cmp);
        relative[relative.len() / 2] * exposure.rays.total() as f64
    };
    let scene = hall();
    let by = |roulette, seed| {
        let path = Path {
            roulette,
            ..Path::default()
        };
        cost(&shot(&scene, path, seed))
    };
    let plain = by(Roulette::Throughput, 1);
    let again = by(Roulette::Throughput, 2) / plain;
    let judged = by(Roulette::Efficiency, 3) / plain;
    println!(
        "variance times rays, of that of roulette by throughput: {judged:.3}; the same again {again:.3}"
    );
    assert!(
        judged < 0.6 && (0.8..1.25).contains(&again),
        "{judged} {again}"
    );
}
