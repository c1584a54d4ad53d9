//! Reflection functions written as shaders, evaluated without a GPU.
//!
//! A shader in WGSL, GLSL or the format of Disney's BRDF Explorer is parsed and validated by naga and compiled to a short list of
//! operations on registers. These run over any [`ShaderNumber`]: `f32`, `f64`, lanes, dual numbers.
//!
//! ```
//! use gonio_num::Vec3;
//! use gonio_shader::{Settings, Shader};
//! use std::path::Path;
//!
//! let text = "
//!     override reflectance: f32 = 0.5; // 0..1 share of the light that is reflected
//!     fn eval(wi: vec3f, wo: vec3f) -> vec3f {
//!         return vec3f(reflectance / 3.14159265);
//!     }";
//! let shader = Shader::new(Path::new("lambert.wgsl"), None, text, &Settings::default())?;
//! assert_eq!(shader.parameters()[0].high, 1.0);
//! let up = Vec3::new(0.0, 0.0, 1.0);
//! let f = shader.eval(&[0.8], up, up);
//! assert!((f[0] - 0.8 / std::f64::consts::PI).abs() < 1e-7);
//! # Ok::<(), gonio_shader::ShaderError>(())
//! ```

// Loops over an index are what vectorises over lanes.
#![allow(clippy::needless_range_loop)]

mod brdf_file;
mod compile;
mod error;
mod glsl;
mod machine;
mod module;
mod number;
mod parameter;
mod parse;
mod program;
mod shader;
mod source;
mod tape;

pub use error::{ShaderError, SourcePlace};
pub use module::ShaderModule;
pub use number::{Narrowed, ShaderNumber};
pub use parameter::{Parameter, ParameterKind};
pub use program::Program;
pub use shader::{Drawn, Settings, Shader, read_text};
pub use source::{LARGEST_SOURCE, Language};

/// The README's Rust, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
