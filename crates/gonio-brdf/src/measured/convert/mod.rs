//! [`convert`], any measurement or model as a file of any format, and what that costs.

mod plan;
mod report;
mod source;

pub use plan::{Shape, TARGETS};
pub use report::{Albedo, ConversionReport, Difference, Worst};
pub use source::Source;

use super::build::Progress;
use super::format::{self, Format};
use super::load::load;
use super::measurement::Measurement;
use super::prepared::{LoadOptions, Select};
use crate::BrdfError;
use plan::Plan;
use std::path::Path;

/// What a file is to be.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Target {
    /// The format by name; by the file's extension if not given.
    pub format: Option<String>,
    /// The layout by name ([`TARGETS`]); the source's own where the format has it, or the format's usual one, if not given.
    pub parameterization: Option<String>,
    /// Nodes along each axis, or levels of a tree; usual ones if not given.
    pub resolution: Option<Vec<usize>>,
}

impl Target {
    /// The format of a file that is to be written at `path`.
    ///
    /// # Errors
    /// If there is none of this name or extension: which there are.
    pub fn format_for(&self, path: &Path) -> Result<&'static Format, BrdfError> {
        let known = || {
            let all: Vec<String> = format::FORMATS
                .iter()
                .map(|f| format!("{} (.{})", f.name, f.extension))
                .collect();
            all.join(", ")
        };
        if let Some(name) = &self.format {
            return format::find(name).ok_or_else(|| BrdfError::Unsupported {
                what: format!("no format `{name}`: known are {}", known()),
            });
        }
        let extension = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default();
        let same = |f: &&Format| f.extension.eq_ignore_ascii_case(extension);
        format::FORMATS
            .iter()
            .find(same)
            .ok_or_else(|| BrdfError::Unsupported {
                what: format!(
                    "{}: the extension says no format: known are {}; or name one",
                    path.display(),
                    known()
                ),
            })
    }
}

/// Writes `source` to `path`, reads it again and compares.
///
/// Where the format can hold the source's numbers as they are, and neither a layout nor a resolution is asked for, they are copied;
/// otherwise the source is evaluated at the nodes, patches or squares of the layout ([`tabulate`](super::tabulate)). What a layout can't
/// hold is averaged: an isotropic one takes the mean over eight azimuths, one that is reciprocal or mirrored by its definition the mean of
/// both.
///
/// # Errors
/// If there is no such format or layout, the format can't hold what is asked for, the file can't be written or read again, or
/// `progress` stops it.
pub fn convert(
    source: &Source,
    path: &Path,
    target: &Target,
    progress: &mut Progress<'_>,
) -> Result<ConversionReport, BrdfError> {
    let format = target.format_for(path)?;
    let as_is = target.parameterization.is_none() && target.resolution.is_none();
    if as_is && let Some(measurement) = source.measurement() {
        let measurement = traced(measurement.clone(), source, "copied");
        match (format.write)(path, &measurement) {
            Ok(()) => return report::compare(source, path, format, &measurement, true),
            Err(BrdfError::Unsupported { .. }) => {}
            Err(other) => return Err(other),
        }
    }
    let plan = Plan::new(source, format, target)?;
    let measurement = plan.carry_out(source, progress)?;
    let measurement = traced(measurement, source, "resampled");
    (format.write)(path, &measurement)?;
    report::compare(source, path, format, &measurement, false)
}

/// The measurement with the source's metadata, and a line about this conversion in its provenance.
fn traced(mut measurement: Measurement, source: &Source, how: &str) -> Measurement {
    if let Some(original) = source.measurement() {
        measurement.metadata = original.metadata.clone();
    } else {
        measurement.metadata.quantity = "BRDF".into();
        measurement.metadata.name = source.name().into();
    }
    measurement.metadata.unit = "sr^-1".into();
    let line = format!("{how} by gonio from {}", source.name());
    measurement.metadata.provenance.push(line);
    measurement
}

/// Reads a file back with every side.
fn read_back(path: &Path) -> Result<super::Measured, BrdfError> {
    let options = LoadOptions {
        select: Select::All,
        ..LoadOptions::default()
    };
    load(path, options)
}
