//! `[[shape]]`: geometry placed in the world.

use super::light::group;
use super::section::{Section, Value};
use super::source::{Source, did_you_mean};
use super::view::refuse;
use crate::camera::look_at;
use crate::reader::{gltf, mesh};
use crate::{LoadOptions, SceneBuilder};
use crate::{SceneError, Shape};
use gonio_num::{Affine3, Vec3};
use std::path::Path;

const KEYS: [&str; 10] = [
    "kind",
    "group",
    "file",
    "material",
    "instances",
    "translate",
    "rotate_deg",
    "scale",
    "matrix",
    "look_at",
];
const TRANSFORM_KEYS: [&str; 5] = ["translate", "rotate_deg", "scale", "matrix", "look_at"];

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Mesh,
    Gltf,
    Sphere,
    Rectangle,
    Disk,
}

/// Reads a shape.
///
/// - `named`: how many of the builder's materials are the file's own
pub(super) fn read(
    builder: &mut SceneBuilder,
    source: &Source,
    value: &Value,
    named: usize,
    options: &LoadOptions,
) -> Result<(), SceneError> {
    let section = Section::new(source, "[[shape]]", value, &KEYS)?;
    let kinds = [
        ("mesh", Kind::Mesh),
        ("gltf", Kind::Gltf),
        ("sphere", Kind::Sphere),
        ("rectangle", Kind::Rectangle),
        ("disk", Kind::Disk),
    ];
    section.require("kind")?;
    let kind = section.choice("kind", &kinds)?.unwrap_or(Kind::Mesh);
    let material = material(builder, &section, named)?;
    let placements = placements(&section)?;
    let group = group(&section)?;
    let first = builder.instance_count();
    if kind == Kind::Gltf {
        let path = file(&section)?;
        let placement = gltf::Placement {
            to_world: Affine3::identity(),
            material,
            object_only: true,
        };
        // A choice of scene is meant for the file that was asked for, not for what it includes.
        let inner = LoadOptions {
            scene: None,
            ..options.clone()
        };
        gltf::append(builder, &path, &inner, &placement)
            .map_err(|e| unless_inside(&section, &path, e))?;
        builder.replicate(first, &placements);
        if let Some(group) = group {
            builder.group_from(first, group);
        }
        return Ok(());
    }
    let shape = match kind {
        Kind::Mesh => {
            let path = file(&section)?;
            mesh::shape(builder, &path, options).map_err(|e| unless_inside(&section, &path, e))?
        }
        Kind::Sphere => builder.shape(Shape::Sphere),
        Kind::Rectangle => builder.shape(Shape::Rectangle),
        Kind::Disk | Kind::Gltf => builder.shape(Shape::Disk),
    };
    if kind != Kind::Mesh {
        refuse(&section, "file", "only meshes and glTF files are read")?;
    }
    let material = match material {
        Some(material) => material,
        None => {
            let default = builder
                .materials()
                .iter()
                .skip(named)
                .position(|m| m.name == "default");
            match default {
                Some(at) => (named + at) as u32,
                None => builder.material(mesh::grey("default")?),
            }
        }
    };
    for to_world in placements {
        builder.instance(shape, to_world.to_f32(), material);
    }
    if let Some(group) = group {
        builder.group_from(first, group);
    }
    Ok(())
}

/// The material that a shape names.
fn material(
    builder: &SceneBuilder,
    section: &Section,
    named: usize,
) -> Result<Option<u32>, SceneError> {
    let Some(name) = section.text("material")? else {
        return Ok(None);
    };
    let own = &builder.materials()[..named];
    if let Some(index) = own.iter().position(|m| m.name == name) {
        return Ok(Some(index as u32));
    }
    let names: Vec<&str> = own.iter().map(|m| m.name.as_str()).collect();
    Err(section.error_at(
        "material",
        format!("there is no material `{name}`"),
        did_you_mean(name, &names),
    ))
}

fn file(section: &Section) -> Result<std::path::PathBuf, SceneError> {
    section.require("file")?;
    Ok(section.path("file")?.unwrap_or_default())
}

/// A file that can't be opened is shown where the scene names it; what is wrong inside is shown there.
fn unless_inside(section: &Section, path: &Path, error: SceneError) -> SceneError {
    match error {
        SceneError::Io {
            path: missing,
            source,
        } if missing == path => {
            section.error_at("file", format!("{}: {source}", missing.display()), None)
        }
        SceneError::Unsupported { what, help, .. } => section.error_at(
            "file",
            format!("{}: {what} is not supported", path.display()),
            Some(help),
        ),
        other => other,
    }
}

/// The placements of a shape: one for each of `instances`, inside the shape's own; or that alone.
fn placements(section: &Section) -> Result<Vec<Affine3<f64>>, SceneError> {
    let own = transform(section)?;
    let instances = section.tables("instances")?;
    if section.get("instances").is_none() {
        return Ok(vec![own]);
    }
    let mut placed = Vec::with_capacity(instances.len());
    for value in instances {
        let instance = Section::new(section.source, "an instance", value, &TRANSFORM_KEYS)?;
        placed.push(transform(&instance)?.then(&own));
    }
    Ok(placed)
}

/// The transform of a table: `matrix`; or `look_at`; or `scale`, then `rotate_deg` (about x, then y, then z), then `translate`.
fn transform(section: &Section) -> Result<Affine3<f64>, SceneError> {
    let m = if section.get("matrix").is_some() {
        for key in ["translate", "rotate_deg", "scale", "look_at"] {
            refuse(section, key, "`matrix` is the whole transform")?;
        }
        matrix(section)?
    } else {
        let scale = match section.get("scale").map(|v| v.get_ref().is_array()) {
            Some(true) => Vec3::from(section.numbers::<3>("scale")?.unwrap_or([1.0; 3])),
            _ => Vec3::splat(section.number("scale")?.unwrap_or(1.0)),
        };
        let turned = match section.get("look_at") {
            Some(value) => {
                refuse(section, "rotate_deg", "`look_at` turns the shape")?;
                towards(section, value)?
            }
            None => rotation(section.numbers::<3>("rotate_deg")?.unwrap_or([0.0; 3])),
        };
        let by = section.numbers::<3>("translate")?.unwrap_or([0.0; 3]);
        Affine3::scale(scale)
            .then(&turned)
            .then(&Affine3::translation(Vec3::from(by)))
    };
    if m.inverse().is_none() || m.to_f32().to_f64().inverse().is_none() {
        return Err(section.error("this transform flattens the shape: it has no inverse", None));
    }
    Ok(m)
}

/// About x, then y, then z \[°].
fn rotation([x, y, z]: [f64; 3]) -> Affine3<f64> {
    let axis = |k: usize| Vec3::new(f64::from(k == 0), f64::from(k == 1), f64::from(k == 2));
    let about = |k: usize, angle: f64| Affine3::rotation(axis(k), angle.to_radians());
    about(0, x).then(&about(1, y)).then(&about(2, z))
}

/// `look_at`: the shape's +z (the normal of a rectangle or disk) points from `from` (by default where `translate` puts it) to the
/// given target.
fn towards(section: &Section, value: &Value) -> Result<Affine3<f64>, SceneError> {
    let target = if value.get_ref().is_array() {
        section.vector("look_at")?.unwrap_or_default()
    } else {
        let table = Section::new(section.source, "look_at", value, &["target"])?;
        table.require("target")?;
        table.vector("target")?.unwrap_or_default()
    };
    let from = section.vector("translate")?.unwrap_or_default();
    // A viewer at the target who looks at the shape has +z towards the target.
    let turned = look_at(target, from, Vec3::new(0.0, 1.0, 0.0)).ok_or_else(|| {
        section.error_at("look_at", "`look_at` is where the shape itself is", None)
    })?;
    let m = turned.to_f64();
    Ok(Affine3::from_columns(m.x, m.y, m.z, Vec3::zero()))
}

/// `matrix`: 12 or 16 numbers, row by row; the last row, if given, is 0, 0, 0, 1.
fn matrix(section: &Section) -> Result<Affine3<f64>, SceneError> {
    let count = section
        .get("matrix")
        .and_then(|v| v.get_ref().as_array())
        .map_or(0, |a| a.len());
    let rows: [f64; 12] = if count == 16 {
        let all = section.numbers::<16>("matrix")?.unwrap_or([0.0; 16]);
        if all[12..] != [0.0, 0.0, 0.0, 1.0] {
            let message = format!(
                "the last row of `matrix` is {:?}, expected 0, 0, 0, 1",
                &all[12..]
            );
            return Err(section.error_at(
                "matrix",
                message,
                Some("write the matrix row by row".into()),
            ));
        }
        std::array::from_fn(|i| all[i])
    } else {
        section.numbers::<12>("matrix")?.unwrap_or([0.0; 12])
    };
    let column = |k: usize| Vec3::new(rows[k], rows[4 + k], rows[8 + k]);
    Ok(Affine3::from_columns(
        column(0),
        column(1),
        column(2),
        column(3),
    ))
}
