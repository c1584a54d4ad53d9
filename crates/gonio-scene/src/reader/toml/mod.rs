//! The native scene format: one plain TOML file.
//!
//! Lengths are in metres, angles in degrees (`…_deg`), colours linear Rec.709: one number, `[r, g, b]`, or `"#rrggbb"`
//! (sRGB-encoded). +y is up. Paths are relative to the file. An unknown key, a wrong type, a number that isn't finite, or a
//! name that doesn't exist is an error that shows the line and, where one is near, the right word.
//!
//! ```toml
//! name = "preview"
//!
//! [film]
//! size = [1280, 720]
//!
//! [camera]                         # or [[camera]] several times
//! eye = [0, 1.2, 4]
//! target = [0, 0.6, 0]
//! fov_deg = 30                     # vertical
//! lens_radius = 0.02               # a thin lens, focused on the target unless focus_distance is given
//!
//! [environment]
//! file = "studio.hdr"              # or uniform = 1.0
//! rotate_deg = 40
//! scale = 1.0
//!
//! [[material]]
//! name = "gold"
//! model = "torrance-sparrow"
//! params = { roughness = 0.3, metal = "gold" }
//! textures = { roughness = { file = "scratches.png", channel = "g" } }
//!
//! [[shape]]
//! kind = "mesh"                    # mesh, gltf, sphere, rectangle, disk
//! file = "bunny.ply"
//! material = "gold"
//! translate = [0, 0.5, 0]
//!
//! [[light]]
//! kind = "point"                   # point, directional, spot
//! position = [2, 3, 1]
//! intensity = [40, 38, 35]         # W/sr
//! group = "key"                    # told apart in layers; shapes, materials that shine and the environment have it, too
//! ```

mod light;
mod material;
mod section;
mod shape;
mod source;
mod view;

use crate::SceneError;
use crate::{LoadOptions, SceneBuilder};
use section::Section;
use source::Source;
use std::path::Path;
use toml::de::DeTable;

/// The tables of a scene file.
const TABLES: [&str; 7] = [
    "name",
    "camera",
    "film",
    "environment",
    "material",
    "shape",
    "light",
];

/// Reads a scene file.
pub(super) fn read(
    builder: &mut SceneBuilder,
    path: &Path,
    options: &LoadOptions,
) -> Result<(), SceneError> {
    let bytes = options.files.read(path, options.max_bytes)?;
    let text = String::from_utf8(bytes).map_err(|e| {
        let place = format!("byte {}", e.utf8_error().valid_up_to());
        SceneError::format(path, place, "a byte that isn't UTF-8", "TOML text")
    })?;
    let source = Source {
        path: path.to_owned(),
        text,
    };
    read_text(builder, &source, options)
}

fn read_text(
    builder: &mut SceneBuilder,
    source: &Source,
    options: &LoadOptions,
) -> Result<(), SceneError> {
    let table = DeTable::parse(&source.text).map_err(|e| {
        source.error(
            e.span().unwrap_or(0..0),
            format!("this is not TOML: {}", e.message()),
            None,
        )
    })?;
    let top = Section::of_table(source, "the scene file", table.span(), table.get_ref());
    top.allow(&TABLES)?;
    if let Some(name) = top.text("name")? {
        builder.rename(name);
    }
    if let Some(film) = top.get("film") {
        view::film(builder, &Section::new(source, "[film]", film, &["size"])?)?;
    }
    for camera in top.tables("camera")? {
        view::camera(
            builder,
            &Section::new(source, "[camera]", camera, &view::CAMERA_KEYS)?,
        )?;
    }
    if let Some(environment) = top.get("environment") {
        light::environment(builder, source, environment, options)?;
    }
    let mut textures = material::Textures::new(source, options);
    for material in top.tables("material")? {
        let section = Section::new(source, "[[material]]", material, &material::KEYS)?;
        let made = material::read(&section, &mut textures)?;
        if let Some(twin) = builder.materials().iter().find(|m| m.name == made.name) {
            let message = format!("a second material called `{}`", twin.name);
            return Err(section.error_at("name", message, None));
        }
        builder.material(made);
    }
    let named = builder.materials().len();
    for shape in top.tables("shape")? {
        shape::read(builder, source, shape, named, options)?;
    }
    for light in top.tables("light")? {
        light::read(builder, source, light)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
