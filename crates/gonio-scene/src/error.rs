//! [`SceneError`], everything that can be wrong with a scene.

use std::path::{Path, PathBuf};

/// Why a scene, or a file of one, was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file could not be opened, read or written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        #[source]
        source: std::io::Error,
    },
    /// A file is not what its format asks for.
    #[error("{}: {place}: found {found}, expected {expected}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Where in it: "line 17", "byte 1024", "vertex 3".
        place: String,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// A file asks for more than a reader is willing to hold.
    #[error("{}: {place}: found {found}, the limit is {limit}", path.display())]
    Limit {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: String,
        /// What it asks for.
        found: String,
        /// What is allowed.
        limit: String,
    },
    /// A mesh breaks its own rules.
    #[error("mesh: {place}: found {found}, expected {expected}")]
    Mesh {
        /// Where: "triangle 7", "position 3".
        place: String,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// An instance can't be placed in a scene.
    #[error("instance {instance}: {message}")]
    Instance {
        /// Its index in the list of instances.
        instance: usize,
        /// What is wrong with it.
        message: String,
    },
}

impl SceneError {
    /// The error of a failed file operation.
    pub fn io(path: &Path, source: std::io::Error) -> Self {
        Self::Io {
            path: path.to_owned(),
            source,
        }
    }

    /// The error of a file that breaks its format.
    pub fn format(
        path: &Path,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Format {
            path: path.to_owned(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// The same error, with the file named that the broken mesh came from; other errors as they are.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Self::Mesh {
                place,
                found,
                expected,
            } => Self::Format {
                path: path.to_owned(),
                place,
                found,
                expected,
            },
            other => other,
        }
    }
}
