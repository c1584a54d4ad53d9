//! [`Files`]: where the files of a scene are read from.

use crate::SceneError;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where a scene's files come from: the disk, or memory (embedded in a program, or dropped on a page).
#[derive(Debug, Clone, Default)]
pub enum Files {
    /// The file system.
    #[default]
    Disk,
    /// Names and contents; a scene refers to them by relative paths as it would to files in one folder.
    Memory(Arc<BTreeMap<PathBuf, Cow<'static, [u8]>>>),
    /// The file system, and somebody who is told each file that is read.
    Watched(Watch),
}

/// Who is told the path and the bytes of each file that is read.
#[derive(Clone)]
pub struct Watch(pub Arc<Told>);

/// What is done with a path and the bytes of its file.
pub type Told = dyn Fn(&Path, &[u8]) + Send + Sync;

impl fmt::Debug for Watch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Watch")
    }
}

impl Files {
    /// Files that are part of the program.
    pub fn embedded(files: impl IntoIterator<Item = (&'static str, &'static [u8])>) -> Self {
        let entry = |(name, bytes): (&str, &'static [u8])| (name.into(), Cow::Borrowed(bytes));
        Self::Memory(Arc::new(files.into_iter().map(entry).collect()))
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// [`SceneError::Io`] if it does not exist or can't be read, [`SceneError::Limit`] if it has more than `max_bytes`.
    pub fn read(&self, path: &Path, max_bytes: u64) -> Result<Vec<u8>, SceneError> {
        let io = |e| SceneError::io(path, e);
        let check = |size: u64| {
            if size <= max_bytes {
                return Ok(());
            }
            Err(SceneError::Limit {
                path: path.to_owned(),
                place: "file".into(),
                found: format!("{size} bytes"),
                limit: format!("{max_bytes} bytes"),
            })
        };
        match self {
            Self::Disk => {
                check(std::fs::metadata(path).map_err(io)?.len())?;
                std::fs::read(path).map_err(io)
            }
            Self::Watched(Watch(tell)) => {
                let bytes = Self::Disk.read(path, max_bytes)?;
                tell(path, &bytes);
                Ok(bytes)
            }
            Self::Memory(files) => {
                let bytes = files
                    .get(path)
                    .ok_or_else(|| io(io::ErrorKind::NotFound.into()))?;
                check(bytes.len() as u64)?;
                Ok(bytes.to_vec())
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LoadOptions, Scene};

    #[test]
    fn a_scene_of_files_in_memory() {
        let files = Files::embedded([
            (
                "scene.toml",
                b"[environment]\nuniform = 1\n[[shape]]\nkind = \"mesh\"\nfile = \"a.obj\""
                    .as_slice(),
            ),
            ("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n".as_slice()),
        ]);
        let options = LoadOptions {
            files,
            ..LoadOptions::default()
        };
        let scene = Scene::load("scene.toml", &options).unwrap();
        assert_eq!(scene.geometry.triangle_count(), 1);
        assert!(matches!(
            Scene::load("other.toml", &options),
            Err(SceneError::Io { .. })
        ));
        let small = LoadOptions {
            max_bytes: 4,
            ..options
        };
        assert!(matches!(
            Scene::load("scene.toml", &small),
            Err(SceneError::Limit { .. })
        ));
    }
}
