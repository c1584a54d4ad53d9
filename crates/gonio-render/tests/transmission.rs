//! Glass: scenes whose answer is derived in their comment. Light passes boundaries and panes, is refracted, reflected within, and
//! absorbed on its way through bodies.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_brdf::part::fresnel;
use gonio_brdf::{Brdf, ModelSpec};
use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::sequence::{SampleStream, SamplerKind};
use gonio_render::Integrator;
use gonio_render::integrator::Path;
use gonio_render::sensor::{self, Reading, SensorOptions};
use gonio_scene::material::AlphaMode;
use gonio_scene::{Light, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::{Moments, z_test};
use std::f64::consts::PI;
use support::*;

const DOWN: Vec3<f32> = Vec3::new(0.0, -1.0, 0.0);
const PATH: Integrator = INTEGRATORS[1];

/// f32 roundings along a path of a few operations, relative: 2⁻²⁴ times about a hundred. Rays start 8 roundings (2⁻²⁴) of a shape's extent, 5
/// here, off its surface: 2.4e-6 for each boundary, which is so much less way in bodies of σ ≤ 1 behind which no noise covers it.
const ROUNDING: f64 = 1e-5;

/// Fresnel reflectance of a boundary of relative index `n` for an angle on its outer side.
fn reflectance(cos: f64, n: f64) -> f64 {
    fresnel::dielectric(cos, n)
}

/// The radiance along a ray.
fn along(scene: &Scene, from: Vec3<f32>, to: Vec3<f32>, integrator: Integrator) -> Reading {
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
fn is(reading: &Reading, expected: f64) -> bool {
    are(reading, [expected; 3])
}

fn are(reading: &Reading, expected: [f64; 3]) -> bool {
    let error = reading.standard_error.expect("these readings are sampled");
    (0..3).all(|c| {
        let difference = reading.value[c] - expected[c];
        difference.abs() <= ROUNDING * expected[c].abs()
            || z_test(difference, error[c] * error[c]).p_value > FALSE_POSITIVE
    })
}

/// Asserts it, and that 5 % more would be noticed.
#[track_caller]
fn assert_is(reading: &Reading, expected: f64) {
    assert!(is(reading, expected), "{expected}: {reading:?}");
    assert!(!is(reading, 1.05 * expected), "{expected}: {reading:?}");
}

fn sphere(radius: f32, centre: [f32; 3]) -> Affine3<f32> {
    Affine3::scale(Vec3::splat(radius)).then(&Affine3::translation(centre.into()))
}

/// A slab of one material between the heights `bottom` and `top`: its two faces, outwards.
fn slab(scene: &mut SceneBuilder, bottom: f32, top: f32, spec: &str) {
    let face = scene.shape(Shape::Rectangle);
    let glass = scene.material(material(spec));
    scene.instance(face, floor(top, 5.0), glass);
    scene.instance(face, ceiling(bottom, 5.0), glass);
}

/// A black lamp of radiance 1 that shines upwards at height `y`.
fn lamp(scene: &mut SceneBuilder, y: f32) {
    let shining = emitter("lambertian:reflectance=0", [1.0; 3]);
    add(scene, Shape::Rectangle, floor(y, 5.0), shining);
}

fn uniform(scene: &mut SceneBuilder, radiance: f32) {
    scene.light(Light::Environment(Environment::uniform([radiance; 3])));
}

/// A clear body absorbs nothing, so in uniform light of radiance 1 it can't be seen: it shows 1 everywhere, refracted or reflected,
/// n² on entering against 1/n² on leaving. So does a thin pane.
#[test]
fn clear_glass_vanishes_in_a_white_furnace() {
    // The sphere fills the picture: from 4 away it is seen under 29°.
    let camera = camera_above(4.0, 29.0);
    for spec in ["glass:ior=1.5", "glass:ior=0.6", "thin-dielectric:ior=1.8"] {
        let scene = furnace(spec, 1.0);
        for sampler in SAMPLERS {
            let film = picture(&scene, &camera, &options(PATH, sampler, 24, 32));
            assert!(agrees(&film, 1.0, ROUNDING), "{spec} {sampler:?}");
            assert!(!agrees(&film, 1.05, ROUNDING), "{spec} {sampler:?}");
        }
    }
    // The control: glass that scales what passes by ½ at each of two boundaries is seen.
    let grey = furnace("glass:transmittance=0.5", 1.0);
    let film = picture(&grey, &camera, &options(PATH, SAMPLERS[1], 24, 32));
    assert!(!agrees(&film, 1.0, ROUNDING));
}

/// Russian roulette that took the scaling of radiance for a loss would end paths in the body early, and those outside a thin medium late.
/// With roulette from the first reflection on the furnace is as white, and the noise no larger than that of ending 1 path in 20.
#[test]
fn roulette_is_not_confused_by_the_scaling_of_radiance() {
    let scene = furnace("glass:ior=3", 1.0);
    let roulette = Integrator::Path(Path {
        max_bounces: 64,
        roulette_after: 0,
    });
    let reading = along(&scene, Vec3::new(0.0, 4.0, 0.0), DOWN, roulette);
    assert_is(&reading, 1.0);
    // A path of k survivals at 0.95 each has the weight 0.95⁻ᵏ with the probability 0.95ᵏ: variance E[0.95⁻ᵏ] − 1. At normal incidence
    // a quarter is reflected at once (k = 0); the others leave the body after j + 1 boundaries more, (¾)(¾)(¼)ʲ, of which j + 1 are followed by
    // roulette. So the variance is ¼ + (9/16) Σ (¼)ʲ 0.95^−(j+1) − 1 = 0.0536, up to 6 standard errors of a variance from 20 000
    // samples, which is below 6 √(0.012/20000): the fourth moment is at most Σ … (0.95⁻ᵏ − 1)⁴ < 0.012.
    let variance = 20_000.0 * reading.standard_error.unwrap()[0].powi(2);
    let expected = 0.25 + 9.0 / 16.0 * (1.0 / 0.95) / (1.0 - 0.25 / 0.95) - 1.0;
    assert!(
        (variance - expected).abs() < 6.0 * (0.012_f64 / 20_000.0).sqrt(),
        "{variance} {expected}"
    );
}

/// Inside a body of index n in uniform light of radiance 1 the radiance is n², in all directions that light reaches from outside: from the
/// centre of a sphere these are all. The equation of one event alone lets through (1 − F) n², and sees nothing where it reflects.
#[test]
fn radiance_inside_a_body_is_scaled_by_the_index_squared() {
    for n in [1.5, 0.8] {
        let scene = furnace(&format!("glass:ior={n}"), 1.0);
        let f = reflectance(1.0, n);
        for (integrator, expected) in [(PATH, n * n), (INTEGRATORS[0], n * n * (1.0 - f))] {
            assert_is(&along(&scene, Vec3::zero(), DOWN, integrator), expected);
        }
    }
}

/// Through one boundary at normal incidence passes 1 − F = 0.96 of the light. A viewer outside sees a lamp within the body at (1 − F)/n² of its
/// radiance; one inside sees a lamp outside at (1 − F) n².
#[test]
fn one_boundary_scales_radiance() {
    let n: f64 = 1.5;
    let passes = 1.0 - reflectance(1.0, n);
    assert!((passes - 0.96).abs() < 1e-12);
    let mut within = SceneBuilder::new("lamp in glass");
    let face = material("glass:ior=1.5");
    add(&mut within, Shape::Rectangle, floor(0.0, 5.0), face);
    lamp(&mut within, -1.0);
    let within = within.build().unwrap();
    let mut outside = SceneBuilder::new("lamp before glass");
    let face = material("glass:ior=1.5");
    add(&mut outside, Shape::Rectangle, ceiling(0.0, 5.0), face);
    lamp(&mut outside, -1.0);
    let outside = outside.build().unwrap();
    for integrator in INTEGRATORS {
        let above = Vec3::new(0.1, 2.0, 0.3);
        assert_is(&along(&within, above, DOWN, integrator), passes / (n * n));
        assert_is(&along(&outside, above, DOWN, integrator), passes * n * n);
    }
}

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

/// Beyond the critical angle, sinθ > 1/n, all is reflected: from inside, the boundary is a mirror that shows the lamp below at its own
/// radiance, and nothing of the bright sky above. Just within the critical angle the sky is seen.
#[test]
fn total_internal_reflection() {
    let mut scene = SceneBuilder::new("under water");
    let face = material("glass:ior=1.5");
    add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), face);
    lamp(&mut scene, -2.0);
    uniform(&mut scene, 100.0);
    let scene = scene.build().unwrap();
    for integrator in INTEGRATORS {
        for (sin, total) in [(0.68_f32, true), (0.65, false)] {
            let up = Vec3::new(sin, (1.0 - sin * sin).sqrt(), 0.0);
            let reading = along(&scene, Vec3::new(0.0, -1.0, 0.0), up, integrator);
            if total {
                assert_eq!(reading.standard_error, Some([0.0; 3]), "{reading:?}");
                assert_is(&reading, 1.0);
            } else {
                assert!(reading.value[0] > 10.0, "{integrator:?} {reading:?}");
            }
        }
    }
}

/// A small lamp lies where Snell's law leads: at the depth h, h tanθt beside the point where the ray enters. Elsewhere, and where the
/// ray would go on straight, it is not seen.
#[test]
fn refraction_obeys_snells_law() {
    let (n, h) = (1.5, 2.0);
    let sin: f64 = 0.9;
    let sin_t = sin / n;
    let tan_t = sin_t / (1.0 - sin_t * sin_t).sqrt();
    let tan = sin / (1.0 - sin * sin).sqrt();
    let seen = |x: f64| {
        let mut scene = SceneBuilder::new("snell");
        let face = material("glass:ior=1.5");
        add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), face);
        let shining = emitter("lambertian:reflectance=0", [1.0; 3]);
        let there =
            floor(-h as f32, 1e-3).then(&Affine3::translation(Vec3::new(x as f32, 0.0, 0.0)));
        add(&mut scene, Shape::Disk, there, shining);
        let scene = scene.build().unwrap();
        let cos = (1.0 - sin * sin).sqrt();
        let ray = Vec3::new(sin as f32, -cos as f32, 0.0);
        // One unit of way above the point (0, 0, 0).
        INTEGRATORS.map(|integrator| along(&scene, -ray, ray, integrator))
    };
    let f = reflectance((1.0 - sin * sin).sqrt(), n);
    for reading in seen(h * tan_t) {
        assert_is(&reading, (1.0 - f) / (n * n));
    }
    for x in [h * tan, h * tan_t + 3e-3, h * tan_t - 3e-3] {
        for reading in seen(x) {
            assert_eq!(reading.value, [0.0; 3], "{x}");
        }
    }
}

/// A ray at height s = sinθ beside the centre of a unit sphere is turned by θ − θt twice, and keeps its distance to the centre: it crosses the
/// axis s / sin(2(θ − θt)) behind the centre. There a small lamp is seen, at (1 − F)² of its radiance.
#[test]
fn a_sphere_focuses() {
    let n: f64 = 1.5;
    for s in [0.2_f64, 0.5, 0.8] {
        let turned = 2.0 * (s.asin() - (s / n).asin());
        let focus = s / turned.sin();
        let f = reflectance((1.0 - s * s).sqrt(), n);
        for (y, expected) in [(focus, (1.0 - f).powi(2)), (1.05 * focus, 0.0)] {
            let mut scene = SceneBuilder::new("lens");
            let glass = material("glass:ior=1.5");
            add(&mut scene, Shape::Sphere, Affine3::identity(), glass);
            let shining = emitter("lambertian:reflectance=0", [1.0; 3]);
            add(&mut scene, Shape::Disk, floor(-y as f32, 1e-3), shining);
            let from = Vec3::new(s as f32, 5.0, 0.0);
            let reading = along(&scene.build().unwrap(), from, DOWN, PATH);
            if expected > 0.0 {
                assert_is(&reading, expected);
            } else {
                assert_eq!(reading.value, [0.0; 3], "{s}");
            }
        }
    }
}

/// A thin pane before a lamp lets (1 − F)/(1 + F) pass in the same direction, and the rest is the mirror image of what is before it. So in
/// uniform light both integrators see 1, and coloured panes their share.
#[test]
fn a_light_seen_through_a_thin_pane() {
    let n = 1.7;
    let cos = 0.6;
    let f = reflectance(cos, n);
    let ray = Vec3::new(0.8, -0.6, 0.0);
    let above = Vec3::new(0.0, 2.0, 0.0);
    let pane = |light: &dyn Fn(&mut SceneBuilder)| {
        let mut scene = SceneBuilder::new("pane");
        let glass = material("thin-dielectric:ior=1.7,transmittance=1/0.5/1");
        add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), glass);
        light(&mut scene);
        scene.build().unwrap()
    };
    let through = (1.0 - f) / (1.0 + f);
    for integrator in INTEGRATORS {
        let reading = along(&pane(&|s| lamp(s, -1.0)), above, ray, integrator);
        let expected = [through, 0.5 * through, through];
        assert!(are(&reading, expected), "{expected:?} {reading:?}");
        assert!(!are(&reading, expected.map(|x| 1.05 * x)), "{reading:?}");
        let reading = along(&pane(&|s| uniform(s, 1.0)), above, ray, integrator);
        let expected = [1.0, 1.0 - 0.5 * through, 1.0];
        assert!(are(&reading, expected), "{expected:?} {reading:?}");
        assert!(!are(&reading, [1.0; 3]), "{reading:?}");
    }
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

/// Surfaces that transmit and have directions of a density, so that lights are sampled on both sides of them: the registry's, and a sum.
fn surfaces_with_densities() -> Vec<String> {
    let models = gonio_brdf::registry::models().iter();
    let transmit = models.filter(|info| {
        let spec = ModelSpec::new(info.name).unwrap();
        let built = spec.build::<f32, 3>();
        built.is_ok_and(|model| model.transmits() && !model.is_delta())
    });
    let mut names: Vec<String> = transmit.map(|info| info.name.into()).collect();
    names.push("sum(lambertian:reflectance=0.4, scaled(0.5, glass))".into());
    names
}

/// A lamp before or behind a plane that scatters, seen from the side of +z or of −z: the radiance is the mean of the weights of the directions that
/// the reflection function draws itself, if these meet the lamp. That needs no density, no light sample and no frame but the plane's own;
/// both integrators have to find the same with all of these.
#[test]
fn light_from_both_sides_of_a_scattering_surface() {
    let half = 0.6_f32;
    for spec in surfaces_with_densities() {
        let model = ModelSpec::parse(&spec).unwrap().build::<f32, 3>().unwrap();
        for (lamp_side, viewer_side) in [(1.0_f32, 1.0_f32), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)]
        {
            let mut scene = SceneBuilder::new("both sides");
            let surface = material(&spec);
            add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), surface);
            // The lamp, shining at the origin from straight above or below.
            let shining = emitter("lambertian:reflectance=0", [1.0; 3]);
            let placed = if lamp_side > 0.0 {
                ceiling(1.0, half)
            } else {
                floor(-1.0, half)
            };
            add(&mut scene, Shape::Rectangle, placed, shining);
            let scene = scene.build().unwrap();
            // `floor` turns local z to world y, and local y to world −z.
            let wo = Vec3::new(0.3, 0.2, viewer_side).normalize();
            let mut moments = Moments::new();
            for k in 0..40_000 {
                let mut stream = SampleStream::new(SamplerKind::Independent, 11, 0, k);
                let s = model.sample(wo, stream.next_3d());
                let hits = s.pdf > 0.0
                    && s.wi.z * lamp_side > 0.0
                    && s.wi.x.abs().max(s.wi.y.abs()) < half * s.wi.z.abs();
                moments.push(if hits { f64::from(s.weight[1]) } else { 0.0 });
            }
            let from = Vec3::new(wo.x, wo.z, -wo.y) * 0.8;
            let one = Integrator::Path(Path {
                max_bounces: 1,
                roulette_after: 4,
            });
            for integrator in [one, INTEGRATORS[0]] {
                let reading = along(&scene, from, from * -1.25, integrator);
                let error = reading.standard_error.unwrap()[1];
                let variance = error * error + moments.variance_of_mean();
                let p = |scale: f64| {
                    let difference = scale * reading.value[1] - moments.mean();
                    if difference.abs() <= ROUNDING * moments.mean() {
                        1.0
                    } else {
                        z_test(difference, variance).p_value
                    }
                };
                let place = format!("{spec} {lamp_side} {viewer_side} {integrator:?}");
                assert!(p(1.0) > FALSE_POSITIVE, "{place} {reading:?} {moments:?}");
                // Where light arrives at all the control is noticed.
                if moments.mean() > 10.0 * variance.sqrt() {
                    assert!(p(2.0) < FALSE_POSITIVE, "{place}");
                }
            }
        }
    }
}

/// In uniform light of radiance 1 on both sides of a plane, a sum of ρ = 0.4 and half of a clear boundary shows a viewer outside
/// 0.4 + ½ (F + (1 − F)/n²). From the inner side its diffuse part, which only reflects, is black: ½ (F + (1 − F) n²).
#[test]
fn a_sum_of_reflection_and_transmission() {
    let n: f64 = 1.5;
    let f = reflectance(1.0, n);
    let mut scene = SceneBuilder::new("sum");
    let surface = material("sum(lambertian:reflectance=0.4, scaled(0.5, glass))");
    add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), surface);
    uniform(&mut scene, 1.0);
    let scene = scene.build().unwrap();
    for integrator in INTEGRATORS {
        let above = along(&scene, -DOWN, DOWN, integrator);
        assert_is(&above, 0.4 + 0.5 * (f + (1.0 - f) / (n * n)));
        let below = along(&scene, DOWN, -DOWN, integrator);
        assert_is(&below, 0.5 * (f + (1.0 - f) * n * n));
    }
}
