//! One reader for every format, by content.

use super::format::{self, Format};
use super::input::{self, Input};
use super::measurement::Measurement;
use super::prepared::{LoadOptions, Measured};
use crate::BrdfError;
use std::path::Path;

/// Reads a file of any known format and makes it ready to be evaluated. The format is told by the file's content, not its name.
///
/// # Errors
/// If the file cannot be read, is of no known format, is broken (file, place, what was found and what was expected), or as
/// [`Measured::new`]. A folder, a pipe or a device is refused without being opened; nothing is allocated that the file's length does
/// not warrant.
pub fn load(path: &Path, options: LoadOptions) -> Result<Measured, BrdfError> {
    Measured::new(path, read(path)?.1, options)
}

/// Reads a file of any known format as it is.
///
/// # Errors
/// As [`load`].
pub fn read(path: &Path) -> Result<(&'static Format, Measurement), BrdfError> {
    let opened = input::open(path)?;
    let format = format::detect(path, &opened.head, opened.length)?;
    let measurement = opened.with_all(path, format.mapped, format.parse)?;
    Ok((format, measurement))
}

/// Reads bytes in memory of any known format; `path` is what errors name.
///
/// # Errors
/// As [`load`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<(&'static Format, Measurement), BrdfError> {
    let head = &bytes[..bytes.len().min(input::HEAD)];
    let format = format::detect(path, head, bytes.len() as u64)?;
    Ok((format, (format.parse)(&Input::new(path, bytes))?))
}
