//! T1: a black body's light, and what the eye makes of it.

use super::within;
use crate::answer::{Answer, colours};
use crate::complaint::Complaint;
use gonio_radiometry::colour::{RgbSpace, rgb_of_emission};
use gonio_radiometry::photometry::{efficacy_of_black_body, luminous_efficiency};
use gonio_radiometry::spectrum::{BlackBody, Observer, Spectrum};
use serde_json::json;

/// The spectrum from 380 to 780 nm, V(λ), the colour of each wavelength, and those of the black body.
pub(super) fn light(kelvin: f64) -> Result<Answer, Complaint> {
    let kelvin = within("the temperature", kelvin, 500.0, 50_000.0)?;
    let body = BlackBody::new(kelvin).map_err(|e| Complaint::new(e.to_string()))?;
    let lambda: Vec<f64> = (0..=80).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
    let radiance: Vec<f64> = lambda.iter().map(|nm| body.at(*nm)).collect();
    let most = radiance.iter().copied().fold(0.0, f64::max);
    let to_rgb = RgbSpace::SRGB.from_xyz();
    let colour = |nm: &f64| brightest(to_rgb.apply(Observer::cie_1931().at(*nm)));
    let single = |values: &[f64], factor: f64| values.iter().map(|x| (x * factor) as f32).collect();
    let v: Vec<f64> = lambda.iter().map(|nm| luminous_efficiency(*nm)).collect();
    Ok(Answer::new(
        json!({
            "efficacy": efficacy_of_black_body(body).value(),
            "rgb": brightest(rgb_of_emission(&Spectrum::BlackBody(body), &RgbSpace::SRGB)),
        }),
        vec![
            ("colour", colours(lambda.iter().map(colour))),
            ("lambda", single(&lambda, 1.0)),
            ("radiance", single(&radiance, most.recip())),
            ("v", single(&v, 1.0)),
        ],
    ))
}

/// As bright as a display shows the colour; what lies outside of its colours is cut.
fn brightest(rgb: [f64; 3]) -> [f64; 3] {
    let rgb = rgb.map(|x| x.max(0.0));
    let most = rgb.iter().copied().fold(0.0, f64::max);
    rgb.map(|x| if most > 0.0 { x / most } else { 0.0 })
}
