//! [`PlotError`].

/// Why a plot can't be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PlotError {
    /// The number of functions is not one that this kind of plot can show.
    #[error("{found} reflection functions were given, expected {expected}")]
    Count {
        /// How many there are.
        found: usize,
        /// How many there can be.
        expected: &'static str,
    },
    /// An option has a value that makes no sense.
    #[error("{option}: {found}, expected {expected}")]
    Option {
        /// Its name.
        option: &'static str,
        /// Its value.
        found: String,
        /// What it can be.
        expected: String,
    },
    /// There is nothing that this kind of plot could show.
    #[error("{name}: {reason}")]
    Nothing {
        /// The function's name.
        name: String,
        /// What it is instead.
        reason: &'static str,
    },
    /// The picture could not be turned into pixels.
    #[error("the picture could not be drawn: {0}")]
    Drawing(String),
}
