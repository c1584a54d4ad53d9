//! Measured reflectance: tables in memory, and one file for each format that is read.

pub mod adaptive;
mod cells;
mod choice;
mod file;
pub mod merl;
mod tabulated;
pub mod tensor_file;

pub use tabulated::{Axes, Tabulated};

use crate::BrdfError;
use adaptive::Adaptive;
use std::path::Path;
use std::sync::Arc;

/// A measurement, in any of the representations.
#[derive(Debug, Clone)]
pub enum Measured {
    /// Cells in memory.
    Tabulated(Arc<Tabulated>),
    /// The adaptive parameterization of the RGL database.
    Adaptive(Arc<Adaptive>),
}

impl Measured {
    /// Reads a file, in the format that its first bytes tell.
    ///
    /// # Errors
    /// As [`merl::read`] and [`Adaptive::read`].
    pub fn read(path: &Path) -> Result<Self, BrdfError> {
        if file::begins_with(path, tensor_file::MAGIC)? {
            return Ok(Adaptive::read(path)?.into());
        }
        Ok(merl::read(path)?.into())
    }
}

impl From<Tabulated> for Measured {
    fn from(table: Tabulated) -> Self {
        Self::Tabulated(Arc::new(table))
    }
}

impl From<Arc<Tabulated>> for Measured {
    fn from(table: Arc<Tabulated>) -> Self {
        Self::Tabulated(table)
    }
}

impl From<Adaptive> for Measured {
    fn from(adaptive: Adaptive) -> Self {
        Self::Adaptive(Arc::new(adaptive))
    }
}
