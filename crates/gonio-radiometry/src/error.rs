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
    /// Text isn't a quantity of the kind that was asked for.
    #[error("\"{text}\" isn't a {quantity}: {found}; expected {expected}")]
    QuantityText {
        /// The text, cut to 80 characters.
        text: String,
        /// Name of the quantity.
        quantity: &'static str,
        /// What is wrong with it.
        found: String,
        /// The unit expected.
        expected: &'static str,
    },
    /// A name that stands for nothing known.
    #[error("unknown {what} \"{found}\"; {expected}")]
    UnknownName {
        /// What it should name, as "illuminant".
        what: &'static str,
        /// The name, cut to 80 characters.
        found: String,
        /// "did you mean …?", or the known names.
        expected: String,
    },
    /// A number is outside the range in which it has a meaning.
    #[error("{name} is {value}; expected {expected}")]
    OutOfRange {
        /// What the number is, with its unit.
        name: &'static str,
        /// The number.
        value: f64,
        /// The range.
        expected: &'static str,
    },
    /// The points of a spectrum don't make one.
    #[error("a spectrum was given {found}; expected {expected}")]
    SpectrumPoints {
        /// What is wrong.
        found: String,
        /// What makes a spectrum.
        expected: &'static str,
    },
    /// A file of spectra is broken.
    #[error("{file}, line {line}: found {found}; expected {expected}")]
    SpectrumFile {
        /// Name of the file.
        file: String,
        /// Line, from 1; the last one if something is missing at the end.
        line: usize,
        /// What stands there.
        found: String,
        /// What should stand there.
        expected: String,
    },
    /// A file of upsampling coefficients is broken.
    #[error("{file}, byte {byte}: found {found}; expected {expected}")]
    CoefficientFile {
        /// Name of the file.
        file: String,
        /// Offset in bytes, from 0.
        byte: u64,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
    /// A file can't be read.
    #[error("{file} can't be read: {message}")]
    Read {
        /// Name of the file.
        file: String,
        /// The system's message.
        message: String,
    },
}

impl RadiometryError {
    /// The error for `found`, which is none of `known`: with the nearest of them, or with all.
    pub(crate) fn unknown_name(what: &'static str, found: &str, known: &[&str]) -> Self {
        let found: String = found.chars().take(80).collect();
        let word = found.to_lowercase();
        let near = known
            .iter()
            .map(|name| {
                (
                    strsim::damerau_levenshtein(&name.to_lowercase(), &word),
                    name,
                )
            })
            .filter(|&(distance, name)| distance <= name.chars().count().div_ceil(3))
            .min_by_key(|&(distance, _)| distance);
        let expected = match near {
            Some((_, name)) => format!("did you mean \"{name}\"?"),
            None => format!("expected one of {}", known.join(", ")),
        };
        Self::UnknownName {
            what,
            found,
            expected,
        }
    }
}
