//! Environment maps from photographs of a mirrored ball (T21; Debevec 1998).
//!
//! | step | module |
//! |---|---|
//! | a photograph and its EXIF | [`Photo`] |
//! | exposures over each other | [`mod@align`] |
//! | codes to exposure | [`response`] |
//! | exposures to radiance, with uncertainty | [`Radiance`] |
//! | the ball's outline | [`outline`] |
//! | pixels to directions and back, from a finite distance | [`ball`] |
//! | the ball's own reflectance | [`BallMaterial`] |
//! | unwrapping | [`panorama`] |
//! | the rotation between viewpoints | [`register`] |
//! | several viewpoints to one panorama | [`mod@blend`] |
//! | holes filled | [`mod@fill`] |
//! | clipped light put back | [`restore`] |
//! | all of it | [`fn@capture`] |
//! | photographs that were never taken, as evidence | [`simulate`] |

pub mod align;
pub mod ball;
pub mod blend;
mod capture;
mod error;
mod explain;
pub mod fill;
pub mod outline;
mod output;
pub mod panorama;
mod photo;
mod radiance;
mod reflectance;
pub mod register;
pub mod response;
pub mod restore;
mod rotation;
pub mod simulate;
mod solve;

pub use ball::{Ball, Projection};
pub use capture::{Capture, KnownLight, Options, ViewFound, capture};
pub use error::CaptureError;
pub use outline::{Lens, Outline};
pub use panorama::{Panorama, Unwrap};
pub use photo::{Exif, Photo};
pub use radiance::Radiance;
pub use reflectance::BallMaterial;
pub use register::Registration;
pub use response::{Response, ResponseChoice};
pub use rotation::Rotation;
