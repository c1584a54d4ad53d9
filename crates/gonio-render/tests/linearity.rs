//! T9: light adds up over lights and over the components of a BRDF.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_render::Film;
use gonio_scene::{Light, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::welch_t_test;
use support::*;

fn scene(spec: &str, lights: &[Light]) -> Scene {
    let mut scene = SceneBuilder::new("linearity");
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
        material(spec),
    );
    for light in lights {
        scene.light(light.clone());
    }
    scene.build().unwrap()
}

fn lights() -> [Light; 2] {
    [
        Light::Point {
            position: Vec3::new(2.0, 4.0, 1.0),
            intensity: [20.0, 10.0, 5.0],
        },
        Light::Environment(Environment::uniform([0.3, 0.4, 0.5])),
    ]
}

/// Whether the mean of `whole` is the sum of the means of `parts`, but for chance.
fn adds_up(whole: &Film, parts: [&Film; 2], scale: f64) -> bool {
    (0..3).all(|c| {
        let mut sums = gonio_verify::statistics::Moments::new();
        for (a, b) in parts[0].pixels().iter().zip(parts[1].pixels()) {
            sums.push(scale * (a.mean()[c] + b.mean()[c]));
        }
        let mut wholes = gonio_verify::statistics::Moments::new();
        for pixel in whole.pixels() {
            wholes.push(pixel.mean()[c]);
        }
        welch_t_test(&wholes, &sums).p_value > FALSE_POSITIVE
    })
}

/// T9a: the reflection of a sum of lights is the sum of the reflections. The camera sees one small place, so that all
/// pixels estimate nearly the same number and the variance over pixels is that of the estimate.
#[test]
fn over_lights() {
    let camera = camera_above(5.0, 0.5);
    let spec = "phong:diffuse=0.3,specular=0.4,exponent=20,normalisation=energy";
    for integrator in INTEGRATORS {
        for sampler in SAMPLERS {
            let shot = |lights: &[Light]| {
                picture(
                    &scene(spec, lights),
                    &camera,
                    &options(integrator, sampler, 24, 32),
                )
            };
            let [a, b] = lights();
            let parts = [
                shot(std::slice::from_ref(&a)),
                shot(std::slice::from_ref(&b)),
            ];
            let whole = shot(&[a, b]);
            assert!(
                adds_up(&whole, [&parts[0], &parts[1]], 1.0),
                "{integrator:?} {sampler:?}"
            );
            assert!(
                !adds_up(&whole, [&parts[0], &parts[1]], 1.02),
                "{integrator:?} {sampler:?}"
            );
        }
    }
}

/// T9b: a BRDF may be a sum of BRDFs. Under a point light and one reflection it holds pixel by pixel, without noise.
#[test]
fn over_components() {
    let [point, _] = lights();
    let camera = camera_above(5.0, 20.0);
    let shot = |spec: &str| {
        picture(
            &scene(spec, std::slice::from_ref(&point)),
            &camera,
            &options(INTEGRATORS[0], SAMPLERS[1], 16, 1),
        )
    };
    let a = shot("lambertian:reflectance=0.3");
    let b = shot("blinn-phong:diffuse=0,specular=0.5,exponent=30");
    let whole =
        shot("sum(lambertian:reflectance=0.3, blinn-phong:diffuse=0,specular=0.5,exponent=30)");
    let mut lit = 0;
    for ((whole, a), b) in whole.pixels().iter().zip(a.pixels()).zip(b.pixels()) {
        for c in 0..3 {
            let sum = a.mean()[c] + b.mean()[c];
            // Floor pixels see the same floor in all three pictures: there the parts hold it twice.
            if whole.mean()[c] != a.mean()[c] {
                assert!(
                    (whole.mean()[c] - sum).abs() <= 1e-5 * sum,
                    "{whole:?} {sum}"
                );
                lit += 1;
            }
        }
    }
    assert!(lit > 100, "the sphere fills part of the picture: {lit}");
}
