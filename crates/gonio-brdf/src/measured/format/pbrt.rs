//! The text format of pbrt-v2 for isotropic measurements (`.brdf`).
//!
//! Numbers separated by white space; `#` begins a comment. First the number of wavelengths n and the wavelengths in nm; then for each
//! pair of directions θ and φ of the light, θ and φ of the viewer, in radians, and n values in sr⁻¹.
//!
//! Only |φ − φ′| counts. pbrt-v2 interpolates between near rows in the coordinates (sinθ sinθ′, |φ − φ′|/π, cosθ cosθ′), which also
//! makes the two directions exchangeable; here the rows are the nodes of a grid where they form one, in the order that the file
//! says.
//!
//! Source: pbrt-v2, `src/materials/measured.cpp`, and Pharr & Humphreys 2010, section 8.6.

use super::super::channel::{Channel, wavelengths};
use super::super::grid::{Boundary, Parameterization};
use super::super::input::Input;
use super::super::measurement::Measurement;
use super::super::metadata::Metadata;
use super::super::output;
use super::super::samples::Samples;
use super::text::{Number, number, short};
use super::{measurement, unsupported};
use crate::BrdfError;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::io::Write;
use std::path::Path;

/// Wavelengths that are believed.
const MOST_WAVELENGTHS: f64 = 4096.0;

/// The words of a text without its comments, with their lines.
fn words(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().flat_map(|(k, line)| {
        let content = line.split('#').next().unwrap_or_default();
        content.split_whitespace().map(move |word| (k + 1, word))
    })
}

/// Whether a file is text whose first word is a number.
pub(super) fn detect(head: &[u8], _length: u64) -> bool {
    if !super::is_text(head) {
        return false;
    }
    let text = String::from_utf8_lossy(head);
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    words(text)
        .next()
        .is_some_and(|(_, word)| word.parse::<f64>().is_ok())
}

/// Reads a measurement.
///
/// # Errors
/// If there is something that is no finite number, the first number is not a number of wavelengths, these don't increase, the last row is
/// not whole, or a direction is below the horizon.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let text = input.text()?;
    let mut words = words(text);
    let mut last_line = 1;
    let mut next = || -> Result<Option<Number>, BrdfError> {
        let Some((line, word)) = words.next() else {
            return Ok(None);
        };
        last_line = line;
        let value = number(input, word, line)?;
        Ok(Some(Number { value, line }))
    };
    let count =
        next()?.ok_or_else(|| input.error("line 1", "no number", "a number of wavelengths"))?;
    if !(1.0..=MOST_WAVELENGTHS).contains(&count.value) || count.value.fract() != 0.0 {
        return Err(input.error(
            format!("line {}", count.line),
            count.value.to_string(),
            format!("a number of wavelengths from 1 to {MOST_WAVELENGTHS}"),
        ));
    }
    let count = count.value as usize;
    let mut channels = Vec::new();
    for k in 0..count {
        let Some(x) = next()? else {
            let found = format!("{k} wavelengths");
            return Err(input.error("end of the file", found, format!("{count}")));
        };
        let rises = wavelengths(&channels)
            .last()
            .is_none_or(|before| x.value > *before);
        if x.value <= 0.0 || !rises {
            return Err(input.error(
                format!("line {}", x.line),
                format!("a wavelength of {} nm", x.value),
                "positive ones that increase",
            ));
        }
        channels.push(Channel::Wavelength(x.value));
    }
    let mut samples = Samples {
        bilateral: true,
        isotropic: true,
        ..Samples::default()
    };
    while let Some(first) = next()? {
        let mut angles = [first.value, 0.0, 0.0, 0.0];
        for k in 1..4 + count {
            let Some(x) = next()? else {
                return Err(input.error(
                    "end of the file",
                    format!("a row of {k} numbers"),
                    format!("{} a row", 4 + count),
                ));
            };
            match angles.get_mut(k) {
                Some(angle) => *angle = x.value,
                None => samples.values.push(x.value as f32),
            }
        }
        for k in [0, 2] {
            if !(-1e-3..=FRAC_PI_2 + 1e-3).contains(&angles[k]) {
                return Err(input.error(
                    format!("line {}", first.line),
                    format!("an elevation of {} radians", angles[k]),
                    "0 to π/2",
                ));
            }
            angles[k] = angles[k].clamp(0.0, FRAC_PI_2);
        }
        samples.angles.push(angles);
    }
    if samples.angles.is_empty() {
        return Err(input.error("end of the file", "no row", "at least one"));
    }
    let mut notes = Vec::new();
    let grid = samples.into_grid(input, &channels, &mut notes)?;
    let mut measurement = measurement(input, grid, channels, Metadata::of_format("pbrt-v2 .brdf"))?;
    measurement.notes = notes;
    Ok(measurement)
}

/// Writes the reflection on the front, which must be a grid over θi, θo and |φo − φi|, of wavelengths; missing values are left out.
///
/// # Errors
/// If it is something else, or the file cannot be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    let grid = super::front_grid(measurement, "a pbrt-v2 file")?;
    let lambda = wavelengths(&measurement.channels);
    let mirrored = matches!(grid.axes().last().map(|a| a.boundary()),
        Some(Boundary::Mirrored(p)) if (p - TAU).abs() < 1e-9);
    if grid.parameterization() != Parameterization::Spherical
        || !mirrored
        || lambda.len() != measurement.channels.len()
    {
        return Err(unsupported(
            "a pbrt-v2 file holds wavelengths over θi, θo and |φo − φi| in [0, π] only",
        ));
    }
    let m = &measurement.metadata;
    output::write(path, |out| {
        for (key, text) in m.entries() {
            writeln!(out, "# {key}: {}", text.replace(['\n', '\r'], " "))?;
        }
        writeln!(
            out,
            "# wavelengths in nm; then theta and phi of the light and of the viewer in radians, and values in sr^-1"
        )?;
        writeln!(out, "{}", lambda.len())?;
        let list: Vec<String> = lambda.iter().map(f64::to_string).collect();
        writeln!(out, "{}", list.join(" "))?;
        for (cell, values) in grid.values().chunks_exact(lambda.len()).enumerate() {
            if values.iter().any(|x| !x.is_finite()) {
                continue;
            }
            let place = grid.place(cell);
            let x = |k: usize| grid.axes()[k].nodes()[place[k]];
            write!(out, "{:.8} 0 {:.8} {:.8}", x(0), x(1), x(2).min(PI))?;
            for v in values {
                write!(out, " {}", short(*v))?;
            }
            writeln!(out)?;
        }
        Ok(())
    })
}
