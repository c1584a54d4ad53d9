//! RGB of any size, and light.

use super::{RgbToSpectrum, SigmoidPolynomial, Solver};
use crate::spectrum::{Observer, Spectrum, VISIBLE};
use gonio_num::Real;

/// A spectrum for RGB of any size: a scale times a sigmoid polynomial.
///
/// The scale is twice the largest component, so that the sigmoid's colour is at most ½, where the family's spectra are
/// smoothest. Negative components count as 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnboundedRgb {
    /// The scale, ≥ 0.
    pub scale: f64,
    /// The shape, in [0, 1].
    pub sigmoid: SigmoidPolynomial,
}

impl UnboundedRgb {
    /// For `rgb` (linear), solved exactly.
    pub fn solve(solver: &Solver, rgb: [f64; 3]) -> Self {
        Self::with(rgb, |c| solver.solve(c).sigmoid)
    }

    /// For `rgb` (linear), looked up.
    pub fn lookup(table: &RgbToSpectrum, rgb: [f64; 3]) -> Self {
        Self::with(rgb, |c| table.lookup(c))
    }

    fn with(rgb: [f64; 3], sigmoid: impl Fn([f64; 3]) -> SigmoidPolynomial) -> Self {
        let largest = rgb[0].max(rgb[1]).max(rgb[2]);
        if !(largest.is_finite() && largest > 0.0) {
            return Self {
                scale: 0.0,
                sigmoid: SigmoidPolynomial::grey(0.5),
            };
        }
        Self {
            scale: 2.0 * largest,
            // Divided twice, not by 2m: twice the largest number overflows.
            sigmoid: sigmoid(rgb.map(|c| 0.5 * (c / largest))),
        }
    }

    /// The value at `lambda_nm`.
    #[inline(always)]
    pub fn at<R: Real>(&self, lambda_nm: R) -> R {
        R::lit(self.scale) * self.sigmoid.at(lambda_nm)
    }

    /// As a spectrum.
    pub fn spectrum(&self) -> Spectrum {
        Spectrum::Sigmoid(self.sigmoid).scaled(self.scale)
    }
}

/// Light with the colour of an RGB: [`UnboundedRgb`] times the spectrum of white light.
///
/// The white is scaled to ∫ S ȳ dλ = 1, so that the light's Y by
/// [`xyz_of_emission`](crate::colour::xyz_of_emission) is the relative luminance of the RGB.
#[derive(Debug, Clone)]
pub struct RgbIlluminant {
    /// The colour.
    pub rgb: UnboundedRgb,
    /// White, with ∫ S ȳ dλ = 1.
    pub white: Spectrum,
}

impl RgbIlluminant {
    /// With the colour `rgb` and the spectral shape of `white`, whose white should be that of the RGB space (D65 for sRGB).
    pub fn new(rgb: UnboundedRgb, white: &Spectrum) -> Self {
        let y = Spectrum::integrate_product(&[white, &Observer::cie_1931().y], VISIBLE);
        Self {
            rgb,
            white: white.scaled(1.0 / y),
        }
    }

    /// The value at `lambda_nm` \[per nm\].
    pub fn at(&self, lambda_nm: f64) -> f64 {
        self.rgb.at(lambda_nm) * self.white.at(lambda_nm)
    }

    /// As a spectrum.
    pub fn spectrum(&self) -> Spectrum {
        self.rgb.spectrum().times(&self.white)
    }
}
