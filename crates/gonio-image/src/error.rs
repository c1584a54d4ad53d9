//! [`ImageError`]: what can go wrong, by cause.

use std::io;
use std::path::Path;

/// Why a picture could not be read, written or compared.
///
/// Each variant names the file (`<memory>` for bytes handed over directly) and, where there is one, the place in it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ImageError {
    /// The bytes contradict their format, or end too early.
    #[error("{file}: {place}: found {found}, expected {expected}")]
    Format {
        /// The file.
        file: String,
        /// Where in it: a header line, a scan line, a chunk.
        place: String,
        /// What stands there.
        found: String,
        /// What should.
        expected: String,
    },
    /// The picture is larger than [`Limits`](crate::Limits) allow. Nothing was allocated for it.
    #[error("{file}: {what} {found} exceed the limit of {limit}")]
    Limit {
        /// The file.
        file: String,
        /// What there is too much of, with its unit.
        what: String,
        /// How much the file claims.
        found: u64,
        /// How much is allowed.
        limit: u64,
    },
    /// A value handed over by the caller cannot be used.
    #[error("{message}")]
    Parameter {
        /// Which value, what it was, and what it should be.
        message: String,
    },
    /// The file may be valid, but this crate does not read or write such files.
    #[error("{file}: {what} is not supported; {instead}")]
    Unsupported {
        /// The file.
        file: String,
        /// What is not supported.
        what: String,
        /// What is.
        instead: String,
    },
    /// The operating system refused.
    #[error("{file}: cannot {action}: {source}")]
    Io {
        /// The file.
        file: String,
        /// What was tried.
        action: &'static str,
        /// Its answer.
        source: io::Error,
    },
}

impl ImageError {
    pub(crate) fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io {
            file: path.display().to_string(),
            action,
            source,
        }
    }

    pub(crate) fn parameter(message: impl Into<String>) -> Self {
        Self::Parameter {
            message: message.into(),
        }
    }

    pub(crate) fn unsupported(
        file: impl Into<String>,
        what: impl Into<String>,
        instead: impl Into<String>,
    ) -> Self {
        Self::Unsupported {
            file: file.into(),
            what: what.into(),
            instead: instead.into(),
        }
    }

    pub(crate) fn format(
        file: impl Into<String>,
        place: impl Into<String>,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> Self {
        Self::Format {
            file: file.into(),
            place: place.into(),
            found: found.into(),
            expected: expected.into(),
        }
    }
}
