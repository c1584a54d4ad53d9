//! The reflection equation solved over a scene (T13).
//!
//! - [`Integrator`]: how much radiance arrives along a ray: [`direct`] sums the lights over one reflection,
//!   [`path`] follows light over many.
//! - [`render`](fn@render): pictures, pass by pass, with progress and the three ways to stop: samples, time, noise.
//! - [`expose`]: the same from any sample to any other, to go on where a picture was interrupted or to divide it.
//! - [`Film`]: sums of samples, their variance, and the auxiliary layers.
//! - [`part`]: films in files, with the samples that they hold, and how parts are put together.
//! - [`sensor`]: radiometric readings of a scene, each with its standard error.
//!
//! An image is the same to the last bit for any number of threads, any split into parts and any number of interruptions: sample k of a
//! pixel is a function of (seed, pixel, k) alone, and the sums of a pixel are functions of the set of its samples.

mod adaptive;
mod error;
pub mod film;
pub mod filter;
mod identity;
pub mod integrator;
pub mod part;
mod pass;
mod render;
mod screen;
pub mod sensor;

pub use error::RenderError;
pub use film::{Film, Kept, Names, PixelSums, Rejected, RejectedSample};
pub use filter::PixelFilter;
pub use identity::{Identity, Mismatch};
pub use integrator::{Integrator, RayCounts, direct, path};
pub use part::{Exposure, Parts};
pub use render::{Progress, RenderOptions, Stop, Target, expose, render};
pub use screen::Screen;
