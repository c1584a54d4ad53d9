//! Bodies that absorb: scenes whose answer is derived in their comment, e^(−σd) for each way of length d within a body.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_num::{Affine3, Vec3};
use gonio_render::Integrator;
use gonio_render::integrator::Path;
use gonio_render::sensor::{self, SensorOptions};
use gonio_scene::material::AlphaMode;
use gonio_scene::{Light, SceneBuilder, Shape};
use std::f64::consts::PI;
use support::glass::*;
use support::*;

/// A slab of thickness d and absorption σ before a lamp. Light that is reflected to and fro within adds up to
/// T = (1 − F)² a / (1 − F² a²) with a = e^(−σd) for one crossing (Airy's sum of intensities), with F = 0.36 for n = 4. What is
/// reflected, R = F + F (1 − F)² a² / (1 − F² a²), shows under uniform light: there L = R + T.
#[test]
fn an_absorbing_slab_is_airys_sum() {
    let (n, d) = (4.0, 0.7);
    let f = reflectance(1.0, n);
    let sigma = [0.0, 0.5, 3.0];
    let spec = "glass:ior=4,absorption=0/0.5/3";
    let above = Vec3::new(0.0, 2.0, 0.0);
    let a = sigma.map(|s: f64| (-s * d).exp());
    let through = a.map(|a| (1.0 - f).powi(2) * a / (1.0 - f * f * a * a));
    let back = a.map(|a| f + f * (1.0 - f).powi(2) * a * a / (1.0 - f * f * a * a));

    let mut scene = SceneBuilder::new("before a lamp");
    slab(&mut scene, 0.0, 0.7, spec);
    lamp(&mut scene, -1.0);
    let reading = along(&scene.build().unwrap(), above, DOWN, PATH);
    assert!(are(&reading, through), "{reading:?} {through:?}");
    let without_echoes = a.map(|a| (1.0 - f).powi(2) * a);
    assert!(!are(&reading, without_echoes), "{reading:?}");

    let mut scene = SceneBuilder::new("in uniform light");
    slab(&mut scene, 0.0, 0.7, spec);
    uniform(&mut scene, 1.0);
    let reading = along(&scene.build().unwrap(), above, DOWN, PATH);
    let both = std::array::from_fn(|k| through[k] + back[k]);
    assert!(are(&reading, both), "{reading:?} {both:?}");
    assert!((both[0] - 1.0).abs() < 1e-12 && !are(&reading, both.map(|x| 1.05 * x)));
}

/// Aslant, sinθt = sinθ/n, the way through is d/cosθt and F that of the angle. n is low, so that light reflected twice within, F² a² = 3e-4
/// of it, is there but small; the sum is Airy's.
#[test]
fn absorption_follows_the_refracted_way() {
    let (n, d, sigma) = (1.33, 0.5, 1.2);
    let (sin, cos): (f64, f64) = (0.8, 0.6);
    let f = reflectance(cos, n);
    let cos_t = (1.0 - (sin / n).powi(2)).sqrt();
    let a = (-sigma * d / cos_t).exp();
    let expected = (1.0 - f).powi(2) * a / (1.0 - f * f * a * a);
    let mut scene = SceneBuilder::new("aslant");
    slab(&mut scene, 0.0, 0.5, "glass:ior=1.33,absorption=1.2");
    lamp(&mut scene, -1.0);
    let ray = Vec3::new(sin as f32, -cos as f32, 0.0);
    let scene = scene.build().unwrap();
    let reading = along(&scene, Vec3::new(0.0, 2.0, 0.0), ray, PATH);
    assert_is(&reading, expected);
    let straight = (1.0 - f).powi(2) * (-sigma * d / cos).exp();
    assert!(!is(&reading, straight), "{reading:?}");
}

/// A grey floor at the depth d in an absorbing body, lit by a point light of intensity I at the height h above it, in the body too. The light's way is
/// absorbed and the viewer's: L = ρ/π I/h² e^(−σh) e^(−σc) for a viewer at the distance c in the body, without noise. One outside sees through
/// the boundary (1 − F)/n² of L with c = d.
#[test]
fn light_and_view_within_a_body_are_absorbed() {
    let (n, sigma, d, h): (f64, f64, f64, f64) = (1.5, 0.4, 2.0, 0.7);
    let mut scene = SceneBuilder::new("pool");
    let water = material("glass:ior=1.5,absorption=0.4");
    add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), water);
    let ground = material("lambertian:reflectance=0.5");
    add(&mut scene, Shape::Rectangle, floor(-2.0, 5.0), ground);
    scene.light(Light::Point {
        position: Vec3::new(0.0, -1.3, 0.0),
        intensity: [3.0; 3],
    });
    let scene = scene.build().unwrap();
    let reflected = 0.5 / PI * 3.0 / (h * h) * (-sigma * h).exp();
    // Two events: light reflected by the floor, and through the boundary. More would add what the boundary mirrors back to the floor.
    let two = Integrator::Path(Path {
        max_bounces: 2,
        roulette_after: 4,
        ..Path::default()
    });
    let above = Vec3::new(0.0, 1.0, 0.0);
    let passes = (1.0 - reflectance(1.0, n)) / (n * n);
    assert_is(
        &along(&scene, above, DOWN, two),
        passes * (-sigma * d).exp() * reflected,
    );
    // From within, one event.
    let one = Integrator::Path(Path {
        max_bounces: 1,
        roulette_after: 4,
        ..Path::default()
    });
    for integrator in [one, INTEGRATORS[0]] {
        for c in [0.25_f64, 1.75] {
            let eye = Vec3::new(0.0, (c - 2.0) as f32, 0.0);
            let reading = along(&scene, eye, DOWN, integrator);
            assert_is(&reading, (-sigma * c).exp() * reflected);
        }
    }
}

/// The same with a black veil of opacity ½ in the water between floor and light, so that light and view cross it: a quarter, and not one bit
/// less absorbed. The direct integrator finds the light through it as well.
#[test]
fn a_veil_within_a_body_leaves_its_absorption() {
    let (sigma, c, h): (f64, f64, f64) = (0.4, 1.75, 0.7);
    let mut scene = SceneBuilder::new("veil in a pool");
    let water = material("glass:ior=1.5,absorption=0.4");
    add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), water);
    let ground = material("lambertian:reflectance=0.5");
    add(&mut scene, Shape::Rectangle, floor(-2.0, 5.0), ground);
    let mut veil = material("lambertian:reflectance=0");
    veil.opacity.mode = AlphaMode::Blend;
    veil.opacity.factor = 0.5;
    add(&mut scene, Shape::Rectangle, floor(-1.8, 5.0), veil);
    scene.light(Light::Point {
        position: Vec3::new(0.0, -1.3, 0.0),
        intensity: [3.0; 3],
    });
    let scene = scene.build().unwrap();
    let expected = 0.25 * 0.5 / PI * 3.0 / (h * h) * (-sigma * (h + c)).exp();
    let one = Integrator::Path(Path {
        max_bounces: 1,
        roulette_after: 4,
        ..Path::default()
    });
    for integrator in [one, INTEGRATORS[0]] {
        let eye = Vec3::new(0.0, (c - 2.0) as f32, 0.0);
        assert_is(&along(&scene, eye, DOWN, integrator), expected);
    }
}

/// A body of index 1 neither reflects nor refracts: what is left is e^(−σ·way), without noise. Through its middle lies a shell of clear glass,
/// index 2, a bubble of it: light passes the bubble as a lossless slab, (1 − F)²/(1 − F²) = (1 − F)/(1 + F), and the body before and behind.
#[test]
fn a_clear_bubble_interrupts_the_absorption() {
    let (sigma, n) = (0.6_f64, 2.0);
    let mut scene = SceneBuilder::new("bubble");
    let body = material("glass:ior=1,absorption=0.6");
    add(&mut scene, Shape::Sphere, sphere(2.0, [0.0; 3]), body);
    let bubble = material("glass:ior=2");
    add(&mut scene, Shape::Sphere, Affine3::identity(), bubble);
    lamp(&mut scene, -3.0);
    let scene = scene.build().unwrap();
    let f = reflectance(1.0, n);
    let expected = (-2.0 * sigma).exp() * (1.0 - f) / (1.0 + f);
    assert_is(
        &along(&scene, Vec3::new(0.0, 3.0, 0.0), DOWN, PATH),
        expected,
    );
    // Half of it from within the bubble, whose radiance is scaled by n² = 4. The light that the bubble's upper face returns is part of it:
    // (1 − F) n² (1 + F² + F⁴ + …) for the ways that pass the lower face, = n² (1 − F)/(1 − F²).
    let within = along(&scene, Vec3::new(0.0, 0.1, 0.0), DOWN, PATH);
    assert_is(&within, (-sigma).exp() * n * n / (1.0 + f));
}

/// Glass, a liquid in it, and air under it, as three surfaces that each part two media (all of index 1): each way has the absorption of its
/// own medium, and the air under them none.
#[test]
fn interfaces_between_three_media() {
    let mut scene = SceneBuilder::new("three media");
    let face = scene.shape(Shape::Rectangle);
    for (spec, placed) in [
        ("glass:ior=1,absorption=0.5", floor(3.0, 5.0)),
        ("glass:ior=1,absorption=0/0.5/1", floor(2.0, 5.0)),
        ("glass:ior=1,absorption=0/0.5/1", ceiling(0.5, 5.0)),
    ] {
        // A material each, as their indices would differ.
        let medium = scene.material(material(spec));
        scene.instance(face, placed, medium);
    }
    lamp(&mut scene, 0.0);
    let scene = scene.build().unwrap();
    let expected = [0.0, 0.5, 1.0].map(|sigma: f64| (-0.5 - 1.5 * sigma).exp());
    let reading = along(&scene, Vec3::new(0.0, 4.0, 0.0), DOWN, PATH);
    assert!(are(&reading, expected), "{expected:?} {reading:?}");
    assert!(!are(&reading, expected.map(|x| 1.05 * x)), "{reading:?}");
}

/// The camera in a body, and a lamp in the same body: e^(−σ·distance) of the lamp's radiance, though no boundary is in between. Also where the
/// body's boundary consists of two shapes, and in a body within that body; outside, nothing is absorbed.
#[test]
fn a_camera_within_a_body() {
    let mut scene = SceneBuilder::new("camera in glass");
    slab(&mut scene, -1.0, 3.0, "glass:ior=1.3,absorption=0.8");
    let inner = material("glass:ior=1.2,absorption=0.1");
    add(
        &mut scene,
        Shape::Sphere,
        sphere(0.5, [2.0, 2.0, 0.0]),
        inner,
    );
    lamp(&mut scene, 0.0);
    let scene = scene.build().unwrap();
    for integrator in INTEGRATORS {
        let eye = Vec3::new(0.0, 1.5, 0.0);
        let reading = along(&scene, eye, DOWN, integrator);
        assert_is(&reading, (-0.8_f64 * 1.5).exp());
    }
    let inner_eye = scene.interior_at(Vec3::new(2.0, 2.0, 0.0));
    let sigmas: Vec<f32> = inner_eye.bodies().iter().map(|b| b.absorption[0]).collect();
    assert_eq!(sigmas, [0.8, 0.1], "outermost first");
    for outside in [[0.0, 3.5, 0.0], [0.0, -1.5, 0.0]] {
        assert!(scene.interior_at(outside.into()).bodies().is_empty());
    }
}

/// A body whose boundary is nothing but holes (opacity 0) neither reflects nor refracts, yet it is there: e^(−σ·way), seen through it and by
/// light that a floor receives through it.
#[test]
fn a_ray_that_passes_by_opacity_enters_the_body() {
    let mut scene = SceneBuilder::new("holes");
    let mut body = material("glass:ior=1.5,absorption=0.3");
    body.opacity.mode = AlphaMode::Mask(0.5);
    body.opacity.factor = 0.0;
    let face = scene.shape(Shape::Rectangle);
    let body = scene.material(body);
    scene.instance(face, floor(3.0, 5.0), body);
    scene.instance(face, ceiling(1.0, 5.0), body);
    let ground = material("lambertian:reflectance=0.5");
    add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), ground);
    scene.light(Light::Directional {
        direction: DOWN,
        irradiance: [2.0; 3],
    });
    let scene = scene.build().unwrap();
    let one = Integrator::Path(Path {
        max_bounces: 1,
        roulette_after: 4,
        ..Path::default()
    });
    for integrator in [one, INTEGRATORS[0]] {
        let reading = along(&scene, Vec3::new(0.0, 4.0, 0.0), DOWN, integrator);
        assert_is(&reading, 0.5 / PI * 2.0 * (-0.3_f64 * 4.0).exp());
    }
}

/// Irradiance within a body in uniform light: n² π, if the detector looks at the boundary within its critical angle all around, as from the
/// centre of a sphere; absorbed over the radius, e^(−σr).
#[test]
fn irradiance_within_a_body() {
    let n: f64 = 1.5;
    let scene = furnace("glass:ior=1.5,absorption=0.5", 1.0);
    let options = SensorOptions {
        integrator: PATH,
        samples: 20_000,
        seed: 5,
    };
    let reading = sensor::irradiance(&scene, Vec3::zero(), DOWN, &options).unwrap();
    let f = reflectance(1.0, n);
    // Reflected at the boundary, light comes back through the centre to the other side of it: a a′ F with two radii more, and so on.
    // The detector is no body that stops it.
    let a = (-0.5_f64).exp();
    let expected = PI * n * n * (1.0 - f) * a / (1.0 - f * a * a);
    assert_is(&reading, expected);
}
