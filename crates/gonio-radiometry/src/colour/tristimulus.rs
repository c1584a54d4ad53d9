//! Spectra to XYZ and RGB, by the CIE 1931 observer.

use super::{RgbSpace, bradford};
use crate::spectrum::{Observer, Spectrum, VISIBLE};

/// (∫ S x̄ dλ, ∫ S ȳ dλ, ∫ S z̄ dλ) where S is the product of `factors`.
fn integrate(factors: &[&Spectrum]) -> [f64; 3] {
    let observer = Observer::cie_1931();
    // ȳ brings its points and its support to the rule; x̄ and z̄ have the same.
    let mut all = factors.to_vec();
    all.push(&observer.y);
    Spectrum::integrate_with(&all, VISIBLE, |lambda| {
        let s: f64 = factors.iter().map(|f| f.at(lambda)).product();
        observer.at(lambda).map(|c| s * c)
    })
}

/// XYZ of light: ∫ S(λ) x̄(λ) dλ and so on, in the unit of S × nm.
///
/// Y times [`MAX_LUMINOUS_EFFICACY`](crate::photometry::MAX_LUMINOUS_EFFICACY) is the photometric value: cd/m² of a
/// radiance in W m⁻² sr⁻¹ nm⁻¹.
pub fn xyz_of_emission(light: &Spectrum) -> [f64; 3] {
    integrate(&[light])
}

/// XYZ of the light with Y = 1: its white.
///
/// NaN for a light without luminance.
pub fn white_of(light: &Spectrum) -> [f64; 3] {
    let xyz = xyz_of_emission(light);
    xyz.map(|c| c / xyz[1])
}

/// XYZ of a reflectance (or a transmittance) under a light, Y = 1 for the perfect reflector: k ∫ ρ(λ) S(λ) x̄(λ) dλ with
/// k = 1 / ∫ S(λ) ȳ(λ) dλ.
pub fn xyz_of_reflectance(reflectance: &Spectrum, light: &Spectrum) -> [f64; 3] {
    let white = xyz_of_emission(light)[1];
    integrate(&[reflectance, light]).map(|c| c / white)
}

/// Linear RGB of a reflectance under a light, adapted from the light's white to the space's (Bradford): the perfect
/// reflector is (1, 1, 1) in every space under every light.
///
/// May have components below 0 or above 1: not every reflectance is in the gamut.
pub fn rgb_of_reflectance(reflectance: &Spectrum, light: &Spectrum, space: &RgbSpace) -> [f64; 3] {
    let adapted = bradford(white_of(light), space.white_xyz());
    space
        .from_xyz()
        .apply(adapted.apply(xyz_of_reflectance(reflectance, light)))
}

/// Linear RGB of light, without adaptation: a reddish light is reddish. In the unit of S × nm, as [`xyz_of_emission`].
pub fn rgb_of_emission(light: &Spectrum, space: &RgbSpace) -> [f64; 3] {
    space.from_xyz().apply(xyz_of_emission(light))
}
