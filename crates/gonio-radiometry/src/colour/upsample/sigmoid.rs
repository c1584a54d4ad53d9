//! [`SigmoidPolynomial`], a smooth reflectance of three numbers.

use gonio_num::Real;

/// A reflectance S(c₀λ² + c₁λ + c₂) with the sigmoid S(x) = ½ + x / (2√(1 + x²)).
///
/// Values in [0, 1] for any coefficients. Source: Jakob and Hanika 2019, eq. 5 and 6.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SigmoidPolynomial {
    /// c₀ \[nm⁻²\], c₁ \[nm⁻¹\] and c₂.
    pub coefficients: [f64; 3],
}

impl SigmoidPolynomial {
    /// With the coefficients c₀ \[nm⁻²\], c₁ \[nm⁻¹\], c₂.
    pub const fn new(coefficients: [f64; 3]) -> Self {
        Self { coefficients }
    }

    /// The same value in [0, 1] at all wavelengths; exact up to 10⁻¹² from 0 and 1.
    pub fn grey(value: f64) -> Self {
        let v = value.clamp(1e-12, 1.0 - 1e-12);
        Self::new([0.0, 0.0, (v - 0.5) / (v * (1.0 - v)).sqrt()])
    }

    /// The reflectance at `lambda_nm`.
    #[inline(always)]
    pub fn at<R: Real>(&self, lambda_nm: R) -> R {
        let [c0, c1, c2] = self.coefficients;
        // Around a wavelength in the middle the terms are smaller, and cancel less in f32.
        let middle = 555.0;
        let d = lambda_nm - R::lit(middle);
        let slope = R::lit(2.0 * c0 * middle + c1);
        let value = R::lit((c0 * middle + c1) * middle + c2);
        sigmoid((R::lit(c0) * d + slope) * d + value)
    }

    /// The wavelength \[nm\] of the largest or smallest value; `None` if the polynomial is linear.
    pub fn extremum_nm(&self) -> Option<f64> {
        let [c0, c1, _] = self.coefficients;
        (c0 != 0.0).then(|| -c1 / (2.0 * c0))
    }

    /// The largest value for `lambda_nm` in [360, 830] nm.
    pub fn max_value(&self) -> f64 {
        let ends = self.at(360.0f64).max(self.at(830.0));
        match self.extremum_nm() {
            Some(l) if (360.0..=830.0).contains(&l) => ends.max(self.at(l)),
            _ => ends,
        }
    }
}

/// S(x) = ½ + x / (2√(1 + x²)), in [0, 1]; 0 at −∞ and 1 at ∞.
#[inline(always)]
fn sigmoid<R: Real>(x: R) -> R {
    // Beyond ±10⁹ the value is 0 or 1 to the last bit in f32, and x² would overflow.
    let x = x.clamp(R::lit(-1e9), R::lit(1e9));
    let half = R::lit(0.5);
    half + half * x / (R::one() + x * x).sqrt()
}
