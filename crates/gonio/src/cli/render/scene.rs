//! The scene of a rendering, as the arguments ask for it, and what it is told by.

use super::Arguments;
use crate::cli::environment::EnvironmentArguments;
use crate::cli::failure::Failure;
use crate::preview;
use gonio_brdf::{ModelSpec, Value};
use gonio_scene::{Files, LoadOptions, Scene, SceneError, Watch};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// A scene, and what it was made of.
pub(super) struct Loaded {
    pub scene: Scene,
    /// What was chosen where the arguments and the file are silent.
    pub notes: Vec<String>,
    /// A hash of everything that it was made of.
    pub hash: String,
    /// What it is called: the file's name without its folder, so that it is the same on every machine.
    pub name: String,
}

/// The scene as the arguments ask for it.
pub(super) fn load(arguments: &Arguments) -> Result<Loaded, Failure> {
    let mut notes = Vec::new();
    let read = Arc::new(Mutex::new(BTreeMap::new()));
    let load = LoadOptions {
        camera: arguments.camera.clone(),
        files: Files::Watched(watch(arguments.scene.as_deref(), &read)),
        ..arguments.environment.for_scene()
    };
    let mut scene = match &arguments.scene {
        Some(path) => load_scene(path, &load)?,
        None => preview::load(load)?,
    };
    for text in &arguments.material {
        replace_material(&mut scene, text, arguments.scene.is_none())
            .map_err(|failure| failure.about(&format!("--material '{text}'")))?;
    }
    arguments.environment.apply(&mut scene)?;
    if scene.lights.iter().next().is_none() {
        let panorama = preview::panorama()?;
        scene.set_environment(Some(arguments.environment.turned(panorama)));
        notes.push(
            "the scene has no light: the built-in panorama lights it; --env chooses another".into(),
        );
    }
    if scene.cameras.is_empty() {
        notes.push("the scene has no camera: it is seen from where all of it is in view".into());
    }
    let files = read.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let name = match &arguments.scene {
        Some(path) => path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into(),
        None => "preview".into(),
    };
    let hash = hash(&files, &scene, &arguments.environment)?;
    Ok(Loaded {
        scene,
        notes,
        hash,
        name,
    })
}

/// Reads a scene; one without content is named by its file.
pub(in crate::cli) fn load_scene(path: &Path, options: &LoadOptions) -> Result<Scene, Failure> {
    Scene::load(path, options).map_err(|e| match e {
        SceneError::Empty { .. } => Failure::from(e).about(&path.display().to_string()),
        other => other.into(),
    })
}

/// Follows one `--material`.
fn replace_material(scene: &mut Scene, text: &str, preview: bool) -> Result<(), Failure> {
    // Names of materials may hold any character, so the scene's own come first.
    let known = scene
        .material_names()
        .into_iter()
        .filter(|name| {
            text.strip_prefix(name)
                .is_some_and(|rest| rest.starts_with('='))
        })
        .max_by_key(|name| name.len())
        .map(str::len);
    let end = known.or_else(|| {
        text.find(['=', ':', '('])
            .filter(|i| text[*i..].starts_with('='))
    });
    let (target, spec) = match end {
        Some(end) => (&text[..end], &text[end + 1..]),
        None if preview => (preview::OBJECT, text),
        None => ("*", text),
    };
    let spec = ModelSpec::parse(spec)?;
    scene.replace_material(target, &spec)?;
    Ok(())
}

/// Files by their paths from the scene's folder, with the hashes of their contents.
type Contents = BTreeMap<PathBuf, blake3::Hash>;

/// Notes each file that is read. A folder's place is no part of what a scene is: paths begin at that of the scene's file.
fn watch(scene: Option<&Path>, read: &Arc<Mutex<Contents>>) -> Watch {
    let folder = scene.and_then(Path::parent).map(Path::to_owned);
    let read = read.clone();
    Watch(Arc::new(move |path, bytes| {
        let from_folder = folder.as_ref().and_then(|f| path.strip_prefix(f).ok());
        let mut files = read.lock().unwrap_or_else(PoisonError::into_inner);
        files.insert(from_folder.unwrap_or(path).to_owned(), blake3::hash(bytes));
    }))
}

/// The hash of what a scene is made of: its files, the descriptions of its materials with the files that they name, and the environment
/// that was asked for.
fn hash(
    files: &Contents,
    scene: &Scene,
    environment: &EnvironmentArguments,
) -> Result<String, Failure> {
    let mut hasher = blake3::Hasher::new();
    let mut add = |what: &str, text: &str| {
        // Lengths first: no two lists of texts look alike.
        for piece in [what, text] {
            hasher.update(&(piece.len() as u64).to_le_bytes());
            hasher.update(piece.as_bytes());
        }
    };
    for (path, hash) in files {
        add("file", &path.to_string_lossy());
        add("content", &hash.to_string());
    }
    for material in &scene.materials {
        add("material", &material.name);
        add("reflects", &described(material.spec())?);
    }
    let (text, files) = environment.described();
    add("environment", &text);
    for file in files {
        add("content", &hash_of_file(&file)?);
    }
    // 128 bits tell all scenes apart that anybody will make, and fit a line.
    let mut hex = hasher.finalize().to_hex().to_string();
    hex.truncate(32);
    Ok(hex)
}

/// A model's description with the contents of files instead of their names.
fn described(spec: &ModelSpec) -> Result<String, Failure> {
    let mut text = format!("{}(", spec.name);
    for (key, value) in &spec.values {
        text += key;
        text += "=";
        match value {
            Value::Path(file) => text += &hash_of_file(Path::new(file))?,
            Value::Models(models) => {
                for model in models {
                    text += &described(model)?;
                }
            }
            other => text += &other.to_string(),
        }
        text += ",";
    }
    Ok(text + ")")
}

fn hash_of_file(path: &Path) -> Result<String, Failure> {
    let mut hasher = blake3::Hasher::new();
    File::open(path)
        .and_then(|file| hasher.update_reader(file).map(|_| ()))
        .map_err(|e| Failure::io(&path.display().to_string(), "read", &e))?;
    Ok(hasher.finalize().to_string())
}
