//! glTF 2.0: documents, nodes, and what of them Gonio maps.
//!
//! The `gltf` crate parses the JSON; indices, lengths and enumerations are checked here, where they are used, because a
//! malformed document must give an error. Nothing is fetched from the network.

mod accessor;
mod container;
mod extension;
mod group;
mod image;
mod layers;
mod material;
mod node;
mod primitive;

use crate::{LoadOptions, SceneBuilder};
use crate::{Material, SceneError, Shape};
use accessor::Arrays;
use gltf::json::{self, mesh::Semantic, validation::Checked};
use gonio_num::Affine3;
use material::Materials;
use serde_json::error::Category;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Reads a glTF file's scene: surfaces, materials, cameras and lights.
pub(super) fn read(
    builder: &mut SceneBuilder,
    path: &Path,
    options: &LoadOptions,
) -> Result<(), SceneError> {
    let placement = Placement {
        to_world: Affine3::identity(),
        material: None,
        object_only: false,
    };
    append(builder, path, options, &placement)
}

/// How a glTF file is put into a scene.
pub(super) struct Placement {
    /// Applied to the whole of it.
    pub to_world: Affine3<f64>,
    /// Index of the material that replaces all of its own.
    pub material: Option<u32>,
    /// Leave its cameras and lights out.
    pub object_only: bool,
}

/// Adds a glTF file's scene to `builder`.
pub(super) fn append(
    builder: &mut SceneBuilder,
    path: &Path,
    options: &LoadOptions,
    placement: &Placement,
) -> Result<(), SceneError> {
    let bytes = options.files.read(path, options.max_bytes)?;
    let (text, bin) = container::split(path, &bytes)?;
    // First as plain JSON: extensions that change the document's form are named before they break the parsing.
    let plain: serde_json::Value =
        serde_json::from_slice(text).map_err(|e| json_error(path, &e))?;
    extension::check_required(path, &plain)?;
    check_version(path, &plain)?;
    drop(plain);
    let root: json::Root = serde_json::from_slice(text).map_err(|e| json_error(path, &e))?;
    let buffers = container::buffers(path, &root, bin, options)?;
    let arrays = Arrays {
        path,
        root: &root,
        buffers: &buffers,
    };
    for warning in extension::warnings(&root) {
        builder.warn(warning);
    }
    let images = image::Images::new(&arrays, options);
    let mut reader = Reader {
        arrays: &arrays,
        builder,
        materials: Materials {
            arrays: &arrays,
            images,
            warnings: Vec::new(),
        },
        material_of: HashMap::new(),
        meshes: HashMap::new(),
        coloured: coloured_materials(&root),
        placement,
        max_instances: options.max_instances,
    };
    let walked = reader.scene(options.scene);
    let warnings = std::mem::take(&mut reader.materials.warnings);
    for warning in warnings {
        builder.warn(warning);
    }
    walked
}

/// A document being put into a scene.
struct Reader<'a, 'b> {
    arrays: &'a Arrays<'a>,
    builder: &'b mut SceneBuilder,
    materials: Materials<'a>,
    /// Scene's index of each material of the document; `None` is the default material.
    material_of: HashMap<Option<usize>, u32>,
    /// Shapes and materials of each mesh of the document.
    meshes: HashMap<usize, Vec<(u32, u32)>>,
    /// The materials that are used with vertex colours.
    coloured: Vec<Option<usize>>,
    placement: &'a Placement,
    max_instances: usize,
}

impl Reader<'_, '_> {
    /// The shapes and materials of a mesh, read once.
    fn mesh(&mut self, index: usize) -> Result<Vec<(u32, u32)>, SceneError> {
        if let Some(known) = self.meshes.get(&index) {
            return Ok(known.clone());
        }
        let meshes = &self.arrays.root.meshes;
        let place = format!("mesh {index}");
        let mesh = meshes
            .get(index)
            .ok_or_else(|| self.arrays.missing(&place, meshes.len()))?;
        let mut parts = Vec::new();
        for (k, primitive) in mesh.primitives.iter().enumerate() {
            let place = match &mesh.name {
                Some(name) => format!("{place} ({name}), primitive {k}"),
                None => format!("{place}, primitive {k}"),
            };
            let own = primitive.material.map(|m| m.value());
            let material = match self.placement.material {
                Some(given) => given,
                None => self.material(own)?,
            };
            let tangents_for = self.builder.materials()[material as usize].tangents_uv_set();
            if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
                self.builder
                    .warn("morph targets are not applied: meshes have their base form");
            }
            match primitive::read(self.arrays, primitive, &place, tangents_for)? {
                primitive::Read::Mesh(mesh) => {
                    let shape = self.builder.shape(Shape::Mesh(Arc::new(mesh)));
                    parts.push((shape, material));
                }
                primitive::Read::Skipped(why) => self.builder.warn(why),
            }
        }
        self.meshes.insert(index, parts.clone());
        Ok(parts)
    }

    /// The scene's index of a material of the document, read when it is first used.
    fn material(&mut self, own: Option<usize>) -> Result<u32, SceneError> {
        if let Some(&known) = self.material_of.get(&own) {
            return Ok(known);
        }
        let coloured = self.coloured.contains(&own);
        let material: Material = match own {
            Some(index) => self.materials.material(index, coloured)?,
            None => self.materials.default_material(coloured)?,
        };
        let index = self.builder.material(material);
        self.material_of.insert(own, index);
        Ok(index)
    }
}

/// The materials that a primitive with vertex colours uses.
fn coloured_materials(root: &json::Root) -> Vec<Option<usize>> {
    let primitives = root.meshes.iter().flat_map(|m| &m.primitives);
    let mut found: Vec<Option<usize>> = primitives
        .filter(|p| {
            p.attributes
                .contains_key(&Checked::Valid(Semantic::Colors(0)))
        })
        .map(|p| p.material.map(|m| m.value()))
        .collect();
    found.sort_unstable();
    found.dedup();
    found
}

/// # Errors
/// [`SceneError::Format`] unless the document asks for glTF 2.
fn check_version(path: &Path, plain: &serde_json::Value) -> Result<(), SceneError> {
    let asset = &plain["asset"];
    let version = asset["minVersion"]
        .as_str()
        .or_else(|| asset["version"].as_str());
    match version {
        Some(v) if v == "2" || v.starts_with("2.") => Ok(()),
        Some(v) => Err(SceneError::format(
            path,
            "asset.version",
            format!("version {v}"),
            "glTF 2.0",
        )),
        None => Err(SceneError::format(
            path,
            "asset.version",
            "no version",
            "\"2.0\"",
        )),
    }
}

fn json_error(path: &Path, error: &serde_json::Error) -> SceneError {
    let place = format!("JSON, line {}, column {}", error.line(), error.column());
    let text = error.to_string();
    let what = text
        .rsplit_once(" at line ")
        .map_or(text.as_str(), |(what, _)| what);
    let found = match error.classify() {
        Category::Eof => "the end of the file".to_owned(),
        Category::Syntax | Category::Io => format!("text that is not JSON ({what})"),
        Category::Data => what.to_owned(),
    };
    SceneError::format(path, place, found, "a glTF 2.0 document")
}

#[cfg(test)]
mod tests;
