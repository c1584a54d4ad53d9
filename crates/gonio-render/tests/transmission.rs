//! Glass: scenes whose answer is derived in their comment. Light passes boundaries and panes, is refracted, and reflected within.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_brdf::{Brdf, ModelSpec};
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::sequence::{SampleStream, SamplerKind};
use gonio_render::Integrator;
use gonio_render::integrator::Path;
use gonio_scene::{SceneBuilder, Shape, TriangleMesh};
use gonio_verify::statistics::{Moments, z_test};
use std::f64::consts::PI;
use std::sync::Arc;
use support::glass::*;
use support::*;

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

/// A sphere of `rows` × 2 `rows` quadrilaterals with the sphere's normals at its vertices.
fn coarse_sphere(rows: u32) -> Shape {
    let mut mesh = TriangleMesh::default();
    let columns = 2 * rows;
    for i in 0..=rows {
        for j in 0..=columns {
            let (theta, phi) = (
                PI * f64::from(i) / f64::from(rows),
                2.0 * PI * f64::from(j % columns) / f64::from(columns),
            );
            let (across, y) = (theta.sin(), theta.cos());
            let p = Vec3::new(across * phi.cos(), y, across * phi.sin()).to_f32();
            mesh.positions.push(p);
            mesh.normals.push(p);
        }
    }
    for i in 0..rows {
        for j in 0..columns {
            let (a, b) = (i * (columns + 1) + j, (i + 1) * (columns + 1) + j);
            mesh.indices.push([a, a + 1, b]);
            mesh.indices.push([a + 1, b + 1, b]);
        }
    }
    Shape::Mesh(Arc::new(mesh))
}

/// Glass with interpolated normals, which differ from those of its triangles. A path through it, without roulette, has the weight 1 if it
/// leaves the body as often as it enters it, whatever the normals; one whose sides of the true surface and of the frame were mixed up would arrive
/// with n² or 1/n². Paths are lost at the silhouettes, the fewer the finer the mesh; none gains. (That the
/// coarse one loses some shows that there are sides to be mixed up.)
#[test]
fn interpolated_normals_leak_no_light() {
    let camera = camera_above(4.0, 29.0);
    let all = Integrator::Path(Path {
        max_bounces: 256,
        roulette_after: u32::MAX,
        ..Path::default()
    });
    for (rows, range) in [(4, 0.5..0.999), (32, 0.98..1.0 + ROUNDING)] {
        let mut scene = SceneBuilder::new("coarse");
        let glass = material("glass");
        add(&mut scene, coarse_sphere(rows), Affine3::identity(), glass);
        uniform(&mut scene, 1.0);
        let scene = scene.build().unwrap();
        assert!(scene.warnings.iter().all(|w| !w.contains("inside out")));
        let film = picture(&scene, &camera, &options(all, SAMPLERS[1], 48, 1));
        let mut sum = 0.0;
        for pixel in film.pixels() {
            let l = pixel.mean()[0];
            assert!(
                l.abs() < ROUNDING || (l - 1.0).abs() < ROUNDING,
                "{rows} {l}"
            );
            sum += l;
        }
        let mean = sum / film.pixels().len() as f64;
        assert!(range.contains(&mean), "{rows}: {mean}");
    }
}

/// Glass is white in the layer of albedos, and its normal faces the viewer from either side.
#[test]
fn the_layers_of_glass() {
    let scene = furnace("glass:ior=1.5,absorption=3", 1.0);
    for height in [4.0, 0.5] {
        // From outside the ball is seen from above, from inside its lower half.
        let film = picture(
            &scene,
            &camera_above(height, 1.0),
            &options(PATH, SAMPLERS[1], 2, 4),
        );
        for pixel in film.pixels() {
            assert!(pixel.albedo().iter().all(|a| (a - 1.0).abs() < 1e-5));
            // Above, the outward normal is +y; below, −y is outward, and it is turned to the viewer.
            assert!(pixel.normal()[1] > 0.99, "{height} {:?}", pixel.normal());
        }
    }
}

/// Russian roulette that took the scaling of radiance for a loss would end paths in the body early, and those outside a thin medium late.
/// With roulette from the first reflection on the furnace is as white, and the noise no larger than that of ending 1 path in 20.
#[test]
fn roulette_is_not_confused_by_the_scaling_of_radiance() {
    let scene = furnace("glass:ior=3", 1.0);
    let roulette = Integrator::Path(Path {
        max_bounces: 64,
        roulette_after: 0,
        ..Path::default()
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
                ..Path::default()
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
