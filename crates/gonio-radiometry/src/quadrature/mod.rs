//! Numerical integration in `f64`, deterministic to the bit.
//!
//! - [`GaussLegendre`]: nodes and weights on an interval
//! - [`ProductRule`]: integrals of smooth functions over the sphere and the hemisphere, exact for polynomials
//! - [`adaptive`]: integrals of functions with peaks and edges, with an error estimate
//!
//! Integrands give arrays `[f64; N]`: N integrals at the cost of one evaluation each.

pub mod adaptive;
mod gauss_legendre;
mod product;

pub use adaptive::{Integral, Tolerance};
pub use gauss_legendre::GaussLegendre;
pub use product::ProductRule;
