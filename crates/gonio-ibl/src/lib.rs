//! Image-based light as real-time renderers use it (theory row T21).
//!
//! From an [`Environment`](gonio_env::Environment) it makes
//!
//! - means of radiance under a kernel for any axis ([`Maps`], [`Filter`]): irradiance, Phong's lobes (Miller & Hoffman 1984), GGX and
//!   Charlie level by level, or any isotropic model of the registry seen along its normal ([`Kernel`], [`Family`]);
//! - spherical harmonics of bands 0 to 9 ([`Harmonics`]), with windows whose cost is reported;
//! - tables of reflectance for the split sum ([`Dfg`]);
//! - directional lights ([`lights`]);
//! - and all of it in a folder, in the conventions of a renderer ([`Target`], [`bundle`]), each file read again.
//!
//! ```
//! use gonio_env::Environment;
//! use gonio_ibl::{Harmonics, Kernel, Maps, Method, Target};
//!
//! let sky = Environment::uniform([1.0, 2.0, 3.0]);
//! let kernel = Kernel::ggx(0.5)?;
//! let method = Method::Tree(gonio_ibl::DEFAULT_TOLERANCE);
//! let maps = Maps::new(&sky, kernel.width(), method);
//! let level = maps.cube(&kernel, 8, Target::Gltf, method);
//! assert!((level.get(0, 3, 3)[1] - 2.0).abs() < 1e-4);
//!
//! // Under uniform radiance 1 the irradiance is π.
//! let irradiance = Harmonics::of_radiance(&sky, 3)?.irradiance();
//! let up = gonio_num::Vec3::new(0.0, 1.0, 0.0);
//! assert!((irradiance.evaluate(up)[0] - std::f64::consts::PI).abs() < 1e-4);
//! # Ok::<(), gonio_ibl::IblError>(())
//! ```
//!
//! # Key decision
//! Prefiltering is a sum over lights with a weight that depends on one angle: what astronomers do with gravity. So it is done as they
//! do it, with a tree of cells that is descended until a cell is small against what the kernel can tell apart (Barnes & Hut 1986). For
//! the same time its error is far below that of filtered importance sampling ([`Method::Sampling`] is there to compare), it has no
//! noise, and a sun in the tail of a lobe is where it is, not smeared over a texel of a mip level.

// Loops over an index are what vectorises over lanes, and channels are short arrays walked side by side.
#![allow(clippy::needless_range_loop)]

pub mod bundle;
pub mod cube;
mod dfg;
mod error;
mod filter;
mod gather;
pub mod harmonics;
mod kernel;
pub mod lights;
mod maps;
mod nodes;
mod points;
mod reference;
mod sampling;
mod target;

pub use dfg::Dfg;
pub use error::IblError;
pub use filter::{DEFAULT_TOLERANCE, Filter};
pub use harmonics::Harmonics;
pub use kernel::{Kernel, ModelKernel};
pub use maps::{Family, MapError, Maps, Method, mirror};
pub use nodes::LightTree;
pub use reference::reference;
pub use target::{TableLayout, Target};

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
