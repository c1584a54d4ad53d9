//! Photometry: light as the eye weighs it.
//!
//! A photometric quantity is the radiometric one, weighted by the luminous efficiency V(λ) of daylight vision and multiplied
//! by K_m: Φ_v = K_m ∫ Φ_e(λ) V(λ) dλ.
//!
//! ```
//! use gonio_radiometry::{photometry, quantity::*, spectrum::Spectrum};
//! // Green laser light of 5 mW at 532 nm.
//! let flux: LuminousFlux = RadiantFlux::new(5e-3) * photometry::efficacy_at(532.0);
//! assert_eq!(format!("{flux:.3}"), "3.022 lm");
//! // The Sun's surface, about a black body.
//! let luminance = photometry::luminance_of(&Spectrum::black_body(5772.0)?);
//! assert_eq!(format!("{luminance:.3e}"), "1.844e9 cd/m²");
//! # Ok::<(), gonio_radiometry::RadiometryError>(())
//! ```

use crate::colour::RgbSpace;
use crate::quantity::{Luminance, LuminousEfficacy, Quantity, kind};
use crate::spectrum::{BlackBody, Observer, Spectrum, VISIBLE};
use gonio_num::Real;

/// K_cd \[lm/W\]: the luminous efficacy of radiation of 540 × 10¹² Hz, exact, the definition of the candela.
pub const LUMINOUS_EFFICACY_540_THZ: f64 = 683.0;

/// The wavelength of 540 × 10¹² Hz in standard air \[nm\].
pub const LAMBDA_540_THZ_NM: f64 = 555.016;

/// K_m \[lm/W\]: the largest luminous efficacy, at 555 nm, K_cd / V(555.016 nm) = 683.002.
///
/// Source: ISO/CIE 23539, which gives these six digits.
pub const MAX_LUMINOUS_EFFICACY: f64 = 683.002;

/// Luminous efficiency V(λ) of daylight (photopic) vision: 1 at 555 nm, 0 outside 360 to 830 nm.
///
/// It is ȳ of the CIE 1931 observer (CIE 1924).
pub fn luminous_efficiency(lambda_nm: f64) -> f64 {
    Observer::cie_1931().y.at(lambda_nm)
}

/// Luminous efficacy K(λ) = K_m V(λ) of light of one wavelength.
pub fn efficacy_at(lambda_nm: f64) -> LuminousEfficacy {
    LuminousEfficacy::new(MAX_LUMINOUS_EFFICACY * luminous_efficiency(lambda_nm))
}

/// K_m ∫ S(λ) V(λ) dλ: the photometric value of a spectral one, in lumens per (unit of S × nm / W).
///
/// A spectral flux \[W/nm\] gives lm, a spectral irradiance lx, a spectral intensity cd.
pub fn photometric_of(spectrum: &Spectrum) -> f64 {
    let v = &Observer::cie_1931().y;
    MAX_LUMINOUS_EFFICACY * Spectrum::integrate_product(&[spectrum, v], VISIBLE)
}

/// Luminance of a spectral radiance \[W m⁻² sr⁻¹ nm⁻¹\].
pub fn luminance_of(spectrum: &Spectrum) -> Luminance {
    Luminance::new(photometric_of(spectrum))
}

/// Luminous efficacy of the visible part of `spectrum`: K_m ∫ S V dλ / ∫ S dλ, both over 360 to 830 nm.
///
/// Light outside that range is not counted; the efficacy of all of a black body's radiation is
/// [`efficacy_of_black_body`]. NaN for a spectrum of zeros.
pub fn efficacy_of(spectrum: &Spectrum) -> LuminousEfficacy {
    LuminousEfficacy::new(photometric_of(spectrum) / spectrum.integrate(VISIBLE))
}

/// Luminous efficacy of all the radiation of a black body: K_m ∫ L V dλ / (σT⁴/π).
///
/// The largest is about 95 lm/W, near 6600 K.
pub fn efficacy_of_black_body(body: BlackBody) -> LuminousEfficacy {
    LuminousEfficacy::new(photometric_of(&Spectrum::BlackBody(body)) / body.total())
}

/// Relative luminance Y of linear RGB with Rec.709 primaries: 0.2126 R + 0.7152 G + 0.0722 B (to four digits).
///
/// 1 for white. The weights are the Y row of [`RgbSpace::SRGB`]'s matrix.
#[inline(always)]
pub fn relative_luminance<R: Real>(rgb: [R; 3]) -> R {
    let [r, g, b] = RgbSpace::SRGB_LUMINANCE_WEIGHTS;
    R::lit(r) * rgb[0] + R::lit(g) * rgb[1] + R::lit(b) * rgb[2]
}

/// Luminance of a linear RGB radiance: `efficacy` × Y.
///
/// RGB doesn't say how many watts stand behind it: `efficacy` does. For RGB integrated with ȳ as by
/// [`colour::xyz_of_emission`](crate::colour::xyz_of_emission) it is [`MAX_LUMINOUS_EFFICACY`]; where RGB (1, 1, 1) is
/// 1 W m⁻² sr⁻¹ of visible light it is the efficacy of the light's white, as 179 lm/W by Radiance's convention.
pub fn luminance_of_rgb<R: Real>(rgb: [R; 3], efficacy: LuminousEfficacy<R>) -> Luminance<R> {
    Quantity::<R, kind::Radiance>::new(relative_luminance(rgb)) * efficacy
}

#[cfg(test)]
mod tests;
