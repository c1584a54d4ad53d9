//! Radiometry: the measure of light, and the geometry and sampling under it.
//!
//! - [`quantity`]: radiometric and photometric quantities as types with units
//! - [`photometry`]: from watts to lumens
//! - [`spectrum`]: functions of wavelength, black bodies, illuminants, the CIE 1931 observer
//! - [`colour`]: XYZ, RGB spaces, Lab, and spectra from RGB
//! - [`direction`]: spherical coordinates, both ways
//! - [`solid_angle`]: solid angles and projected solid angles in closed form, and the Jacobians between measures
//! - [`quadrature`]: integrals over the sphere, the hemisphere and rectangles
//! - [`sequence`]: sample sequences indexed by (seed, pixel, sample, dimension)
//! - [`warp`]: maps from the unit square to directions, points and tables, with their densities and inverses
//!
//! This crate is floor 1: it knows numbers and vectors of `gonio_num`, and nothing of surfaces, scenes or images.

pub mod colour;
pub mod direction;
mod error;
pub mod photometry;
pub mod quadrature;
pub mod quantity;
pub mod sequence;
pub mod solid_angle;
pub mod spectrum;
pub mod warp;

#[cfg(test)]
mod testing;

pub use error::RadiometryError;

/// The examples of the README, as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// A file of real spectral data, for tests: from the folder that `GONIO_SPECTRAL` names, or from `shared/data/spectral` in or
/// beside a folder above. The repository does not have it; a test that misses it says so and skips.
#[cfg(test)]
fn spectral_data(name: &str) -> Option<std::path::PathBuf> {
    let given = std::env::var_os("GONIO_SPECTRAL").map(std::path::PathBuf::from);
    let above = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let found = given
        .into_iter()
        .chain(above.map(|folder| folder.join("shared/data/spectral")))
        .map(|folder| folder.join(name))
        .find(|file| file.is_file());
    if found.is_none() {
        eprintln!("skipped: {name} is absent; GONIO_SPECTRAL names a folder that has it");
    }
    found
}
