//! The same options give the same bits, and different ones don't.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_render::{Film, Integrator, RenderOptions, Stop, Target, render};
use gonio_scene::{Light, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::image_z_test;
use std::ops::ControlFlow;
use std::time::Duration;
use support::*;

fn scene() -> Scene {
    let mut scene = SceneBuilder::new("reproducible");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(-1.0, 10.0),
        material("lambertian:reflectance=0.5"),
    );
    add(
        &mut scene,
        Shape::Sphere,
        Affine3::identity(),
        material("ggx:metal=gold,roughness=0.4"),
    );
    scene.light(Light::Point {
        position: Vec3::new(2.0, 4.0, 1.0),
        intensity: [20.0; 3],
    });
    scene.light(Light::Environment(Environment::uniform([0.3, 0.4, 0.5])));
    scene.build().unwrap()
}

/// A body that absorbs with a bead in it, under a pane, lit by a lamp and a sky.
fn glass() -> Scene {
    let mut scene = SceneBuilder::new("glass");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(-1.0, 10.0),
        material("lambertian:reflectance=0.5"),
    );
    for (spec, scale, at) in [
        ("glass:ior=1.5,absorption=0.1/0.5/1", 1.0, [0.0; 3]),
        ("lambertian:reflectance=0.7", 0.3, [0.2, 0.1, 0.3]),
        (
            "sum(lambertian:reflectance=0.4, scaled(0.5, glass))",
            0.5,
            [1.6, 0.0, 0.0],
        ),
    ] {
        let placed = Affine3::scale(Vec3::splat(scale)).then(&Affine3::translation(at.into()));
        add(&mut scene, Shape::Sphere, placed, material(spec));
    }
    let pane = material("thin-dielectric:transmittance=0.9/1/0.8");
    let above = floor(2.0, 0.7).then(&Affine3::translation(Vec3::new(-0.8, 0.0, 0.3)));
    add(&mut scene, Shape::Rectangle, above, pane);
    let lamp = emitter("lambertian:reflectance=0", [5.0; 3]);
    let beside = ceiling(4.0, 1.0).then(&Affine3::translation(Vec3::new(2.0, 0.0, 0.0)));
    add(&mut scene, Shape::Rectangle, beside, lamp);
    scene.light(Light::Environment(Environment::uniform([0.3, 0.4, 0.5])));
    scene.build().unwrap()
}

fn on_threads(threads: usize, scene: &Scene, options: &RenderOptions) -> Film {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| picture(scene, &camera_above(6.0, 30.0), options))
}

#[test]
fn the_image_does_not_depend_on_the_number_of_threads() {
    for scene in [scene(), glass()] {
        for integrator in INTEGRATORS {
            let options = options(integrator, SAMPLERS[1], 24, 8);
            let one = on_threads(1, &scene, &options);
            for threads in [2, 5] {
                assert_eq!(
                    one.pixels(),
                    on_threads(threads, &scene, &options).pixels(),
                    "{} {integrator:?} {threads}",
                    scene.name
                );
            }
            let other_seed = RenderOptions { seed: 8, ..options };
            assert_ne!(one.pixels(), on_threads(1, &scene, &other_seed).pixels());
        }
    }
}

/// More samples go on from fewer: pass boundaries leave no trace.
#[test]
fn an_interrupted_image_is_the_one_with_fewer_samples() {
    let full = options(INTEGRATORS[1], SAMPLERS[1], 16, 64);
    let camera = camera_above(6.0, 30.0);
    for scene in [scene(), glass()] {
        let (stopped, stop) = render(&scene, &camera, &full, |p, _| {
            if p.samples >= 8 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
        .unwrap();
        assert_eq!((stop, stopped.samples_per_pixel()), (Stop::Interrupted, 8));
        let fewer = RenderOptions {
            target: Target {
                samples: 8,
                time: None,
                noise: None,
                adaptive: false,
            },
            ..full
        };
        assert_eq!(stopped.pixels(), picture(&scene, &camera, &fewer).pixels());
    }
}

#[test]
fn the_targets_stop_it() {
    let base = options(INTEGRATORS[1], SAMPLERS[1], 16, 1 << 20);
    let camera = camera_above(6.0, 30.0);
    let go_on = |_: &_, _: &_| ControlFlow::Continue(());
    let by = |time, noise| RenderOptions {
        target: Target {
            samples: 1 << 20,
            time,
            noise,
            adaptive: false,
        },
        ..base
    };

    let (_, stop) = render(
        &scene(),
        &camera,
        &by(Some(Duration::from_millis(1)), None),
        go_on,
    )
    .unwrap();
    assert_eq!(stop, Stop::Time);
    let (film, stop) = render(&scene(), &camera, &by(None, Some(0.05)), go_on).unwrap();
    assert_eq!(stop, Stop::Noise);
    assert!(film.noise() <= 0.05 && film.samples_per_pixel() >= 16);

    assert!(render(&scene(), &camera, &by(None, Some(f64::NAN)), go_on).is_err());
    let none = RenderOptions {
        target: Target {
            samples: 0,
            time: None,
            noise: None,
            adaptive: false,
        },
        ..base
    };
    assert!(render(&scene(), &camera, &none, go_on).is_err());
    assert!(
        render(
            &scene(),
            &camera,
            &RenderOptions { width: 0, ..base },
            go_on
        )
        .is_err()
    );
}

/// `direct` and `path` with one reflection estimate the same image in different ways.
#[test]
fn direct_and_one_bounce_agree() {
    for scene in [scene(), glass()] {
        agree_on(&scene);
    }
}

fn agree_on(scene: &Scene) {
    let one = Integrator::Path(gonio_render::integrator::Path {
        max_bounces: 1,
        roulette_after: 4,
        ..gonio_render::integrator::Path::default()
    });
    let shot = |integrator, seed| {
        let options = RenderOptions {
            seed,
            ..options(integrator, SAMPLERS[0], 24, 256)
        };
        picture(scene, &camera_above(6.0, 30.0), &options)
    };
    let flat = |image: gonio_image::Image| image.pixels.concat();
    let (a, b) = (shot(INTEGRATORS[0], 1), shot(one, 2));
    let compare = |scale: f32| {
        let scaled: Vec<f32> = flat(b.image()).iter().map(|x| x * scale).collect();
        // The variances are estimates from 256 samples, so the test of a pixel is a t-test in truth: hence the share of pixels.
        image_z_test(
            &flat(a.image()),
            &flat(a.variance()),
            &scaled,
            &flat(b.variance()),
            0.01,
            1e-6,
        )
    };
    assert!(compare(1.0).passed(0.9975), "{:?}", compare(1.0));
    assert!(!compare(1.25).passed(0.9975), "{:?}", compare(1.25));
}
