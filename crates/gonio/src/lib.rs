//! Gonio, a reflectance laboratory and reference renderer.
//!
//! You bring a reflection function and light. Gonio evaluates it, proves or refutes that it is physical, and renders it.
//!
//! This crate is the façade: each concept of the theory is a module, re-exported from the crate that implements it.
//!
//! | module | concept |
//! |---|---|
//! | [`num`] | the numbers that formulas are written over |
//! | [`radiometry`] | quantities and units, spectra and colour, directions, solid angles, sampling |
//! | [`image`] | pictures of light: files, tone mapping, differences |
//! | [`verify`] | evidence: is this reflection function physical? |
//! | [`brdf`] | reflection functions and their registry |
//! | [`env`](mod@env) | environment maps |
//! | [`scene`] | shapes, materials, lights, cameras, and readers |
//! | [`render`] | the reflection equation solved over a scene; radiometric sensors |
//! | [`preview`] | the embedded scene that `gonio render` shows without a file |

pub use gonio_brdf as brdf;
pub use gonio_env as env;
pub use gonio_image as image;
pub use gonio_num as num;
pub use gonio_radiometry as radiometry;
pub use gonio_render as render;
pub use gonio_scene as scene;
pub use gonio_verify as verify;

pub mod cli;
pub mod preview;

#[cfg(doctest)]
mod documents;
