//! Colour: what the CIE 1931 observer makes of a spectrum, and the RGB spaces.
//!
//! ```
//! use gonio_radiometry::colour::{RgbSpace, rgb_of_reflectance, srgb_encode};
//! use gonio_radiometry::spectrum::{Illuminant, Spectrum};
//! let red_glass = Spectrum::irregular(vec![580.0, 620.0], vec![0.05, 0.9])?;
//! let rgb = rgb_of_reflectance(&red_glass, &Illuminant::D65.spectrum(), &RgbSpace::SRGB);
//! let screen = rgb.map(|c| srgb_encode(c.clamp(0.0, 1.0)));
//! assert!(screen[0] > 0.8 && screen[1] < 0.4 && screen[2] < 0.3);
//! # Ok::<(), gonio_radiometry::RadiometryError>(())
//! ```
//!
//! Matrices are derived from primaries and white points in `f64`; the rounded matrices of the standards were rejected, since
//! they aren't each other's inverses. From one white to another colours are adapted by Bradford's transform.

mod adaptation;
mod chromaticity;
mod lab;
mod matrix;
mod space;
mod temperature;
mod transfer;
mod tristimulus;
pub mod upsample;

#[cfg(test)]
mod tests;

pub use adaptation::{bradford, von_kries};
pub use chromaticity::{uv_of_xyz, xy_of_xyz, xyz_of_xy, xyz_of_xyy};
pub use lab::{delta_e_76, delta_e_2000, lab_of_xyz, xyz_of_lab};
pub use matrix::Matrix3;
pub use space::RgbSpace;
pub use temperature::{ColourTemperature, correlated_colour_temperature};
pub use transfer::{srgb_decode, srgb_encode};
pub use tristimulus::{
    rgb_of_emission, rgb_of_reflectance, white_of, xyz_of_emission, xyz_of_reflectance,
};
