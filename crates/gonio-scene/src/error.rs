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
    /// A number that a scene is described with is not one it may be.
    #[error("{name} is {found}, expected {expected}")]
    Parameter {
        /// What it describes, with its unit.
        name: String,
        /// What was given.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// A scene file in the native format is wrong.
    #[error("{}:{line}:{column}: {message}\n{snippet}", path.display())]
    Description {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// Column in characters, from 1.
        column: usize,
        /// What is wrong.
        message: String,
        /// The line with the place underlined.
        snippet: String,
        /// How to go on.
        help: Option<String>,
    },
    /// A file asks for what Gonio can't do.
    #[error("{}: {what} is not supported", path.display())]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// What it asks for.
        what: String,
        /// How to go on.
        help: String,
    },
    /// A texture can't be read.
    #[error("{what}: {source}")]
    Image {
        /// The scene's file and the image in it.
        what: String,
        /// Why.
        #[source]
        source: gonio_image::ImageError,
    },
    /// An environment can't be read.
    #[error(transparent)]
    Environment(#[from] gonio_env::EnvError),
    /// A reflection function can't be made.
    #[error(transparent)]
    Brdf(#[from] gonio_brdf::BrdfError),
    /// There is no material of this name.
    #[error("there is no material `{name}`")]
    UnknownMaterial {
        /// The name as given.
        name: String,
        /// Which there are.
        help: String,
    },
    /// There is no camera of this name or index.
    #[error("there is no camera `{name}`")]
    UnknownCamera {
        /// The name or index as given.
        name: String,
        /// Which there are.
        help: String,
    },
    /// There is neither a surface nor an environment.
    #[error("the scene `{name}` has neither a surface nor an environment: nothing to render")]
    Empty {
        /// The scene's name.
        name: String,
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
    /// How to go on, as one line, where there is a way.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Description { help, .. } => help.clone(),
            Self::Unsupported { help, .. }
            | Self::UnknownMaterial { help, .. }
            | Self::UnknownCamera { help, .. } => Some(help.clone()),
            Self::Environment(e) => e.help(),
            Self::Brdf(e) => e.help(),
            Self::Empty { .. } => Some("add a shape, or an environment".into()),
            _ => None,
        }
    }

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
