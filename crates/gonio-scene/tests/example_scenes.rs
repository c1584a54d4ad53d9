//! The example scenes of the repository load, without a warning and with all that a render needs.

use gonio_scene::{LoadOptions, Scene, SceneError};
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn example(name: &str) -> Scene {
    Scene::load(folder().join(name), &LoadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn every_example_loads() {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder()).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "toml") {
            continue;
        }
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let scene = example(&name);
        assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
        assert_eq!(scene.cameras.len(), 1, "{name}");
        assert!(scene.film_size.is_some(), "{name}");
        assert!(!scene.geometry.instances().is_empty(), "{name}");
        assert!(scene.lights.each().next().is_some(), "{name} is dark");
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        assert_eq!(scene.name, stem);
        // Whoever opens the picture sees something: the centre of the image, or the lower half's, shows a surface.
        let camera = &scene.cameras[0];
        let seen = |film| scene.intersect(&camera.ray(film, 1.0, [0.5; 2])).is_some();
        assert!(
            (1..20).any(|k| seen([k as f32 / 20.0, 0.5])),
            "{name} shows nothing"
        );
        found.push(name);
    }
    for name in [
        "cornell.toml",
        "furnace.toml",
        "glass.toml",
        "groups.toml",
        "spheres.toml",
    ] {
        assert!(found.iter().any(|f| f == name), "{name} is missing");
    }
}

/// The boxes of `cornell.toml` are made of rectangles by `instances`: each is closed, with its faces outwards.
#[test]
fn the_boxes_of_the_cornell_box_are_closed() {
    let scene = example("cornell.toml");
    // Six walls and the lamp less the front, and two boxes of six faces.
    assert_eq!(scene.geometry.instances().len(), 6 + 2 * 6);
    for b in 0..2 {
        let faces = &scene.geometry.instances()[6 + 6 * b..][..6];
        let centre = faces
            .iter()
            .fold(gonio_num::Vec3::zero(), |sum, f| sum + f.to_world.origin)
            * (1.0 / 6.0);
        for face in faces {
            let out = face.to_world.origin - centre;
            let cos = out.dot(face.to_world.z) / (out.length() * face.to_world.z.length());
            assert!(cos > 0.9999, "a face looks {cos} outwards");
        }
    }
}

/// The bodies of `glass.toml` are closed, with their insides inside: also the block, of six rectangles, and the bubble in the amber.
#[test]
fn the_bodies_of_the_glass_scene_are_closed() {
    let scene = example("glass.toml");
    let inside = |p: [f32; 3]| {
        let interior = scene.interior_at(p.into());
        let names = interior.bodies().iter();
        names
            .map(|b| scene.materials[b.material as usize].name.clone())
            .collect::<Vec<_>>()
    };
    assert_eq!(inside([-2.3, 1.0, 0.0]), ["clear"]);
    assert_eq!(inside([0.2, 0.7, -0.3]), ["bottle"]);
    assert_eq!(inside([2.35, 1.0, 0.0]), ["amber"]);
    assert_eq!(inside([2.05, 1.3, 0.45]), ["amber", "air"]);
    for outside in [[-0.9, 0.9, 0.7], [0.2, 1.6, -0.3], [2.35, 0.0005, 3.0]] {
        assert!(inside(outside).is_empty(), "{outside:?}");
    }
}

/// The control: a scene that isn't there, or that says what no scene says, is an error.
#[test]
fn what_is_no_example_is_refused() {
    let options = LoadOptions::default();
    assert!(matches!(
        Scene::load(folder().join("no-such.toml"), &options),
        Err(SceneError::Io { .. })
    ));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("cornell.toml");
    let text = std::fs::read_to_string(self::folder().join("cornell.toml")).unwrap();
    std::fs::write(&path, text.replacen("reflectance", "reflectence", 1)).unwrap();
    let message = Scene::load(&path, &options).unwrap_err().to_string();
    assert!(message.contains("reflectence"), "{message}");
}
