//! [`Harmonics`]: an environment as real spherical harmonics, in bands 0 to 9.
//!
//! Basis: orthonormal, real, z the polar axis, **without** the Condon–Shortley sign; coefficient (l, m) is at l² + l + m, with
//! m < 0 for sin |m|φ:
//!
//! ```text
//! Y₀₀ = √(1/4π)    Y₁₋₁ = √(3/4π) y    Y₁₀ = √(3/4π) z    Y₁₁ = √(3/4π) x    …
//! L(ω) ≈ Σ c_lm Y_lm(ω),   c_lm = ∫ L Y_lm dω
//! ```
//!
//! (x, y, z) are the world's, +y up. Targets have conventions of their own.
//!
//! Sources: Ramamoorthi & Hanrahan 2001, "An Efficient Representation for Irradiance Environment Maps"; Sloan 2008, "Stupid
//! Spherical Harmonics (SH) Tricks".

mod panorama;
mod window;

pub use window::directions;
pub use window::{Residual, Window};

use crate::IblError;
use crate::nodes::LightTree;
use gonio_env::Environment;
use gonio_num::Vec3;
use gonio_radiometry::quadrature::ProductRule;
use std::f64::consts::PI;

/// Most bands.
pub const MOST_BANDS: usize = 10;

/// Coefficients of a function on the sphere with three channels.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    bands: usize,
    coefficients: Vec<[f64; 3]>,
}

/// The basis functions of `bands` bands at the unit direction `d`, in order.
pub fn basis(bands: usize, d: Vec3<f64>) -> Vec<f64> {
    let mut y = vec![0.0; bands * bands];
    if bands == 0 {
        return y;
    }
    // sin^m θ cos mφ and sin^m θ sin mφ, as powers of x + iy.
    let (mut c, mut s) = (1.0, 0.0);
    let mut diagonal = (0.25 / PI).sqrt();
    for m in 0..bands {
        if m > 0 {
            (c, s) = (c * d.x - s * d.y, c * d.y + s * d.x);
            diagonal *= ((2 * m + 1) as f64 / (2 * m) as f64).sqrt();
        }
        let mut before = 0.0;
        let mut p = diagonal;
        for l in m..bands {
            if l > m {
                let (lf, mf) = (l as f64, m as f64);
                let a = ((4.0 * lf * lf - 1.0) / (lf * lf - mf * mf)).sqrt();
                let k = lf - 1.0;
                let b = ((k * k - mf * mf) / (4.0 * k * k - 1.0)).max(0.0).sqrt();
                (before, p) = (p, a * (d.z * p - b * before));
            }
            let centre = l * l + l;
            if m == 0 {
                y[centre] = p;
            } else {
                let root2 = std::f64::consts::SQRT_2;
                y[centre + m] = root2 * p * c;
                y[centre - m] = root2 * p * s;
            }
        }
    }
    y
}

/// The band of coefficient `index`.
pub fn band_of(index: usize) -> usize {
    index.isqrt()
}

/// What a clamped cosine does to band l: A₀ = π, A₁ = 2π/3, A₂ = π/4, 0 for other odd l. Ramamoorthi & Hanrahan 2001, eq. 8.
pub fn cosine_factor(l: usize) -> f64 {
    match l {
        0 => PI,
        1 => 2.0 * PI / 3.0,
        l if l % 2 == 1 => 0.0,
        l => {
            // l!/(2^l ((l/2)!)²) is the product of (2k − 1)/2k for k = 1 … l/2.
            let half = l / 2;
            let product: f64 = (1..=half)
                .map(|k| (2 * k - 1) as f64 / (2 * k) as f64)
                .product();
            let sign = if half % 2 == 1 { 1.0 } else { -1.0 };
            sign * 2.0 * PI / ((l + 2) as f64 * (l - 1) as f64) * product
        }
    }
}

impl Harmonics {
    /// From coefficients in order.
    ///
    /// # Errors
    /// If their number is no square, or more than 100.
    pub fn new(coefficients: Vec<[f64; 3]>) -> Result<Self, IblError> {
        let bands = coefficients.len().isqrt();
        if bands * bands != coefficients.len() || bands == 0 {
            return Err(IblError::parameter(
                "coefficients",
                coefficients.len(),
                "1, 4, 9, … 100 of them",
            ));
        }
        Self::check_bands(bands)?;
        Ok(Self {
            bands,
            coefficients,
        })
    }

    /// The radiance of an environment. A panorama is integrated exactly, as it is interpolated; another picture as the points of
    /// its finest cells.
    ///
    /// # Errors
    /// If `bands` is 0 or above [`MOST_BANDS`].
    pub fn of_radiance(environment: &Environment, bands: usize) -> Result<Self, IblError> {
        Self::check_bands(bands)?;
        if let Some(texels) = environment.lat_long_texels() {
            return Ok(panorama::project(&texels, bands));
        }
        let tree = LightTree::new(environment, 0.05);
        let cells = &tree.levels[0].cells;
        let mut coefficients = vec![[0.0; 3]; bands * bands];
        for i in 0..cells.len() {
            let d = Vec3::new(cells.x[i], cells.y[i], cells.z[i]).to_f64();
            let rgb = [cells.r[i], cells.g[i], cells.b[i]];
            for (c, y) in coefficients.iter_mut().zip(basis(bands, d)) {
                for k in 0..3 {
                    c[k] += f64::from(rgb[k]) * f64::from(cells.w[i]) * y;
                }
            }
        }
        Ok(Self {
            bands,
            coefficients,
        })
    }

    /// The coefficients of any function of at most `bands` bands, by a quadrature that is exact for it.
    pub fn of_function(bands: usize, mut f: impl FnMut(Vec3<f64>) -> [f64; 3]) -> Self {
        // Products of two functions of band ≤ B − 1 have degree ≤ 2B − 2. The rule passes by channel and coefficient: 300 at most.
        let sums: [f64; 3 * MOST_BANDS * MOST_BANDS] =
            ProductRule::new(bands, 2 * bands).sphere(|d| {
                let value = f(d);
                let mut products = [0.0; 3 * MOST_BANDS * MOST_BANDS];
                for (product, y) in products.chunks_exact_mut(3).zip(basis(bands, d)) {
                    for k in 0..3 {
                        product[k] = value[k] * y;
                    }
                }
                products
            });
        let coefficients = sums.chunks_exact(3).map(|c| [c[0], c[1], c[2]]);
        Self {
            bands,
            coefficients: coefficients.take(bands * bands).collect(),
        }
    }

    /// Whether there can be so many bands.
    ///
    /// # Errors
    /// If `bands` is 0 or above [`MOST_BANDS`].
    pub fn check_bands(bands: usize) -> Result<(), IblError> {
        if (1..=MOST_BANDS).contains(&bands) {
            return Ok(());
        }
        Err(IblError::parameter(
            "bands",
            bands,
            "a whole number from 1 to 10",
        ))
    }

    /// How many bands.
    pub fn bands(&self) -> usize {
        self.bands
    }

    /// The coefficients, (l, m) at l² + l + m.
    pub fn coefficients(&self) -> &[[f64; 3]] {
        &self.coefficients
    }

    /// The function's value towards the unit direction `d`.
    pub fn evaluate(&self, d: Vec3<f64>) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (c, y) in self.coefficients.iter().zip(basis(self.bands, d)) {
            for k in 0..3 {
                sum[k] += c[k] * y;
            }
        }
        sum
    }

    /// Each band times `factor(l)`.
    pub fn scaled(&self, factor: impl Fn(usize) -> f64) -> Self {
        let coefficients = self
            .coefficients
            .iter()
            .enumerate()
            .map(|(i, c)| c.map(|v| v * factor(band_of(i))))
            .collect();
        Self {
            bands: self.bands,
            coefficients,
        }
    }

    /// Irradiance \[W m⁻²] of radiance: each band times A_l.
    pub fn irradiance(&self) -> Self {
        self.scaled(cosine_factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_bands_are_the_published_polynomials() {
        let d = Vec3::new(0.48, 0.6, 0.64);
        let y = basis(3, d);
        let expected = [
            0.282095,
            0.488603 * d.y,
            0.488603 * d.z,
            0.488603 * d.x,
            1.092548 * d.x * d.y,
            1.092548 * d.y * d.z,
            0.315392 * (3.0 * d.z * d.z - 1.0),
            1.092548 * d.x * d.z,
            0.546274 * (d.x * d.x - d.y * d.y),
        ];
        // The constants of Ramamoorthi & Hanrahan 2001, eq. 3, have six digits.
        for (a, b) in y.iter().zip(expected) {
            assert!((a - b).abs() < 1e-6, "{a} {b}");
        }
    }

    #[test]
    fn the_basis_is_orthonormal() {
        let n = MOST_BANDS;
        for i in [0, 3, 17, 42, 63, 99] {
            let all: [f64; 100] = ProductRule::new(n, 2 * n).sphere(|d| {
                let y = basis(n, d);
                std::array::from_fn(|k| y[k] * y[i])
            });
            for (k, v) in all.iter().enumerate() {
                // Sums of 200 products of size 1.
                assert!(
                    (v - f64::from(u8::from(k == i))).abs() < 1e-12,
                    "{i} {k}: {v}"
                );
            }
        }
    }

    #[test]
    fn cosine_factors_are_those_of_the_paper() {
        let expected = [
            PI,
            2.0 * PI / 3.0,
            PI / 4.0,
            0.0,
            -PI / 24.0,
            0.0,
            PI / 64.0,
        ];
        for (l, e) in expected.into_iter().enumerate() {
            assert!((cosine_factor(l) - e).abs() < 1e-15, "{l}");
        }
    }
}
