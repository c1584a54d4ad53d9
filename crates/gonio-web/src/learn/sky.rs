//! T6 and T13: light from the whole hemisphere, as a sum over cells that comes near the integral.

use super::geometry::patch;
use super::steps as checked;
use crate::answer::{Answer, colours};
use crate::complaint::Complaint;
use crate::subject::{Angles, Subject};
use gonio_brdf::Brdf;
use gonio_num::{Real, Vec3};
use gonio_radiometry::direction::spherical_direction;
use gonio_radiometry::quadrature::{Tolerance, adaptive};
use serde::Deserialize;
use serde_json::json;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A sky above the surface.
#[derive(Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Sky {
    /// Of radiance 1.
    Uniform,
    /// (1 + 2 cosθ)/3, 1 at the zenith (Moon & Spencer 1942).
    Overcast,
    /// A bright spot at θ = 60°, φ = 0: exp(20 (cos γ − 1)), γ the angle from its centre.
    LowSun,
}

impl Sky {
    fn radiance(self, w: Vec3<f64>) -> f64 {
        match self {
            Self::Uniform => 1.0,
            Self::Overcast => (1.0 + 2.0 * w.z) / 3.0,
            Self::LowSun => {
                let sun = spherical_direction(PI / 3.0, 0.0);
                Real::exp(20.0 * (w.dot(sun) - 1.0))
            }
        }
    }
}

/// Rings of cells; each has four times as many cells as there are rings.
const MOST: usize = 32;

/// How far the integrals are from exact, at most: far below what a page shows.
const TOLERANCE: Tolerance = Tolerance {
    absolute: 1e-8,
    relative: 1e-7,
    max_evaluations: 400_000,
};

/// The centres of the cells of the hemisphere, θ outer, and what solid angle each covers.
fn cells(steps: usize) -> impl Iterator<Item = (Vec3<f64>, f64)> {
    let around = 4 * steps;
    let (dtheta, dphi) = (FRAC_PI_2 / steps as f64, TAU / around as f64);
    (0..steps).flat_map(move |i| {
        let theta = (i as f64 + 0.5) * dtheta;
        let solid_angle = patch(theta, dtheta, dphi);
        (0..around).map(move |j| {
            let phi = (j as f64 + 0.5) * dphi;
            (spherical_direction(theta, phi), solid_angle)
        })
    })
}

/// E = ∫ L cosθ dω.
pub(super) fn irradiance(sky: Sky, steps: usize) -> Result<Answer, Complaint> {
    let steps = checked(steps, MOST)?;
    let term = |(w, solid_angle): (Vec3<f64>, f64)| sky.radiance(w) * w.z * solid_angle;
    let sum = |steps| cells(steps).map(term).sum::<f64>();
    let [exact] = adaptive::hemisphere(&TOLERANCE, |w| [sky.radiance(w) * w.z]).value;
    Ok(Answer::new(
        json!({ "sum": sum(steps), "exact": exact }),
        vec![
            ("cells", cells(steps).map(|c| term(c) as f32).collect()),
            ("sums", (1..=MOST).map(|n| sum(n) as f32).collect()),
        ],
    ))
}

/// Lr = ∫ L f cosθ dω.
pub(super) fn reflection(
    function: &str,
    wo: Angles,
    sky: Sky,
    steps: usize,
) -> Result<Answer, Complaint> {
    let steps = checked(steps, MOST)?;
    let subject = Subject::open(function)?;
    let wo = wo.direction();
    let integrand = |w: Vec3<f64>| {
        let light = sky.radiance(w);
        subject.model.eval_cos(w, wo).map(|x| light * x)
    };
    let term = |(w, solid_angle)| integrand(w).map(|x| x * solid_angle);
    let sum = |steps| {
        cells(steps).map(term).fold([0.0; 3], |sum, t| {
            [sum[0] + t[0], sum[1] + t[1], sum[2] + t[2]]
        })
    };
    let exact = adaptive::hemisphere(&TOLERANCE, integrand).value;
    let answer = Answer::new(
        json!({ "sum": sum(steps), "exact": exact }),
        vec![
            ("sums", colours((1..=MOST).map(sum))),
            ("terms", colours(cells(steps).map(term))),
        ],
    );
    subject.sound()?;
    Ok(answer)
}
