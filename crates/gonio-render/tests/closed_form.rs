//! Scenes whose answer is derived in their comment, for every integrator and sampler.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::solid_angle::projected;
use gonio_render::Integrator;
use gonio_render::integrator::Path;
use gonio_scene::{Light, SceneBuilder, Shape};
use std::f64::consts::PI;
use support::*;

/// f32 roundings along a path of a few operations, relative: 2⁻²⁴ times about a hundred.
const ROUNDING: f64 = 1e-5;

/// Under uniform light of radiance 1, a convex Lambertian body of reflectance ρ shows radiance ρ/π · E = ρ/π · π = ρ
/// everywhere: nothing else reflects onto it.
#[test]
fn a_lambertian_sphere_in_a_uniform_furnace_shows_its_albedo() {
    let camera = camera_above(4.0, 10.0);
    for albedo in [0.0, 0.18, 0.5, 1.0] {
        let scene = furnace(&format!("lambertian:reflectance={albedo}"), 1.0);
        for integrator in INTEGRATORS {
            for sampler in SAMPLERS {
                let film = picture(&scene, &camera, &options(integrator, sampler, 24, 16));
                assert!(
                    agrees(&film, albedo, ROUNDING),
                    "{albedo} {integrator:?} {sampler:?}"
                );
                // Negative control: 2 % off is noticed.
                if albedo > 0.0 {
                    assert!(
                        !agrees(&film, albedo * 1.02, ROUNDING),
                        "{albedo} {integrator:?} {sampler:?}"
                    );
                }
            }
        }
    }
}

/// Inside a closed box whose walls emit radiance 1 and reflect the fraction a, every ray carries
/// L = 1 + a L, so L = 1 + a + a² + … = 1 / (1 − a). One reflection alone (`direct`) gives 1 + a, and n reflections the sum
/// of the first n + 1 terms.
#[test]
fn a_closed_furnace_box() {
    let a: f64 = 0.5;
    let mut scene = SceneBuilder::new("box");
    let walls = [
        (Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)),
        (Vec3::new(0.0, 1.0, 0.0), Vec3::new(0.0, 0.0, 1.0)),
        (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.0, 0.0)),
    ];
    for (x, y) in walls {
        let z = x.cross(y);
        for sign in [1.0_f32, -1.0] {
            // The wall at −z·sign, facing inward: turned about y for the other side.
            let placed = Affine3::from_columns(x * sign, y, z * sign, z * -sign);
            add(
                &mut scene,
                Shape::Rectangle,
                placed,
                emitter(&format!("lambertian:reflectance={a}"), [1.0; 3]),
            );
        }
    }
    let scene = scene.build().unwrap();
    let camera = gonio_scene::Camera::look_at(
        Vec3::new(0.1, 0.2, -0.3),
        Vec3::new(0.7, 0.3, 0.9),
        Vec3::new(0.0, 1.0, 0.0),
        60.0,
    )
    .unwrap();
    for sampler in SAMPLERS {
        let at = |bounces| {
            Integrator::Path(Path {
                max_bounces: bounces,
                roulette_after: 3,
                ..Path::default()
            })
        };
        for (integrator, expected) in [
            (INTEGRATORS[0], 1.0 + a),
            (at(0), 1.0),
            (at(1), 1.0 + a),
            (at(3), 1.0 + a + a * a + a * a * a),
            (at(1000), 1.0 / (1.0 - a)),
        ] {
            let film = picture(&scene, &camera, &options(integrator, sampler, 24, 32));
            assert!(
                agrees(&film, expected, ROUNDING),
                "{integrator:?} {sampler:?} {:?}",
                pixel_moments(&film, 0).mean()
            );
            if expected > 1.0 {
                assert!(
                    !agrees(&film, expected * 1.02, ROUNDING),
                    "{integrator:?} {sampler:?}"
                );
            }
        }
    }
}

/// A point light of intensity I above a Lambertian floor: E = I cosθ / r², L = ρ/π E, without noise. The camera stands at the
/// light, so that θ and r follow from the pixel; the centre has cosθ = 1.
#[test]
fn a_point_light_obeys_the_inverse_square_law() {
    for height in [0.5, 2.0, 10.0] {
        let mut scene = SceneBuilder::new("point");
        add(
            &mut scene,
            Shape::Rectangle,
            floor(0.0, 100.0),
            material("lambertian:reflectance=0.5"),
        );
        // Beside the camera's axis at distance d: cosθ = h/r, r² = h² + d².
        let d = 0.7_f64;
        scene.light(Light::Point {
            position: Vec3::new(d as f32, height as f32, 0.0),
            intensity: [3.0, 2.0, 1.0],
        });
        let scene = scene.build().unwrap();
        // So narrow a view that E changes by less than 1e-5 over the picture (|dE/dx| ≤ 3 E d / r², x ≤ 2e-6).
        let camera = camera_above(1.0, 1e-4);
        let r2 = height * height + d * d;
        for integrator in INTEGRATORS {
            for sampler in SAMPLERS {
                let film = picture(&scene, &camera, &options(integrator, sampler, 2, 2));
                for (c, intensity) in [3.0, 2.0, 1.0].into_iter().enumerate() {
                    let expected = 0.5 / PI * intensity * (height / r2.sqrt()) / r2;
                    let found = film.pixels()[0].mean()[c];
                    assert!(
                        (found / expected - 1.0).abs() < 3e-5,
                        "{integrator:?} {height}: {found} {expected}"
                    );
                }
            }
        }
    }
}

/// A square light of radiance 1 and side 2a, facing the floor at height h: the irradiance at the point under its centre is
/// four times that of a corner of a quarter, E = 4 · L/2 · [A/√(1+A²) atan(B/√(1+A²)) + B/√(1+B²) atan(A/√(1+B²))] with
/// A = B = a/h (form factor of a rectangle, parallel, from a corner; Howell, Mengüç & Siegel, C-11).
#[test]
fn a_rectangle_light_has_its_form_factor() {
    let (a, h) = (0.8_f64, 1.3_f64);
    let ratio = a / h;
    let root = (1.0 + ratio * ratio).sqrt();
    let irradiance = 4.0 * 0.5 * 2.0 * ratio / root * (ratio / root).atan();
    let polygon = [[-a, -a], [-a, a], [a, a], [a, -a]].map(|[x, z]| Vec3::new(x, h, z));
    let by_lambert = projected::polygon(&polygon, Vec3::zero(), Vec3::new(0.0, 1.0, 0.0));
    assert!(
        (irradiance - by_lambert).abs() < 1e-12,
        "{irradiance} {by_lambert}"
    );

    let mut scene = SceneBuilder::new("rectangle light");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(0.0, 50.0),
        material("lambertian:reflectance=0.5"),
    );
    add(
        &mut scene,
        Shape::Rectangle,
        ceiling(h as f32, a as f32),
        emitter("lambertian:reflectance=0", [1.0; 3]),
    );
    let scene = scene.build().unwrap();
    let camera = camera_above(1.0, 1e-4);
    let expected = 0.5 / PI * irradiance;
    for integrator in INTEGRATORS {
        for sampler in SAMPLERS {
            let film = picture(&scene, &camera, &options(integrator, sampler, 16, 64));
            assert!(agrees(&film, expected, 2e-5), "{integrator:?} {sampler:?}");
            assert!(
                !agrees(&film, expected * 1.02, 2e-5),
                "{integrator:?} {sampler:?}"
            );
        }
    }
}

/// A spherical light of radiance 1 and radius r at distance d above the floor: E = π (r/d)², as if it were a disk seen under
/// the same cone (sin²σ = r²/d²).
#[test]
fn a_sphere_light_has_its_form_factor() {
    let (r, d) = (0.4_f64, 1.5_f64);
    let mut scene = SceneBuilder::new("sphere light");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(0.0, 50.0),
        material("lambertian:reflectance=1"),
    );
    let placed = Affine3::scale(Vec3::splat(r as f32))
        .then(&Affine3::translation(Vec3::new(0.0, d as f32, 0.0)));
    add(
        &mut scene,
        Shape::Sphere,
        placed,
        emitter("lambertian:reflectance=0", [1.0; 3]),
    );
    let scene = scene.build().unwrap();
    let camera = camera_above(1.0, 1e-4);
    let expected = (r / d) * (r / d);
    for integrator in INTEGRATORS {
        for sampler in SAMPLERS {
            let film = picture(&scene, &camera, &options(integrator, sampler, 16, 64));
            assert!(
                agrees(&film, expected, 2e-5),
                "{integrator:?} {sampler:?} {}",
                pixel_moments(&film, 0).mean()
            );
            assert!(
                !agrees(&film, expected * 1.02, 2e-5),
                "{integrator:?} {sampler:?}"
            );
        }
    }
}

/// A mirror shows the environment's radiance times its reflectance, without noise.
#[test]
fn a_mirror_reflects_the_environment() {
    let scene = furnace("mirror:reflectance=0.7", 2.0);
    for integrator in INTEGRATORS {
        let film = picture(
            &scene,
            &camera_above(4.0, 10.0),
            &options(integrator, SAMPLERS[1], 4, 1),
        );
        for pixel in film.pixels() {
            assert!(
                (pixel.mean()[0] - 1.4).abs() < 1e-5,
                "{integrator:?} {pixel:?}"
            );
        }
    }
}

/// A plane of opacity ½ before uniform light of radiance 1, seen against it: ½ of the ray goes on and finds 1, the other
/// half meets a surface of reflectance 0.4 that is lit on both sides alike and shows 0.4 — so L = ½ + ½ · 0.4.
#[test]
fn a_partly_transparent_surface() {
    let mut scene = SceneBuilder::new("veil");
    let mut veil = material("lambertian:reflectance=0.4");
    veil.opacity.factor = 0.5;
    veil.opacity.mode = gonio_scene::material::AlphaMode::Blend;
    add(&mut scene, Shape::Rectangle, floor(0.0, 5.0), veil);
    scene.light(Light::Environment(Environment::uniform([1.0; 3])));
    let scene = scene.build().unwrap();
    for integrator in INTEGRATORS {
        for sampler in SAMPLERS {
            let film = picture(
                &scene,
                &camera_above(4.0, 10.0),
                &options(integrator, sampler, 16, 32),
            );
            assert!(
                agrees(&film, 0.7, ROUNDING),
                "{integrator:?} {sampler:?} {}",
                pixel_moments(&film, 0).mean()
            );
            assert!(!agrees(&film, 0.72, ROUNDING), "{integrator:?} {sampler:?}");
        }
    }
}

/// A mirror under a black veil of opacity ½, in uniform light of radiance 1: light crosses the veil once on its way in and
/// once on its way out, and the two are independent, so L = ½ · ½. One random number for both crossings would give ½.
#[test]
fn a_path_crosses_a_partly_transparent_surface_twice() {
    let mut scene = SceneBuilder::new("veiled mirror");
    let mut veil = material("lambertian:reflectance=0");
    veil.opacity.factor = 0.5;
    veil.opacity.mode = gonio_scene::material::AlphaMode::Blend;
    add(&mut scene, Shape::Rectangle, floor(1.0, 50.0), veil);
    add(
        &mut scene,
        Shape::Rectangle,
        floor(0.0, 50.0),
        material("mirror:reflectance=1"),
    );
    scene.light(Light::Environment(Environment::uniform([1.0; 3])));
    let scene = scene.build().unwrap();
    for integrator in INTEGRATORS {
        for sampler in SAMPLERS {
            let film = picture(
                &scene,
                &camera_above(4.0, 10.0),
                &options(integrator, sampler, 16, 32),
            );
            assert!(
                agrees(&film, 0.25, ROUNDING),
                "{integrator:?} {sampler:?} {}",
                pixel_moments(&film, 0).mean()
            );
            assert!(!agrees(&film, 0.5, ROUNDING), "{integrator:?} {sampler:?}");
        }
    }
}
