//! Writing a part.

use super::{Exposure, Header, LARGEST_HEADER, Label, MAGIC, VERSION};
use crate::RenderError;
use crate::film::record::Widths;
use gonio_image::{rewrite_file_with, write_file_with};
use std::io::{self, Write};
use std::path::Path;

/// Writes a part, whole or not at all.
///
/// # Errors
/// [`RenderError::Image`] if it can't be written; what stood at `path` then stays.
pub fn write(path: &Path, label: &Label, exposure: &Exposure) -> Result<(), RenderError> {
    Ok(write_file_with(path, |file| put(file, label, exposure))?)
}

/// As [`write()`], to a file that this process alone writes, again and again: a process that is killed leaves one temporary file at
/// most, which the next one takes over.
///
/// # Errors
/// As [`write()`].
pub fn write_alone(path: &Path, label: &Label, exposure: &Exposure) -> Result<(), RenderError> {
    Ok(rewrite_file_with(path, |file| put(file, label, exposure))?)
}

/// Pixels that are put into bytes at a time.
const PIXELS: usize = 4096;

fn put(file: &mut dyn Write, label: &Label, exposure: &Exposure) -> io::Result<()> {
    let film = &exposure.film;
    let widths = Widths::of(film);
    let header = Header {
        identity: label.identity.clone(),
        scene: label.scene.clone(),
        of: label.of,
        names: label.names.clone(),
        kept: film.kept(),
        width: film.width(),
        height: film.height(),
        first: exposure.samples.start,
        end: exposure.samples.end,
        rays: exposure.rays,
        seconds: exposure.elapsed.as_secs_f64(),
        rejected: film.rejected().into(),
        columns: widths.as_slice().to_vec(),
    };
    let header = serde_json::to_vec(&header).map_err(io::Error::other)?;
    if header.len() > LARGEST_HEADER as usize {
        return Err(io::Error::other(format!(
            "the names of materials and the settings take {} bytes, at most {LARGEST_HEADER} can be read again",
            header.len()
        )));
    }
    let mut hasher = blake3::Hasher::new();
    let mut put = |bytes: &[u8]| {
        hasher.update(bytes);
        file.write_all(bytes)
    };
    put(&MAGIC)?;
    put(&VERSION.to_le_bytes())?;
    put(&(header.len() as u32).to_le_bytes())?;
    put(&header)?;
    let mut bytes = Vec::with_capacity(PIXELS * widths.bytes());
    let count = film.pixels().len();
    for first in (0..count).step_by(PIXELS) {
        bytes.clear();
        for pixel in first..count.min(first + PIXELS) {
            widths.write(film, pixel, &mut bytes);
        }
        put(&bytes)?;
    }
    file.write_all(hasher.finalize().as_bytes())
}
