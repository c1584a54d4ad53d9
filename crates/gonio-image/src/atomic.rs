//! Files that appear whole or not at all.

use crate::ImageError;
use std::fs::{File, OpenOptions};
use std::io::{self, Cursor, Read, Seek, SeekFrom, Write};
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
    let mut pending = Pending::create(path)?;
    pending
        .write_all(bytes)
        .map_err(|e| ImageError::io(path, "write it", e))?;
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
        let special = std::fs::metadata(path).is_ok_and(|m| !m.is_file() && !m.is_dir());
        let target = if special {
            Target::Memory(Cursor::default())
        } else {
            let temporary = Temporary::beside(path)?;
            let file = File::options()
                .read(true)
                .write(true)
                .create_new(true)
                .open(&temporary.path)
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
}

impl Temporary {
    fn beside(path: &Path) -> Result<Self, ImageError> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let name = path.file_name().ok_or_else(|| {
            ImageError::parameter(format!("{}: names no file to write", path.display()))
        })?;
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        // Short, whatever the length of the name: a name may be as long as the file system allows.
        let mut stem: String = name.to_string_lossy().chars().take(32).collect();
        stem.insert(0, '.');
        Ok(Self {
            path: path.with_file_name(format!("{stem}.{}.{count}.tmp", std::process::id())),
            in_place: false,
        })
    }
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
