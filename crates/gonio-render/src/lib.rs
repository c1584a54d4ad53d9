//! The reflection equation solved over a scene (T13).
//!
//! - [`Integrator`]: how much radiance arrives along a ray: [`direct`] sums the lights over one reflection,
//!   [`path`] follows light over many.
//! - [`render`](fn@render): pictures, pass by pass, with progress and the three ways to stop: samples, time, noise.
//! - [`Film`]: sums of samples, their variance, and the auxiliary layers.
//! - [`sensor`]: radiometric readings of a scene, each with its standard error.
//!
//! An image is the same to the last bit for any number of threads: sample k of a pixel is a function of (seed, pixel,
//! k) alone, and each pixel adds its samples in the order of k.

mod error;
pub mod film;
pub mod filter;
pub mod integrator;
mod pass;
mod render;
pub mod sensor;

pub use error::RenderError;
pub use film::{Film, PixelSums, Rejected};
pub use filter::PixelFilter;
pub use integrator::{Integrator, RayCounts, direct, path};
pub use render::{Progress, RenderOptions, Stop, Target, render};
