//! `[[material]]`: a model, its parameters, its textures, emission and opacity.

use super::light::group;
use super::section::{Section, Value, number_of};
use super::source::{Source, did_you_mean};
use crate::material::{AlphaMode, Channels, NormalMap, Opacity, TextureInput};
use crate::scene::LoadOptions;
use crate::texture::{Bitmap, Filter, Texture, Transfer, UvTransform, Wrap};
use crate::{Material, SceneError};
use gonio_brdf::{BrdfError, Kind, ModelSpec};
use gonio_image::{Limits, RawImage};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::DeValue;

pub(super) const KEYS: [&str; 9] = [
    "name",
    "model",
    "params",
    "textures",
    "normal",
    "emission",
    "opacity",
    "double_sided",
    "group",
];

const TEXTURE_KEYS: [&str; 11] = [
    "file",
    "channel",
    "scale",
    "offset",
    "colour_space",
    "wrap",
    "filter",
    "uv_set",
    "uv_offset",
    "uv_rotate_deg",
    "uv_scale",
];

/// The pictures of a scene file, each read once.
pub(super) struct Textures<'a> {
    source: &'a Source,
    options: &'a LoadOptions,
    limits: Limits,
    read: HashMap<PathBuf, Arc<Bitmap>>,
}

impl<'a> Textures<'a> {
    pub fn new(source: &'a Source, options: &'a LoadOptions) -> Self {
        let limits = Limits {
            max_pixels: options.max_texture_pixels,
            ..Limits::default()
        };
        Self {
            source,
            options,
            limits,
            read: HashMap::new(),
        }
    }

    fn bitmap(&mut self, file: &str, at: &Value) -> Result<Arc<Bitmap>, SceneError> {
        let path = self.source.relative(file);
        if let Some(known) = self.read.get(&path) {
            return Ok(known.clone());
        }
        let bytes = self
            .options
            .files
            .read(&path, self.options.max_bytes)
            .map_err(|e| self.source.error(at.span(), format!("texture {e}"), None))?;
        let raw = RawImage::decode_within(&bytes, &self.limits).map_err(|e| {
            self.source
                .error(at.span(), format!("texture {}: {e}", path.display()), None)
        })?;
        let bitmap = Arc::new(Bitmap::new(path.display().to_string(), raw));
        self.read.insert(path, bitmap.clone());
        Ok(bitmap)
    }

    /// A texture: the text of a file's path, or a table. `extra` are further keys that the table may have.
    fn input(
        &mut self,
        name: &str,
        value: &Value,
        transfer: Transfer,
        extra: &[&str],
    ) -> Result<TextureInput, SceneError> {
        if let DeValue::String(file) = value.get_ref() {
            let bitmap = self.bitmap(file, value)?;
            return Ok(TextureInput::new(
                Texture::new(bitmap, transfer),
                Channels::Rgb,
            ));
        }
        let keys: Vec<&str> = TEXTURE_KEYS.iter().chain(extra).copied().collect();
        let section = Section::new(self.source, name, value, &keys)?;
        let file = section.require("file")?;
        let path = section.text("file")?.unwrap_or_default();
        let spaces = [("srgb", Transfer::Srgb), ("linear", Transfer::Linear)];
        let transfer = section.choice("colour_space", &spaces)?.unwrap_or(transfer);
        let mut texture = Texture::new(self.bitmap(path, file)?, transfer);
        let wraps = [
            ("repeat", Wrap::Repeat),
            ("clamp", Wrap::Clamp),
            ("mirror", Wrap::Mirror),
        ];
        if let Some(wrap) = section.choice("wrap", &wraps)? {
            texture.wrap = [wrap; 2];
        }
        let filters = [("bilinear", Filter::Bilinear), ("nearest", Filter::Nearest)];
        texture.filter = section.choice("filter", &filters)?.unwrap_or_default();
        if let Some(set) = section.number("uv_set")? {
            if set != 0.0 && set != 1.0 {
                return Err(section.error_at(
                    "uv_set",
                    format!("`uv_set` is {set}, expected 0 or 1"),
                    None,
                ));
            }
            texture.uv_set = set as u8;
        }
        let offset = section.numbers::<2>("uv_offset")?.unwrap_or([0.0; 2]);
        let turn = section.number("uv_rotate_deg")?.unwrap_or(0.0);
        let scale = section.numbers::<2>("uv_scale")?.unwrap_or([1.0; 2]);
        texture.transform = UvTransform::new(
            offset.map(|x| x as f32),
            turn.to_radians() as f32,
            scale.map(|x| x as f32),
        );
        let channels = [
            ("rgb", Channels::Rgb),
            ("r", Channels::Red),
            ("g", Channels::Green),
            ("b", Channels::Blue),
            ("a", Channels::Alpha),
        ];
        let mut input = TextureInput::new(
            texture,
            section.choice("channel", &channels)?.unwrap_or_default(),
        );
        // For a normal map `scale` is one number, which its reader takes itself.
        if !extra.contains(&"normal") {
            input.scale = numbers_or_one(&section, "scale")?.unwrap_or([1.0; 3]);
            input.offset = numbers_or_one(&section, "offset")?.unwrap_or([0.0; 3]);
        }
        Ok(input)
    }
}

/// One number for all, or three.
fn numbers_or_one(section: &Section, key: &str) -> Result<Option<[f32; 3]>, SceneError> {
    match section.get(key).map(|v| v.get_ref()) {
        Some(DeValue::Array(_)) => Ok(section.numbers::<3>(key)?.map(|v| v.map(|x| x as f32))),
        _ => Ok(section.number(key)?.map(|x| [x as f32; 3])),
    }
}

/// Reads a material.
pub(super) fn read(section: &Section, textures: &mut Textures) -> Result<Material, SceneError> {
    section.require("name")?;
    let name = section.text("name")?.unwrap_or_default();
    let source = section.source;
    let model_text = section.text("model")?.unwrap_or("lambertian");
    let folder = source.relative("");
    let mut spec =
        ModelSpec::parse_in(model_text, &folder).map_err(|e| brdf_error(section, "model", &e))?;
    if let Some(params) = section.get("params") {
        let params = Section::open(source, "params", params)?;
        // A file comes first: it says which other parameters there are.
        let known = spec.info().map_or(&[][..], |info| info.parameters);
        let is_known = |key: &str| known.iter().any(|p| p.name == key);
        let (first, rest): (Vec<_>, Vec<_>) = params
            .entries()
            .into_iter()
            .partition(|(key, ..)| is_known(key));
        for (key, span, value) in first.into_iter().chain(rest) {
            set(&mut spec, key, value, &folder).map_err(|e| match e {
                // The key is wrong, or else its value.
                BrdfError::UnknownParameter { .. } => {
                    source.error(span.clone(), e.to_string(), parameter_help(&spec, key))
                }
                _ => source.error(value.span(), e.to_string(), e.help()),
            })?;
        }
    }
    let mut material =
        Material::new(name, &spec).map_err(|e| section.error(e.to_string(), e.help()))?;
    if let Some(table) = section.get("textures") {
        let parameters = spec
            .parameters()
            .map_err(|e| brdf_error(section, "model", &e))?;
        for (key, span, value) in Section::open(source, "textures", table)?.entries() {
            let declared = parameters.iter().find(|p| p.name == key);
            let is_colour = declared.is_some_and(|p| matches!(p.kind, Kind::Colour { .. }));
            let transfer = if is_colour {
                Transfer::Srgb
            } else {
                Transfer::Linear
            };
            if declared.is_none() {
                let message = format!("`{}` has no parameter `{key}`", spec.name);
                return Err(source.error(span, message, parameter_help(&spec, key)));
            }
            let mut input = textures.input(&format!("texture of {key}"), value, transfer, &[])?;
            if !is_colour && input.channels == Channels::Rgb {
                input.channels = Channels::Red;
            }
            material
                .bind_texture(key, input)
                .map_err(|e| source.error(span.clone(), e.to_string(), e.help()))?;
        }
    }
    if let Some(value) = section.get("normal") {
        let input = textures.input("normal", value, Transfer::Linear, &["normal"])?;
        let scale = match value.get_ref() {
            DeValue::Table(_) => Section::open(source, "normal", value)?
                .number("scale")?
                .unwrap_or(1.0),
            _ => 1.0,
        };
        material.normal_map = Some(NormalMap {
            texture: input.texture,
            scale: scale as f32,
        });
    }
    emission(section, &mut material, textures)?;
    if let Some(group) = group(section)? {
        if !material.emission.is_lit() {
            let message = "`group` is for lights, and this material has no `emission`";
            return Err(section.error_at("group", message, None));
        }
        material.emission.group = Some(group.into());
    }
    opacity(section, &mut material, textures)?;
    material.double_sided = section.flag("double_sided")?.unwrap_or(false);
    Ok(material)
}

/// `emission`: a colour, or a table of `radiance`, `strength` and `texture`.
fn emission(
    section: &Section,
    material: &mut Material,
    textures: &mut Textures,
) -> Result<(), SceneError> {
    let Some(value) = section.get("emission") else {
        return Ok(());
    };
    if !value.get_ref().is_table() {
        material.emission.radiance = section.colour("emission")?.unwrap_or_default();
        return Ok(());
    }
    let table = Section::new(
        section.source,
        "emission",
        value,
        &["radiance", "strength", "texture"],
    )?;
    let strength = table
        .number_in("strength", 0.0, 1e30, "a number ≥ 0")?
        .unwrap_or(1.0) as f32;
    let radiance = table
        .colour("radiance")?
        .unwrap_or([1.0; 3])
        .map(|r| r * strength);
    if radiance.iter().any(|r| !r.is_finite()) {
        return Err(table.error_at(
            "strength",
            format!("radiance × strength is {radiance:?}, expected finite numbers"),
            None,
        ));
    }
    material.emission.radiance = radiance;
    if let Some(texture) = table.get("texture") {
        let input = textures.input("texture of emission", texture, Transfer::Srgb, &[])?;
        material.emission.texture = Some(input.texture);
    }
    Ok(())
}

/// `opacity`: a number, or a table of `value`, `texture` and `cutoff`.
fn opacity(
    section: &Section,
    material: &mut Material,
    textures: &mut Textures,
) -> Result<(), SceneError> {
    let Some(value) = section.get("opacity") else {
        return Ok(());
    };
    const SHARE: &str = "a number from 0 to 1";
    let mut made = Opacity {
        mode: AlphaMode::Blend,
        ..Opacity::default()
    };
    if value.get_ref().is_table() {
        let table = Section::new(
            section.source,
            "opacity",
            value,
            &["value", "texture", "cutoff"],
        )?;
        made.factor = table.number_in("value", 0.0, 1.0, SHARE)?.unwrap_or(1.0) as f32;
        if let Some(cutoff) = table.number_in("cutoff", 0.0, 1.0, SHARE)? {
            made.mode = AlphaMode::Mask(cutoff as f32);
        }
        if let Some(texture) = table.get("texture") {
            let mut input = textures.input("texture of opacity", texture, Transfer::Linear, &[])?;
            let chosen = texture.get_ref().is_table() && texture.get_ref().get("channel").is_some();
            if !chosen {
                input.channels = Channels::Alpha;
            }
            made.texture = Some(input);
        }
    } else {
        made.factor = section
            .number_in("opacity", 0.0, 1.0, SHARE)?
            .unwrap_or(1.0) as f32;
    }
    material.opacity = made;
    Ok(())
}

/// Sets a parameter of a model from a TOML value.
fn set(spec: &mut ModelSpec, key: &str, value: &Value, folder: &Path) -> Result<(), BrdfError> {
    use gonio_brdf::Value as Parameter;
    match value.get_ref() {
        DeValue::String(text) => spec.set_text_in(key, text, folder),
        DeValue::Boolean(b) => spec.set_text(key, if *b { "on" } else { "off" }),
        DeValue::Array(items) if items.len() == 3 => {
            // What is no number becomes NaN, which no parameter takes.
            let mut rgb = [f64::NAN; 3];
            for (slot, item) in rgb.iter_mut().zip(items.iter()) {
                *slot = number_of(item.get_ref()).unwrap_or(f64::NAN);
            }
            spec.set(key, Parameter::Colour(rgb))
        }
        other => spec.set(key, Parameter::Number(number_of(other).unwrap_or(f64::NAN))),
    }
}

fn parameter_help(spec: &ModelSpec, key: &str) -> Option<String> {
    let names: Vec<&str> = spec.parameters().ok()?.iter().map(|p| p.name).collect();
    did_you_mean(key, &names)
}

fn brdf_error(section: &Section, key: &str, error: &BrdfError) -> SceneError {
    section.error_at(key, error.to_string(), error.help())
}
