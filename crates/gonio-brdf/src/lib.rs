//! Reflection functions: models, measured tables, and the registry that names them.
//!
//! A bidirectional reflectance distribution function (BRDF) is
//!
//! f(ωi→ωr) = dLr(ωr) / (Li(ωi) cosθi dωi)  in sr⁻¹.
//!
//! Each model is **one file** in [`model`], written once over [`Real`](gonio_num::Real), and one line of the registry.
//! That source serves single rays, reference values, batches, derivatives and shader export. A model declares its
//! parameters (name, unit, range, default, meaning) once, next to the formula; from that come parsing, error messages,
//! help, documentation and the property tests.
//!
//! ```
//! use gonio_brdf::{Brdf, Model, ModelSpec};
//! use gonio_num::Vec3;
//!
//! let gold: Model<f64, 3> = ModelSpec::parse("torrance-sparrow:roughness=0.3,metal=gold")?.build()?;
//! let wo = Vec3::new(0.6, 0.0, 0.8);
//! let wi = Vec3::new(-0.6, 0.0, 0.8);
//! let [r, g, b] = gold.eval(wi, wo); // sr⁻¹, without the cosine
//! assert!(r > g && g > b);
//! # Ok::<(), gonio_brdf::BrdfError>(())
//! ```
//!
//! Conventions: `wi` points to the light and `wo` to the viewer; both leave the surface, have unit length and are given
//! in the local frame with normal +z. Below the horizon (z ≤ 0 of either) every function is 0.

// Loops over an index are what vectorises over lanes, and colours are short arrays walked side by side.
#![allow(clippy::needless_range_loop)]
// Where batches are compiled without lanes, what leads to them has no use.
#![cfg_attr(any(fuzzing, test), allow(dead_code))]

mod brdf;
mod check;
mod error;
mod number;
mod parameter;
mod shader_file;
mod showcase;
mod spec;
mod sweep;

pub mod batch;
pub mod export;
pub mod measured;
pub mod model;
pub mod part;
pub mod preset;
pub mod record;
pub mod registry;

pub use brdf::{Brdf, Sample};
pub use check::{CheckOptions, check, check_with};
pub use error::BrdfError;
pub use model::{Model, ParameterSlot};
pub use number::{Function, Index, LaneIndex, Number};
pub use parameter::{Kind, ParameterInfo, Value};
pub use registry::{Alias, Declares, ModelInfo};
pub use showcase::showcase;
pub use spec::ModelSpec;
pub use sweep::{space, sweep};
