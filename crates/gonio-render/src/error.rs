//! [`RenderError`].

use std::path::PathBuf;

/// What can stop a rendering before it starts, and what can be wrong with the files that it begins from.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// An option has a value outside its range.
    #[error("{option} is {found}, expected {expected}")]
    Parameter {
        /// The option, as its field is named.
        option: &'static str,
        /// The value found.
        found: String,
        /// The values that are accepted.
        expected: &'static str,
    },
    /// The film would need more memory than allowed.
    #[error(
        "an image of {width}×{height} pixels needs {needed_mib} MiB, more than the limit of {limit_mib} MiB"
    )]
    Limit {
        /// Pixels across.
        width: u32,
        /// Pixels down.
        height: u32,
        /// Memory that the film needs.
        needed_mib: u64,
        /// Memory that is allowed.
        limit_mib: u64,
    },
    /// The operating system refused a file.
    #[error("{}: cannot {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// The reason.
        source: std::io::Error,
    },
    /// A file is no part of a picture, or a damaged one.
    #[error("{}, {place}: found {found}, expected {expected}", path.display())]
    Part {
        /// The file.
        path: PathBuf,
        /// Where in it.
        place: String,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// Parts that do not belong together, or do not make a whole.
    #[error("{}: {what}", path.display())]
    Merge {
        /// The part.
        path: PathBuf,
        /// What differs, from which other part, or what is missing.
        what: String,
    },
    /// A file could not be written.
    #[error(transparent)]
    Image(#[from] gonio_image::ImageError),
}
