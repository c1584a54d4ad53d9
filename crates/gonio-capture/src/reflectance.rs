//! What the ball itself swallows: its Fresnel reflectance, which is divided out.
//!
//! A polished metal reflects (Born & Wolf, Principles of Optics, §14.2; the form of Lagarde, "Memo on Fresnel equations",
//! 2013), with c = cos θ, s² = 1 − c² and η + ik its index of refraction,
//!
//! ```text
//! t = η² − k² − s²,  u = √(t² + 4 η² k²),  a = √((u + t)/2)
//! R⊥ = (u + c² − 2 a c) / (u + c² + 2 a c)
//! R∥ = R⊥ (c² u + s⁴ − 2 a c s²) / (c² u + s⁴ + 2 a c s²)
//! F  = (R⊥ + R∥) / 2
//! ```

use crate::CaptureError;
use gonio_num::Real;
use std::fmt;
use std::str::FromStr;

/// What the ball is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum BallMaterial {
    /// Chromium, the plating of most mirrored balls. η and k: the RGB projections of the spectra distributed with Mitsuba
    /// 3.9.1 (BSD-3-Clause) that `gonio-brdf` has as the metal `chrome`.
    #[default]
    Chrome,
    /// Steel, as iron: the oxide film that makes steel stainless is too thin to be seen. η and k at 650, 550 and 450 nm, linear between the
    /// measurements of Johnson & Christy 1974, "Optical constants of transition metals", Phys. Rev. B 9, 5056.
    Steel,
    /// Reflectance at normal incidence, RGB in (0, 1], with Schlick's increase towards grazing incidence (17).
    F0([f64; 3]),
    /// Reflects everything.
    Perfect,
}

const CHROMIUM: [[f64; 2]; 3] = [[3.68155, 4.30993], [3.06625, 4.46111], [1.85598, 4.15025]];
const IRON: [[f64; 2]; 3] = [[2.9114, 3.0893], [2.9497, 2.9318], [2.5845, 2.7670]];

impl BallMaterial {
    /// The share of radiance that the ball reflects, RGB in (0, 1], at the angle of incidence whose cosine is `cos`, in
    /// [0, 1]. 1 at grazing incidence.
    pub fn reflectance(self, cos: f64) -> [f64; 3] {
        match self {
            Self::Chrome => CHROMIUM.map(|[eta, k]| conductor(cos, eta, k)),
            Self::Steel => IRON.map(|[eta, k]| conductor(cos, eta, k)),
            Self::F0(f0) => f0.map(|f0| f0 + (1.0 - f0) * (1.0 - cos).pow5()),
            Self::Perfect => [1.0; 3],
        }
    }
}

/// Fresnel reflectance of unpolarised light at a conductor in air.
fn conductor(cos: f64, eta: f64, k: f64) -> f64 {
    let c2 = cos * cos;
    let s2 = 1.0 - c2;
    let t = eta * eta - k * k - s2;
    let u = (t * t + 4.0 * eta * eta * k * k).sqrt();
    let a = (0.5 * (u + t)).max(0.0).sqrt();
    let perpendicular = (u + c2 - 2.0 * a * cos) / (u + c2 + 2.0 * a * cos);
    let (p, q) = (c2 * u + s2 * s2, 2.0 * a * cos * s2);
    0.5 * perpendicular * (1.0 + (p - q) / (p + q))
}

impl FromStr for BallMaterial {
    type Err = CaptureError;

    /// Reads `chrome`, `steel`, `perfect`, or F0 as one number or three, `0.9` or `0.95/0.93/0.88`.
    fn from_str(text: &str) -> Result<Self, CaptureError> {
        match text {
            "chrome" => return Ok(Self::Chrome),
            "steel" => return Ok(Self::Steel),
            "perfect" => return Ok(Self::Perfect),
            _ => {}
        }
        let numbers: Option<Vec<f64>> = text
            .split('/')
            .map(|n| {
                n.trim()
                    .parse::<f64>()
                    .ok()
                    .filter(|f| *f > 0.0 && *f <= 1.0)
            })
            .collect();
        match numbers.as_deref() {
            Some([grey]) => Ok(Self::F0([*grey; 3])),
            Some([r, g, b]) => Ok(Self::F0([*r, *g, *b])),
            _ => Err(CaptureError::parameter(
                "ball material",
                text,
                "chrome, steel, perfect, or F0 in (0, 1] as one number or three, such as 0.95/0.93/0.88",
            )),
        }
    }
}

impl fmt::Display for BallMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chrome => f.write_str("chrome"),
            Self::Steel => f.write_str("steel"),
            Self::Perfect => f.write_str("perfect"),
            Self::F0([r, g, b]) => write!(f, "{r}/{g}/{b}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At normal incidence F = ((η − 1)² + k²) / ((η + 1)² + k²).
    #[test]
    fn normal_incidence_is_the_textbook_value() {
        for (material, indices) in [
            (BallMaterial::Chrome, CHROMIUM),
            (BallMaterial::Steel, IRON),
        ] {
            let found = material.reflectance(1.0);
            for (f, [eta, k]) in found.iter().zip(indices) {
                let expected = ((eta - 1.0).powi(2) + k * k) / ((eta + 1.0).powi(2) + k * k);
                assert!((f - expected).abs() < 1e-14, "{f} {expected}");
            }
        }
    }

    /// The rows of Johnson & Christy's table of iron (λ \[µm], η, k) on both sides of 650, 550 and 450 nm.
    #[test]
    fn steel_is_iron_as_it_was_measured() {
        let rows = [
            (0.650, [[0.617, 2.88, 3.05], [0.659, 2.92, 3.10]]),
            (0.550, [[0.549, 2.95, 2.93], [0.582, 2.94, 2.99]]),
            (0.450, [[0.431, 2.48, 2.71], [0.451, 2.59, 2.77]]),
        ];
        for ([eta, k], (lambda, [a, b])) in IRON.into_iter().zip(rows) {
            let t = (lambda - a[0]) / (b[0] - a[0]);
            for (found, i) in [(eta, 1), (k, 2)] {
                // Four decimals are kept.
                assert!(
                    (found - (a[i] + t * (b[i] - a[i]))).abs() < 6e-5,
                    "{lambda} {i}"
                );
            }
        }
    }

    #[test]
    fn grazing_incidence_reflects_everything() {
        for material in [
            BallMaterial::Chrome,
            BallMaterial::Steel,
            BallMaterial::F0([0.5; 3]),
            BallMaterial::Perfect,
        ] {
            for f in material.reflectance(0.0) {
                assert!((f - 1.0).abs() < 1e-14, "{material} {f}");
            }
        }
    }

    #[test]
    fn words_and_numbers_are_read_back() {
        for text in ["chrome", "steel", "perfect", "0.9/0.8/0.7"] {
            assert_eq!(text.parse::<BallMaterial>().unwrap().to_string(), text);
        }
        for bad in ["crome", "0", "1.5", "0.9/0.8", "nan", ""] {
            assert!(bad.parse::<BallMaterial>().is_err(), "{bad}");
        }
    }
}
