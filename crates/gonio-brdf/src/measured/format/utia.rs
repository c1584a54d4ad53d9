//! The format of the UTIA database of measured anisotropic reflectance (`.bin`).
//!
//! Three planes (red, green, blue) of little-endian `f64`, no header: φv fastest, then θv, φi, θi, where θ = 0°, 15° … 75° and φ =
//! 0°, 7.5° … 352.5°; i is the direction to the light, v to the viewer. 6 · 48 · 6 · 48 · 3 numbers: 1,990,656 bytes.
//!
//! Between the nodes values are linear. Beyond 75° the database's own code continues the last interval linearly and takes what is
//! negative as 0; here this is a seventh node at 90°, with the value 2 f(75°) − f(60°), not below 0.
//!
//! The files say nothing of a unit. The numbers are taken as sr⁻¹ as they are; some readers multiply by 1/140, which the model's
//! parameter `scale` can do.
//!
//! Source: Filip & Vávra 2014, "Template-Based Sampling of Anisotropic BRDFs", and the reading code published with it.

use super::super::channel::rgb;
use super::super::grid::parameterization::radians;
use super::super::grid::{Axis, Boundary, Grid, Parameterization};
use super::super::input::Input;
use super::super::measurement::Measurement;
use super::super::metadata::Metadata;
use super::super::output;
use super::{has_axes, measurement, unsupported};
use crate::BrdfError;
use std::f64::consts::TAU;
use std::io::Write;
use std::path::Path;

/// Elevations and azimuths in a file.
const THETA: usize = 6;
const PHI: usize = 48;
/// Numbers of a plane.
const PLANE: usize = THETA * PHI * THETA * PHI;
/// The length of every file.
const LENGTH: u64 = (PLANE * 3 * 8) as u64;
/// No measured reflection is larger; a number with its bytes reversed usually is.
const LARGEST: f64 = 1e9;

/// Whether a file has the one length that there is.
pub(super) fn detect(_head: &[u8], length: u64) -> bool {
    length == LENGTH
}

/// Reads a table.
///
/// # Errors
/// If its length is another, or a number is not finite or beyond ±10⁹.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let bytes = input.bytes();
    if bytes.len() as u64 != LENGTH {
        return Err(input.error(
            "whole file",
            format!("{} bytes", bytes.len()),
            format!("{LENGTH} bytes: 3 planes of 6 × 48 × 6 × 48 numbers"),
        ));
    }
    let (numbers, _) = bytes.as_chunks::<8>();
    let mut stored = vec![0.0f32; 3 * PLANE];
    for (at, number) in numbers.iter().enumerate() {
        let x = f64::from_le_bytes(*number);
        if x.is_nan() || x.abs() > LARGEST {
            let swapped = f64::from_be_bytes(*number);
            let found = if swapped.abs() <= LARGEST && swapped.abs() > 1e-12 {
                format!("{x:e} ({swapped} if it were big-endian)")
            } else {
                format!("{x:e}")
            };
            return Err(input.error(
                format!("number {at}, byte {}", 8 * at),
                found,
                "a finite number of at most 1e9, little-endian",
            ));
        }
        stored[at % PLANE * 3 + at / PLANE] = x as f32;
    }
    let axes = axes().map_err(|found| input.error("axes", found, "nodes that increase"))?;
    let grid = Grid::new(
        Parameterization::SphericalAnisotropic,
        axes,
        3,
        extended(&stored),
    )
    .map_err(|(found, expected)| input.error("whole file", found, expected))?;
    let mut measurement = measurement(input, grid, rgb(), Metadata::of_format("UTIA"))?;
    measurement.metadata.unit = "sr^-1 (assumed: the format names none)".into();
    measurement
        .notes
        .push("beyond 75° the last interval is continued linearly to 90°, not below 0".into());
    Ok(measurement)
}

/// θi, φi, θv, φv with the node at 90° added.
pub(in super::super) fn axes() -> Result<Vec<Axis>, String> {
    let theta = || Axis::regular(0.0, radians(15.0), THETA + 1, Boundary::Clamped);
    let phi = || Axis::regular(0.0, radians(7.5), PHI, Boundary::Periodic(TAU));
    Ok(vec![theta()?, phi()?, theta()?, phi()?])
}

/// RGB of 6 × 48 × 6 × 48 nodes with a seventh elevation of both directions.
fn extended(stored: &[f32]) -> Vec<f32> {
    let mut out = Vec::with_capacity((THETA + 1) * PHI * (THETA + 1) * PHI * 3);
    // At 90° twice the last node less the one before it.
    let terms = |theta: usize| {
        if theta < THETA {
            [(theta, 1.0), (theta, 0.0)]
        } else {
            [(THETA - 1, 2.0), (THETA - 2, -1.0)]
        }
    };
    for theta_i in 0..=THETA {
        for phi_i in 0..PHI {
            for theta_v in 0..=THETA {
                for phi_v in 0..PHI {
                    for c in 0..3 {
                        let mut sum = 0.0;
                        for (ti, wi) in terms(theta_i) {
                            for (tv, wv) in terms(theta_v) {
                                let at = ((ti * PHI + phi_i) * THETA + tv) * PHI + phi_v;
                                sum += wi * wv * f64::from(stored[at * 3 + c]);
                            }
                        }
                        let added = theta_i == THETA || theta_v == THETA;
                        out.push(if added { sum.max(0.0) } else { sum } as f32);
                    }
                }
            }
        }
    }
    out
}

/// Writes the reflection on the front, which must be a grid with the axes of this format, 90° included or not, and red, green and blue.
///
/// # Errors
/// If it is something else, or the file cannot be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    let grid = super::front_grid(measurement, "a UTIA file")?;
    let fits = grid.parameterization() == Parameterization::SphericalAnisotropic
        && has_axes(grid, axes())
        && measurement.channels == rgb();
    if !fits {
        return Err(unsupported(
            "a UTIA file holds red, green and blue for elevations of 0° to 75° in steps of 15° and azimuths in steps of 7.5° only",
        ));
    }
    output::write(path, |out| {
        for c in 0..3 {
            for theta_i in 0..THETA {
                for phi_i in 0..PHI {
                    for theta_v in 0..THETA {
                        for phi_v in 0..PHI {
                            let at =
                                ((theta_i * PHI + phi_i) * (THETA + 1) + theta_v) * PHI + phi_v;
                            out.write_all(&f64::from(grid.values()[at * 3 + c]).to_le_bytes())?;
                        }
                    }
                }
            }
        }
        Ok(())
    })
}

/// The axes of a table of this format, 90° included.
#[allow(clippy::missing_panics_doc)] // never
pub fn layout() -> Vec<Axis> {
    axes().expect("invariant: regular nodes increase")
}
