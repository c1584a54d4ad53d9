//! The embedded scene: a preview object in rough gold, on a stand, under a panorama.
//!
//! Its files are in the repository's `assets/preview`.

use gonio_env::{EnvError, Environment};
use gonio_scene::{Files, LoadOptions, Scene, SceneError};
use std::path::Path;

/// The name of the material that the preview is about.
pub const OBJECT: &str = "object";

const SCENE: &[u8] = include_bytes!("../../../assets/preview/scene.toml");
const BALL: &[u8] = include_bytes!("../../../assets/preview/ball.glb");
const STAND: &[u8] = include_bytes!("../../../assets/preview/stand.glb");
const PANORAMA: &[u8] = include_bytes!("../../../assets/preview/sunset.hdr");

/// The preview scene.
///
/// ```
/// let scene = gonio::preview::scene()?;
/// assert!(scene.materials.iter().any(|m| m.name == gonio::preview::OBJECT));
/// # Ok::<(), gonio::scene::SceneError>(())
/// ```
///
/// # Errors
/// None in a sound build: the files are part of the program.
pub fn scene() -> Result<Scene, SceneError> {
    load(LoadOptions::default())
}

/// The preview scene, read as `options` say, but for the place of its files.
///
/// # Errors
/// If the options ask for what the scene doesn't have, such as another camera.
pub fn load(options: LoadOptions) -> Result<Scene, SceneError> {
    let files = Files::embedded([
        ("preview.toml", SCENE),
        ("ball.glb", BALL),
        ("stand.glb", STAND),
        ("sunset.hdr", PANORAMA),
    ]);
    Scene::load("preview.toml", &LoadOptions { files, ..options })
}

/// The embedded panorama, dawn on the Piazzetta in Venice: the light of scenes that have none.
///
/// # Errors
/// None in a sound build.
pub fn panorama() -> Result<Environment, EnvError> {
    Environment::decode(PANORAMA, Path::new("sunset.hdr"), &Default::default())
}
