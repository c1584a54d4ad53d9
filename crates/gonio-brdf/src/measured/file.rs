//! Files of measured reflectance: opened and mapped into memory, with errors that name the place.

use crate::BrdfError;
use memmap2::Mmap;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

/// What is wrong where in a file, which itself is named later.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Fault {
    pub place: String,
    pub found: String,
    pub expected: String,
}

impl Fault {
    pub fn new(place: impl ToString, found: impl ToString, expected: impl ToString) -> Self {
        Self {
            place: place.to_string(),
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    /// The error for the file `path`.
    pub fn at(self, path: &Path) -> BrdfError {
        BrdfError::Format {
            path: path.into(),
            place: self.place,
            found: self.found,
            expected: self.expected,
        }
    }
}

/// Up to 16 bytes as a message shows them.
pub(super) fn quoted(bytes: &[u8]) -> String {
    let shown = &bytes[..bytes.len().min(16)];
    let more = if bytes.len() > 16 { "…" } else { "" };
    format!("`{}{more}`", shown.escape_ascii())
}

/// Opens a regular file. A folder, a pipe or a device is refused before it is opened: opening a pipe waits for its other end.
fn open(path: &Path, what: &str) -> Result<File, BrdfError> {
    let io = |source| BrdfError::Io {
        path: path.into(),
        source,
    };
    if !std::fs::metadata(path).map_err(io)?.is_file() {
        return Err(Fault::new("whole file", "not a regular file", what).at(path));
    }
    File::open(path).map_err(io)
}

/// The first bytes of a file, at most `count`.
fn first_bytes(file: &File, path: &Path, count: usize) -> Result<Vec<u8>, BrdfError> {
    let mut start = Vec::new();
    let read = file.take(count as u64).read_to_end(&mut start);
    read.map_err(|source| BrdfError::Io {
        path: path.into(),
        source,
    })?;
    Ok(start)
}

/// Maps a regular file that begins with `magic` into memory; `what` is what it should be. A file that begins otherwise is refused
/// before it is mapped.
pub(super) fn map(path: &Path, magic: &[u8], what: &str) -> Result<Arc<Mmap>, BrdfError> {
    let file = open(path, what)?;
    let start = first_bytes(&file, path, magic.len())?;
    if start != magic {
        let found = match start.len() {
            0 => "an empty file".into(),
            _ => quoted(&start),
        };
        return Err(Fault::new("byte 0", found, format!("{} of {what}", quoted(magic))).at(path));
    }
    mapping::map(&file)
        .map(Arc::new)
        .map_err(|source| BrdfError::Io {
            path: path.into(),
            source,
        })
}

/// The one unsafe call of the measured tables.
mod mapping {
    #![allow(unsafe_code)]

    /// The file as memory.
    pub fn map(file: &std::fs::File) -> std::io::Result<memmap2::Mmap> {
        // SAFETY: the bytes must not change while they are mapped. No other handle of this program writes to a table that it has
        // open: writers write a new file and rename it, which leaves the mapped one as it was. That another program writes into
        // the file in place, or cuts it off, is beyond what any reader can rule out; the documentation of the readers says so.
        unsafe { memmap2::Mmap::map(file) }
    }
}
