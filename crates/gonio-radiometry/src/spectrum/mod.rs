//! Spectra: functions of wavelength, from 360 to 830 nm where light is concerned.
//!
//! A [`Spectrum`] may be a radiance, an irradiance, a reflectance or a sensitivity: it is a function of the wavelength in nm
//! with bare values, whose unit its maker knows. Kinds: constant, table with regular or irregular steps (linear between its
//! points), black body, sigmoid (upsampled from RGB), any function, and products of these.
//!
//! ```
//! use gonio_radiometry::spectrum::{Illuminant, Observer, Spectrum, VISIBLE};
//! let filter = Spectrum::irregular(vec![500.0, 600.0], vec![0.0, 1.0])?;
//! let observer = Observer::cie_1931();
//! let transmitted = Spectrum::integrate_product(&[&filter, &Illuminant::D65.spectrum(), &observer.y], VISIBLE);
//! assert!(transmitted > 0.0);
//! # Ok::<(), gonio_radiometry::RadiometryError>(())
//! ```
//!
//! Integrals follow one rule, [`Spectrum::integrate_product`]: exact for up to three tables, fourth order for the rest.

mod black_body;
mod illuminant;
mod integral;
mod observer;
mod read;
mod table;

#[cfg(test)]
mod tests;

pub use black_body::{
    BlackBody, FIRST_RADIATION_CONSTANT, SECOND_RADIATION_CONSTANT, STEFAN_BOLTZMANN,
    WIEN_DISPLACEMENT, planck,
};
pub use illuminant::{Illuminant, daylight, daylight_chromaticity};
pub use observer::Observer;
pub use read::SpectralColumns;
pub(crate) use read::read_limited;
pub use table::{Beyond, Irregular, Regular};

use crate::RadiometryError;
use crate::colour::upsample::SigmoidPolynomial;
use std::fmt;
use std::sync::Arc;

/// A range of wavelengths \[nm\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavelengthRange {
    /// The shortest wavelength \[nm\].
    pub min_nm: f64,
    /// The longest wavelength \[nm\].
    pub max_nm: f64,
}

/// 360 to 830 nm: where the eye sees anything at all, and where the CIE's functions are defined.
pub const VISIBLE: WavelengthRange = WavelengthRange {
    min_nm: 360.0,
    max_nm: 830.0,
};

impl WavelengthRange {
    /// The part that is in both ranges; empty (min ≥ max) if they don't meet.
    pub fn intersection(self, other: Self) -> Self {
        Self {
            min_nm: self.min_nm.max(other.min_nm),
            max_nm: self.max_nm.min(other.max_nm),
        }
    }

    /// Its width \[nm\]; 0 if empty.
    pub fn width_nm(self) -> f64 {
        (self.max_nm - self.min_nm).max(0.0)
    }
}

/// A function of the wavelength, given by the user.
#[derive(Clone)]
pub struct SpectralFunction(Arc<dyn Fn(f64) -> f64 + Send + Sync>);

impl fmt::Debug for SpectralFunction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SpectralFunction(…)")
    }
}

/// A function of the wavelength. Cheap to clone.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Spectrum {
    /// The same at all wavelengths.
    Constant(f64),
    /// Points at equal steps, linear between them.
    Regular(Arc<Regular>),
    /// Points at any wavelengths, linear between them.
    Irregular(Arc<Irregular>),
    /// Thermal radiation.
    BlackBody(BlackBody),
    /// A smooth reflectance with values in [0, 1], as made from RGB.
    Sigmoid(SigmoidPolynomial),
    /// Any function.
    Function(SpectralFunction),
    /// The product of two spectra: light and filter, light and reflectance.
    Product(Arc<(Spectrum, Spectrum)>),
}

impl Spectrum {
    /// Points at `first_nm`, `first_nm + step_nm` …, linear between them; beyond the ends the nearest value holds.
    ///
    /// # Errors
    /// If there are no values, if one isn't finite, or if a wavelength or the step isn't positive and finite.
    pub fn regular(first_nm: f64, step_nm: f64, values: Vec<f64>) -> Result<Self, RadiometryError> {
        Ok(Self::Regular(Arc::new(Regular::new(
            first_nm,
            step_nm,
            values,
            Beyond::Nearest,
        )?)))
    }

    /// Points at `lambda_nm`, linear between them; beyond the ends the nearest value holds.
    ///
    /// # Errors
    /// If there are no points, if the two lengths differ, if the wavelengths aren't positive and strictly increasing, or if a
    /// number isn't finite.
    pub fn irregular(lambda_nm: Vec<f64>, values: Vec<f64>) -> Result<Self, RadiometryError> {
        Ok(Self::Irregular(Arc::new(Irregular::new(
            lambda_nm,
            values,
            Beyond::Nearest,
        )?)))
    }

    /// Radiance of a black body \[W m⁻² sr⁻¹ nm⁻¹\] at `temperature_k` kelvin.
    ///
    /// # Errors
    /// If the temperature isn't positive and finite.
    pub fn black_body(temperature_k: f64) -> Result<Self, RadiometryError> {
        Ok(Self::BlackBody(BlackBody::new(temperature_k)?))
    }

    /// Any function of the wavelength in nm. Integrals sample it every half nanometre: it should be smooth at that scale.
    pub fn function(f: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self::Function(SpectralFunction(Arc::new(f)))
    }

    /// The product of this spectrum and another, wavelength by wavelength.
    pub fn times(&self, other: &Self) -> Self {
        Self::Product(Arc::new((self.clone(), other.clone())))
    }

    /// This spectrum times a number.
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::Constant(c) => Self::Constant(c * factor),
            _ => self.times(&Self::Constant(factor)),
        }
    }

    /// The value at the wavelength `lambda_nm`.
    pub fn at(&self, lambda_nm: f64) -> f64 {
        match self {
            Self::Constant(c) => *c,
            Self::Regular(t) => t.at(lambda_nm),
            Self::Irregular(t) => t.at(lambda_nm),
            Self::BlackBody(b) => b.at(lambda_nm),
            Self::Sigmoid(s) => s.at(lambda_nm),
            Self::Function(f) => (f.0)(lambda_nm),
            Self::Product(p) => p.0.at(lambda_nm) * p.1.at(lambda_nm),
        }
    }

    /// Where the spectrum may differ from 0: all wavelengths, unless a table says that it ends.
    pub fn support(&self) -> WavelengthRange {
        let everywhere = WavelengthRange {
            min_nm: 0.0,
            max_nm: f64::INFINITY,
        };
        match self {
            Self::Regular(t) if t.beyond() == Beyond::Zero => t.range(),
            Self::Irregular(t) if t.beyond() == Beyond::Zero => t.range(),
            Self::Product(p) => p.0.support().intersection(p.1.support()),
            _ => everywhere,
        }
    }
}
