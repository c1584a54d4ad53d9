//! Windows against ringing, and what they take away.

use super::Harmonics;
use crate::IblError;
use gonio_num::{Real, Vec3};
use serde::Serialize;
use std::f64::consts::{PI, TAU};
use std::str::FromStr;

/// How high bands are damped. Never done unasked: a window makes light softer than it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Window {
    /// Not at all.
    None,
    /// (1 + cos(π l/w))/2, w the number of bands.
    Hann,
    /// sin(π l/w)/(π l/w), w the number of bands.
    Lanczos,
    /// 1/(1 + λ l² (l + 1)²) with the smallest λ that leaves no negative value in any channel: the least squared Laplacian.
    Laplacian,
}

/// What a window has changed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Residual {
    /// Largest change over the sphere, relative to the mean.
    pub largest: f64,
    /// Root of the mean squared change over that of the function.
    pub rms: f64,
    /// Smallest value before, relative to the mean: negative where it rings below 0.
    pub smallest_before: f64,
    /// Smallest value after.
    pub smallest_after: f64,
    /// λ of the Laplacian window.
    pub lambda: Option<f64>,
}

impl FromStr for Window {
    type Err = IblError;

    fn from_str(text: &str) -> Result<Self, IblError> {
        match text {
            "none" => Ok(Self::None),
            "hann" => Ok(Self::Hann),
            "lanczos" => Ok(Self::Lanczos),
            "laplacian" => Ok(Self::Laplacian),
            _ => Err(IblError::parameter(
                "window",
                format!("\"{text}\""),
                "none, hann, lanczos or laplacian",
            )),
        }
    }
}

/// Directions over which extremes are looked for.
const DIRECTIONS: usize = 2048;

/// Directions spread evenly over the sphere: Swinbank & Purser 2006, "Fibonacci grids".
pub fn directions(count: usize) -> impl Iterator<Item = Vec3<f64>> {
    let golden = 0.5 * (5.0f64.sqrt() - 1.0);
    (0..count).map(move |i| {
        let z = 1.0 - (2 * i + 1) as f64 / count as f64;
        let r = ((1.0 - z) * (1.0 + z)).sqrt();
        let phi = TAU * (i as f64 * golden).fract();
        Vec3::new(r * Real::cos(phi), r * Real::sin(phi), z)
    })
}

impl Window {
    /// The windowed function, and what has changed.
    ///
    /// Source: Sloan 2008, "Stupid Spherical Harmonics (SH) Tricks", windowing and appendix A7.
    pub fn apply(self, f: &Harmonics) -> (Harmonics, Residual) {
        let w = f.bands() as f64;
        let mut lambda = None;
        let windowed = match self {
            Self::None => f.clone(),
            Self::Hann => f.scaled(|l| 0.5 * (1.0 + Real::cos(PI * l as f64 / w))),
            Self::Lanczos => f.scaled(|l| match l {
                0 => 1.0,
                l => {
                    let x = PI * l as f64 / w;
                    Real::sin(x) / x
                }
            }),
            Self::Laplacian => {
                let found = least_lambda(f);
                lambda = Some(found);
                f.scaled(|l| laplacian(l, found))
            }
        };
        let mean = f.coefficients()[0].iter().sum::<f64>() / 3.0 * (0.25 / PI).sqrt();
        let mean = if mean.abs() > 0.0 { mean } else { 1.0 };
        let mut largest = 0.0f64;
        for d in directions(DIRECTIONS) {
            let (a, b) = (f.evaluate(d), windowed.evaluate(d));
            for k in 0..3 {
                largest = largest.max((a[k] - b[k]).abs());
            }
        }
        // Parseval: the basis is orthonormal.
        let energy = |c: &[[f64; 3]]| c.iter().flatten().map(|v| v * v).sum::<f64>();
        let differences: Vec<[f64; 3]> = f
            .coefficients()
            .iter()
            .zip(windowed.coefficients())
            .map(|(a, b)| [a[0] - b[0], a[1] - b[1], a[2] - b[2]])
            .collect();
        let whole = energy(f.coefficients());
        let residual = Residual {
            largest: largest / mean,
            rms: if whole > 0.0 {
                (energy(&differences) / whole).sqrt()
            } else {
                0.0
            },
            smallest_before: smallest(f) / mean,
            smallest_after: smallest(&windowed) / mean,
            lambda,
        };
        (windowed, residual)
    }
}

fn laplacian(l: usize, lambda: f64) -> f64 {
    let x = (l * (l + 1)) as f64;
    1.0 / (1.0 + lambda * x * x)
}

fn smallest(f: &Harmonics) -> f64 {
    directions(DIRECTIONS)
        .flat_map(|d| f.evaluate(d))
        .fold(f64::INFINITY, f64::min)
}

/// By bisection of the logarithm: more damping makes the smallest value no smaller once the mean rules.
fn least_lambda(f: &Harmonics) -> f64 {
    if smallest(f) >= 0.0 {
        return 0.0;
    }
    let sound = |lambda: f64| smallest(&f.scaled(|l| laplacian(l, lambda))) >= 0.0;
    let (mut low, mut high) = (1e-8, 1e4);
    if !sound(high) {
        // A mean below 0: nothing that only damps can help.
        return high;
    }
    for _ in 0..40 {
        let middle = (low * high).sqrt();
        if sound(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}
