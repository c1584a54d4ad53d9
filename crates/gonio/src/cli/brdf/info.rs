//! `gonio brdf info`.

use super::convert::summarized;
use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json};
use gonio_brdf::measured::{
    Boundary, Data, LoadOptions, Measured, Scale, Select, ToRgb, format::Format, read,
};
use serde_json::{Value, json};
use std::path::Path;

pub(super) fn run(file: &Path, json: bool) -> Result<(), Failure> {
    let (format, measurement) = read(file)?;
    let options = LoadOptions {
        select: Select::All,
        ..LoadOptions::default()
    };
    let measured = Measured::new(file, measurement, options)?;
    if json {
        return print_json(&in_json(file, format, &measured));
    }
    print(&in_words(file, format, &measured))
}

fn in_words(file: &Path, format: &Format, measured: &Measured) -> String {
    let m = measured.measurement();
    let channels: Vec<String> = m.channels.iter().map(ToString::to_string).collect();
    let mut text = format!(
        "{}\n  format     {}: {}\n  channels   {}\n",
        file.display(),
        format.name,
        format.summary,
        summarized(&channels)
    );
    for (key, value) in m.metadata.entries() {
        text += &format!("  {key:<10} {}\n", value.replace('\n', " "));
    }
    for c in &m.components {
        let values = c.data.values();
        let (low, high) = range(values);
        text += &format!(
            "\n{}\n  {}: {}\n  values from {low} to {high} sr⁻¹, {}{}\n",
            c.side.name(),
            c.data.name(),
            c.data.size(),
            if values.is_mapped() {
                "read where they are in the file"
            } else {
                "in memory"
            },
            if c.uncertainty.is_some() {
                ", with uncertainties"
            } else {
                ""
            }
        );
        text += &axes(&c.data);
    }
    text += "\nFound\n";
    text += &format!(
        "  {} values: {} negative, {} missing, {} below the horizon\n",
        measured.found().values,
        measured.found().negative,
        measured.found().missing,
        measured.found().unreachable
    );
    if let Some(place) = &measured.found().first_negative {
        text += &format!("  the first negative one: {place}\n");
    }
    if measured.found().out_of_gamut > 0 {
        text += &format!(
            "  {} colours outside linear Rec.709, brought to its border\n",
            measured.found().out_of_gamut
        );
    }
    let properties = [
        (measured.is_isotropic(), "isotropic by its layout"),
        (measured.is_reciprocal(), "reciprocal by its layout"),
    ];
    for (holds, property) in properties {
        if holds {
            text += &format!("  {property}\n");
        }
    }
    for (title, lines) in [
        ("Not evaluated", unused(measured)),
        ("Notes", measured.found().notes.clone()),
    ] {
        if !lines.is_empty() {
            text += &format!("\n{title}\n");
            for line in lines {
                text += &format!("  {line}\n");
            }
        }
    }
    text
}

/// The channels that have no part in the colour, and what the file has beside its values.
fn unused(measured: &Measured) -> Vec<String> {
    let mut lines = measured.measurement().unused.clone();
    let channels = &measured.measurement().channels;
    lines.extend(ToRgb::new(channels).unused(channels));
    lines
}

fn range(values: &[f32]) -> (f32, f32) {
    values
        .iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), x| {
            (low.min(*x), high.max(*x))
        })
}

/// The axes of a grid, a line each.
fn axes(data: &Data) -> String {
    let Data::Grid(grid) = data else {
        return String::new();
    };
    let mut text = String::new();
    for (name, axis) in grid.parameterization().axes().iter().zip(grid.axes()) {
        let deg = |x: f64| format!("{:.4}", x.to_degrees());
        let nodes = axis.nodes();
        let boundary = match axis.boundary() {
            Boundary::Clamped => "constant beyond".into(),
            Boundary::Periodic(p) => format!("closed after {}°", deg(p)),
            Boundary::Mirrored(p) => format!("closed after {}°, mirrored", deg(p)),
        };
        let scale = match axis.scale() {
            Scale::Linear => "",
            Scale::SquareRoot => ", linear in its root",
        };
        text += &format!(
            "  {name:<9} {} nodes from {}° to {}°, {boundary}{scale}\n",
            axis.len(),
            deg(nodes[0]),
            deg(nodes[nodes.len() - 1]),
        );
    }
    text
}

fn in_json(file: &Path, format: &Format, measured: &Measured) -> Value {
    let m = measured.measurement();
    let found = measured.found();
    let components: Vec<Value> = m
        .components
        .iter()
        .map(|c| {
            let (low, high) = range(c.data.values());
            let axes = match &c.data {
                Data::Grid(grid) => grid
                    .parameterization()
                    .axes()
                    .iter()
                    .zip(grid.axes())
                    .map(|(name, axis)| json!({ "name": name, "nodes_rad": axis.nodes() }))
                    .collect(),
                _ => Vec::new(),
            };
            json!({
                "side": c.side.name(),
                "layout": c.data.name(),
                "size": c.data.size(),
                "axes": axes,
                "smallest_per_sr": low,
                "largest_per_sr": high,
                "mapped": c.data.values().is_mapped(),
                "uncertainty": c.uncertainty.is_some(),
            })
        })
        .collect();
    json!({
        "file": file.display().to_string(),
        "format": format.name,
        "channels": m.channels.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "metadata": m.metadata.entries().into_iter().map(|(k, v)| (k.to_owned(), json!(v))).collect::<serde_json::Map<_, _>>(),
        "components": components,
        "values": found.values,
        "negative": found.negative,
        "missing": found.missing,
        "below_the_horizon": found.unreachable,
        "out_of_gamut": found.out_of_gamut,
        "isotropic": measured.is_isotropic(),
        "reciprocal": measured.is_reciprocal(),
        "not_evaluated": unused(measured),
        "notes": found.notes,
    })
}
