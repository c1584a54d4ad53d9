//! `[camera]` and `[film]`.

use super::section::Section;
use crate::SceneBuilder;
use crate::SceneError;
use crate::camera::{Camera, Projection, look_at};
use gonio_num::Vec3;

pub(super) const CAMERA_KEYS: [&str; 9] = [
    "name",
    "kind",
    "eye",
    "target",
    "up",
    "fov_deg",
    "lens_radius",
    "focus_distance",
    "half_height",
];

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Perspective,
    Orthographic,
}

/// The largest side of an image.
const MAX_SIDE: f64 = 65_536.0;

/// `[film]`: `size = [width, height]`.
pub(super) fn film(builder: &mut SceneBuilder, section: &Section) -> Result<(), SceneError> {
    section.require("size")?;
    if let Some(size) = section.numbers::<2>("size")? {
        if size
            .iter()
            .any(|&s| s.fract() != 0.0 || !(1.0..=MAX_SIDE).contains(&s))
        {
            let message =
                format!("`size` is {size:?}, expected two whole numbers from 1 to {MAX_SIDE}");
            return Err(section.error_at("size", message, None));
        }
        builder.film_size(size.map(|s| s as u32));
    }
    Ok(())
}

/// `[camera]`.
pub(super) fn camera(builder: &mut SceneBuilder, section: &Section) -> Result<(), SceneError> {
    let kinds = [
        ("perspective", Kind::Perspective),
        ("orthographic", Kind::Orthographic),
    ];
    let kind = section.choice("kind", &kinds)?.unwrap_or(Kind::Perspective);
    section.require("eye")?;
    section.require("target")?;
    let eye = section.vector("eye")?.unwrap_or_default();
    let target = section.vector("target")?.unwrap_or_default();
    let up = section.vector("up")?.unwrap_or(Vec3::new(0.0, 1.0, 0.0));
    let placed = look_at(eye, target, up)
        .ok_or_else(|| section.error_at("target", "`eye` and `target` are the same point", None))?;
    let projection = match kind {
        Kind::Perspective => {
            refuse(section, "half_height", "only an orthographic camera has it")?;
            let fov_deg = section
                .number_in(
                    "fov_deg",
                    0.01,
                    179.0,
                    "a vertical field of view from 0.01 to 179 degrees",
                )?
                .unwrap_or(40.0);
            let fov_y_rad = fov_deg.to_radians() as f32;
            let lens_radius = section
                .number_in("lens_radius", 0.0, 1e6, "a radius ≥ 0 in metres")?
                .unwrap_or(0.0);
            let to_target = f64::from((target - eye).length());
            let focus = section
                .number_in("focus_distance", 1e-6, 1e12, "a distance > 0 in metres")?
                .unwrap_or(to_target);
            if lens_radius > 0.0 {
                Projection::ThinLens {
                    fov_y_rad,
                    lens_radius: lens_radius as f32,
                    focus_distance: focus as f32,
                }
            } else {
                Projection::Pinhole { fov_y_rad }
            }
        }
        Kind::Orthographic => {
            for key in ["fov_deg", "lens_radius", "focus_distance"] {
                refuse(section, key, "only a perspective camera has it")?;
            }
            section.require("half_height")?;
            let half = section.number_in("half_height", 1e-9, 1e12, "a length > 0 in metres")?;
            Projection::Orthographic {
                half_height: half.unwrap_or(1.0) as f32,
            }
        }
    };
    let name = section.text("name")?.unwrap_or_default();
    builder.camera(Camera::new(name, &placed, projection)?);
    Ok(())
}

/// An error if a key is given that has no meaning here.
pub(super) fn refuse(section: &Section, key: &str, why: &str) -> Result<(), SceneError> {
    match section.get(key) {
        None => Ok(()),
        Some(_) => Err(section.error_at(key, format!("`{key}` has no meaning here: {why}"), None)),
    }
}
