//! [`Input`], the bytes of a file that is read as a measurement, with what errors need.

use super::values::Values;
use super::{file, tensor_file};
use crate::BrdfError;
use memmap2::Mmap;
use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Numbers that a table may have: more can't be addressed by whole numbers of 32 bits.
pub(crate) const MOST_VALUES: u64 = u32::MAX as u64;
/// Bytes of a file that is read into memory whole. Larger tables come in the container, which is mapped.
pub(crate) const MOST_BYTES: u64 = 1 << 30;
/// Bytes at a file's beginning by which its format is told.
pub(super) const HEAD: usize = 64 << 10;

/// The bytes of a file.
pub struct Input<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    map: Option<&'a Arc<Mmap>>,
}

impl<'a> Input<'a> {
    /// Bytes in memory; `path` is what errors name.
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self {
            path,
            bytes,
            map: None,
        }
    }

    /// All bytes.
    pub fn bytes(&self) -> &'a [u8] {
        self.bytes
    }

    /// The file.
    pub fn path(&self) -> &'a Path {
        self.path
    }

    /// An error about a place in the file.
    pub(crate) fn error(
        &self,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> BrdfError {
        BrdfError::Format {
            path: self.path.into(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// The bytes as text.
    pub(crate) fn text(&self) -> Result<&'a str, BrdfError> {
        let text = std::str::from_utf8(self.bytes).map_err(|e| {
            let at = e.valid_up_to();
            self.error(
                format!("byte {at}"),
                format!("the byte 0x{:02x}", self.bytes[at]),
                "text in UTF-8",
            )
        })?;
        Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
    }

    /// The little-endian `f32` in the bytes `range`: in place if the file is mapped.
    pub(super) fn values(&self, range: Range<usize>) -> Values {
        match self.map {
            Some(map) => Values::mapped(map, range),
            None => Values::from_bytes(&self.bytes[range]),
        }
    }
}

/// A file that was opened, and its first bytes.
pub(super) struct Opened {
    file: File,
    pub length: u64,
    pub head: Vec<u8>,
}

/// Opens a regular file. A folder, a pipe or a device is refused before it is opened: opening a pipe waits for its other end.
pub(super) fn open(path: &Path) -> Result<Opened, BrdfError> {
    let io = |source| BrdfError::Io {
        path: path.into(),
        source,
    };
    let metadata = std::fs::metadata(path).map_err(io)?;
    if !metadata.is_file() {
        return Err(BrdfError::Format {
            path: path.into(),
            place: "whole file".into(),
            found: if metadata.is_dir() {
                "a folder"
            } else {
                "a pipe or a device"
            }
            .into(),
            expected: "a file with a measurement".into(),
        });
    }
    let file = File::open(path).map_err(io)?;
    let length = file.metadata().map_err(io)?.len();
    let mut head = Vec::new();
    (&file)
        .take(HEAD as u64)
        .read_to_end(&mut head)
        .map_err(io)?;
    Ok(Opened { file, length, head })
}

impl Opened {
    /// Calls `parse` on the whole file: mapped if asked, read into memory otherwise.
    pub fn with_all<T>(
        mut self,
        path: &Path,
        mapped: bool,
        parse: impl FnOnce(&Input<'_>) -> Result<T, BrdfError>,
    ) -> Result<T, BrdfError> {
        let io = |source| BrdfError::Io {
            path: path.into(),
            source,
        };
        // Where files can't be mapped, as in a browser, they are read.
        if mapped && cfg!(any(unix, windows)) {
            let map = file::map(path, tensor_file::MAGIC, "a container of tables")?;
            return parse(&Input {
                path,
                bytes: &map,
                map: Some(&map),
            });
        }
        if self.length > MOST_BYTES {
            return Err(Input::new(path, &[]).error(
                "whole file",
                format!("{} bytes", self.length),
                format!("at most {MOST_BYTES} of this format"),
            ));
        }
        let mut bytes = std::mem::take(&mut self.head);
        self.file
            .take(MOST_BYTES)
            .read_to_end(&mut bytes)
            .map_err(io)?;
        parse(&Input::new(path, &bytes))
    }
}
