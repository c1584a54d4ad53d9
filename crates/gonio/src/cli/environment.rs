//! The environment, as `render`, `measure` and `env` take it.

use super::failure::Failure;
use super::parse;
use gonio_env::{Environment, Layout, Proxy};
use gonio_scene::{LoadOptions, Scene};
use std::path::{Path, PathBuf};

/// Which light comes from infinitely far away.
#[derive(clap::Args)]
pub(super) struct EnvironmentArguments {
    /// Light from infinitely far away: a panorama (.hdr, .exr, .png, .jpg, .ktx2, .dds; or a folder of faces), uniform:RADIANCE, or sky:DATE@LATITUDE,LONGITUDE
    #[arg(long, value_name = "FILE")]
    env: Option<String>,
    /// Turn the environment about the vertical, counter-clockwise seen from above
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = parse::finite, allow_hyphen_values = true)]
    env_rotate: f32,
    /// The room around the panorama: box:X0,Y0,Z0,X1,Y1,Z1 or sphere:X,Y,Z,RADIUS, then @X,Y,Z where it was taken [default: the centre]
    #[arg(long, value_name = "PROXY", value_parser = proxy, allow_hyphen_values = true)]
    env_proxy: Option<Proxy>,
    #[command(flatten)]
    reading: PanoramaArguments,
}

impl EnvironmentArguments {
    /// The environment that was asked for, if any.
    pub fn load(&self) -> Result<Option<Environment>, Failure> {
        let Some(text) = &self.env else {
            return Ok(None);
        };
        Ok(Some(self.turned(self.reading.parse(text)?)))
    }

    /// How a scene's own environment is read.
    pub fn for_scene(&self) -> LoadOptions {
        LoadOptions {
            sanitize: self.reading.env_sanitize,
            ..LoadOptions::default()
        }
    }

    /// Puts the environment that was asked for into the scene, or turns the scene's own.
    pub fn apply(&self, scene: &mut Scene) -> Result<(), Failure> {
        if let Some(environment) = self.load()? {
            scene.set_environment(Some(environment));
        } else if (self.env_rotate != 0.0 || self.env_proxy.is_some())
            && let Some(environment) = scene.lights.environment().cloned()
        {
            scene.set_environment(Some(self.turned(environment)));
        }
        let replaced = scene.lights.environment().and_then(replaced);
        scene.warnings.extend(replaced);
        Ok(())
    }

    /// Everything that was asked for but the names of files, in words, and the files in a fixed order.
    pub fn described(&self) -> (String, Vec<PathBuf>) {
        let PanoramaArguments {
            env_layout,
            env_convention,
            env_sanitize,
            env_repair,
        } = &self.reading;
        let (name, files) = match self.env.as_deref() {
            None => ("none", Vec::new()),
            Some(text) if text.starts_with("uniform:") || text.starts_with("sky:") => {
                (text, Vec::new())
            }
            Some(text) => ("files", files_of(text)),
        };
        let text = format!(
            "{name} {} {:?} {env_layout:?} {env_convention:?} {env_sanitize} {env_repair}",
            self.env_rotate, self.env_proxy
        );
        (text, files)
    }

    /// `environment`, turned and in its room as asked.
    pub fn turned(&self, environment: Environment) -> Environment {
        let proxy = self.env_proxy.or(environment.proxy().copied());
        environment.rotated_deg(self.env_rotate).with_proxy(proxy)
    }
}

/// The files that a panorama may be read from: the file, those of the folder, or those of the pattern `{face}`; by their names.
fn files_of(text: &str) -> Vec<PathBuf> {
    let path = Path::new(text);
    let (folder, start, end) = match text.split_once("{face}") {
        // The place of a face's name is in the file's name.
        Some(_) => {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let (start, end) = name.split_once("{face}").unwrap_or_default();
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            (folder, start.to_owned(), end.to_owned())
        }
        None if path.is_dir() => (path.to_owned(), String::new(), String::new()),
        None => return vec![path.to_owned()],
    };
    let here = folder.as_os_str().is_empty();
    let entries = std::fs::read_dir(if here { Path::new(".") } else { &folder });
    let mut files: Vec<PathBuf> = entries
        .into_iter()
        .flatten()
        .filter_map(|entry| entry.ok())
        .filter(|entry| {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            name.starts_with(&start) && name.ends_with(&end) && entry.path().is_file()
        })
        .map(|entry| folder.join(entry.file_name()))
        .collect();
    files.sort();
    files
}

fn proxy(text: &str) -> Result<Proxy, String> {
    text.parse().map_err(|e: gonio_env::EnvError| e.to_string())
}

/// The warning that texels of a panorama are not what its file says.
pub(super) fn replaced(environment: &Environment) -> Option<String> {
    match environment.replaced_texels() {
        0 => None,
        1 => Some("one unsound texel of the panorama was replaced".into()),
        n => Some(format!("{n} unsound texels of the panorama were replaced")),
    }
}

/// How a panorama is read.
#[derive(clap::Args)]
pub(super) struct PanoramaArguments {
    /// Layout of the panorama: lat-long, cube, cube-cross, octahedral, equal-area-octahedral, angular, mirror-ball, dual-paraboloid …
    /// [default: found by its content and shape]
    #[arg(long, value_name = "LAYOUT", visible_alias = "from")]
    env_layout: Option<String>,
    /// Whose axes and orientation the panorama has: gonio, pbrt, mitsuba, blender, gltf, opengl or unreal
    /// [default: opengl for cubes in .ktx2 and .dds, else gonio]
    #[arg(long, value_name = "NAME", visible_alias = "from-convention")]
    env_convention: Option<String>,
    /// Replace NaN, infinite and negative texels of the panorama instead of refusing it
    #[arg(long)]
    env_sanitize: bool,
    /// Replace such texels by the mean of their sound neighbours
    #[arg(long, visible_alias = "repair")]
    env_repair: bool,
}

impl PanoramaArguments {
    /// The environment that `text` names: a file, uniform:RADIANCE, or sky:….
    pub fn parse(&self, text: &str) -> Result<Environment, Failure> {
        let layout = match &self.env_layout {
            None => None,
            Some(word) => Some(word.parse::<Layout>()?),
        };
        let options = gonio_env::LoadOptions {
            layout,
            convention: match &self.env_convention {
                None => None,
                Some(word) => Some(word.parse()?),
            },
            sanitize: self.env_sanitize,
            repair: self.env_repair,
            ..Default::default()
        };
        Ok(Environment::parse(text, &options)?)
    }
}
