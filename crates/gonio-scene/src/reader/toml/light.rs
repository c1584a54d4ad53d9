//! `[[light]]` and `[environment]`.

use super::section::{Section, Value};
use super::source::Source;
use super::view::refuse;
use crate::SceneError;
use crate::light::{Light, SpotCone, group};
use crate::{LoadOptions, SceneBuilder};
use gonio_env::{Convention, Environment, Layout, Proxy, Sky};
use gonio_num::Vec3;
use std::path::Path;

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Point,
    Directional,
    Spot,
}

/// `[[light]]`.
pub(super) fn read(
    builder: &mut SceneBuilder,
    source: &Source,
    value: &Value,
) -> Result<(), SceneError> {
    const NAME: &str = "[[light]]";
    let kinds = [
        ("point", Kind::Point),
        ("directional", Kind::Directional),
        ("spot", Kind::Spot),
    ];
    let section = Section::open(source, NAME, value)?;
    section.require("kind")?;
    let kind = section.choice("kind", &kinds)?.unwrap_or(Kind::Point);
    section.allow(match kind {
        Kind::Point => &["kind", "group", "position", "intensity"],
        Kind::Directional => &["kind", "group", "direction", "irradiance"],
        Kind::Spot => &[
            "kind",
            "group",
            "position",
            "direction",
            "target",
            "intensity",
            "inner_deg",
            "outer_deg",
        ],
    })?;
    let vector = |key: &str| -> Result<Vec3<f32>, SceneError> {
        section.require(key)?;
        Ok(section.vector(key)?.unwrap_or_default())
    };
    let colour = |key: &str| -> Result<[f32; 3], SceneError> {
        section.require(key)?;
        Ok(section.colour(key)?.unwrap_or_default())
    };
    let unit = |key: &str, v: Vec3<f32>| -> Result<Vec3<f32>, SceneError> {
        let n = v.to_f64().normalize().to_f32();
        if n.is_finite() {
            return Ok(n);
        }
        Err(section.error_at(key, format!("`{key}` gives no direction"), None))
    };
    let group = group(&section)?;
    let light = match kind {
        Kind::Point => Light::Point {
            position: vector("position")?,
            intensity: colour("intensity")?,
        },
        Kind::Directional => Light::Directional {
            direction: unit("direction", vector("direction")?)?,
            irradiance: colour("irradiance")?,
        },
        Kind::Spot => {
            let position = vector("position")?;
            let direction = if section.get("target").is_some() {
                refuse(&section, "direction", "`target` says where the spot points")?;
                unit("target", vector("target")? - position)?
            } else {
                unit("direction", vector("direction")?)?
            };
            let angle = "an angle from 0 to 90 degrees";
            let outer = section
                .number_in("outer_deg", 0.0, 90.0, angle)?
                .unwrap_or(30.0);
            let inner = section
                .number_in("inner_deg", 0.0, 90.0, angle)?
                .unwrap_or(0.0);
            let cone = SpotCone::new(inner.to_radians() as f32, outer.to_radians() as f32);
            let cone = cone.ok_or_else(|| {
                let message = format!(
                    "a cone from {inner} to {outer} degrees, expected 0 ≤ inner ≤ outer, outer > 0"
                );
                section.error_at("outer_deg", message, None)
            })?;
            Light::Spot {
                position,
                direction,
                intensity: colour("intensity")?,
                cone,
            }
        }
    };
    match group {
        Some(group) => builder.light_in(light, group),
        None => builder.light(light),
    }
    Ok(())
}

/// `group`: the group of lights that a table's light is in.
pub(super) fn group<'a>(section: &Section<'a>) -> Result<Option<&'a str>, SceneError> {
    match section.text("group")? {
        Some(name) if !group::is_name(name) => {
            let message = format!("`group` is {name:?}, expected {}", group::NAMES);
            Err(section.error_at("group", message, None))
        }
        other => Ok(other),
    }
}

/// The panorama in a file, or what is wrong with it and how to go on.
fn panorama(
    path: &Path,
    (layout, convention): (Option<Layout>, Option<Convention>),
    options: &LoadOptions,
) -> Result<Environment, (String, Option<String>)> {
    let bytes = options.files.read(path, options.max_bytes).map_err(|e| {
        let help = "a path is relative to the folder of the scene file";
        (e.to_string(), Some(help.into()))
    })?;
    let reading = gonio_env::LoadOptions {
        layout,
        convention,
        sanitize: options.sanitize,
        ..Default::default()
    };
    Environment::decode(&bytes, path, &reading).map_err(|e| (e.to_string(), e.help()))
}

/// `[environment]`.
pub(super) fn environment(
    builder: &mut SceneBuilder,
    source: &Source,
    value: &Value,
    options: &LoadOptions,
) -> Result<(), SceneError> {
    let keys = [
        "file",
        "uniform",
        "sky",
        "layout",
        "convention",
        "rotate_deg",
        "scale",
        "proxy",
        "group",
    ];
    let section = Section::new(source, "[environment]", value, &keys)?;
    let layouts = Layout::ALL.map(|layout| (layout.name(), layout));
    let conventions = Convention::ALL.map(|convention| (convention.name(), convention));
    let turned = (
        section.choice("layout", &layouts)?,
        section.choice("convention", &conventions)?,
    );
    let sky = section.text("sky")?;
    let mut made = match (section.path("file")?, section.colour("uniform")?, sky) {
        (Some(path), None, None) => panorama(&path, turned, options)
            .map_err(|(message, help)| section.error_at("file", message, help))?,
        (None, Some(radiance), None) => {
            refuse(&section, "layout", "a uniform environment has none")?;
            refuse(&section, "convention", "a uniform environment has none")?;
            Environment::uniform(radiance)
        }
        (None, None, Some(words)) => {
            refuse(&section, "layout", "a sky has none")?;
            refuse(&section, "convention", "a sky has none")?;
            let sky = words.parse().and_then(Sky::new);
            Environment::from_sky(
                sky.map_err(|e| section.error_at("sky", e.to_string(), e.help()))?,
            )
        }
        (None, None, None) => {
            let message = "[environment] needs `file`, `uniform` or `sky`";
            return Err(section.error(message, None));
        }
        (file, uniform, sky) => {
            let both = match (file, uniform, sky) {
                (Some(_), Some(_), _) => ["file", "uniform"],
                (Some(_), ..) => ["file", "sky"],
                _ => ["uniform", "sky"],
            };
            let message = format!("[environment] has both `{}` and `{}`", both[0], both[1]);
            return Err(section.error_at(both[1], message, None));
        }
    };
    if let Some(words) = section.text("proxy")? {
        let proxy = words.parse::<Proxy>();
        let proxy = proxy.map_err(|e| section.error_at("proxy", e.to_string(), e.help()))?;
        made = made.with_proxy(Some(proxy));
    }
    if let Some(yaw) = section.number("rotate_deg")? {
        made = made.rotated_deg(yaw as f32);
    }
    if let Some(scale) = section.colour("scale")? {
        made = made.scaled(scale);
    }
    if let Some(group) = group(&section)? {
        builder.environment_group(group);
    }
    builder.environment(made);
    Ok(())
}
