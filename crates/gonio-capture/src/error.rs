//! [`CaptureError`], what can go wrong on the way from photographs to light.

use std::path::PathBuf;

/// Why no environment could be made of the photographs.
///
/// The message says what is wrong and where; [`CaptureError::help`] says how to go on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureError {
    /// A photograph could not be read, or a picture not be written.
    #[error(transparent)]
    Image(#[from] gonio_image::ImageError),
    /// The captured panorama can't be an environment.
    #[error(transparent)]
    Environment(#[from] gonio_env::EnvError),
    /// A picture that explains a step could not be drawn.
    #[error(transparent)]
    Plot(#[from] gonio_plot::PlotError),
    /// The photograph is a camera's raw file.
    #[error("{}: a camera's raw file, which is not read", file.display())]
    CameraRaw {
        /// The file.
        file: PathBuf,
    },
    /// The exposure of a photograph is not known.
    #[error("{file}: its EXIF data don't tell {missing}")]
    NoExposure {
        /// The file.
        file: String,
        /// What is missing.
        missing: &'static str,
    },
    /// Photographs of one view with equal exposures.
    #[error(
        "{first} and {second} have the same exposure ({exposure}), so one tells nothing that the other doesn't"
    )]
    EqualExposures {
        /// A file.
        first: String,
        /// Another.
        second: String,
        /// Their exposure.
        exposure: String,
    },
    /// Photographs of one view that differ in size.
    #[error(
        "{file}: {found} pixels, but {other} has {expected}: exposures of one view must be of one size"
    )]
    Size {
        /// The file.
        file: String,
        /// Its size.
        found: String,
        /// The photograph it is compared with.
        other: String,
        /// The other's size.
        expected: String,
    },
    /// Photographs of one view that don't show the same.
    #[error(
        "{file} doesn't show what {other} shows: at the best shift {:.0} % of the pixels are dark in one and bright in the other, expected at \
         most {:.0} %",
        100.0 * found,
        100.0 * most
    )]
    NotAligned {
        /// The file.
        file: String,
        /// The photograph it is compared with.
        other: String,
        /// Share of the pixels that differ.
        found: f64,
        /// The largest share.
        most: f64,
    },
    /// The response curve can't be found.
    #[error("the camera's response can't be found: {reason}")]
    Response {
        /// Why.
        reason: String,
    },
    /// No circle of the photograph is a ball's outline.
    #[error(
        "{file}: no ball found: the best circle has an edge along {:.0} % of it, expected at least {:.0} %",
        100.0 * found,
        100.0 * expected
    )]
    NoBall {
        /// The file.
        file: String,
        /// Share of the best circle that lies on edges, beyond what chance gives.
        found: f64,
        /// The least share.
        expected: f64,
    },
    /// Two views do not show the same surroundings.
    #[error(
        "{file}: not the same scene as {reference}: turned as well as possible they correlate by {found:.2}, expected at \
         least {expected:.2}"
    )]
    DifferentScenes {
        /// The file.
        file: String,
        /// The first view's file.
        reference: String,
        /// The largest correlation over all rotations.
        found: f64,
        /// The least.
        expected: f64,
    },
    /// The clipped light can't be restored.
    #[error("the clipped light can't be restored: {reason}")]
    Restore {
        /// Why.
        reason: String,
        /// How to go on.
        help: &'static str,
    },
    /// A number out of range.
    #[error("{name} = {found}, expected {expected}")]
    Parameter {
        /// What the number is.
        name: &'static str,
        /// What was given.
        found: String,
        /// What is allowed.
        expected: &'static str,
    },
}

impl CaptureError {
    pub(crate) fn parameter(
        name: &'static str,
        found: impl std::fmt::Display,
        expected: &'static str,
    ) -> Self {
        Self::Parameter {
            name,
            found: found.to_string(),
            expected,
        }
    }

    /// How to go on, as one sentence for a `help:` line, where there is a way.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::Image(_) | Self::Parameter { .. } => None,
            Self::Environment(_) | Self::Plot(_) => None,
            Self::CameraRaw { .. } => Some(
                "develop it without a tone curve to a 16-bit TIFF (dcraw -4 -T, or RawTherapee's neutral profile) and pass --linear",
            ),
            Self::NoExposure { .. } => {
                Some("say the exposures, one a photograph: --exposures 1/30,1/125")
            }
            Self::EqualExposures { .. } => Some(
                "photographs from two viewpoints are --views 2; of equal photographs leave all but one out",
            ),
            Self::Size { .. } => Some(
                "pass the exposures of each view as the camera made them, uncropped; several viewpoints are --views N",
            ),
            Self::NotAligned { .. } => Some(
                "exposures of one view need one place of the camera, and nothing that moves; several viewpoints are --views N",
            ),
            Self::Response { .. } => {
                Some("name the curve: --response srgb, or --linear for linear data")
            }
            Self::NoBall { .. } => {
                Some("if there is a ball, say where: --ball X,Y,RADIUS in pixels")
            }
            Self::DifferentScenes { .. } => Some(
                "photograph the same ball, in the same place and light, from each viewpoint; if that was done, say how they are turned: --turned YAW,PITCH,ROLL",
            ),
            Self::Restore { help, .. } => Some(help),
        }
    }
}
