//! glTF extensions: what is mapped, what is left out, and what can't be done without.

use crate::SceneError;
use gltf::json;
use std::path::Path;

/// Extensions that are mapped.
const MAPPED: [&str; 16] = [
    "EXT_mesh_gpu_instancing",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    // Descriptive only.
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// Extensions without which the geometry or the textures can't be read, and how to do without them.
const ESSENTIAL: [(&str, &str); 5] = [
    (
        "KHR_draco_mesh_compression",
        "save the file without mesh compression, for instance: gltf-transform copy in.glb out.glb",
    ),
    (
        "EXT_meshopt_compression",
        "save the file without mesh compression, for instance: gltf-transform copy in.glb out.glb",
    ),
    (
        "KHR_texture_basisu",
        "save the textures as PNG, for instance: gltf-transform ktxdecompress in.glb out.glb",
    ),
    (
        "EXT_texture_webp",
        "save the textures as PNG, for instance: gltf-transform png in.glb out.glb",
    ),
    (
        "EXT_texture_avif",
        "save the textures as PNG, for instance: gltf-transform png in.glb out.glb",
    ),
];

/// # Errors
/// [`SceneError::Unsupported`] if the document requires an extension without which it can't be read. Materials that are
/// required but not mapped are only warned about: the geometry is right.
pub(super) fn check_required(path: &Path, plain: &serde_json::Value) -> Result<(), SceneError> {
    let required = plain["extensionsRequired"]
        .as_array()
        .map_or(&[][..], Vec::as_slice);
    for name in required.iter().filter_map(serde_json::Value::as_str) {
        if MAPPED.contains(&name) || name.starts_with("KHR_materials_") {
            continue;
        }
        let known = ESSENTIAL.iter().find(|(essential, _)| *essential == name);
        return Err(SceneError::Unsupported {
            path: path.to_owned(),
            what: format!("the required glTF extension {name}"),
            help: known.map_or(
                "save the file without this extension".into(),
                |(_, help)| (*help).into(),
            ),
        });
    }
    Ok(())
}

/// What of the document is not mapped, in words.
pub(super) fn warnings(root: &json::Root) -> Vec<String> {
    let mut warnings = Vec::new();
    for name in &root.extensions_used {
        if MAPPED.contains(&name.as_str()) {
            continue;
        }
        let required = if root.extensions_required.contains(name) {
            " (required by the file)"
        } else {
            ""
        };
        warnings.push(if name == "KHR_materials_variants" {
            format!("{name}: the default materials are used{required}")
        } else if name.starts_with("KHR_materials_") {
            let count = root.materials.iter().filter(|m| uses(m, name)).count();
            let materials = if count == 1 {
                "material is"
            } else {
                "materials are"
            };
            format!("{name} is not mapped: {count} {materials} rendered without it{required}")
        } else {
            format!("{name} is not mapped: what it adds is left out{required}")
        });
    }
    if !root.animations.is_empty() {
        warnings.push("animations are not played: the scene is as at rest".into());
    }
    if !root.skins.is_empty() {
        warnings.push("skins are not applied: meshes have their bind pose".into());
    }
    warnings
}

/// Whether a material has an extension that isn't mapped.
fn uses(material: &json::Material, name: &str) -> bool {
    let extensions = material.extensions.as_ref();
    extensions.is_some_and(|e| e.others.contains_key(name))
}
