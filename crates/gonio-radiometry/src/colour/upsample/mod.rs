//! Spectra from RGB: sigmoids of quadratic polynomials (Jakob and Hanika 2019).
//!
//! Many spectra have the same colour; this family has exactly one for (nearly) each, smooth and with values in [0, 1]. Its
//! coefficients come from [`Solver`] (exact, about 40 µs a colour) or by interpolation from a [`RgbToSpectrum`] table
//! (about 85 ns, for textures).
//!
//! - [`SigmoidPolynomial`]: a reflectance, for RGB in [0, 1]³
//! - [`UnboundedRgb`]: a scaled one, for RGB of any size
//! - [`RgbIlluminant`]: a scaled one times the spectrum of white, for light
//!
//! ```
//! use gonio_radiometry::colour::{RgbSpace, rgb_of_reflectance, upsample::Solver};
//! use gonio_radiometry::spectrum::{Illuminant, Spectrum};
//! let fit = Solver::srgb().solve([0.8, 0.3, 0.1]);
//! let back = rgb_of_reflectance(&Spectrum::Sigmoid(fit.sigmoid), &Illuminant::D65.spectrum(), &RgbSpace::SRGB);
//! assert!((back[0] - 0.8).abs() < 1e-4 && (back[1] - 0.3).abs() < 1e-4 && (back[2] - 0.1).abs() < 1e-4);
//! ```

mod rgb;
mod sigmoid;
mod solve;
mod table;

#[cfg(test)]
mod tests;

pub use rgb::{RgbIlluminant, UnboundedRgb};
pub use sigmoid::SigmoidPolynomial;
pub use solve::{Fit, Solver};
pub use table::RgbToSpectrum;
