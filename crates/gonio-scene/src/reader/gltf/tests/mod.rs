use crate::{Light, LoadOptions, Ray, Scene, SceneError};
use gonio_num::Vec3;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

mod bad;
mod layers;

/// One triangle in the plane z = 0, with texture coordinates, and whatever else `change` makes of it.
fn document(change: impl FnOnce(&mut Value)) -> Value {
    let mut d = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2}, "indices": 1, "material": 0}]}],
        "materials": [{"name": "paint"}],
        "buffers": [{"byteLength": 66}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6},
            {"buffer": 0, "byteOffset": 42, "byteLength": 24}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC2"}
        ]
    });
    change(&mut d);
    d
}

fn bytes(positions: [f32; 9], indices: [u16; 3]) -> Vec<u8> {
    let mut out: Vec<u8> = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    out.extend(indices.iter().flat_map(|i| i.to_le_bytes()));
    let uvs: [f32; 6] = [0.0, 1.0, 1.0, 1.0, 0.0, 0.0];
    out.extend(uvs.iter().flat_map(|x| x.to_le_bytes()));
    out
}

const CORNERS: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

fn sound() -> Vec<u8> {
    bytes(CORNERS, [0, 1, 2])
}

/// A binary container.
fn glb(document: &Value, bin: &[u8]) -> Vec<u8> {
    let mut json = document.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    out.extend(2_u32.to_le_bytes());
    out.extend((28 + json.len() as u32 + bin.len() as u32).to_le_bytes());
    for (kind, data) in [(0x4E4F_534A_u32, json.as_slice()), (0x004E_4942, bin)] {
        out.extend((data.len() as u32).to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.extend(data);
    }
    out
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }
    fn write(&self, name: &str, bytes: &[u8]) -> PathBuf {
        let path = self.0.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    }
    fn load(&self, document: &Value, bin: &[u8]) -> Result<Scene, SceneError> {
        load(&self.write("a.glb", &glb(document, bin)))
    }
}

fn load(path: &Path) -> Result<Scene, SceneError> {
    Scene::load(path, &LoadOptions::default())
}

/// The error of a document, which must name the file.
fn refused(change: impl FnOnce(&mut Value), bin: &[u8]) -> SceneError {
    let folder = Folder::new();
    let error = folder.load(&document(change), bin).unwrap_err();
    assert!(error.to_string().contains("a.glb"), "{error}");
    error
}

#[test]
fn a_triangle_is_read_in_all_containers() {
    let folder = Folder::new();
    let scene = folder.load(&document(|_| ()), &sound()).unwrap();
    assert_eq!(
        (scene.geometry.triangle_count(), scene.material_names()),
        (1, vec!["paint"])
    );
    assert_eq!(scene.name, "a");
    let hit = scene
        .intersect(&Ray::new(
            Vec3::new(0.25, 0.25, 1.0),
            Vec3::new(0.0, 0.0, -1.0),
        ))
        .unwrap();
    assert_eq!(hit.ng, Vec3::new(0.0, 0.0, 1.0));
    assert!((hit.uv[0] - 0.25).abs() < 1e-6 && (hit.uv[1] - 0.75).abs() < 1e-6);

    folder.write("tri angle.bin", &sound());
    let beside = document(|d| d["buffers"][0]["uri"] = json!("tri%20angle.bin"));
    let path = folder.write("b.gltf", beside.to_string().as_bytes());
    assert_eq!(load(&path).unwrap().geometry.triangle_count(), 1);

    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let text: String = sound()
        .chunks(3)
        .flat_map(|c| {
            let n = c.iter().fold(0_u32, |n, &b| n << 8 | u32::from(b));
            [18, 12, 6, 0].map(|s| char::from(DIGITS[(n >> s & 63) as usize]))
        })
        .collect();
    let inline = document(|d| {
        d["buffers"][0]["uri"] = json!(format!("data:application/octet-stream;base64,{text}"))
    });
    let path = folder.write("c.gltf", inline.to_string().as_bytes());
    assert_eq!(load(&path).unwrap().geometry.triangle_count(), 1);
}

/// A mirrored node: the front stays the front (glTF 2.0 section 3.7.4).
#[test]
fn negative_scale_keeps_the_outside() {
    let folder = Folder::new();
    let mirrored = document(|d| d["nodes"][0]["scale"] = json!([-1, 1, 1]));
    let scene = folder.load(&mirrored, &sound()).unwrap();
    let hit = scene
        .intersect(&Ray::new(
            Vec3::new(-0.25, 0.25, 1.0),
            Vec3::new(0.0, 0.0, -1.0),
        ))
        .unwrap();
    assert_eq!(hit.ng, Vec3::new(0.0, 0.0, 1.0));
}

#[test]
fn nodes_share_a_mesh_and_multiply_transforms() {
    let folder = Folder::new();
    let tree = document(|d| {
        d["nodes"] = json!([
            {"children": [1, 2], "translation": [10, 0, 0]}, {"mesh": 0, "translation": [0, 5, 0]}, {"mesh": 0, "scale": [2, 2, 2]}
        ]);
    });
    let scene = folder.load(&tree, &sound()).unwrap();
    assert_eq!(scene.geometry.shapes().len(), 1);
    let at: Vec<_> = scene
        .geometry
        .instances()
        .iter()
        .map(|i| i.to_world.transform_point(Vec3::new(1.0, 0.0, 0.0)))
        .collect();
    assert_eq!(at, [Vec3::new(11.0, 5.0, 0.0), Vec3::new(12.0, 0.0, 0.0)]);
}

#[test]
fn materials_lights_and_cameras_are_mapped() {
    let folder = Folder::new();
    let full = document(|d| {
        d["materials"][0] = json!({
            "name": "glow", "extras": {"light_group": "lamps"}, "doubleSided": true, "alphaMode": "MASK", "alphaCutoff": 0.25,
            "emissiveFactor": [1, 0.5, 0], "pbrMetallicRoughness": {"baseColorFactor": [0.2, 0.4, 0.6, 0.5], "roughnessFactor": 0.3, "metallicFactor": 0},
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}, "KHR_materials_ior": {"ior": 1.33}, "KHR_materials_odd": {}}
        });
        d["extensionsUsed"] = json!(["KHR_materials_odd", "KHR_lights_punctual", "EXT_odd"]);
        d["extensions"] = json!({"KHR_lights_punctual": {"lights": [
            {"type": "point", "intensity": 3, "color": [1, 0, 0], "extras": {"light_group": "key"}},
            {"type": "directional", "intensity": 2, "extras": {"light_group": "key"}},
            {"type": "spot", "spot": {"outerConeAngle": 0.5}}
        ]}});
        d["nodes"] = json!([
            {"mesh": 0, "children": [1, 2, 3, 4, 5]},
            {"extensions": {"KHR_lights_punctual": {"light": 0}}, "translation": [0, 7, 0]},
            {"extensions": {"KHR_lights_punctual": {"light": 1}}, "extras": {"light_group": "sun", "other": [1]}},
            {"extensions": {"KHR_lights_punctual": {"light": 2}}, "extras": {"light_group": 3}},
            {"camera": 0, "translation": [0, 0, 5], "scale": [2, 2, 2]}, {"camera": 1, "name": "flat"}
        ]);
        d["cameras"] = json!([
            {"name": "eye", "type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1, "aspectRatio": 1.5}},
            {"type": "orthographic", "orthographic": {"xmag": 4, "ymag": 2, "znear": 0, "zfar": 9}}
        ]);
    });
    let scene = folder.load(&full, &sound()).unwrap();
    let material = &scene.materials[0];
    assert!(material.double_sided && !material.opacity.is_opaque());
    assert_eq!(material.emission.radiance, [8.0, 4.0, 0.0]);
    assert_eq!(
        material.spec().to_string(),
        "gltf:base_color=0.20000000298023224/0.4000000059604645/0.6000000238418579,ior=1.3300000429153442,metallic=0,roughness=0.30000001192092896"
    );
    let lights: Vec<_> = scene.lights.iter().collect();
    assert!(
        matches!(lights[0], Light::Point { position, intensity } if position.y == 7.0 && *intensity == [3.0, 0.0, 0.0])
    );
    assert!(
        matches!(lights[1], Light::Directional { direction, irradiance } if direction.z == -1.0 && *irradiance == [2.0; 3])
    );
    assert!(matches!(lights[2], Light::Spot { .. }));
    // Groups by the node, else by the light or the material; what can be no name is told.
    let groups = &scene.lights.groups();
    let of: Vec<&str> = (0..4)
        .map_while(|light| Some(groups[scene.lights.group(light)? as usize].as_str()))
        .collect();
    assert_eq!(of, ["key", "sun", "default", "lamps"]);
    let says = |w: &&String| w.contains("node 3: the extra property light_group is 3");
    assert_eq!(scene.warnings.iter().filter(says).count(), 1);
    assert!(matches!(
        lights[3],
        Light::Area {
            instance: 0,
            two_sided: true,
            ..
        }
    ));
    let names: Vec<_> = scene
        .cameras
        .iter()
        .map(|c| (c.name.as_str(), c.aspect))
        .collect();
    assert_eq!(names, [("eye", Some(1.5)), ("flat", Some(2.0))]);
    let all = scene.warnings.join("\n");
    assert!(
        all.contains("KHR_materials_odd is not mapped: 1 material is")
            && all.contains("EXT_odd")
            && all.contains("1 cd"),
        "{all}"
    );
}

#[test]
fn the_camera_is_chosen_by_name_or_index() {
    let folder = Folder::new();
    let two = document(|d| {
        d["nodes"] = json!([{"mesh": 0, "children": [1, 2]}, {"camera": 0, "name": "left"}, {"camera": 0, "name": "right"}]);
        d["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 0.6, "znear": 0.1}}]);
    });
    let path = folder.write("a.glb", &glb(&two, &sound()));
    let first = |choice: &str| {
        let options = LoadOptions {
            camera: Some(choice.into()),
            ..LoadOptions::default()
        };
        Scene::load(&path, &options).map(|s| s.cameras[0].name.clone())
    };
    assert_eq!(first("right").unwrap(), "right");
    assert_eq!(first("1").unwrap(), "right");
    assert_eq!(first("0").unwrap(), "left");
    assert_eq!(
        first("rigth").unwrap_err().help().unwrap(),
        "did you mean `right`?"
    );
    assert!(
        first("2")
            .unwrap_err()
            .to_string()
            .contains("no camera `2`")
    );
}

#[test]
fn points_and_lines_are_skipped_with_a_warning() {
    let folder = Folder::new();
    let mixed = document(|d| {
        d["meshes"][0]["primitives"] = json!([
            {"attributes": {"POSITION": 0}, "mode": 0}, {"attributes": {"POSITION": 0}, "mode": 3}, {"attributes": {"POSITION": 0}, "mode": 5}
        ]);
    });
    let scene = folder.load(&mixed, &sound()).unwrap();
    assert_eq!(scene.geometry.triangle_count(), 1);
    assert_eq!(
        scene
            .warnings
            .iter()
            .filter(|w| w.contains("skipped"))
            .count(),
        2,
        "{:?}",
        scene.warnings
    );
    let none = document(|d| {
        d["meshes"][0]["primitives"] = json!([{"attributes": {"POSITION": 0}, "mode": 0}])
    });
    assert!(matches!(
        folder.load(&none, &sound()).unwrap_err(),
        SceneError::Empty { .. }
    ));
}
