//! Broken documents: an error that names the place, never a panic.

use super::*;

#[test]
fn bad_documents_are_refused_by_place() {
    let bin = sound();
    for (says, change) in [
        (
            "index below 3",
            (|d| d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(9))
                as fn(&mut Value),
        ),
        ("accessor 1", |d| {
            d["accessors"][1]["count"] = json!(4_000_000_000_u64)
        }),
        ("accessor 1", |d| {
            d["accessors"][1]["componentType"] = json!(5126)
        }),
        ("bufferView 0", |d| {
            d["bufferViews"][0]["byteOffset"] = json!(60)
        }),
        ("buffer 0", |d| d["buffers"][0]["byteLength"] = json!(100)),
        ("limit", |d| d["buffers"][0]["byteLength"] = json!(u64::MAX)),
        ("node 3", |d| d["scenes"][0]["nodes"] = json!([3])),
        ("reached twice", |d| d["nodes"][0]["children"] = json!([0])),
        ("mesh 5", |d| d["nodes"][0]["mesh"] = json!(5)),
        ("material 7", |d| {
            d["meshes"][0]["primitives"][0]["material"] = json!(7)
        }),
        ("scene 4", |d| d["scene"] = json!(4)),
        ("unknown mode", |d| {
            d["meshes"][0]["primitives"][0]["mode"] = json!(77)
        }),
        ("2 texture coordinates for 3", |d| {
            d["accessors"][2]["count"] = json!(2)
        }),
        ("version 1.0", |d| d["asset"]["version"] = json!("1.0")),
        ("no version", |d| d["asset"] = json!({})),
        ("JSON, line 1", |d| d["nodes"] = json!("none")),
        ("texture 0", |d| {
            d["materials"][0]["normalTexture"] = json!({"index": 0})
        }),
        ("camera 2", |d| d["nodes"][0]["camera"] = json!(2)),
        ("number out of range", |d| {
            d["nodes"][0]["translation"] = json!([1e39, 0, 0])
        }),
        ("field of view", |d| {
            d["nodes"][0]["camera"] = json!(0);
            d["cameras"] = json!([{"type": "perspective", "perspective": {"yfov": 9, "znear": 1}}]);
        }),
        ("color × intensity", |d| {
            d["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
            d["extensions"] =
                json!({"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": -1}]}});
        }),
    ] {
        let error = refused(change, &bin).to_string();
        assert!(error.contains(says), "{says}: {error}");
    }
}

#[test]
fn bad_vertices_are_refused_by_place() {
    let mut corners = CORNERS;
    corners[4] = f32::NAN;
    let error = refused(|_| (), &bytes(corners, [0, 1, 2])).to_string();
    assert!(
        error.contains("mesh 0, primitive 0, vertex 1") && error.contains("NaN"),
        "{error}"
    );
    let error = refused(|_| (), &bytes(CORNERS, [0, 1, 3])).to_string();
    assert!(
        error.contains("index 2") && error.contains("found 3"),
        "{error}"
    );
}

#[test]
fn missing_files_are_named() {
    let folder = Folder::new();
    let no_bin = document(|d| d["buffers"][0]["uri"] = json!("gone.bin"));
    let path = folder.write("a.gltf", no_bin.to_string().as_bytes());
    let error = load(&path).unwrap_err();
    assert!(
        matches!(&error, SceneError::Io { path, .. } if path.ends_with("gone.bin")),
        "{error}"
    );
    let textured = |uri: Value| {
        document(move |d| {
            d["materials"][0] = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}});
            d["textures"] = json!([{"source": 0}]);
            d["images"] = json!([uri]);
        })
    };
    let error = folder
        .load(&textured(json!({"uri": "gone.png"})), &sound())
        .unwrap_err();
    assert!(
        matches!(&error, SceneError::Io { path, .. } if path.ends_with("gone.png")),
        "{error}"
    );
    folder.write("broken.png", b"\x89PNG\r\n\x1a\nbroken");
    let error = folder
        .load(&textured(json!({"uri": "broken.png"})), &sound())
        .unwrap_err();
    assert!(
        matches!(error, SceneError::Image { .. })
            && error.to_string().contains("image 0 (broken.png)"),
        "{error}"
    );
    let error = folder
        .load(
            &textured(json!({"uri": "https://example.org/a.png"})),
            &sound(),
        )
        .unwrap_err();
    assert!(error.to_string().contains("nothing is fetched"), "{error}");
    let error = load(&folder.0.path().join("none.glb"))
        .unwrap_err()
        .to_string();
    assert!(error.contains("none.glb"), "{error}");
    let error = load(&folder.write("a.fbx", b"")).unwrap_err();
    assert!(error.help().unwrap().contains(".glb"), "{error}");
}

#[test]
fn required_extensions_are_named() {
    let draco = refused(
        |d| d["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]),
        &sound(),
    );
    assert!(
        draco.to_string().contains("KHR_draco_mesh_compression"),
        "{draco}"
    );
    assert!(draco.help().unwrap().contains("without mesh compression"));
    let folder = Folder::new();
    let prism = document(|d| {
        d["extensionsUsed"] = json!(["KHR_materials_dispersion"]);
        d["extensionsRequired"] = json!(["KHR_materials_dispersion"]);
    });
    let scene = folder.load(&prism, &sound()).unwrap();
    assert!(
        scene
            .warnings
            .iter()
            .any(|w| w.contains("KHR_materials_dispersion") && w.contains("required"))
    );
}

/// Every truncation, and 2,000 documents with one byte changed: an error or a scene, never a panic.
#[test]
fn damaged_files_never_panic() {
    let folder = Folder::new();
    let whole = glb(&document(|_| ()), &sound());
    for cut in 0..whole.len() {
        let path = folder.write("cut.glb", &whole[..cut]);
        assert!(load(&path).is_err(), "cut at {cut}");
    }
    let mut rng = gonio_radiometry::sequence::Rng::from_name("damaged files never panic");
    let mut survived = 0;
    for _ in 0..2_000 {
        let mut bytes = whole.clone();
        let at = rng.next_u32() as usize % bytes.len();
        bytes[at] = rng.next_u32() as u8;
        survived += usize::from(load(&folder.write("bent.glb", &bytes)).is_ok());
    }
    assert!(survived < 2_000);
}
