//! The formats of files that hold measured reflection: one file each, and one line each in [`FORMATS`].

pub mod astm;
pub mod container;
pub mod merl;
pub mod pbrt;
pub mod radiance;
pub mod rgl;
mod text;
pub mod utia;

use super::channel::Channel;
use super::grid::{Axis, Grid};
use super::input::Input;
use super::measurement::{Component, Data, Measurement, Side};
use super::metadata::Metadata;
use crate::BrdfError;
use std::path::Path;

/// A file format.
#[derive(Debug, Clone, Copy)]
pub struct Format {
    /// Its name in the command.
    pub name: &'static str,
    /// The extension that files usually have.
    pub extension: &'static str,
    /// One line on what it is.
    pub summary: &'static str,
    /// By what it is told, in words.
    pub told_by: &'static str,
    /// Whether a file with this beginning and length is one.
    detect: fn(&[u8], u64) -> bool,
    /// Reads one.
    pub parse: fn(&Input<'_>) -> Result<Measurement, BrdfError>,
    /// Writes one.
    pub write: fn(&Path, &Measurement) -> Result<(), BrdfError>,
    /// Whether it is mapped rather than read.
    pub(super) mapped: bool,
}

/// Every format, in the order in which a file is tried.
pub const FORMATS: &[Format] = &[
    Format {
        name: "gonio",
        extension: "gonio",
        summary: "the project's own: any layout, any channels, uncertainty, provenance",
        told_by: "a tensor_file with the field gonio.version",
        detect: container::detect,
        parse: container::parse,
        write: container::write,
        mapped: true,
    },
    Format {
        name: "rgl",
        extension: "bsdf",
        summary: "RGL database: adaptive parameterization, RGB or spectral",
        told_by: "a tensor_file with the fields theta_i and vndf",
        detect: rgl::detect,
        parse: rgl::parse,
        write: rgl::write,
        mapped: true,
    },
    Format {
        name: "radiance",
        extension: "xml",
        summary: "Radiance and WINDOW BSDF: Klems patches or tensor trees, both sides, XML",
        told_by: "XML with the element WindowElement",
        detect: radiance::detect,
        parse: radiance::parse,
        write: radiance::write,
        mapped: false,
    },
    Format {
        name: "astm",
        extension: "astm",
        summary: "ASTM E1392 and E2387: text with named columns",
        told_by: "text with a line VARS",
        detect: astm::detect,
        parse: astm::parse,
        write: astm::write,
        mapped: false,
    },
    Format {
        name: "pbrt",
        extension: "brdf",
        summary: "pbrt-v2: isotropic, wavelengths, text",
        told_by: "text that begins with a number",
        detect: pbrt::detect,
        parse: pbrt::parse,
        write: pbrt::write,
        mapped: false,
    },
    Format {
        name: "utia",
        extension: "bin",
        summary: "UTIA database: anisotropic, RGB",
        told_by: "1990656 bytes",
        detect: utia::detect,
        parse: utia::parse,
        write: utia::write,
        mapped: false,
    },
    Format {
        name: "merl",
        extension: "binary",
        summary: "MERL database: isotropic, half and difference angles, RGB",
        told_by: "three 32-bit numbers of cells, each from 1 to 4096",
        detect: merl::detect,
        parse: merl::parse,
        write: merl::write,
        mapped: false,
    },
];

/// The format called `name`.
pub fn find(name: &str) -> Option<&'static Format> {
    FORMATS.iter().find(|f| f.name == name)
}

/// The format of a file with this beginning and length.
///
/// # Errors
/// If it is none of them: what was looked for.
pub(super) fn detect(path: &Path, head: &[u8], length: u64) -> Result<&'static Format, BrdfError> {
    let found = FORMATS.iter().find(|f| (f.detect)(head, length));
    found.ok_or_else(|| {
        let looked_for: Vec<String> = FORMATS
            .iter()
            .map(|f| format!("{} ({})", f.name, f.told_by))
            .collect();
        let first: Vec<String> = head.iter().take(8).map(|b| format!("{b:02x}")).collect();
        BrdfError::Format {
            path: path.into(),
            place: "beginning of the file".into(),
            found: match length {
                0 => "an empty file".into(),
                _ => format!("{} in a file of {length} bytes", first.join(" ")),
            },
            expected: format!("one of {}", looked_for.join(", ")),
        }
    })
}

fn unsupported(what: &str) -> BrdfError {
    BrdfError::Unsupported { what: what.into() }
}

/// A measurement of the reflection on the front that was read.
fn measurement(
    input: &Input<'_>,
    grid: Grid,
    channels: Vec<Channel>,
    metadata: Metadata,
) -> Result<Measurement, BrdfError> {
    let components = vec![Component::reflection(Data::Grid(grid))];
    Measurement::new(components, channels, metadata).map_err(|e| {
        input.error(
            "whole file",
            e.to_string(),
            "values and channels that agree",
        )
    })
}

/// Whether a grid has these axes.
fn has_axes(grid: &Grid, axes: Result<Vec<Axis>, String>) -> bool {
    axes.is_ok_and(|axes| {
        axes.len() == grid.axes().len() && axes.iter().zip(grid.axes()).all(|(a, b)| a.is_like(b))
    })
}

/// The grid of the reflection on the front.
fn front_grid<'a>(measurement: &'a Measurement, what: &str) -> Result<&'a Grid, BrdfError> {
    match measurement
        .component(Side::ReflectionFront)
        .map(|c| &c.data)
    {
        Some(Data::Grid(grid)) => Ok(grid),
        Some(other) => Err(unsupported(&format!(
            "{what} holds a grid of angles, not a {}",
            other.name()
        ))),
        None => Err(unsupported(&format!(
            "{what} holds the reflection on the front, which this measurement lacks"
        ))),
    }
}

/// Whether the beginning of a file is text in UTF-8, but for a character that the end of `head` cuts.
fn is_text(head: &[u8]) -> bool {
    let ends_within = |e: &std::str::Utf8Error| e.error_len().is_none();
    let utf8 = std::str::from_utf8(head).map_or_else(|e| ends_within(&e), |_| true);
    utf8 && !head.is_empty() && !head.contains(&0)
}
