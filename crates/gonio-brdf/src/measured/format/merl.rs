//! The format of the MERL database of measured isotropic reflectance (`.binary`).
//!
//! Three little-endian `i32` (cells along θh, θd, φd; the database has 90, 90, 180), then three planes of little-endian
//! `f64`: red, green, blue; φd varies fastest. Values times 1/1500, 1.15/1500 and 1.66/1500 are sr⁻¹.
//!
//! Cells have equal steps of √(θh/90°), θd in [0°, 90°] and φd in [0°, 180°), where it closes on itself: exchanging the two directions
//! turns φd by 180°. A cell's value is taken to stand at its centre, and values between centres to be linear; the
//! database's own code takes the nearest cell.
//!
//! Source: Matusik et al. 2003, "A Data-Driven Reflectance Model", and the reading code published with it.

use super::super::channel::rgb;
use super::super::grid::{Axis, Boundary, Grid, Parameterization, Scale};
use super::super::input::Input;
use super::super::measurement::Measurement;
use super::super::metadata::Metadata;
use super::super::output;
use super::{has_axes, measurement, unsupported};
use crate::BrdfError;
use std::f64::consts::{FRAC_PI_2, PI};
use std::io::Write;
use std::path::Path;

/// What a stored value is multiplied by to be in sr⁻¹.
const SCALE: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];
/// The largest number of cells along an axis that is believed.
const LARGEST: i32 = 4096;
/// Cells of the database.
pub(in super::super) const DATABASE: [usize; 3] = [90, 90, 180];

/// The three numbers at the beginning.
fn header(bytes: &[u8]) -> Option<[i32; 3]> {
    let (numbers, _) = bytes.as_chunks::<4>();
    let [a, b, c] = numbers.first_chunk::<3>()?;
    Some([*a, *b, *c].map(i32::from_le_bytes))
}

/// Whether a file begins like one of these: with three numbers that could be numbers of cells.
pub(super) fn detect(head: &[u8], _length: u64) -> bool {
    let believed = |n: i32| (1..=LARGEST).contains(&n);
    header(head).is_some_and(|dims| {
        dims.into_iter().all(believed) || dims.map(i32::swap_bytes).into_iter().all(believed)
    })
}

/// Reads a table. Nothing is allocated before the length is known to match the header.
///
/// # Errors
/// If the header is not three numbers from 1 to 4096, the length is not what it says, or a value is not finite.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let bytes = input.bytes();
    let Some(dims) = header(bytes) else {
        return Err(input.error(
            "header",
            format!("{} bytes", bytes.len()),
            "12 bytes of header, three 32-bit numbers",
        ));
    };
    for (k, n) in dims.into_iter().enumerate() {
        if !(1..=LARGEST).contains(&n) {
            let swapped = n.swap_bytes();
            let found = if (1..=LARGEST).contains(&swapped) {
                format!("{n} cells ({swapped} if it were big-endian)")
            } else {
                format!("{n} cells")
            };
            return Err(input.error(
                format!("header, byte {}", 4 * k),
                found,
                format!("1 to {LARGEST}, little-endian (the database has 90, 90, 180)"),
            ));
        }
    }
    let dims = dims.map(|n| n as usize);
    let cells: usize = dims.iter().product();
    // 4096³ cells of 24 bytes are far below 2⁶⁴.
    let expected = 12 + 24 * cells as u64;
    if bytes.len() as u64 != expected {
        return Err(input.error(
            "whole file",
            format!("{} bytes", bytes.len()),
            format!(
                "{expected} bytes for {}×{}×{} cells",
                dims[0], dims[1], dims[2]
            ),
        ));
    }
    let (numbers, _) = bytes[12..].as_chunks::<8>();
    let mut values = vec![0.0f32; 3 * cells];
    for (plane, scale) in SCALE.into_iter().enumerate() {
        for cell in 0..cells {
            let at = plane * cells + cell;
            let stored = f64::from_le_bytes(numbers[at]);
            let x = (stored * scale) as f32;
            if !x.is_finite() {
                return Err(input.error(
                    format!(
                        "{} plane, cell {cell}, byte {}",
                        ["red", "green", "blue"][plane],
                        12 + 8 * at
                    ),
                    stored.to_string(),
                    "a finite number",
                ));
            }
            values[3 * cell + plane] = x;
        }
    }
    let axes = axes(dims).map_err(|found| input.error("header", found, "cells"))?;
    let grid = Grid::new(Parameterization::HalfDifference, axes, 3, values)
        .map_err(|(found, expected)| input.error("header", found, expected))?;
    measurement(input, grid, rgb(), Metadata::of_format("MERL"))
}

/// The axes of a table with so many cells.
pub(in super::super) fn axes([theta_h, theta_d, phi_d]: [usize; 3]) -> Result<Vec<Axis>, String> {
    let centres = |n: usize| (0..n).map(move |k| (k as f64 + 0.5) / n as f64);
    Ok(vec![
        Axis::new(
            centres(theta_h).map(|x| x * x * FRAC_PI_2).collect(),
            Boundary::Clamped,
            Scale::SquareRoot,
        )?,
        Axis::new(
            centres(theta_d).map(|x| x * FRAC_PI_2).collect(),
            Boundary::Clamped,
            Scale::Linear,
        )?,
        Axis::new(
            centres(phi_d).map(|x| x * PI).collect(),
            Boundary::Periodic(PI),
            Scale::Linear,
        )?,
    ])
}

/// Writes the reflection on the front, which must be a grid with the axes of this format and red, green and blue.
///
/// # Errors
/// If it is something else, or the file cannot be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    let grid = super::front_grid(measurement, "a MERL file")?;
    let dims = grid.shape();
    let dims = <[usize; 3]>::try_from(dims).ok();
    let fits = dims.is_some_and(|dims| {
        dims.iter().all(|n| *n <= LARGEST as usize) && has_axes(grid, axes(dims))
    });
    let (true, Some(dims)) = (fits && measurement.channels == rgb(), dims) else {
        return Err(unsupported(
            "a MERL file holds red, green and blue over cells of half and difference angles only",
        ));
    };
    output::write(path, |out| {
        for n in dims {
            out.write_all(&(n as i32).to_le_bytes())?;
        }
        for (plane, scale) in SCALE.into_iter().enumerate() {
            for cell in grid.values().chunks_exact(3) {
                out.write_all(&(f64::from(cell[plane]) / scale).to_le_bytes())?;
            }
        }
        Ok(())
    })
}
