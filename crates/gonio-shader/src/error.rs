//! [`ShaderError`], what can be wrong with a shader.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why a shader cannot be evaluated: the file, the place, what was found and what was expected.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct ShaderError {
    /// The shader's file, or the name it was given.
    pub path: PathBuf,
    /// Where in the file, if it is at one place.
    pub place: Option<SourcePlace>,
    /// What is wrong.
    pub message: String,
    /// What helps to correct it, if anything does.
    pub help: Option<String>,
}

/// A place in a shader's file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SourcePlace {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// The line's text.
    pub text: String,
}

impl ShaderError {
    pub(crate) fn new(path: &Path, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            place: None,
            message: message.into(),
            help: None,
        }
    }

    pub(crate) fn with_help(self, help: impl Into<String>) -> Self {
        Self {
            help: Some(help.into()),
            ..self
        }
    }

    /// The source line with a mark below the column, where the place is known.
    pub fn snippet(&self) -> Option<String> {
        let place = self.place.as_ref()?;
        // The text before the column decides how far the mark stands to the right, tabs included.
        let before: String = place
            .text
            .chars()
            .take(place.column - 1)
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        Some(format!("{}\n{before}^", place.text))
    }
}

impl fmt::Display for ShaderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.path.display())?;
        if let Some(place) = &self.place {
            write!(f, ":{}:{}", place.line, place.column)?;
        }
        write!(f, ": {}", self.message)
    }
}
