//! T7 to T13: what a function reflects of light from a sky, from a cone, from points; and how it changes when the surface turns.

use super::{steps as checked, within};
use crate::answer::{Answer, colours};
use crate::complaint::Complaint;
use crate::subject::{Angles, Subject};
use gonio_brdf::Brdf;
use gonio_num::{Frame, Real, Vec3};
use gonio_plot::numbers::directional_albedo;
use gonio_radiometry::photometry::relative_luminance;
use gonio_radiometry::quadrature::{GaussLegendre, Tolerance, adaptive};
use serde::Deserialize;
use serde_json::json;
use std::f64::consts::PI;

/// M and E under uniform light of radiance 1: M/E = ∫ a(θ) 2 cosθ sinθ dθ, averaged over azimuths.
pub(super) fn exitance(function: &str) -> Result<Answer, Complaint> {
    let subject = Subject::open(function)?;
    let f = subject.function();
    // A directional albedo is smooth in cosθ and takes milliseconds.
    let azimuths = if subject.spec.declares()?.isotropic {
        1
    } else {
        6
    };
    let albedo = GaussLegendre::new(6).integrate(0.0, 1.0, |cos: f64| {
        let theta = Real::acos(cos).to_degrees();
        let mut mean = [0.0; 3];
        for k in 0..azimuths {
            let phi = 360.0 * k as f64 / azimuths as f64;
            let a = directional_albedo(&f, theta, phi).reflected;
            for (m, a) in mean.iter_mut().zip(a) {
                *m += 2.0 * cos * a / azimuths as f64;
            }
        }
        mean
    });
    subject.sound()?;
    let exitance = albedo.map(|a| PI * a);
    Ok(Answer::new(
        json!({ "irradiance": PI, "exitance": exitance, "albedo": albedo }),
        Vec::new(),
    ))
}

/// Light of radiance 1 from a cone around `wi`: reflected radiance, irradiance, their ratio, and f, which it comes near.
pub(super) fn cone(
    function: &str,
    wi: Angles,
    wo: Angles,
    half_angle: f64,
) -> Result<Answer, Complaint> {
    let half = within("the half angle", half_angle, 0.1, 90.0)?.to_radians();
    let subject = Subject::open(function)?;
    let (wi, wo) = (wi.direction(), wo.direction());
    let frame = Frame::from_normal(wi);
    let tolerance = Tolerance {
        absolute: 1e-9,
        relative: 1e-6,
        max_evaluations: 100_000,
    };
    // Reflected in three channels, and the irradiance.
    let [r, g, b, irradiance] = adaptive::zone(Real::cos(half), 1.0, &tolerance, |local| {
        let w = frame.to_world(local);
        let [r, g, b] = subject.model.eval_cos(w, wo);
        match w.z > 0.0 {
            true => [r, g, b, w.z],
            false => [0.0; 4],
        }
    })
    .value;
    let ratio = [r, g, b].map(|x| x / irradiance);
    let f = subject.model.eval(wi, wo);
    subject.sound()?;
    Ok(Answer::new(
        json!({
            "reflected": [r, g, b],
            "irradiance": irradiance,
            "ratio": ratio,
            "f": f,
        }),
        Vec::new(),
    ))
}

/// f while the surface turns about its normal, under light and viewer that stay.
pub(super) fn turn(
    function: &str,
    wi: Angles,
    wo: Angles,
    steps: usize,
) -> Result<Answer, Complaint> {
    let steps = checked(steps, 720)?;
    let subject = Subject::open(function)?;
    // What the surface turns by, the directions turn back by in its own frame.
    let turned = |w: Angles, k: usize| {
        let phi = w.phi - 360.0 * k as f64 / steps as f64;
        Angles { phi, ..w }.direction()
    };
    let values: Vec<[f64; 3]> = (0..=steps)
        .map(|k| subject.model.eval(turned(wi, k), turned(wo, k)))
        .collect();
    subject.sound()?;
    let luminances = || values.iter().map(|v| relative_luminance(*v));
    Ok(Answer::new(
        json!({
            "least": luminances().fold(f64::INFINITY, f64::min),
            "largest": luminances().fold(0.0, f64::max),
        }),
        vec![("values", colours(values.iter().copied()))],
    ))
}

/// A light so far away that it is one direction; `radiance` is its irradiance on a surface that faces it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PointLight {
    theta: f64,
    phi: f64,
    radiance: [f64; 3],
}

/// Lr = Σ Li f cosθi.
pub(super) fn sum(function: &str, wo: Angles, lights: &[PointLight]) -> Result<Answer, Complaint> {
    const MOST: usize = 64;
    if lights.len() > MOST {
        let message = format!("{} lights are given, expected {MOST} at most", lights.len());
        return Err(Complaint::new(message));
    }
    let subject = Subject::open(function)?;
    let wo = wo.direction();
    let terms: Vec<[f64; 3]> = (lights.iter())
        .map(|light| {
            let wi: Vec3<f64> = Angles {
                theta: light.theta,
                phi: light.phi,
            }
            .direction();
            let f_cos = subject.model.eval_cos(wi, wo);
            [0, 1, 2].map(|k| light.radiance[k] * f_cos[k])
        })
        .collect();
    subject.sound()?;
    let sum = [0, 1, 2].map(|k| terms.iter().map(|t| t[k]).sum::<f64>());
    Ok(Answer::new(
        json!({ "sum": sum }),
        vec![("terms", colours(terms))],
    ))
}
