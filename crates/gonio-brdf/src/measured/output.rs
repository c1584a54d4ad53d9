//! Files that appear whole or not at all.

use crate::BrdfError;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes a file: to a temporary name in the same folder, flushed to the disk, then renamed. On failure the temporary file is removed,
/// and what stood at `path` stays as it was.
pub(crate) fn write(
    path: &Path,
    content: impl FnOnce(&mut BufWriter<File>) -> std::io::Result<()>,
) -> Result<(), BrdfError> {
    let io = |source| BrdfError::Io {
        path: path.into(),
        source,
    };
    let Some(temporary) = beside(path) else {
        let names_nothing = std::io::ErrorKind::IsADirectory;
        return Err(io(names_nothing.into()));
    };
    let written = (|| {
        let mut out = BufWriter::with_capacity(
            1 << 18,
            File::options()
                .write(true)
                .create_new(true)
                .open(&temporary)?,
        );
        content(&mut out)?;
        out.flush()?;
        out.get_ref().sync_all()?;
        drop(out);
        std::fs::rename(&temporary, path)
    })();
    written.map_err(|source| {
        // What was written is of no use; that it can't be removed either adds nothing to the error.
        let _ = std::fs::remove_file(&temporary);
        io(source)
    })
}

/// A name in the same folder, short whatever the length of the file's own.
fn beside(path: &Path) -> Option<PathBuf> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let mut stem: String = path
        .file_name()?
        .to_string_lossy()
        .chars()
        .take(32)
        .collect();
    stem.insert(0, '.');
    Some(path.with_file_name(format!("{stem}.{}.{count}.tmp", std::process::id())))
}
