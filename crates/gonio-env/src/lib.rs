//! Environment maps: light from infinitely far away, one radiance per direction.
//!
//! An [`Environment`] is uniform, or a picture of everything around a point: a latitude–longitude panorama, an angular
//! map (light probe), or the photograph of a mirrored ball ([`Layout`]). It answers what a renderer asks: the radiance
//! from a direction, a direction sampled where the light is, and the density of that sampling; and what a person asks:
//! the irradiance on a surface, where the sun stands, and whether the picture is sound ([`EnvInfo`]).
//!
//! ```
//! use gonio_env::Environment;
//! use gonio_num::Vec3;
//!
//! let sky = Environment::uniform([1.0, 1.0, 1.0]);
//! // Under uniform unit radiance the irradiance is π.
//! assert_eq!(sky.irradiance(Vec3::new(0.0, 1.0, 0.0)), [std::f64::consts::PI; 3]);
//!
//! let s = sky.sample([0.25, 0.5]);
//! assert_eq!(s.pdf, sky.pdf(s.wi)); // per steradian, bit for bit
//! ```
//!
//! # Key decisions
//! - Radiance is interpolated bilinearly between texel centres: around the circle in longitude, constant beyond the
//!   first and last row. The sampling density is **the luminance of that interpolation**, exactly, times sin θ over the picture. So it
//!   is positive wherever radiance is, continuous, finite at the poles, needs no division by sin θ, and costs nothing beside the
//!   radiance. Rejected: a table of constant texels, which gives zero density to the half texel of glow around a bright texel on
//!   black; and linear in cos θ, which inverts in closed form but misses near the poles.
//! - A sample's radiance and density are those of its final, rounded direction: [`Environment::sample`] and
//!   [`Environment::pdf`] agree to the last bit.
//! - Pictures are checked when they are read: a texel that is NaN, infinite or negative is an error that names it, or,
//!   on request, is replaced and counted ([`LoadOptions::sanitize`]).
//!
//! Sources: Blinn & Newell 1976; Debevec 1998; Pharr, Jakob & Humphreys 2023, §12.5.

mod batch;
mod environment;
mod error;
mod info;
mod irradiance;
mod load;
mod lookup;
mod panorama;
mod product;
pub mod projection;
mod proxy;
mod resample;
mod sampling;
pub mod sky;
pub mod test_image;
mod texels;

pub use batch::EnvSamples;
pub use environment::{EnvSample, Environment};
pub use error::EnvError;
pub use info::{EnvInfo, Peak};
pub use irradiance::{Irradiance, LatLongTexels};
pub use load::LoadOptions;
pub use panorama::{Conversion, Kept, Panorama, Rows};
pub use product::{Candidates, ProductSample, Reflected};
pub use projection::{Convention, Layout, View};
pub use proxy::Proxy;
pub use resample::{Filter, NO_ROTATION, Rotation, SIX_AXES, rotation_deg};
pub use sampling::{Guide, SamplingMethod};
pub use sky::{Sky, SkyOptions};

/// Luminance of linear RGB with Rec.709 primaries, relative to white (1, 1, 1).
pub(crate) fn luminance(rgb: [f32; 3]) -> f64 {
    0.2126 * f64::from(rgb[0]) + 0.7152 * f64::from(rgb[1]) + 0.0722 * f64::from(rgb[2])
}
