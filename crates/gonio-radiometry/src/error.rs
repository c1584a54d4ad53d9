//! [`RadiometryError`], everything that can go wrong here.

use thiserror::Error;

/// What went wrong, by cause. Each message says what was found and what was expected.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RadiometryError {
    /// A sampling table's dimensions are zero, too large, or don't match its number of entries.
    #[error(
        "a sampling table of {width} by {height} cells was given {found} entries; expected width × height entries, \
         with 1 to {max} cells along each axis"
    )]
    TableShape {
        /// Cells along x.
        width: usize,
        /// Cells along y; 1 for a one-dimensional table.
        height: usize,
        /// Entries that were given.
        found: usize,
        /// The most cells along an axis.
        max: usize,
    },
    /// An entry of a sampling table is negative, infinite or not a number.
    #[error(
        "entry ({x}, {y}) of a sampling table is {value}; expected a finite number that is not negative"
    )]
    TableEntry {
        /// Column of the entry, from 0.
        x: usize,
        /// Row of the entry, from 0; 0 in a one-dimensional table.
        y: usize,
        /// The entry.
        value: f32,
    },
    /// All entries of a sampling table are zero: nothing can be chosen.
    #[error(
        "all {entries} entries of a sampling table are zero; expected at least one positive entry"
    )]
    TableAllZero {
        /// Number of entries.
        entries: usize,
    },
}
