//! A bare mesh file as a scene: its parts, all grey, to be given materials by name.

use super::extension;
use crate::SceneBuilder;
use crate::mesh::{obj, ply};
use crate::{LoadOptions, Material, SceneError, Shape, TriangleMesh};
use gonio_brdf::ModelSpec;
use gonio_num::Affine3;
use std::path::Path;
use std::sync::Arc;

/// Adds an OBJ or PLY file, made of grey diffuse materials: one for each name after `usemtl`, or `default`.
pub(super) fn read(
    builder: &mut SceneBuilder,
    path: &Path,
    options: &LoadOptions,
) -> Result<(), SceneError> {
    let bytes = options.files.read(path, options.max_bytes)?;
    if extension(path) == "obj" {
        let file = obj::parse(&bytes, path)?;
        if !file.libraries.is_empty() {
            let named = file.libraries.join(", ");
            builder.warn(format!(
                "material libraries are not read ({named}): the materials are grey"
            ));
        }
        for part in file.parts {
            let name = part.material.as_deref().unwrap_or("default");
            add(builder, part.mesh, name)?;
        }
        return Ok(());
    }
    add(builder, ply::parse(&bytes, path)?, "default")
}

/// Adds a mesh of the grey material `name`, which is made if there is none yet.
fn add(builder: &mut SceneBuilder, mesh: TriangleMesh, name: &str) -> Result<(), SceneError> {
    let known = builder.materials().iter().position(|m| m.name == name);
    let material = match known {
        Some(index) => index as u32,
        None => builder.material(grey(name)?),
    };
    let shape = builder.shape(Shape::Mesh(Arc::new(mesh)));
    builder.instance(shape, Affine3::identity(), material);
    Ok(())
}

/// Adds the whole of an OBJ or PLY file as one shape.
pub(super) fn shape(
    builder: &mut SceneBuilder,
    path: &Path,
    options: &LoadOptions,
) -> Result<u32, SceneError> {
    let kind = extension(path);
    if !matches!(kind.as_str(), "obj" | "ply") {
        return Err(SceneError::Unsupported {
            path: path.to_owned(),
            what: format!("a mesh with the extension `{kind}`"),
            help: "meshes are .obj or .ply; a glTF file is a shape of kind \"gltf\"".into(),
        });
    }
    let bytes = options.files.read(path, options.max_bytes)?;
    let mesh = if kind == "obj" {
        obj::parse(&bytes, path)?.merged()
    } else {
        ply::parse(&bytes, path)?
    };
    Ok(builder.shape(Shape::Mesh(Arc::new(mesh))))
}

/// The material of surfaces that say nothing about theirs: Lambertian, reflectance 0.5.
pub(super) fn grey(name: &str) -> Result<Material, SceneError> {
    Material::new(
        name,
        &ModelSpec::from_pairs("lambertian", [("reflectance", "0.5")])?,
    )
}

#[cfg(test)]
mod tests {
    use crate::{LoadOptions, Scene};

    #[test]
    fn bare_meshes_are_scenes_of_named_grey_parts() {
        let folder = tempfile::tempdir().unwrap();
        let obj = folder.path().join("two.obj");
        let text =
            "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\nusemtl blue\nf 1 3 2\n";
        std::fs::write(&obj, text).unwrap();
        let scene = Scene::load(&obj, &LoadOptions::default()).unwrap();
        assert_eq!(
            (scene.name.as_str(), scene.material_names()),
            ("two", vec!["red", "blue"])
        );
        assert!(
            scene.warnings.iter().any(|w| w.contains("a.mtl")),
            "{:?}",
            scene.warnings
        );

        let ply = folder.path().join("one.ply");
        let text = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                    element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        std::fs::write(&ply, text).unwrap();
        let scene = Scene::load(&ply, &LoadOptions::default()).unwrap();
        assert_eq!(
            (scene.geometry.triangle_count(), scene.material_names()),
            (1, vec!["default"])
        );

        let toml = folder.path().join("both.toml");
        let shapes = ["two.obj", "one.ply"]
            .map(|f| format!("[[shape]]\nkind = \"mesh\"\nfile = \"{f}\"\n"))
            .concat();
        std::fs::write(&toml, shapes).unwrap();
        let scene = Scene::load(&toml, &LoadOptions::default()).unwrap();
        assert_eq!(
            (scene.geometry.triangle_count(), scene.materials.len()),
            (3, 1)
        );
        std::fs::write(&toml, "[[shape]]\nkind = \"mesh\"\nfile = \"a.glb\"\n").unwrap();
        let error = Scene::load(&toml, &LoadOptions::default()).unwrap_err();
        assert!(
            error.to_string().contains("both.toml:3:8") && error.help().unwrap().contains("gltf"),
            "{error}"
        );
    }
}
