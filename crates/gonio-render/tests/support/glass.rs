//! What the tests of glass share: readings along single rays, slabs and lamps.

use super::*;
use gonio_brdf::part::fresnel;
use gonio_render::sensor::{self, Reading, SensorOptions};
use gonio_verify::statistics::z_test;

pub const DOWN: Vec3<f32> = Vec3::new(0.0, -1.0, 0.0);

pub const PATH: Integrator = INTEGRATORS[1];

/// f32 roundings along a path of a few operations, relative: 2⁻²⁴ times about a hundred. Rays start 8 roundings (2⁻²⁴) of a shape's extent, 5
/// here, off its surface: 2.4e-6 for each boundary, which is so much less way in bodies of σ ≤ 1 behind which no noise covers it.
pub const ROUNDING: f64 = 1e-5;

/// Fresnel reflectance of a boundary of relative index `n` for an angle on its outer side.
pub fn reflectance(cos: f64, n: f64) -> f64 {
    fresnel::dielectric(cos, n)
}

/// The radiance along a ray.
pub fn along(scene: &Scene, from: Vec3<f32>, to: Vec3<f32>, integrator: Integrator) -> Reading {
    let options = SensorOptions {
        integrator,
        samples: 20_000,
        seed: 3,
    };
    let reading = sensor::radiance(scene, from, to, &options).unwrap();
    assert_eq!(reading.rejected, 0, "{reading:?}");
    reading
}

/// Within a rounding, or but for chance.
pub fn is(reading: &Reading, expected: f64) -> bool {
    are(reading, [expected; 3])
}

pub fn are(reading: &Reading, expected: [f64; 3]) -> bool {
    let error = reading.standard_error.expect("these readings are sampled");
    (0..3).all(|c| {
        let difference = reading.value[c] - expected[c];
        difference.abs() <= ROUNDING * expected[c].abs()
            || z_test(difference, error[c] * error[c]).p_value > FALSE_POSITIVE
    })
}

/// Asserts it, and that 5 % more would be noticed.
#[track_caller]
pub fn assert_is(reading: &Reading, expected: f64) {
    assert!(is(reading, expected), "{expected}: {reading:?}");
    assert!(!is(reading, 1.05 * expected), "{expected}: {reading:?}");
}

pub fn sphere(radius: f32, centre: [f32; 3]) -> Affine3<f32> {
    Affine3::scale(Vec3::splat(radius)).then(&Affine3::translation(centre.into()))
}

/// A slab of one material between the heights `bottom` and `top`: its two faces, outwards.
pub fn slab(scene: &mut SceneBuilder, bottom: f32, top: f32, spec: &str) {
    let face = scene.shape(Shape::Rectangle);
    let glass = scene.material(material(spec));
    scene.instance(face, floor(top, 5.0), glass);
    scene.instance(face, ceiling(bottom, 5.0), glass);
}

/// A black lamp of radiance 1 that shines upwards at height `y`.
pub fn lamp(scene: &mut SceneBuilder, y: f32) {
    let shining = emitter("lambertian:reflectance=0", [1.0; 3]);
    add(scene, Shape::Rectangle, floor(y, 5.0), shining);
}

pub fn uniform(scene: &mut SceneBuilder, radiance: f32) {
    scene.light(Light::Environment(Environment::uniform([radiance; 3])));
}
