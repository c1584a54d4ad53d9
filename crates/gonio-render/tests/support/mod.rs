//! Small scenes with known answers, and the statistics to compare with them.
#![allow(dead_code)]

pub mod glass;

use gonio_brdf::ModelSpec;
use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::sequence::SamplerKind;
use gonio_render::integrator::{Direct, EnvironmentSampling, LightChoice, Path, Roulette};
use gonio_render::{Film, Integrator, Kept, PixelFilter, RenderOptions, Screen, Target, render};
use gonio_scene::{Camera, Light, Material, Scene, SceneBuilder, Shape};
use gonio_verify::statistics::{Moments, t_test};
use std::ops::ControlFlow;

pub const INTEGRATORS: [Integrator; 4] = [
    Integrator::Direct(Direct {
        environment: EnvironmentSampling::Luminance,
        without_cosine: false,
    }),
    Integrator::Path(Path {
        max_bounces: 64,
        roulette_after: 4,
        environment: EnvironmentSampling::Luminance,
        light_choice: LightChoice::Tree,
        light_samples: 1,
        light_candidates: 1,
        splitting: 1,
        roulette: Roulette::Throughput,
    }),
    SPLIT,
    JUDGED,
];
/// Path tracing with several samples at the first surface, and several candidates for each of light.
pub const SPLIT: Integrator = Integrator::Path(Path {
    max_bounces: 64,
    roulette_after: 2,
    environment: EnvironmentSampling::Luminance,
    light_choice: LightChoice::Tree,
    light_samples: 4,
    light_candidates: 2,
    splitting: 2,
    roulette: Roulette::Throughput,
});
/// Path tracing with roulette from the first surface on.
pub const JUDGED: Integrator = Integrator::Path(Path {
    max_bounces: 64,
    roulette_after: 4,
    environment: EnvironmentSampling::Luminance,
    light_choice: LightChoice::Tree,
    light_samples: 1,
    light_candidates: 1,
    splitting: 1,
    roulette: Roulette::Efficiency,
});
pub const SAMPLERS: [SamplerKind; 2] = [SamplerKind::Independent, SamplerKind::Sobol];

/// Probability that a right renderer fails one of these tests, before Šidák's correction over the tests of a file.
pub const FALSE_POSITIVE: f64 = 1e-6;

pub fn material(spec: &str) -> Material {
    Material::new(spec, &ModelSpec::parse(spec).unwrap()).unwrap()
}

pub fn emitter(spec: &str, radiance: [f32; 3]) -> Material {
    let mut material = material(spec);
    material.emission.radiance = radiance;
    material
}

/// One shape of one material.
pub fn add(scene: &mut SceneBuilder, shape: Shape, to_world: Affine3<f32>, material: Material) {
    let shape = scene.shape(shape);
    let material = scene.material(material);
    scene.instance(shape, to_world, material);
}

/// A horizontal square of half side `half` at height `y`, facing up.
pub fn floor(y: f32, half: f32) -> Affine3<f32> {
    Affine3::from_columns(
        Vec3::new(half, 0.0, 0.0),
        Vec3::new(0.0, 0.0, -half),
        Vec3::new(0.0, half, 0.0),
        Vec3::new(0.0, y, 0.0),
    )
}

/// The same, facing down.
pub fn ceiling(y: f32, half: f32) -> Affine3<f32> {
    Affine3::from_columns(
        Vec3::new(half, 0.0, 0.0),
        Vec3::new(0.0, 0.0, half),
        Vec3::new(0.0, -half, 0.0),
        Vec3::new(0.0, y, 0.0),
    )
}

/// A scene of a single sphere of radius 1 at the origin under uniform light.
pub fn furnace(spec: &str, radiance: f32) -> Scene {
    let mut scene = SceneBuilder::new("furnace");
    add(
        &mut scene,
        Shape::Sphere,
        Affine3::identity(),
        material(spec),
    );
    scene.light(Light::Environment(Environment::uniform([radiance; 3])));
    scene.build().unwrap()
}

/// Looks at the origin from above, so narrowly that every pixel sees a small part of what is there.
pub fn camera_above(height: f32, fov_deg: f32) -> Camera {
    Camera::look_at(
        Vec3::new(0.0, height, 0.0),
        Vec3::zero(),
        Vec3::new(0.0, 0.0, -1.0),
        fov_deg,
    )
    .unwrap()
}

/// Looks at the floor's middle from the height of an eye.
pub fn camera_before() -> Camera {
    Camera::look_at(
        Vec3::new(0.0, 1.6, 4.0),
        Vec3::new(0.0, 0.5, 0.0),
        Vec3::new(0.0, 1.0, 0.0),
        45.0,
    )
    .unwrap()
}

/// How likely two right pictures differ as much in channel `c`, the first of them made brighter by a factor: a t-test of the difference pixel by pixel.
pub fn p_of_difference(a: &Film, b: &Film, c: usize, brighter: f64) -> f64 {
    let mut moments = Moments::new();
    for (a, b) in a.pixels().iter().zip(b.pixels()) {
        moments.push(brighter * a.mean()[c] - b.mean()[c]);
    }
    t_test(&moments, 0.0).p_value
}

pub fn options(integrator: Integrator, sampler: SamplerKind, side: u32, spp: u32) -> RenderOptions {
    RenderOptions {
        width: side,
        height: side,
        target: Target {
            samples: spp,
            time: None,
            noise: None,
            adaptive: false,
        },
        integrator,
        sampler,
        screen: Screen::INDEPENDENT,
        filter: PixelFilter::Box,
        seed: 7,
        keep: Kept::NOTHING,
    }
}

pub fn picture(scene: &Scene, camera: &Camera, options: &RenderOptions) -> Film {
    let (film, _) = render(scene, camera, options, |_, _| ControlFlow::Continue(())).unwrap();
    assert_eq!(film.rejected().count, 0, "{:?}", film.rejected());
    film
}

/// The moments of the pixels of one channel. Pixels are independent, so a t-test over them is valid for every sampler.
pub fn pixel_moments(film: &Film, channel: usize) -> Moments {
    let mut moments = Moments::new();
    for pixel in film.pixels() {
        moments.push(pixel.mean()[channel]);
    }
    moments
}

/// Whether the mean of the picture agrees with `expected`, but for chance and a relative rounding of `rounding`.
pub fn agrees(film: &Film, expected: f64, rounding: f64) -> bool {
    (0..3).all(|c| {
        let moments = pixel_moments(film, c);
        (moments.mean() - expected).abs() <= rounding * expected.abs()
            || t_test(&moments, expected).p_value > FALSE_POSITIVE
    })
}
