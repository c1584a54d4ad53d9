//! [`RenderError`].

/// What can stop a rendering before it starts.
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
}
