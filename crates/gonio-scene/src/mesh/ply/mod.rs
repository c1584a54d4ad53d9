//! Stanford PLY: ascii, binary little-endian, binary big-endian.
//!
//! Our own reader rather than a library's: it decodes a million triangles in tens of milliseconds, its memory is bounded
//! by the size of the file whatever the header promises, and its errors name the element or the line.
//!
//! Read are, of the element `vertex`: x y z; nx ny nz; texture coordinates u v, s t, or texture_u texture_v; red green blue
//! and alpha, where whole numbers are sRGB-encoded and floating-point ones linear. Of the element `face`: the list
//! vertex_indices or vertex_index, of polygons that are taken as convex and cut into a fan. All else is passed over.
//! Texture coordinates are turned to v downwards.

mod body;
mod header;

use super::TriangleMesh;
use crate::SceneError;
use std::path::Path;

/// Reads a PLY file.
///
/// # Errors
/// [`SceneError::Io`] if it can't be read; [`SceneError::Format`], with the place, if it can't be understood, ends too
/// early, or its mesh breaks a rule of [`TriangleMesh::check`].
pub fn read(path: &Path) -> Result<TriangleMesh, SceneError> {
    let bytes = std::fs::read(path).map_err(|e| SceneError::io(path, e))?;
    parse(&bytes, path)
}

/// Reads a PLY file that is in memory; `path` is for errors.
///
/// # Errors
/// As [`read`], but for input and output.
pub fn parse(bytes: &[u8], path: &Path) -> Result<TriangleMesh, SceneError> {
    let fault = |f: Fault| SceneError::format(path, f.place, f.found, f.expected);
    let (header, body) = header::parse(bytes).map_err(fault)?;
    let mesh = body::parse(&header, bytes, body).map_err(fault)?;
    mesh.check().map_err(|e| e.in_file(path))?;
    Ok(mesh)
}

/// Where a file breaks the format, what was found and what was expected.
#[derive(Debug)]
struct Fault {
    place: String,
    found: String,
    expected: String,
}

impl Fault {
    fn new(
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self {
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}

#[cfg(test)]
mod tests;
