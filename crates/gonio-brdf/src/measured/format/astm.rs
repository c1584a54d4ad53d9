//! The text format of ASTM E1392 and E2387 for measured scatter (`.astm`, `.dat`), as laboratories write it.
//!
//! A header of lines with a keyword in capitals and a value, of which the last is `VARS` with the names of the columns, separated by
//! commas; then a row of numbers for each pair of directions. `NUM_POINTS`, if it is there, is the number of rows.
//!
//! | column | meaning |
//! |---|---|
//! | `theta_i`, `phi_i` | direction to the light; without `phi_i` it is 0 |
//! | `theta_s`, `phi_s` (or `theta_r`, `phi_r`) | direction to the viewer; without `phi_s` the measurement is in the plane of incidence, θs positive on the side of the mirror direction, negative on that of the light |
//! | any other | values in sr⁻¹: `R`, `G`, `B`; `X`, `Y`, `Z`; a wavelength such as `465nm`; or a band by its name |
//!
//! Angles are in radians, or in degrees where one of them could be no radians: an elevation above π/2 or an azimuth beyond ±2π.
//! A negative elevation is on the opposite azimuth.
//!
//! Source: ASTM E1392-96 and E2387-05; the files of the Cornell light measurement laboratory have this layout.

use super::super::channel::Channel;
use super::super::grid::Parameterization;
use super::super::input::Input;
use super::super::measurement::Measurement;
use super::super::metadata::Metadata;
use super::super::output;
use super::super::samples::Samples;
use super::text::{number, short};
use super::{measurement, unsupported};
use crate::BrdfError;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::io::Write;
use std::path::Path;

/// Columns that are believed.
const MOST_COLUMNS: usize = 4096;

/// Whether a file is text in which a line begins with `VARS`.
pub(super) fn detect(head: &[u8], _length: u64) -> bool {
    super::is_text(head)
        && head
            .split(|b| *b == b'\n')
            .any(|line| keyword(line.trim_ascii()) == b"VARS")
}

fn keyword(line: &[u8]) -> &[u8] {
    let end = line
        .iter()
        .position(|b| b.is_ascii_whitespace() || *b == b',');
    &line[..end.unwrap_or(line.len())]
}

/// What a column holds.
#[derive(Debug, Clone, PartialEq)]
enum Column {
    Angle(usize),
    Value(Channel),
}

/// Reads a measurement.
///
/// # Errors
/// If there is no `VARS`, a column of angles is missing, there are no values, a row has another number of columns or something that is no
/// finite number, the rows are not as many as `NUM_POINTS` says, or a direction is below the horizon.
pub fn parse(input: &Input<'_>) -> Result<Measurement, BrdfError> {
    let text = input.text()?;
    let mut metadata = Metadata::of_format("ASTM E1392");
    let mut announced: Option<(usize, usize)> = None;
    let mut lines = text.lines().enumerate().map(|(k, l)| (k + 1, l.trim()));
    let mut columns = None;
    for (line, content) in lines.by_ref() {
        let (key, value) = content
            .split_once(char::is_whitespace)
            .unwrap_or((content, ""));
        let value = value.trim().trim_matches('"');
        match key {
            "" => {}
            "VARS" => {
                columns = Some((line, columns_of(input, value, line)?));
                break;
            }
            "NUM_POINTS" => {
                let count = value.parse().map_err(|_| {
                    input.error(
                        format!("line {line}"),
                        format!("`{value}`"),
                        "a number of points",
                    )
                })?;
                announced = Some((line, count));
            }
            _ => describe(&mut metadata, key, value),
        }
    }
    let Some((vars, columns)) = columns else {
        return Err(input.error(
            "header",
            "no line VARS",
            "VARS and the names of the columns",
        ));
    };
    let (samples, channels, signed) = rows(input, &columns, lines, vars)?;
    if let Some((line, count)) = announced
        && count != samples.angles.len()
    {
        return Err(input.error(
            format!("line {line}"),
            format!("NUM_POINTS {count} before {} rows", samples.angles.len()),
            "as many rows",
        ));
    }
    if samples.angles.is_empty() {
        return Err(input.error(format!("after line {vars}"), "no row", "at least one"));
    }
    let mut notes = Vec::new();
    if signed {
        notes.push(
            "measured in the plane of incidence only: linear in azimuth between its two halves"
                .into(),
        );
    }
    let grid = samples.into_grid(input, &channels, &mut notes)?;
    let mut measurement = measurement(input, grid, channels, metadata)?;
    measurement.notes = notes;
    Ok(measurement)
}

/// Takes a line of the header into the metadata.
fn describe(metadata: &mut Metadata, key: &str, value: &str) {
    let entry = match key {
        "SAMPLE_NAME" => &mut metadata.name,
        "LAB_NAME" | "OPERATOR" | "AUTHOR" => &mut metadata.author,
        "SYSTEM_NAME" | "INSTRUMENT" => &mut metadata.instrument,
        "MEAS_DATE" | "MEAS_TIME" | "DATE" => &mut metadata.date,
        "LICENCE" | "LICENSE" => &mut metadata.licence,
        "COMMENT" | "DESCRIPTION" => &mut metadata.description,
        _ => {
            let line = format!("{key} {value}");
            join(&mut metadata.description, line.trim());
            return;
        }
    };
    join(entry, value);
}

fn join(entry: &mut String, text: &str) {
    if !entry.is_empty() && !text.is_empty() {
        entry.push_str("; ");
    }
    entry.push_str(text);
}

fn columns_of(input: &Input<'_>, text: &str, line: usize) -> Result<Vec<Column>, BrdfError> {
    let names: Vec<&str> = text
        .split([',', ';', '\t'])
        .map(str::trim)
        .filter(|n| !n.is_empty())
        .collect();
    let place = || format!("line {line}");
    if names.len() > MOST_COLUMNS {
        let found = format!("{} columns", names.len());
        return Err(input.error(place(), found, format!("at most {MOST_COLUMNS}")));
    }
    let columns: Vec<Column> = names
        .iter()
        .map(|name| match name.to_ascii_lowercase().as_str() {
            "theta_i" => Column::Angle(0),
            "phi_i" => Column::Angle(1),
            "theta_s" | "theta_r" | "theta_o" => Column::Angle(2),
            "phi_s" | "phi_r" | "phi_o" => Column::Angle(3),
            _ => Column::Value(Channel::from_name(name)),
        })
        .collect();
    let count = |wanted: usize| {
        let same = |c: &&Column| **c == Column::Angle(wanted);
        columns.iter().filter(same).count()
    };
    let values = columns.iter().any(|c| matches!(c, Column::Value(_)));
    let (i, o) = (count(0), count(2));
    if i != 1 || o != 1 || count(1) > 1 || count(3) > 1 || !values {
        return Err(input.error(
            place(),
            format!("columns {}", names.join(", ")),
            "theta_i, phi_i, theta_s, phi_s, each once, and at least one of values",
        ));
    }
    Ok(columns)
}

type Rows = (Samples, Vec<Channel>, bool);

fn rows<'a>(
    input: &Input<'_>,
    columns: &[Column],
    lines: impl Iterator<Item = (usize, &'a str)>,
    vars: usize,
) -> Result<Rows, BrdfError> {
    let mut samples = Samples::default();
    let mut places = Vec::new();
    for (line, content) in lines {
        if content.is_empty() || content.starts_with('#') {
            continue;
        }
        let mut angles = [0.0; 4];
        let mut found = 0;
        let words = content
            .split(|c: char| c == ',' || c == ';' || c.is_whitespace())
            .filter(|w| !w.is_empty());
        for word in words {
            let x = number(input, word, line)?;
            match columns.get(found) {
                Some(Column::Angle(k)) => angles[*k] = x,
                Some(Column::Value(_)) => samples.values.push(x as f32),
                None => {}
            }
            found += 1;
        }
        if found != columns.len() {
            return Err(input.error(
                format!("line {line}"),
                format!("{found} numbers"),
                format!("{}, as line {vars} says", columns.len()),
            ));
        }
        samples.angles.push(angles);
        places.push(line);
    }
    let has = |k: usize| columns.contains(&Column::Angle(k));
    let in_degrees = samples.angles.iter().any(|a| {
        let elevation = a[0].abs().max(a[2].abs());
        let azimuth = a[1].abs().max(a[3].abs());
        elevation > FRAC_PI_2 + 1e-3 || azimuth > TAU + 1e-3
    });
    let unit = if in_degrees { PI / 180.0 } else { 1.0 };
    for (a, line) in samples.angles.iter_mut().zip(places) {
        for x in a.iter_mut() {
            *x *= unit;
        }
        if !has(3) {
            // Positive beyond the normal.
            a[3] = a[1] + PI;
        }
        for k in [0, 2] {
            if a[k] < 0.0 {
                a[k] = -a[k];
                a[k + 1] += PI;
            }
            if a[k] > FRAC_PI_2 + 1e-3 {
                return Err(input.error(
                    format!("line {line}"),
                    format!("an elevation of {:.3}°", a[k] * 180.0 / PI),
                    "0° to 90°: reflection",
                ));
            }
            a[k] = a[k].min(FRAC_PI_2);
        }
    }
    let channels = columns
        .iter()
        .filter_map(|c| match c {
            Column::Value(channel) => Some(channel.clone()),
            Column::Angle(_) => None,
        })
        .collect();
    Ok((samples, channels, !has(3)))
}

/// Writes the reflection on the front, which must be a grid over directions; missing values are left out.
///
/// # Errors
/// If it is something else, or the file cannot be written.
pub fn write(path: &Path, measurement: &Measurement) -> Result<(), BrdfError> {
    let grid = super::front_grid(measurement, "an ASTM file")?;
    let isotropic = match grid.parameterization() {
        Parameterization::Spherical => true,
        Parameterization::SphericalAnisotropic => false,
        _ => {
            return Err(unsupported(
                "an ASTM file holds a grid over directions only",
            ));
        }
    };
    let names: Vec<String> = measurement
        .channels
        .iter()
        .map(|c| match c {
            Channel::Red => "R".into(),
            Channel::Green => "G".into(),
            Channel::Blue => "B".into(),
            Channel::X => "X".into(),
            Channel::Y => "Y".into(),
            Channel::Z => "Z".into(),
            Channel::Wavelength(nm) => format!("{nm}nm"),
            other => other.to_string().replace([',', ';', '\n', '\t'], " "),
        })
        .collect();
    let rows: Vec<usize> = grid
        .values()
        .chunks_exact(grid.channels())
        .enumerate()
        .filter(|(_, v)| v.iter().all(|x| x.is_finite()))
        .map(|(cell, _)| cell)
        .collect();
    let m = &measurement.metadata;
    output::write(path, |out| {
        let one_line = |s: &str| s.replace(['\n', '\r'], " ");
        for (key, value) in [
            ("LAB_NAME", &m.author),
            ("SYSTEM_NAME", &m.instrument),
            ("SAMPLE_NAME", &m.name),
            ("MEAS_DATE", &m.date),
            ("LICENCE", &m.licence),
            ("COMMENT", &m.description),
        ] {
            if !value.is_empty() {
                writeln!(out, "{key} \"{}\"", one_line(value))?;
            }
        }
        writeln!(out, "MEAS_NAME BRDF")?;
        writeln!(out, "NUM_POINTS {}", rows.len())?;
        writeln!(out, "VARS theta_i,phi_i,theta_s,phi_s,{}", names.join(","))?;
        for cell in rows {
            let place = grid.place(cell);
            let x = |k: usize| grid.axes()[k].nodes()[place[k]];
            let [ti, pi, to, po] = if isotropic {
                [x(0), 0.0, x(1), x(2)]
            } else {
                [x(0), x(1), x(2), x(3)]
            };
            write!(out, "{ti:.8},{pi:.8},{to:.8},{po:.8}")?;
            for v in &grid.values()[cell * grid.channels()..][..grid.channels()] {
                write!(out, ",{}", short(*v))?;
            }
            writeln!(out)?;
        }
        Ok(())
    })
}
