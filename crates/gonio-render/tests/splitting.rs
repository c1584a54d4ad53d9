//! Several samples at the first surface: the same expectation, and less noise.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::{Candidates, Environment};
use gonio_num::{Affine3, Vec3};
use gonio_render::integrator::{EnvironmentSampling, Path};
use gonio_render::{Film, Integrator, RenderOptions, render};
use gonio_scene::{Light, Scene, SceneBuilder, Shape};
use std::ops::ControlFlow;
use support::*;

/// Surfaces that differ in what finds light on them, lamps that a ray meets and one that it doesn't, under a sky.
fn scene() -> Scene {
    let mut scene = SceneBuilder::new("splitting");
    let floor = floor(0.0, 4.0);
    add(
        &mut scene,
        Shape::Rectangle,
        floor,
        material("lambertian:reflectance=0.6"),
    );
    for (k, spec) in [
        "ggx:metal=gold,alpha=0.1",
        "coat(lambertian:reflectance=0.5)",
        "mirror",
        "glass:ior=1.5",
    ]
    .into_iter()
    .enumerate()
    {
        let at = Vec3::new(k as f32 - 1.5, 0.5, 0.0);
        let placed = Affine3::scale(Vec3::splat(0.45)).then(&Affine3::translation(at));
        add(&mut scene, Shape::Sphere, placed, material(spec));
    }
    let lamp = emitter("lambertian:reflectance=0.2", [4.0, 3.0, 2.0]);
    let placed =
        Affine3::scale(Vec3::splat(0.3)).then(&Affine3::translation(Vec3::new(-1.0, 1.6, 1.0)));
    add(&mut scene, Shape::Sphere, placed, lamp.clone());
    add(&mut scene, Shape::Rectangle, ceiling(2.5, 0.5), lamp);
    scene.light(Light::Point {
        position: Vec3::new(1.0, 2.0, 2.0),
        intensity: [1.0; 3],
    });
    scene.light(Light::Environment(Environment::uniform([0.3; 3])));
    scene.build().unwrap()
}

fn shot(scene: &Scene, path: Path, seed: u64) -> Film {
    let options = RenderOptions {
        seed,
        ..options(Integrator::Path(path), SAMPLERS[0], 32, 64)
    };
    picture(scene, &camera_before(), &options)
}

/// Mean over pixels of the variance of a pixel, in the first channel.
fn noise(film: &Film) -> f64 {
    let pixels = film.pixels().iter();
    pixels.map(|p| p.variance_of_mean()[0]).sum::<f64>() / film.pixels().len() as f64
}

/// Pixel by pixel the difference of two pictures is 0 in the mean, by a t-test over the pixels. The control is a picture that is 3 % brighter.
/// Light and directions have a part each: each split alone is less noisy than neither, and both are less noisy than each. So are several candidates for a light
/// sample, which is less than as many samples do. What is left is the noise of the pixel's own area, of which there are as many samples in all of them.
#[test]
fn the_same_picture_with_less_noise() {
    let scene = scene();
    let plain = Path {
        max_bounces: 8,
        ..Path::default()
    };
    let alone = shot(&scene, plain, 1);
    let mut left = Vec::new();
    for (seed, (light_samples, light_candidates, splitting)) in
        (2..).zip([(4, 1, 1), (1, 1, 3), (4, 1, 4), (1, 4, 1), (2, 3, 1)])
    {
        let path = Path {
            light_samples,
            light_candidates,
            splitting,
            ..plain
        };
        let split = shot(&scene, path, seed);
        for c in 0..3 {
            let off = |brighter| p_of_difference(&alone, &split, c, brighter);
            assert!(off(1.0) > FALSE_POSITIVE, "{path:?}, channel {c}");
            assert!(
                off(1.03) < FALSE_POSITIVE,
                "{path:?}, channel {c}: the control passed"
            );
        }
        left.push(noise(&split) / noise(&alone));
    }
    println!("variance against that without splitting: {left:.2?}");
    assert!(
        left[2] < left[0].min(left[1])
            && left[0].max(left[1]) < 0.95
            && left[3..].iter().all(|l| (left[0]..0.95).contains(l)),
        "{left:?}"
    );
}

#[test]
fn product_sampling_has_candidates_of_its_own() {
    let scene = scene();
    let path = Path {
        environment: EnvironmentSampling::Product(Candidates::default()),
        light_candidates: 2,
        ..Path::default()
    };
    let options = options(Integrator::Path(path), SAMPLERS[0], 4, 1);
    let taken = render(&scene, &camera_before(), &options, |_, _| {
        ControlFlow::Continue(())
    });
    let message = taken.unwrap_err().to_string();
    assert!(
        message.starts_with("light_candidates is 2 beside product sampling"),
        "{message}"
    );
}
