//! Files that appear whole or not at all.

use crate::ImageError;
use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Cursor, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// Writes `bytes` to `path`: to a temporary name in the same folder, flushed to the disk, then renamed. On failure the
/// temporary file is removed, and what stood at `path` stays as it was.
///
/// A path that exists and is no ordinary file (a pipe, a device) is written to directly: renaming would replace it.
///
/// # Errors
/// [`ImageError::Io`] with what could not be done.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), ImageError> {
    write_with(path, |file| file.write_all(bytes))
}

/// As [`write_file`](write()), of what `content` writes, bit by bit.
///
/// # Errors
/// As [`write_file`](write()).
pub fn write_with(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), ImageError> {
    fill(path, Pending::create(path)?, content)
}

/// As [`write_file_with`](write_with), for a file that one process alone writes again and again: the temporary name is always the same,
/// so that a process that is killed leaves one such file at most, and the next one takes it over.
///
/// # Errors
/// As [`write_file`](write()).
pub fn rewrite_with(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), ImageError> {
    let pending = Pending::create_as(path, Temporary::of(path)?)?;
    fill(path, pending, content)
}

fn fill(
    path: &Path,
    mut pending: Pending,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), ImageError> {
    let mut buffered = BufWriter::with_capacity(1 << 16, &mut pending);
    content(&mut buffered)
        .and_then(|()| buffered.flush())
        .map_err(|e| ImageError::io(path, "write it", e))?;
    drop(buffered);
    pending.put_in_place()
}

/// A file that is not in place yet: dropped, it is gone.
pub(crate) struct Pending {
    path: PathBuf,
    target: Target,
}

enum Target {
    Beside(File, Temporary),
    /// For a pipe or a device, which can't be gone back in.
    Memory(Cursor<Vec<u8>>),
}

impl Pending {
    pub fn create(path: &Path) -> Result<Self, ImageError> {
        Self::create_as(path, Temporary::beside(path)?)
    }

    fn create_as(path: &Path, temporary: Temporary) -> Result<Self, ImageError> {
        let special = std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
        let target = if special {
            Target::Memory(Cursor::default())
        } else {
            let file = temporary
                .create()
                .map_err(|e| ImageError::io(path, "create a file in its folder", e))?;
            Target::Beside(file, temporary)
        };
        Ok(Self {
            path: path.to_owned(),
            target,
        })
    }

    /// Flushes it to the disk and gives it its name.
    pub fn put_in_place(self) -> Result<(), ImageError> {
        let path = &self.path;
        match self.target {
            Target::Beside(file, mut temporary) => {
                file.sync_all()
                    .map_err(|e| ImageError::io(path, "write it", e))?;
                std::fs::rename(&temporary.path, path)
                    .map_err(|e| ImageError::io(path, "put it in place", e))?;
                temporary.in_place = true;
                Ok(())
            }
            Target::Memory(bytes) => OpenOptions::new()
                .write(true)
                .open(path)
                .and_then(|mut f| f.write_all(bytes.get_ref()).and_then(|()| f.flush()))
                .map_err(|e| ImageError::io(path, "write it", e)),
        }
    }
}

impl Read for Pending {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Beside(file, _) => file.read(bytes),
            Target::Memory(all) => all.read(bytes),
        }
    }
}

impl Write for Pending {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.target {
            Target::Beside(file, _) => file.write(bytes),
            Target::Memory(all) => all.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Seek for Pending {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match &mut self.target {
            Target::Beside(file, _) => file.seek(to),
            Target::Memory(all) => all.seek(to),
        }
    }
}

/// A file that is removed when dropped, unless it was put in place.
struct Temporary {
    path: PathBuf,
    in_place: bool,
    /// Whether a file of this name is one that was left behind.
    taken_over: bool,
}

impl Temporary {
    /// A name that no other file has.
    fn beside(path: &Path) -> Result<Self, ImageError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let stem = stem(path)?;
        Ok(Self {
            path: path.with_file_name(format!("{stem}.{}.{count}.tmp", std::process::id())),
            in_place: false,
            taken_over: false,
        })
    }

    /// The same name every time.
    fn of(path: &Path) -> Result<Self, ImageError> {
        Ok(Self {
            path: path.with_file_name(format!("{}.tmp", stem(path)?)),
            in_place: false,
            taken_over: true,
        })
    }

    fn create(&self) -> io::Result<File> {
        let mut options = File::options();
        options.read(true).write(true);
        match self.taken_over {
            true => options.create(true).truncate(true),
            false => options.create_new(true),
        };
        options.open(&self.path)
    }
}

/// How a temporary name begins: short, whatever the length of the name, since a name may be as long as the file system allows.
fn stem(path: &Path) -> Result<String, ImageError> {
    let name = path.file_name().ok_or_else(|| {
        ImageError::parameter(format!("{}: names no file to write", path.display()))
    })?;
    let start: String = name.to_string_lossy().chars().take(32).collect();
    Ok(format!(".{start}"))
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.in_place {
            // It may never have been made; there is nobody to tell.
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entries(folder: &Path) -> usize {
        std::fs::read_dir(folder).unwrap().count()
    }

    #[test]
    fn replaces_whole() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write(&path, b"first").unwrap();
        write(&path, b"second").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(entries(folder.path()), 1);
    }

    /// What stood there stays, and nothing is left behind.
    #[test]
    fn a_content_that_fails_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        write(&path, b"first").unwrap();
        let half = |file: &mut dyn Write| {
            file.write_all(&[0; 100_000])?;
            Err(io::ErrorKind::StorageFull.into())
        };
        assert!(matches!(
            write_with(&path, half),
            Err(ImageError::Io { .. })
        ));
        assert!(matches!(
            rewrite_with(&path, half),
            Err(ImageError::Io { .. })
        ));
        assert_eq!(std::fs::read(&path).unwrap(), b"first");
        assert_eq!(entries(folder.path()), 1);
    }

    #[test]
    fn what_a_killed_process_left_is_taken_over() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        std::fs::write(folder.path().join(".a.bin.tmp"), [1; 1000]).unwrap();
        rewrite_with(&path, |file| file.write_all(b"whole")).unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"whole");
        assert_eq!(entries(folder.path()), 1);
    }

    #[test]
    fn a_missing_folder_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nowhere").join("a.bin");
        let error = write(&path, b"x").unwrap_err().to_string();
        assert!(
            error.contains("nowhere") && error.contains("create"),
            "{error}"
        );
        assert_eq!(entries(folder.path()), 0);
    }

    #[test]
    fn a_file_used_as_a_folder_and_a_folder_used_as_a_file_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, b"x").unwrap();
        assert!(matches!(
            write(&file.join("a.bin"), b"x"),
            Err(ImageError::Io { .. })
        ));
        let inner = folder.path().join("inner");
        std::fs::create_dir(&inner).unwrap();
        assert!(matches!(write(&inner, b"x"), Err(ImageError::Io { .. })));
        assert!(matches!(
            write(Path::new(""), b"x"),
            Err(ImageError::Parameter { .. })
        ));
        assert_eq!(entries(folder.path()), 2);
    }

    #[test]
    fn a_full_disk_is_an_error() {
        let full = Path::new("/dev/full");
        if !full.exists() {
            eprintln!("skipped: no /dev/full here");
            return;
        }
        let error = write(full, &[0; 100_000]).unwrap_err().to_string();
        assert!(error.contains("/dev/full: cannot write it"), "{error}");
        assert!(full.exists());
    }

    #[test]
    fn a_read_only_folder_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let mut permissions = std::fs::metadata(folder.path()).unwrap().permissions();
        permissions.set_readonly(true);
        std::fs::set_permissions(folder.path(), permissions).unwrap();
        match write(&folder.path().join("a.bin"), b"x") {
            Ok(()) => eprintln!("skipped: this user may write to a read-only folder"),
            Err(e) => {
                assert!(matches!(e, ImageError::Io { .. }), "{e}");
                assert_eq!(entries(folder.path()), 0);
            }
        }
    }
}
