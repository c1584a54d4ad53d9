//! The numbers that formulas are written over.
//!
//! Every formula of Gonio is written **once**, generic over [`Real`]. That one source serves `f32` for a single ray,
//! `f64` for reference values, [`Lanes`](lanes::Lanes) for batches, [`Dual`](dual::Dual) for derivatives and
//! [`Expr`](expr::Expr) to print shader code.
//!
//! The key decision is reproducibility: a formula gives the same bits on every processor. So nothing here fuses a
//! multiplication with an addition, and the transcendental functions are our own for `f32` (lanes use the very same
//! polynomials) and the portable `libm` for `f64`; the platform's are never called.
//!
//! This crate is floor 0. It knows numbers, vectors, frames and transforms; it knows nothing of light.

mod affine;
pub mod dispatch;
mod double_lanes;
pub mod dual;
pub mod expr;
mod frame;
pub mod lanes;
pub mod math;
mod real;
mod table;
mod vec3;
pub mod vectors;
mod window;

pub use affine::Affine3;
pub use double_lanes::DoubleLanes;
pub use frame::Frame;
pub use real::{LoopState, Mask, Real, Work};
pub use table::{Table1, Table2, Table3};
pub use vec3::Vec3;
pub use vectors::Vectors;
pub use window::window;

/// The example of the README, compiled and run.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
