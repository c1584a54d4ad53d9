//! Correlated colour temperature.

use super::{uv_of_xyz, xyz_of_emission, xyz_of_xy};
use crate::RadiometryError;
use crate::spectrum::{BlackBody, Spectrum};

/// The temperature of the black body whose colour is nearest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourTemperature {
    /// The temperature \[K\].
    pub kelvin: f64,
    /// Distance from the black body in CIE 1960 (u, v): above 0 towards green, below 0 towards magenta. Beyond 0.05 the
    /// temperature means nothing.
    pub duv: f64,
}

const RANGE_K: [f64; 2] = [1000.0, 100_000.0];

fn planckian_uv(mired: f64) -> Result<[f64; 2], RadiometryError> {
    let body = Spectrum::BlackBody(BlackBody::new(1e6 / mired)?);
    Ok(uv_of_xyz(xyz_of_emission(&body)))
}

/// Correlated colour temperature of the chromaticity (x, y).
///
/// The nearest point of the Planckian locus in CIE 1960 (u, v), found by golden-section search over 1/T, to 10⁻⁴ mired.
///
/// # Errors
/// If (x, y) isn't finite with y > 0, or if the nearest point is at an end of [1000, 100 000] K.
pub fn correlated_colour_temperature(xy: [f64; 2]) -> Result<ColourTemperature, RadiometryError> {
    if !(xy[0].is_finite() && xy[1].is_finite() && xy[1] > 0.0) {
        return Err(RadiometryError::OutOfRange {
            name: "the chromaticity y",
            value: xy[1],
            expected: "a finite chromaticity (x, y) with y above 0",
        });
    }
    let target = uv_of_xyz(xyz_of_xy(xy));
    let distance2 = |mired: f64| -> Result<f64, RadiometryError> {
        let uv = planckian_uv(mired)?;
        Ok((uv[0] - target[0]) * (uv[0] - target[0]) + (uv[1] - target[1]) * (uv[1] - target[1]))
    };
    let ends = [1e6 / RANGE_K[1], 1e6 / RANGE_K[0]];
    // A coarse scan first: seen from far off the locus there can be two minima.
    let steps = 64;
    let mired_at = |i: usize| ends[0] + (ends[1] - ends[0]) * i as f64 / steps as f64;
    let mut best = (0, f64::INFINITY);
    for i in 0..=steps {
        let d = distance2(mired_at(i))?;
        if d < best.1 {
            best = (i, d);
        }
    }
    if best.0 == 0 || best.0 == steps {
        return Err(RadiometryError::OutOfRange {
            name: "the correlated colour temperature [K]",
            value: 1e6 / mired_at(best.0),
            expected: "a colour whose nearest black body is within 1000 to 100000 K",
        });
    }
    let (mut a, mut b) = (mired_at(best.0 - 1), mired_at(best.0 + 1));
    let golden = 0.618_033_988_749_894_9;
    let mut inner = [b - golden * (b - a), a + golden * (b - a)];
    let mut values = [distance2(inner[0])?, distance2(inner[1])?];
    while b - a > 1e-4 {
        if values[0] < values[1] {
            b = inner[1];
            inner = [b - golden * (b - a), inner[0]];
            values = [distance2(inner[0])?, values[0]];
        } else {
            a = inner[0];
            inner = [inner[1], a + golden * (b - a)];
            values = [values[1], distance2(inner[1])?];
        }
    }
    let mired = 0.5 * (a + b);
    let uv = planckian_uv(mired)?;
    // The locus runs to the left (cooler light has larger u) with green above it: greater v.
    let side = if target[1] >= uv[1] { 1.0 } else { -1.0 };
    Ok(ColourTemperature {
        kelvin: 1e6 / mired,
        duv: side * distance2(mired)?.sqrt(),
    })
}
