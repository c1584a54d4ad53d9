//! [`IblError`], what can go wrong.

/// Why light could not be prefiltered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IblError {
    /// An argument out of range.
    #[error("{name} = {found}, expected {expected}")]
    Parameter {
        /// What it is.
        name: &'static str,
        /// What was given.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// A reflection function that has no kernel here, or no such table.
    #[error("{model}: {reason}")]
    Model {
        /// The model.
        model: String,
        /// Why not.
        reason: String,
    },
    /// The environment.
    #[error(transparent)]
    Environment(#[from] gonio_env::EnvError),
    /// The reflection function.
    #[error(transparent)]
    Brdf(#[from] gonio_brdf::BrdfError),
    /// A picture could not be written or read again.
    #[error(transparent)]
    Image(#[from] gonio_image::ImageError),
    /// A file that was written does not say, read again, what was meant.
    #[error("{file}: read again, {place} is {found}, written was {expected}")]
    Validation {
        /// The file.
        file: String,
        /// Where in it.
        place: String,
        /// What is read.
        found: String,
        /// What was written.
        expected: String,
    },
}

impl IblError {
    pub(crate) fn parameter(
        name: &'static str,
        found: impl ToString,
        expected: impl ToString,
    ) -> Self {
        Self::Parameter {
            name,
            found: found.to_string(),
            expected: expected.to_string(),
        }
    }

    /// How to go on, as one sentence, where there is a way.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Environment(e) => e.help(),
            Self::Brdf(e) => e.help(),
            Self::Model { .. } => Some(
                "give an isotropic model that is not a mirror, such as ggx:roughness=0.3,f0=1"
                    .to_owned(),
            ),
            Self::Validation { .. } => {
                Some("the disk may be full or failing: write elsewhere".to_owned())
            }
            _ => None,
        }
    }
}
