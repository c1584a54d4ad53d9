//! Every choice of a light gives the same picture, by single paths and in waves.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

mod support;

use gonio_env::Environment;
use gonio_num::{Affine3, Vec3};
use gonio_radiometry::sequence::Rng;
use gonio_render::integrator::{EnvironmentSampling, LightChoice, Path};
use gonio_render::{Film, Integrator, RenderOptions};
use gonio_scene::{Light, Scene, SceneBuilder, Shape, TriangleMesh};
use std::sync::Arc;
use support::*;

/// Lamps of each way in which one is sampled, of which power and place differ, over surfaces that find them by lights, by reflection, or by
/// both, under a sky.
fn scene() -> Scene {
    let mut scene = SceneBuilder::new("light choice");
    for (placed, spec) in [
        (floor(0.0, 4.0), "lambertian:reflectance=0.6"),
        (
            Affine3::scale(Vec3::splat(0.45)).then(&Affine3::translation(Vec3::new(0.7, 0.5, 0.3))),
            "ggx:metal=gold,alpha=0.2",
        ),
    ] {
        let shape = if spec.starts_with("ggx") {
            Shape::Sphere
        } else {
            Shape::Rectangle
        };
        add(&mut scene, shape, placed, material(spec));
    }
    let lamp = |strength: f32| {
        emitter(
            "lambertian:reflectance=0.2",
            [strength, 0.8 * strength, 0.5 * strength],
        )
    };
    for k in 0..6 {
        let at = Vec3::new(k as f32 - 2.5, 0.6 + 0.2 * k as f32, 0.5 - 0.3 * k as f32);
        let placed =
            Affine3::scale(Vec3::splat(0.12 + 0.03 * k as f32)).then(&Affine3::translation(at));
        add(
            &mut scene,
            Shape::Sphere,
            placed,
            lamp(2.0 + 2.0 * k as f32),
        );
    }
    add(&mut scene, Shape::Rectangle, ceiling(2.5, 0.5), lamp(3.0));
    let fin = TriangleMesh {
        positions: [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ]
        .map(Into::into)
        .to_vec(),
        indices: vec![[0, 1, 2], [0, 2, 3]],
        ..TriangleMesh::default()
    };
    let mut both = lamp(4.0);
    both.double_sided = true;
    let placed =
        Affine3::scale(Vec3::splat(0.5)).then(&Affine3::translation(Vec3::new(-1.5, 0.2, 1.0)));
    add(&mut scene, Shape::Mesh(Arc::new(fin)), placed, both);
    // It shines nothing, and is none of those that are chosen from.
    scene.light(Light::Point {
        position: Vec3::new(0.0, 1.0, 0.0),
        intensity: [0.0; 3],
    });
    scene.light(Light::Point {
        position: Vec3::new(1.0, 2.0, 2.0),
        intensity: [1.0; 3],
    });
    scene.light(Light::Environment(Environment::uniform([0.3; 3])));
    scene.build().unwrap()
}

fn shot(scene: &Scene, path: Path, name: &str) -> Film {
    let options = RenderOptions {
        seed: Rng::from_name(name).next_u64(),
        ..options(Integrator::Path(path), SAMPLERS[0], 32, 256)
    };
    picture(scene, &camera_before(), &options)
}

/// Pixel by pixel the difference of two pictures is 0 in the mean, by a t-test over the pixels. The control is a picture that is 5 % brighter: where a
/// sample deviates by up to five times the mean, 1024 pixels of 256 samples do by 1 % of it.
/// Waves take the first picture; single paths the second, whose sky is sampled by candidates.
#[test]
fn the_same_picture_by_every_choice() {
    let scene = scene();
    for environment in [
        EnvironmentSampling::Luminance,
        EnvironmentSampling::Product(gonio_env::Candidates {
            light: 2,
            reflection: 2,
        }),
    ] {
        let by = |light_choice: LightChoice| {
            let path = Path {
                max_bounces: 4,
                environment,
                light_choice,
                ..Path::default()
            };
            shot(&scene, path, &format!("{path:?}"))
        };
        let tree = by(LightChoice::Tree);
        for choice in [LightChoice::Power, LightChoice::Uniform] {
            let other = by(choice);
            for c in 0..3 {
                let off = |brighter| p_of_difference(&tree, &other, c, brighter);
                let name = format!("{choice:?}, {environment:?}, channel {c}");
                assert!(off(1.0) > FALSE_POSITIVE, "{name}: {}", off(1.0));
                assert!(off(1.05) < FALSE_POSITIVE, "{name}: the control passed");
            }
        }
    }
}
