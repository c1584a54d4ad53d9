//! Readers of scenes, one file or folder a format.

mod gltf;
mod mesh;
mod tangent;
mod toml;

use crate::{Camera, SceneError};
use crate::{LoadOptions, Scene, SceneBuilder};
use gonio_brdf::registry;
use std::path::Path;

/// The extensions of the files that [`load`] reads.
const EXTENSIONS: [&str; 5] = ["toml", "gltf", "glb", "obj", "ply"];

/// Reads a scene, by the file's extension.
pub(crate) fn load(path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let mut builder = SceneBuilder::new(stem);
    match extension(path).as_str() {
        "toml" => toml::read(&mut builder, path, options)?,
        "gltf" | "glb" => gltf::read(&mut builder, path, options)?,
        "obj" | "ply" => mesh::read(&mut builder, path, options)?,
        other => return Err(unknown_format(path, other)),
    }
    let mut scene = builder.build()?;
    if let Some(choice) = &options.camera {
        choose_camera(&mut scene.cameras, choice)?;
    }
    Ok(scene)
}

/// A path's extension in lower case; empty without one.
fn extension(path: &Path) -> String {
    path.extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase()
}

fn unknown_format(path: &Path, extension: &str) -> SceneError {
    let what = match extension {
        _ if path.is_dir() => "a folder as a scene".into(),
        "" => "a scene file without an extension".into(),
        _ => format!("a scene file with the extension `{extension}`"),
    };
    SceneError::Unsupported {
        path: path.to_owned(),
        what,
        help: format!("Gonio reads .{}", EXTENSIONS.join(", .")),
    }
}

/// Moves the camera of this name, or else of this index, to the front.
fn choose_camera(cameras: &mut [Camera], choice: &str) -> Result<(), SceneError> {
    let by_name = cameras.iter().position(|c| c.name == choice);
    let by_index = || choice.parse().ok().filter(|&i: &usize| i < cameras.len());
    match by_name.or_else(by_index) {
        Some(at) => {
            cameras[..=at].rotate_right(1);
            Ok(())
        }
        None => {
            let names: Vec<&str> = cameras.iter().map(|c| c.name.as_str()).collect();
            let help = match (
                registry::suggest(choice, names.iter().copied()),
                cameras.len(),
            ) {
                (_, 0) => "the scene has no camera".into(),
                (Some(near), _) => format!("did you mean `{near}`?"),
                (None, 1) if names[0].is_empty() => "the scene has one camera: 0".into(),
                (None, 1) => format!("the scene has one camera: 0 ({})", names[0]),
                (None, n) => format!("the scene has cameras 0 to {}: {}", n - 1, names.join(", ")),
            };
            Err(SceneError::UnknownCamera {
                name: choice.into(),
                help,
            })
        }
    }
}
