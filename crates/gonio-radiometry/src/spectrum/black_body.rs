//! Thermal radiation: Planck's law.

use crate::RadiometryError;
use gonio_num::Real;

/// c₁L = 2hc² \[W m² sr⁻¹\], from the exact h and c of the SI of 2019.
pub const FIRST_RADIATION_CONSTANT: f64 = 2.0 * PLANCK * LIGHT_SPEED * LIGHT_SPEED;

/// c₂ = hc/k \[m K\], from the exact h, c and k of the SI of 2019: 1.438 776 877… × 10⁻².
pub const SECOND_RADIATION_CONSTANT: f64 = PLANCK * LIGHT_SPEED / BOLTZMANN;

/// The Stefan–Boltzmann constant σ = 2π⁵k⁴/(15h³c²) \[W m⁻² K⁻⁴\]: 5.670 374 419… × 10⁻⁸.
pub const STEFAN_BOLTZMANN: f64 = 2.0
    * (std::f64::consts::PI
        * std::f64::consts::PI
        * std::f64::consts::PI
        * std::f64::consts::PI
        * std::f64::consts::PI)
    * BOLTZMANN
    * (BOLTZMANN / PLANCK)
    * (BOLTZMANN / PLANCK)
    * (BOLTZMANN / PLANCK)
    / (15.0 * LIGHT_SPEED * LIGHT_SPEED);

/// Wien's displacement constant b \[m K\]: the radiance per wavelength peaks at λ = b/T. b = c₂/x with x = 5(1 − e⁻ˣ).
pub const WIEN_DISPLACEMENT: f64 = SECOND_RADIATION_CONSTANT / 4.965_114_231_744_276;

/// h \[J s\].
const PLANCK: f64 = 6.626_070_15e-34;
/// c \[m s⁻¹\].
const LIGHT_SPEED: f64 = 299_792_458.0;
/// k \[J K⁻¹\].
const BOLTZMANN: f64 = 1.380_649e-23;

/// Spectral radiance of a black body \[W m⁻² sr⁻¹ nm⁻¹\].
///
/// L(λ, T) = c₁L / (λ⁵ (e^(c₂/λT) − 1))
///
/// - `lambda_nm`: wavelength in vacuum \[nm\], positive
/// - `temperature_k`: \[K\], positive
///
/// Never NaN for such arguments; 0 where the exponential overflows. Source: Planck 1901; constants of the SI of 2019.
///
/// ```
/// use gonio_radiometry::spectrum::planck;
/// assert!((planck(500.0, 5000.0) / 12_107.2 - 1.0_f64).abs() < 1e-5);
/// ```
#[inline(always)]
pub fn planck<R: Real>(lambda_nm: R, temperature_k: R) -> R {
    let x = R::lit(SECOND_RADIATION_CONSTANT * 1e9) / (lambda_nm * temperature_k);
    // λ in µm keeps λ⁵ within the range of f32; 1e30 · 1e-9 turns "per µm⁵ of wavelength, per m" to "per nm".
    let lambda_um = lambda_nm * R::lit(1e-3);
    let c1 = R::lit(FIRST_RADIATION_CONSTANT * 1e21);
    // e⁻⁸⁷ is the smallest normal f32.
    let e = R::select(x.lt(R::lit(87.0)), (-x.min(R::lit(87.0))).exp(), R::zero());
    c1 * e / (lambda_um.pow5() * one_minus_exp_neg(x))
}

/// 1 − e⁻ˣ for x > 0, without cancellation for small x.
#[inline(always)]
fn one_minus_exp_neg<R: Real>(x: R) -> R {
    // Taylor to x⁶: below x = 0.1 the rest is less than 1e-10 of the sum; in f64 that is the worst relative error here.
    let t = x.min(R::lit(0.1));
    let mut series = R::one();
    for k in [7.0, 6.0, 5.0, 4.0, 3.0, 2.0] {
        series = R::one() - t * series / R::lit(k);
    }
    R::select(
        x.lt(R::lit(0.1)),
        t * series,
        R::one() - (-x.max(R::lit(0.1))).exp(),
    )
}

/// A black body at a temperature, as it is or scaled to a peak of 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BlackBody {
    temperature_k: f64,
    scale: f64,
}

impl BlackBody {
    /// Radiance \[W m⁻² sr⁻¹ nm⁻¹\] at `temperature_k` kelvin.
    ///
    /// # Errors
    /// If the temperature isn't positive and finite.
    pub fn new(temperature_k: f64) -> Result<Self, RadiometryError> {
        if !(temperature_k.is_finite() && temperature_k > 0.0) {
            return Err(RadiometryError::OutOfRange {
                name: "the temperature of a black body [K]",
                value: temperature_k,
                expected: "a finite number above 0",
            });
        }
        Ok(Self {
            temperature_k,
            scale: 1.0,
        })
    }

    /// The same shape with a peak of 1, at whatever wavelength that is.
    #[must_use]
    pub fn normalised(self) -> Self {
        Self {
            scale: 1.0 / planck(self.peak_nm(), self.temperature_k),
            ..self
        }
    }

    /// The temperature \[K\].
    pub fn temperature_k(self) -> f64 {
        self.temperature_k
    }

    /// The wavelength \[nm\] of the largest radiance per wavelength, b/T (Wien).
    pub fn peak_nm(self) -> f64 {
        WIEN_DISPLACEMENT * 1e9 / self.temperature_k
    }

    /// Radiance over all wavelengths \[W m⁻² sr⁻¹\], σT⁴/π (Stefan–Boltzmann), times the scale.
    pub fn total(self) -> f64 {
        let t2 = self.temperature_k * self.temperature_k;
        self.scale * STEFAN_BOLTZMANN * t2 * t2 / std::f64::consts::PI
    }

    /// The value at `lambda_nm`.
    pub fn at(self, lambda_nm: f64) -> f64 {
        self.scale * planck(lambda_nm, self.temperature_k)
    }
}
