//! [`ProductRule`]: directions, by a rule in cosθ times one in φ.

use super::GaussLegendre;
use gonio_num::{Real, Vec3};
use std::f64::consts::TAU;

/// Gauss–Legendre in cosθ times equal steps in φ: dω = d(cosθ) dφ (T4).
///
/// With n nodes in cosθ and m in φ it is exact (to rounding) over the sphere for every polynomial in x, y, z of degree
/// below min(2n, m), so for products of spherical harmonics with ℓ₁ + ℓ₂ in that range. Over the hemisphere it is exact
/// where the integrand, averaged over φ, is a polynomial in cosθ of degree below 2n: in particular 1 and cosθ.
///
/// For integrands with a peak or an edge use [`adaptive`](super::adaptive).
///
/// ```
/// use gonio_radiometry::quadrature::ProductRule;
/// // Irradiance under unit radiance: E = ∫ cosθ dω = π. (7)
/// let [irradiance] = ProductRule::new(8, 16).hemisphere(|w| [w.z]);
/// assert!((irradiance - std::f64::consts::PI).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ProductRule {
    polar: GaussLegendre,
    /// cos and sin of the azimuths.
    azimuths: Vec<(f64, f64)>,
}

impl ProductRule {
    /// The rule of `polar` nodes in cosθ and `azimuthal` in φ.
    ///
    /// # Panics
    /// If either is 0.
    pub fn new(polar: usize, azimuthal: usize) -> Self {
        assert!(azimuthal > 0, "a quadrature rule needs at least one node");
        // Half a step off the axes: a grid that mirrors to itself in x and in y.
        let azimuths = (0..azimuthal)
            .map(|i| {
                let phi = TAU * (i as f64 + 0.5) / azimuthal as f64;
                (Real::cos(phi), Real::sin(phi))
            })
            .collect();
        Self {
            polar: GaussLegendre::new(polar),
            azimuths,
        }
    }

    /// ∫ f(ω) dω over the whole sphere.
    pub fn sphere<const N: usize>(&self, f: impl FnMut(Vec3<f64>) -> [f64; N]) -> [f64; N] {
        self.zone(-1.0, 1.0, f)
    }

    /// ∫ f(ω) dω over the hemisphere z ≥ 0. The cosine isn't included.
    pub fn hemisphere<const N: usize>(&self, f: impl FnMut(Vec3<f64>) -> [f64; N]) -> [f64; N] {
        self.zone(0.0, 1.0, f)
    }

    /// ∫ f(ω) dω over the zone `z_min` ≤ cosθ ≤ `z_max`, both in [−1, 1].
    pub fn zone<const N: usize>(
        &self,
        z_min: f64,
        z_max: f64,
        mut f: impl FnMut(Vec3<f64>) -> [f64; N],
    ) -> [f64; N] {
        let step = TAU / self.azimuths.len() as f64;
        self.polar.integrate(z_min, z_max, |z| {
            let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
            let mut ring = [0.0; N];
            for &(cos, sin) in &self.azimuths {
                let values = f(Vec3::new(across * cos, across * sin, z));
                for (sum, v) in ring.iter_mut().zip(values) {
                    *sum += step * v;
                }
            }
            ring
        })
    }

    /// Evaluations that an integral takes.
    pub fn evaluations(&self) -> usize {
        self.polar.nodes().len() * self.azimuths.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn the_sphere_is_four_pi_and_irradiance_is_pi() {
        for n in [1, 2, 5, 40] {
            let rule = ProductRule::new(n, 2 * n);
            let [whole] = rule.sphere(|_| [1.0]);
            let [half, cosine] = rule.hemisphere(|w| [1.0, w.z]);
            assert!((whole - 4.0 * PI).abs() < 1e-12);
            assert!((half - 2.0 * PI).abs() < 1e-12);
            assert!((cosine - PI).abs() < 1e-12);
        }
    }

    /// ∫ x²ᵃ y²ᵇ z²ᶜ over the sphere is 2 Γ(a+½) Γ(b+½) Γ(c+½) / Γ(a+b+c+3/2); odd powers give 0.
    #[test]
    fn polynomials_are_exact() {
        let rule = ProductRule::new(6, 12);
        let double_factorial = |n: i32| (1..n).step_by(2).map(f64::from).product::<f64>();
        for (a, b, c) in [
            (0, 0, 1),
            (1, 1, 1),
            (2, 1, 0),
            (0, 2, 3),
            (5, 0, 0),
            (0, 0, 5),
        ] {
            let [found, odd] = rule.sphere(|w| {
                let even = w.x.powi(2 * a) * w.y.powi(2 * b) * w.z.powi(2 * c);
                [even, even * w.x]
            });
            // With Γ(n+½) = (2n−1)!! √π / 2ⁿ: 4π (2a−1)!! (2b−1)!! (2c−1)!! / (2(a+b+c)+1)!!.
            let numerator: f64 = [a, b, c].map(|k| double_factorial(2 * k)).iter().product();
            let expected = 4.0 * PI * numerator / double_factorial(2 * (a + b + c) + 2);
            assert!((found - expected).abs() < 1e-12, "{a} {b} {c}");
            assert!(odd.abs() < 1e-12);
        }
    }

    /// The nine real spherical harmonics of ℓ ≤ 2.
    fn harmonics(w: Vec3<f64>) -> [f64; 9] {
        let Vec3 { x, y, z } = w;
        let (c0, c1) = ((0.25 / PI).sqrt(), (0.75 / PI).sqrt());
        let c2 = (3.75 / PI).sqrt();
        [
            c0,
            c1 * y,
            c1 * z,
            c1 * x,
            c2 * x * y,
            c2 * y * z,
            (0.3125 / PI).sqrt() * (3.0 * z * z - 1.0),
            c2 * x * z,
            0.5 * c2 * (x * x - y * y),
        ]
    }

    #[test]
    fn spherical_harmonics_are_orthonormal() {
        let gram = |rule: &ProductRule| {
            let mut worst = 0.0f64;
            for i in 0..9 {
                let row: [f64; 9] = rule.sphere(|w| {
                    let y = harmonics(w);
                    y.map(|v| v * y[i])
                });
                for (j, v) in row.iter().enumerate() {
                    worst = worst.max((v - f64::from(u8::from(i == j))).abs());
                }
            }
            worst
        };
        assert!(gram(&ProductRule::new(3, 5)) < 1e-13);
        // A rule of too few nodes must fail.
        assert!(gram(&ProductRule::new(2, 5)) > 1e-3);
        assert!(gram(&ProductRule::new(3, 4)) > 1e-3);
    }
}
