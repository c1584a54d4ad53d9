//! Radiometric sensors against closed forms.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_render::sensor::{self, Parallelogram, Reading, SensorOptions};
use gonio_scene::{Light, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::z_test;
use std::f64::consts::PI;
use support::*;

const UP: Vec3<f32> = Vec3::new(0.0, 1.0, 0.0);

fn under_uniform_light(radiance: f32) -> Scene {
    let mut scene = SceneBuilder::new("uniform");
    scene.light(Light::Environment(Environment::uniform([radiance; 3])));
    scene.build().unwrap()
}

fn quick() -> SensorOptions {
    SensorOptions {
        samples: 20_000,
        ..SensorOptions::default()
    }
}

/// Within five standard errors (two-sided false-positive rate 6e-7) or a rounding of 1e-5.
fn agrees(reading: &Reading, expected: f64) -> bool {
    let error = reading.standard_error.expect("these readings are sampled");
    (0..3).all(|c| {
        let difference = reading.value[c] - expected;
        difference.abs() <= 1e-5 * expected.abs()
            || z_test(difference, error[c] * error[c]).p_value > FALSE_POSITIVE
    })
}

/// (7): E = ∫ cosθ dω = π under uniform unit radiance, for every orientation.
#[test]
fn irradiance_under_uniform_radiance_is_pi() {
    let scene = under_uniform_light(1.0);
    for n in [UP, Vec3::new(1.0, -2.0, 0.5), Vec3::new(0.0, 0.0, -1.0)] {
        for integrator in INTEGRATORS {
            let options = SensorOptions {
                integrator,
                ..quick()
            };
            let reading = sensor::irradiance(&scene, Vec3::zero(), n, &options).unwrap();
            assert!(agrees(&reading, PI), "{reading:?}");
            assert!(!agrees(&reading, PI * 1.02), "{reading:?}");
            assert_eq!((reading.quantity, reading.unit), ("irradiance", "W m⁻²"));
        }
    }
}

/// Under a sphere of radius r whose centre is d above, black and opaque, uniform light loses the sphere's share:
/// E = π (1 − r²/d²).
#[test]
fn an_occluder_takes_its_share() {
    let (r, d) = (0.5_f64, 1.0_f64);
    let mut scene = SceneBuilder::new("occluder");
    let placed = Affine3::scale(Vec3::splat(r as f32)).then(&Affine3::translation(UP));
    add(
        &mut scene,
        Shape::Sphere,
        placed,
        material("lambertian:reflectance=0"),
    );
    scene.light(Light::Environment(Environment::uniform([1.0; 3])));
    let scene = scene.build().unwrap();
    let reading = sensor::irradiance(&scene, Vec3::zero(), UP, &quick()).unwrap();
    let expected = PI * (1.0 - (r / d) * (r / d));
    assert!(agrees(&reading, expected), "{reading:?} {expected}");
    assert!(!agrees(&reading, expected * 1.03), "{reading:?}");
}

/// A point light of intensity I: E = I cosθ / r², exactly.
#[test]
fn irradiance_of_a_point_light() {
    let mut scene = SceneBuilder::new("point");
    scene.light(Light::Environment(Environment::uniform([0.0; 3])));
    scene.light(Light::Point {
        position: Vec3::new(3.0, 4.0, 0.0),
        intensity: [10.0; 3],
    });
    let scene = scene.build().unwrap();
    let reading = sensor::irradiance(&scene, Vec3::zero(), UP, &quick()).unwrap();
    let expected = 10.0 * (4.0 / 5.0) / 25.0;
    assert!(
        (reading.value[0] / expected - 1.0).abs() < 1e-5,
        "{reading:?}"
    );
}

/// M = ρ E for a Lambertian floor; a lamp of radiance L has M = π L.
#[test]
fn radiant_exitance_is_reflectance_times_irradiance() {
    let mut scene = SceneBuilder::new("floor");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(0.0, 1.0),
        material("lambertian:reflectance=0.3"),
    );
    scene.light(Light::Environment(Environment::uniform([2.0; 3])));
    let scene = scene.build().unwrap();
    let reading = sensor::radiant_exitance(&scene, Vec3::zero(), UP, 1e-3, &quick()).unwrap();
    assert!(agrees(&reading, 0.3 * 2.0 * PI), "{reading:?}");
    assert!(!agrees(&reading, 0.3 * 2.0 * PI * 1.05), "{reading:?}");

    let mut scene = SceneBuilder::new("lamp");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(0.0, 1.0),
        emitter("lambertian:reflectance=0", [5.0; 3]),
    );
    let scene = scene.build().unwrap();
    let reading = sensor::radiant_exitance(&scene, Vec3::zero(), UP, 1e-3, &quick()).unwrap();
    assert!(agrees(&reading, 5.0 * PI), "{reading:?}");
}

/// Φ = π L A through a detector of area A under uniform radiance L.
#[test]
fn flux_through_a_rectangle() {
    let scene = under_uniform_light(2.0);
    let detector = Parallelogram {
        corner: Vec3::zero(),
        side_u: Vec3::new(0.0, 0.0, 3.0),
        side_v: Vec3::new(0.5, 0.0, 0.0),
    };
    let reading = sensor::flux(&scene, &detector, &quick()).unwrap();
    assert!(agrees(&reading, PI * 2.0 * 1.5), "{reading:?}");
    assert!(!agrees(&reading, PI * 2.0 * 1.5 * 1.02), "{reading:?}");
}

#[test]
fn radiance_along_a_ray() {
    let scene = furnace("mirror:reflectance=0.5", 3.0);
    let miss = sensor::radiance(&scene, Vec3::new(0.0, 3.0, 0.0), UP, &quick()).unwrap();
    assert_eq!(miss.value, [3.0; 3]);
    assert_eq!(miss.standard_error, Some([0.0; 3]));
    let hit = sensor::radiance(&scene, Vec3::new(0.0, 3.0, 0.0), -UP, &quick()).unwrap();
    assert!(agrees(&hit, 1.5), "{hit:?}");
}

/// The reading does not depend on the number of threads.
#[test]
fn readings_are_reproducible() {
    let scene = furnace("lambertian:reflectance=0.5", 1.0);
    let read = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            sensor::irradiance(&scene, Vec3::new(0.0, -1.5, 0.0), UP, &quick()).unwrap()
        })
    };
    assert_eq!(read(1), read(3));
}

#[test]
fn impossible_sensors_are_errors() {
    let scene = under_uniform_light(1.0);
    let zero = Vec3::zero();
    assert!(sensor::irradiance(&scene, zero, zero, &quick()).is_err());
    assert!(sensor::irradiance(&scene, zero, Vec3::new(f32::NAN, 0.0, 0.0), &quick()).is_err());
    assert!(sensor::radiance(&scene, zero, zero, &quick()).is_err());
    assert!(sensor::radiant_exitance(&scene, zero, UP, 0.0, &quick()).is_err());
    let flat = Parallelogram {
        corner: zero,
        side_u: UP,
        side_v: UP,
    };
    assert!(sensor::flux(&scene, &flat, &quick()).is_err());
    for samples in [0, 1, 1 << 40] {
        let options = SensorOptions { samples, ..quick() };
        assert!(
            sensor::irradiance(&scene, zero, UP, &options).is_err(),
            "{samples}"
        );
    }
}
