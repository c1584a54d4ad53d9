//! Every way to sample the environment gives what quadrature gives, for models of the registry; and rooms look right from everywhere.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_env::{Candidates, Environment, Layout};
use gonio_image::Image;
use gonio_num::{Affine3, Real, Vec3};
use gonio_radiometry::sequence::{Rng, SampleStream, SamplerKind};
use gonio_render::integrator::{Direct, EnvironmentSampling, Path};
use gonio_render::{Integrator, RayCounts};
use gonio_scene::{Interior, Ray, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::{Moments, sidak, t_test};
use std::f64::consts::{PI, TAU};
use support::*;

const SAMPLINGS: [EnvironmentSampling; 5] = [
    EnvironmentSampling::Luminance,
    EnvironmentSampling::Compensated,
    EnvironmentSampling::Cosine,
    EnvironmentSampling::Product(Candidates {
        light: 3,
        reflection: 2,
    }),
    EnvironmentSampling::Product(Candidates {
        light: 2,
        reflection: 1,
    }),
];

/// Not smooth, so that quadrature serves; the last has a part that reflects into one direction alone.
const MODELS: [&str; 7] = [
    "lambertian:reflectance=0.8/0.5/0.2",
    "torrance-sparrow:metal=gold,roughness=0.5",
    "ward:roughness=0.6",
    "oren-nayar",
    "disney:roughness=0.5,metallic=0.3",
    "sheen-charlie",
    "gltf:roughness=0.6,metallic=0.5",
];

fn panoramas() -> [(&'static str, Environment); 2] {
    let mut rng = Rng::from_name("environment sampling");
    let mut noise = Image::from_fn(16, 8, |_, _| {
        [rng.next_f32(), rng.next_f32(), rng.next_f32()]
    });
    noise.set(9, 2, [30.0, 25.0, 20.0]);
    let gradient = Image::from_fn(8, 4, |x, y| [x as f32 / 4.0, y as f32, 1.0]);
    [noise, gradient]
        .map(|image| ("", Environment::from_image(image, Layout::LatLong).unwrap()))
        .into_iter()
        .zip(["sun", "gradient"])
        .map(|((_, env), name)| (name, env.rotated_deg(25.0)))
        .collect::<Vec<_>>()
        .try_into()
        .unwrap()
}

fn patch(spec: &str, env: Environment) -> Scene {
    let mut scene = SceneBuilder::new("patch");
    add(
        &mut scene,
        Shape::Rectangle,
        floor(0.0, 1.0),
        material(spec),
    );
    scene.environment(env);
    scene.build().unwrap()
}

/// Radiance toward `wo` (local, y up) by midpoints in the angle from the zenith and in longitude.
fn by_quadrature(spec: &str, env: &Environment, towards: Vec3<f64>) -> f64 {
    let model: Model<f64, 3> = ModelSpec::parse(spec).unwrap().build().unwrap();
    // The frame of a floor: its normal is y. All models here are isotropic, so that only the angles count.
    let local = |d: Vec3<f64>| Vec3::new(d.x, -d.z, d.y);
    let (rows, columns) = (300, 600);
    let mut sum = 0.0;
    for k in 0..rows * columns {
        let theta = 0.5 * PI * ((k / columns) as f64 + 0.5) / rows as f64;
        let ((sin, cos), (s, c)) = (
            Real::sin_cos(theta),
            Real::sin_cos(TAU * ((k % columns) as f64 + 0.5) / columns as f64),
        );
        let d = Vec3::new(sin * s, cos, -sin * c);
        let f = model.eval(local(d), local(towards));
        let radiance = env.radiance(d.to_f32());
        sum += f[1] * f64::from(radiance[1]) * cos * sin;
    }
    sum * 0.5 * PI / rows as f64 * TAU / columns as f64
}

fn estimate(
    scene: &Scene,
    integrator: Integrator,
    towards: Vec3<f64>,
    name: &str,
    count: u32,
) -> Moments {
    let towards = towards.to_f32();
    let ray = Ray::new(towards * 2.0, -towards);
    let mut moments = Moments::new();
    let seed = Rng::from_name(name).next_u64();
    let mut counts = RayCounts::default();
    for k in 0..count {
        let mut stream = SampleStream::new(SamplerKind::Independent, seed, 0, k);
        let sample = integrator.radiance(scene, &ray, &Interior::OUTSIDE, &mut stream, &mut counts);
        moments.push(f64::from(sample.radiance[1]));
    }
    moments
}

fn integrators(environment: EnvironmentSampling) -> [Integrator; 3] {
    [
        Integrator::Direct(Direct {
            environment,
            ..Direct::default()
        }),
        Integrator::Path(Path {
            max_bounces: 1,
            environment,
            ..Path::default()
        }),
        Integrator::Path(Path {
            max_bounces: 1,
            environment,
            light_samples: 2,
            splitting: 3,
            ..Path::default()
        }),
    ]
}

#[test]
fn every_sampling_gives_what_quadrature_gives() {
    let towards = Vec3::new(0.6, 0.64, 0.48);
    let level = sidak(1e-4, (2 * 3 * SAMPLINGS.len() * MODELS.len()) as u64);
    for (panorama, env) in panoramas() {
        for spec in MODELS {
            let truth = by_quadrature(spec, &env, towards);
            let scene = patch(spec, env.clone());
            for sampling in SAMPLINGS {
                for integrator in integrators(sampling) {
                    let name = format!("{panorama} {spec} {integrator:?}");
                    let found = estimate(&scene, integrator, towards, &name, 4000);
                    // The midpoints err by some 1e-4 of the whole.
                    let off = (found.mean() - truth).abs();
                    let right = off < 2e-4 * truth || t_test(&found, truth).p_value > level;
                    assert!(right, "{name}: {} against {truth}", found.mean());
                    assert!(
                        t_test(&found, 1.3 * truth).p_value < level,
                        "{name}: the control passed"
                    );
                }
            }
        }
    }
}

/// A part that reflects into one direction alone is not the product's: it has to come in once, and not twice.
#[test]
fn a_smooth_coat_is_counted_once() {
    let towards = Vec3::new(0.6, 0.64, 0.48);
    let (_, env) = &panoramas()[1];
    for spec in ["mirror", "mix(0.5, mirror, lambertian:reflectance=0.5)"] {
        let scene = patch(spec, env.clone());
        for k in 0..2 {
            let of = |s: EnvironmentSampling| {
                estimate(
                    &scene,
                    integrators(s)[k],
                    towards,
                    &format!("{spec} {s:?}"),
                    20_000,
                )
            };
            let (plain, product) = (of(SAMPLINGS[0]), of(SAMPLINGS[3]));
            let sigma = (plain.variance_of_mean() + product.variance_of_mean()).sqrt();
            let off = (plain.mean() - product.mean()).abs();
            assert!(
                off <= 5.0 * sigma + 1e-6 * plain.mean(),
                "{spec}: {} {}",
                plain.mean(),
                product.mean()
            );
            assert!(
                0.2 * plain.mean() > 5.0 * sigma,
                "{spec}: nothing would be noticed"
            );
        }
    }
}

/// The walls of a room shine by a smooth function of the place; a panorama of them is taken at `capture`.
fn wall(h: Vec3<f64>) -> [f32; 3] {
    let wave = |x: f64| (1.0 + Real::sin(2.0 * x)) as f32;
    [
        0.2 + wave(h.x),
        0.2 + wave(h.z + 0.7),
        0.2 + wave(h.y * 1.3),
    ]
}

const LOW: Vec3<f64> = Vec3::new(-2.0, 0.0, -3.0);
const HIGH: Vec3<f64> = Vec3::new(2.0, 2.5, 3.0);
const CAPTURE: Vec3<f64> = Vec3::new(0.4, 1.5, -1.0);

/// Where a ray from inside meets the room, by the slab on each axis.
fn meets(p: Vec3<f64>, d: Vec3<f64>) -> Vec3<f64> {
    let mut t = f64::INFINITY;
    for axis in 0..3 {
        let to = if d[axis] > 0.0 { HIGH[axis] } else { LOW[axis] };
        if d[axis] != 0.0 {
            t = t.min((to - p[axis]) / d[axis]);
        }
    }
    p + d * t
}

fn room(proxy: bool) -> Environment {
    let (width, height) = (1024, 512);
    let image = Image::from_fn(width, height, |x, y| {
        let uv = [
            (x as f64 + 0.5) / width as f64,
            (y as f64 + 0.5) / height as f64,
        ];
        wall(meets(CAPTURE, Layout::LatLong.direction(uv)))
    });
    let env = Environment::from_image(image, Layout::LatLong).unwrap();
    let words = "box:-2,0,-3,2,2.5,3@0.4,1.5,-1";
    env.with_proxy(proxy.then(|| words.parse().unwrap()))
}

/// What a ray from anywhere in the room sees is the wall that it meets, within the panorama's resolution: a texel is 0.006 rad, 3 cm on
/// the farthest wall, over which `wall` changes by 0.08 at most; on average by far less. Without the proxy it is another wall.
#[test]
fn a_room_is_seen_right_from_everywhere() {
    let mut rng = Rng::from_name("a room");
    let (with, without) = (room(true), room(false));
    let mut errors = [0.0_f64; 2];
    let mut worst = 0.0_f64;
    let count = 4000;
    for _ in 0..count {
        let share =
            Vec3::new(rng.next_f64(), rng.next_f64(), rng.next_f64()) * 0.9 + Vec3::splat(0.05);
        let p = LOW + (HIGH - LOW).mul_elementwise(share);
        let d = Environment::uniform([1.0; 3])
            .sample([rng.next_f32(), rng.next_f32()])
            .wi;
        let truth = wall(meets(p, d.to_f64()));
        for (error, env) in errors.iter_mut().zip([&with, &without]) {
            let seen = env.radiance_from(p.to_f32(), d);
            let off = f64::from((seen[0] - truth[0]).abs().max((seen[1] - truth[1]).abs()));
            *error += off / f64::from(count);
            if env.proxy().is_some() {
                worst = worst.max(off);
            }
        }
    }
    // Close to a wall a texel of the panorama stands for a steeper view: the mean stays far below, the worst within the bound.
    assert!(errors[0] < 0.005 && worst < 0.12, "{errors:?} {worst}");
    // Negative control.
    assert!(errors[1] > 0.3, "{errors:?}");
}

/// A white Lambertian patch in the room shows its irradiance / π: by quadrature over the true walls.
#[test]
fn a_room_lights_right_from_everywhere() {
    let place = Vec3::new(-1.2, 0.8, 1.9);
    let (rows, columns) = (400, 800);
    let mut truth = 0.0;
    for k in 0..rows * columns {
        let theta = 0.5 * PI * ((k / columns) as f64 + 0.5) / rows as f64;
        let ((sin, cos), (s, c)) = (
            Real::sin_cos(theta),
            Real::sin_cos(TAU * ((k % columns) as f64 + 0.5) / columns as f64),
        );
        let d = Vec3::new(sin * s, cos, -sin * c);
        truth += f64::from(wall(meets(place, d))[1]) * cos * sin;
    }
    truth *= 0.5 * PI / f64::from(rows) * TAU / f64::from(columns) / PI;
    for sampling in SAMPLINGS {
        for integrator in integrators(sampling) {
            let found = |proxy: bool| {
                let mut scene = SceneBuilder::new("room");
                let small = floor(0.0, 0.01);
                let placed = small.then(&Affine3::translation(place.to_f32()));
                add(
                    &mut scene,
                    Shape::Rectangle,
                    placed,
                    material("lambertian:reflectance=1"),
                );
                scene.environment(room(proxy));
                let scene = scene.build().unwrap();
                let eye = place + Vec3::new(0.0, 0.5, 0.0);
                let ray = Ray::new(eye.to_f32(), Vec3::new(0.0, -1.0, 0.0));
                let mut moments = Moments::new();
                let mut counts = RayCounts::default();
                let seed = Rng::from_name(integrator.name()).next_u64();
                for k in 0..4000 {
                    let mut stream = SampleStream::new(SamplerKind::Independent, seed, 0, k);
                    let sample = integrator.radiance(
                        &scene,
                        &ray,
                        &Interior::OUTSIDE,
                        &mut stream,
                        &mut counts,
                    );
                    moments.push(f64::from(sample.radiance[1]));
                }
                moments
            };
            let right = found(true);
            // The panorama's resolution, as above, beside the noise.
            let off = (right.mean() - truth).abs();
            assert!(
                off < 0.002 * truth || t_test(&right, truth).p_value > 1e-5,
                "{integrator:?}: {} {truth}",
                right.mean()
            );
            assert!(
                t_test(&found(false), truth).p_value < 1e-5,
                "{integrator:?}: the control passed"
            );
        }
    }
}
