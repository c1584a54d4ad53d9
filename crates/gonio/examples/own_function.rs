//! Is a reflection function of one's own physical? As a closure, with its sampling.
//!
//! The function is diffuse with a Schlick term for the light that a coat reflects before it gets in. Once it is written as it
//! often is, with the cosine of wi alone, and once with that of both directions.
//!
//! `cargo run --release --example own_function`

use gonio::num::Vec3;
use gonio::radiometry::warp;
use gonio::verify::{Effort, Expectation, Report, Subject, SubjectFailed, SubjectSample, check};
use std::f64::consts::PI;

fn main() -> Result<(), SubjectFailed> {
    for report in [hasty()?, careful()?] {
        println!("{report}\n");
    }
    Ok(())
}

/// Schlick's share of light that is not reflected by the coat (17), F0 = 0.04.
fn passes(cos_theta: f64) -> f64 {
    1.0 - (0.04 + 0.96 * (1.0 - cos_theta).powi(5))
}

/// Light passes the coat on its way in, and is forgotten on its way out: not reciprocal.
pub fn hasty() -> Result<Report, SubjectFailed> {
    judge("hasty", |wi, _| 0.8 / PI * passes(wi.z))
}

/// Light passes the coat on both ways.
pub fn careful() -> Result<Report, SubjectFailed> {
    judge("careful", |wi, wo| 0.8 / PI * passes(wi.z) * passes(wo.z))
}

/// Checks a function of the directions above the horizon that is sampled in proportion to the cosine.
fn judge(
    name: &str,
    f: impl Fn(Vec3<f64>, Vec3<f64>) -> f64 + Sync,
) -> Result<Report, SubjectFailed> {
    let above = |wi: Vec3<f64>, wo: Vec3<f64>| wi.z > 0.0 && wo.z > 0.0;
    let eval = |wi: Vec3<f64>, wo: Vec3<f64>| match above(wi, wo) {
        true => [f(wi, wo); 3],
        false => [0.0; 3],
    };
    let pdf = |wi: Vec3<f64>, wo: Vec3<f64>| match above(wi, wo) {
        true => wi.z / PI,
        false => 0.0,
    };
    let sample = |wo: Vec3<f64>, u: [f64; 3]| {
        let wi = warp::cosine_hemisphere([u[0], u[1]]);
        above(wi, wo).then(|| SubjectSample {
            wi,
            // f cosθ / pdf
            weight: [f(wi, wo) * PI; 3],
            pdf: wi.z / PI,
            delta: false,
        })
    };
    let subject = Subject::new(name, &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    check(&subject, &Expectation::PHYSICAL, Effort::Quick, name)
}
