//! T2 to T5: solid angle, spherical coordinates, the differential solid angle, radiance.

use super::within;
use crate::answer::Answer;
use crate::complaint::Complaint;
use gonio_num::Real;
use gonio_radiometry::direction::{spherical_coordinates_of_point, spherical_point};
use gonio_radiometry::solid_angle::{cone_of_angle, disk, jacobian, projected};
use serde_json::json;
use std::f64::consts::{PI, TAU};

pub(super) fn solid_angle(half_angle: f64) -> Result<Answer, Complaint> {
    let half = within("the half angle", half_angle, 0.0, 180.0)?;
    let steradians = cone_of_angle(half.to_radians());
    Ok(numbers(json!({
        "steradians": steradians,
        "share": steradians / (4.0 * PI),
    })))
}

/// There and back.
pub(super) fn spherical(theta: f64, phi: f64, r: f64) -> Result<Answer, Complaint> {
    let theta = within("θ", theta, 0.0, 180.0)?;
    let phi = within("φ", phi, -360.0, 360.0)?;
    let r = within("r", r, 0.0, 1e6)?;
    let p = spherical_point(r, theta.to_radians(), phi.to_radians());
    let (r, theta, phi) = spherical_coordinates_of_point(p);
    Ok(numbers(json!({
        "x": p.x, "y": p.y, "z": p.z,
        "back": { "r": r, "theta": theta.to_degrees(), "phi": phi.to_degrees() },
    })))
}

/// A patch around θ and φ: by its differential and exactly; and all patches of that size together.
pub(super) fn differential(
    [theta, phi]: [f64; 2],
    [dtheta, dphi]: [f64; 2],
) -> Result<Answer, Complaint> {
    let theta = within("θ", theta, 0.0, 180.0)?.to_radians();
    within("φ", phi, -360.0, 360.0)?;
    let dtheta = within("dθ", dtheta, 0.1, 90.0)?.to_radians();
    let dphi = within("dφ", dphi, 0.1, 90.0)?.to_radians();
    let cos = |angle: f64| Real::cos(angle.clamp(0.0, PI));
    let exact = (cos(theta - 0.5 * dtheta) - cos(theta + 0.5 * dtheta)) * dphi;
    let rows = (PI / dtheta).round().max(1.0);
    let columns = (TAU / dphi).round().max(1.0);
    let step = PI / rows;
    let sum: f64 = (0..rows as usize)
        .map(|i| columns * patch((i as f64 + 0.5) * step, step, TAU / columns))
        .sum();
    Ok(numbers(json!({
        "differential": patch(theta, dtheta, dphi),
        "exact": exact,
        "sum": sum,
        "whole": 4.0 * PI,
    })))
}

/// sinθ dθ dφ.
pub(super) fn patch(theta: f64, dtheta: f64, dphi: f64) -> f64 {
    jacobian::solid_angle_per_angles(theta) * dtheta * dphi
}

/// A round lamp that faces the receiver.
pub(super) fn radiance(radius: f64, distance: f64, radiance: f64) -> Result<Answer, Complaint> {
    let radius = within("the radius", radius, 1e-3, 1e3)?;
    let distance = within("the distance", distance, 1e-3, 1e6)?;
    let radiance = within("the radiance", radiance, 0.0, 1e9)?;
    let solid_angle = projected::disk_parallel(radius, distance, 0.0);
    let irradiance = radiance * solid_angle;
    Ok(numbers(json!({
        "solid_angle": disk(radius, distance),
        "projected": solid_angle,
        "irradiance": irradiance,
        "inverse_square": radiance * PI * radius * radius / (distance * distance),
        "ratio": irradiance / solid_angle,
    })))
}

fn numbers(answer: serde_json::Value) -> Answer {
    Answer::new(answer, Vec::new())
}
