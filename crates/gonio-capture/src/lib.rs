//! Environment maps from photographs of a mirrored ball (T21).

pub mod ball;
mod error;
pub mod fill;
pub mod outline;
pub mod panorama;
mod photo;
mod radiance;
mod reflectance;
pub mod register;
pub mod response;
mod rotation;
mod solve;

pub use ball::{Ball, Projection};
pub use error::CaptureError;
pub use outline::{Lens, Outline};
pub use panorama::{Panorama, Unwrap};
pub use photo::{Exif, Photo};
pub use radiance::Radiance;
pub use reflectance::BallMaterial;
pub use register::Registration;
pub use response::{Response, ResponseChoice};
pub use rotation::Rotation;
