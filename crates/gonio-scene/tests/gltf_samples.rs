//! Khronos sample models: each loads, and what could not be mapped is said. Skipped where the models are absent:
//! set `GONIO_GLTF_SAMPLES` to a folder that holds them.

use gonio_num::Vec3;
use gonio_scene::{Camera, LoadOptions, Scene};
use std::path::{Path, PathBuf};

/// Models, with what their READMEs let one expect: triangles at least, and words of a warning if there must be one.
const MODELS: [(&str, &str); 28] = [
    ("AnisotropyRotationTest", ""),
    ("Box", ""),
    ("BoxTextured", ""),
    ("BoxVertexColors", ""),
    ("Cameras", ""),
    ("ClearCoatCarPaint", ""),
    ("ClearCoatTest", ""),
    ("EmissiveStrengthTest", ""),
    ("FlightHelmet", ""),
    ("IridescenceLamp", ""),
    ("MeshPrimitiveModes", "skipped"),
    ("MetalRoughSpheresNoTextures", ""),
    ("MultiUVTest", ""),
    ("MultipleScenes", "2 scenes"),
    ("NegativeScaleTest", ""),
    ("NormalTangentTest", ""),
    ("OrientationTest", ""),
    ("SheenChair", "KHR_materials_variants"),
    ("SimpleInstancing", ""),
    ("SpecularTest", ""),
    ("TextureCoordinateTest", ""),
    ("TextureSettingsTest", ""),
    ("TextureTransformMultiTest", "unlit"),
    ("TransmissionRoughnessTest", ""),
    ("TransmissionTest", ""),
    ("TriangleWithoutIndices", ""),
    ("UnlitTest", "unlit"),
    ("VertexColorTest", ""),
];

/// The glTF file of a model in the folder of samples.
fn file(folder: &Path, model: &str) -> Option<PathBuf> {
    let candidates = [
        format!("glTF-Binary/{model}.glb"),
        format!("glTF/{model}.gltf"),
    ];
    candidates
        .iter()
        .map(|c| folder.join(model).join(c))
        .find(|p| p.exists())
}

fn samples() -> Option<PathBuf> {
    let given = std::env::var_os("GONIO_GLTF_SAMPLES").map(PathBuf::from);
    // Beside a checkout, or further up.
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let beside = root
        .ancestors()
        .map(|a| a.join("shared/data/gltf"))
        .find(|p| p.is_dir());
    given.or(beside)
}

#[test]
fn every_sample_loads() {
    let Some(folder) = samples() else {
        eprintln!("skipped: no folder of glTF samples (GONIO_GLTF_SAMPLES)");
        return;
    };
    for (model, expected) in MODELS {
        let Some(path) = file(&folder, model) else {
            eprintln!("skipped: no {model}");
            continue;
        };
        let scene =
            Scene::load(&path, &LoadOptions::default()).unwrap_or_else(|e| panic!("{model}: {e}"));
        println!(
            "{model}: {} triangles, {} instances, {} materials, {} lights, {} cameras",
            scene.geometry.triangle_count(),
            scene.geometry.instances().len(),
            scene.materials.len(),
            scene.lights.len(),
            scene.cameras.len()
        );
        for warning in &scene.warnings {
            println!("    {warning}");
        }
        assert!(scene.geometry.triangle_count() > 0, "{model}");
        let unexpected: Vec<_> = scene
            .warnings
            .iter()
            .filter(|w| {
                !w.contains("no light")
                    && !w.contains("degenerate triangle")
                    && (expected.is_empty() || !w.contains("KHR_") && !w.contains(expected))
            })
            .collect();
        assert!(unexpected.is_empty(), "{model}: {unexpected:?}");
        if !expected.is_empty() {
            assert!(
                scene.warnings.iter().any(|w| w.contains(expected)),
                "{model}: {:?}",
                scene.warnings
            );
        }
        shade_all_over(model, &scene);
    }
}

/// A coarse picture from the framing camera: nothing that is shaded is NaN, and the object is in the picture.
fn shade_all_over(model: &str, scene: &Scene) {
    let camera = Camera::framing(&scene.bounds(), 1.0);
    let mut hits = 0;
    for i in 0..48 * 48 {
        let film = [(i % 48) as f32 / 48.0, (i / 48) as f32 / 48.0];
        let ray = camera.ray(film, 1.0, [0.5; 2]);
        let Some(point) = scene.intersect(&ray) else {
            continue;
        };
        hits += 1;
        let wo = -ray.direction;
        let shading = scene.shade(&point, wo);
        assert!(
            shading.frame.n.is_finite() && shading.frame.n.dot(wo) > 0.0,
            "{model}"
        );
        assert!((0.0..=1.0).contains(&shading.alpha), "{model}");
        let f = gonio_brdf::Brdf::eval_cos(
            &*shading.model,
            Vec3::new(0.0, 0.0, 1.0),
            shading.frame.to_local(wo),
        );
        assert!(
            f.iter().all(|x| x.is_finite() && *x >= 0.0),
            "{model}: {f:?}"
        );
        assert!(
            scene.emitted(&point, wo).iter().all(|x| x.is_finite()),
            "{model}"
        );
    }
    assert!(hits > 20, "{model}: {hits} hits");
}
