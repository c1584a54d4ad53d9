//! Environment maps from photographs of a mirrored ball (T21).

pub mod ball;
mod error;
pub mod outline;
mod photo;
mod radiance;
mod reflectance;
pub mod response;
mod solve;

pub use ball::{Ball, Projection};
pub use error::CaptureError;
pub use outline::{Lens, Outline};
pub use photo::{Exif, Photo};
pub use radiance::Radiance;
pub use reflectance::BallMaterial;
pub use response::{Response, ResponseChoice};
