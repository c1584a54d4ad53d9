//! Distributions of microfacet normals: density, and sampling with exact densities.

use super::special::{exp_m1, ln_1p};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::FRAC_1_PI;

/// Which distribution of normals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    /// Beckmann & Spizzichino 1963: Gaussian slopes.
    Beckmann,
    /// Trowbridge & Reitz 1975, "GGX" in Walter et al. 2007: long tails.
    Ggx,
    /// Blinn 1977: a power of the cosine, exponent p = 2/α² − 2; anisotropic as in Ashikhmin & Shirley 2000.
    BlinnPhong,
}

/// A distribution of normals with slope scales along x and y.
///
/// Its density D satisfies ∫ D(h) h.z dh = 1 over the hemisphere (h in sr).
#[derive(Debug, Clone, Copy)]
pub struct Distribution<R> {
    /// Which one.
    pub shape: Shape,
    /// Slope scale along x, [[`ALPHA_MIN`], 1].
    pub alpha_x: R,
    /// Slope scale along y, [[`ALPHA_MIN`], 1].
    pub alpha_y: R,
}

/// The smallest slope scale: smaller ones are taken for this one. At it, single precision still resolves the peak to
/// about 0.1 %; for anything smoother use `mirror`.
pub const ALPHA_MIN: f64 = 1e-4;

impl<R: Real> Distribution<R> {
    /// D(h) in sr⁻¹; 0 for h.z ≤ 0.
    ///
    /// - GGX: 1 / (π αx αy e²), e = (h.x/αx)² + (h.y/αy)² + h.z²
    /// - Beckmann: exp(−((h.x/αx)² + (h.y/αy)²)/h.z²) / (π αx αy h.z⁴)
    /// - Blinn–Phong: h.zᵖ / (π αx αy), p = px cos²φ + py sin²φ, p· = 2/α·² − 2
    ///
    /// - `h`: unit, local frame
    ///
    /// Source: Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces", eqs 25, 30, 33;
    /// Burley 2012 for the anisotropic GGX; Ashikhmin & Shirley 2000, eq. 4.
    #[inline(always)]
    pub fn density(&self, h: Vec3<R>) -> R {
        let (ax, ay) = (self.alpha_x, self.alpha_y);
        let d = match self.shape {
            Shape::Ggx => {
                // With s = αx αy and q = s² e: s³/(π q²), one division. e ≥ 1 for unit h, as no α is above 1.
                let s = ax * ay;
                let q = (h.x * ay).sq() + (h.y * ax).sq() + (h.z * s).sq();
                let q = q.max(R::lit(0.5) * s * s);
                R::lit(FRAC_1_PI) * (s * s * s) / (q * q)
            }
            Shape::Beckmann => {
                let z2 = (h.z * h.z).max(R::lit(1e-12));
                let e = (h.x / ax).sq() + (h.y / ay).sq();
                (-(e / z2)).exp() / (R::pi() * ax * ay * (z2 * z2))
            }
            Shape::BlinnPhong => {
                // (p/2) tan²θ-weighted: h.zᵖ = exp(−p/2 · ln(1 + tan²θ)), which keeps its digits near the pole.
                let z2 = (h.z * h.z).max(R::lit(1e-12));
                let sin2 = h.x * h.x + h.y * h.y;
                let weighted = (h.x / ax).sq() + (h.y / ay).sq() - sin2; // = sin²θ · p/2
                let half_p = weighted / sin2.max(R::lit(1e-30));
                (-(half_p * ln_1p(sin2 / z2))).exp() / (R::pi() * ax * ay)
            }
        };
        R::select(h.z.gt(R::zero()), d, R::zero())
    }

    /// A normal with density D(h)·h.z.
    ///
    /// `u0`, `u1`: in [0, 1).
    #[inline(always)]
    pub fn sample_normal(&self, u0: R, u1: R) -> Vec3<R> {
        let (ax, ay) = (self.alpha_x, self.alpha_y);
        let rest = (R::one() - u1).max(R::lit(1e-12));
        match self.shape {
            // Slopes are (αx, αy)-scaled from a radially symmetric distribution of slope length r.
            Shape::Ggx => slopes(ax, ay, (u1 / rest).safe_sqrt(), u0),
            Shape::Beckmann => slopes(ax, ay, (-rest.ln()).safe_sqrt(), u0),
            Shape::BlinnPhong => {
                // tanφ = (αy/αx) tan 2πu0; then cosθ = (1 − u1)^(1/(p + 2)), p + 2 = 2 (cos²φ/αx² + sin²φ/αy²).
                let d = around_axis(u0, R::one(), R::zero());
                let (x, y) = (ax * d.x, ay * d.y);
                let over = (x * x + y * y).max(R::lit(1e-30)).sqrt().recip();
                let (cos, sin) = (x * over, y * over);
                let half = (cos / ax).sq() + (sin / ay).sq();
                let log = rest.ln() / half; // 2 ln cosθ
                let sin_theta = (-exp_m1(log)).safe_sqrt();
                Vec3::new(sin_theta * cos, sin_theta * sin, (log * R::lit(0.5)).exp())
            }
        }
    }

    /// A normal with density D(h) G₁(w) max(w·h, 0)/w.z: those of the GGX distribution that are visible from `w`.
    ///
    /// In the frame stretched by (αx, αy) the distribution is a hemisphere, and its reflections of w are a spherical cap.
    ///
    /// Source: Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", listing 3.
    #[inline(always)]
    pub fn sample_visible_ggx(&self, w: Vec3<R>, u0: R, u1: R) -> Vec3<R> {
        let (ax, ay) = (self.alpha_x, self.alpha_y);
        let std = Vec3::new(ax * w.x, ay * w.y, w.z).normalize();
        let z = (R::one() - u1) * (R::one() + std.z) - std.z;
        let sin = (R::one() - z * z).safe_sqrt();
        let h = around_axis(u0, sin, z) + std;
        let n = Vec3::new(ax * h.x, ay * h.y, h.z.max(R::zero()));
        // Only a grazing w at the cap's rim gives a zero vector; the normal then is +z.
        let length2 = n.length_squared();
        let bad = length2.lt(R::lit(1e-30));
        let up = Vec3::new(R::zero(), R::zero(), R::one());
        let unit = n * length2.max(R::lit(1e-30)).sqrt().recip();
        Vec3::select(bad, up, unit)
    }

    /// The same with another number type.
    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Distribution<S> {
        Distribution {
            shape: self.shape,
            alpha_x: f(self.alpha_x),
            alpha_y: f(self.alpha_y),
        }
    }
}

/// The normal with slopes r (αx cos 2πu, αy sin 2πu).
#[inline(always)]
fn slopes<R: Real>(alpha_x: R, alpha_y: R, r: R, u: R) -> Vec3<R> {
    let d = around_axis(u, r, R::one());
    Vec3::new(alpha_x * d.x, alpha_y * d.y, R::one()).normalize()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// ∫ f dh over the hemisphere: `rings` midpoints of t = tanθ/(1 + tanθ), which spreads the peak, times `turns` of φ.
    pub(in crate::part) fn hemisphere_sum(
        rings: u32,
        turns: u32,
        f: impl Fn(Vec3<f64>) -> f64,
    ) -> f64 {
        let mut sum = 0.0;
        for i in 0..rings {
            let t = (f64::from(i) + 0.5) / f64::from(rings);
            let tan = t / (1.0 - t);
            let cos = 1.0 / (1.0 + tan * tan).sqrt();
            let sin = tan * cos;
            let d_theta = cos * cos / (1.0 - t).powi(2) / f64::from(rings);
            for j in 0..turns {
                let h = around_axis((f64::from(j) + 0.5) / f64::from(turns), sin, cos);
                sum += f(h) * sin * d_theta;
            }
        }
        sum * std::f64::consts::TAU / f64::from(turns)
    }

    fn all(alpha_x: f64, alpha_y: f64) -> [Distribution<f64>; 3] {
        [Shape::Beckmann, Shape::Ggx, Shape::BlinnPhong].map(|shape| Distribution {
            shape,
            alpha_x,
            alpha_y,
        })
    }

    #[test]
    fn projected_area_is_one() {
        for (ax, ay) in [(0.1, 0.1), (0.5, 0.2), (1.0, 1.0)] {
            for d in all(ax, ay) {
                let sum = hemisphere_sum(4000, 128, |h| d.density(h) * h.z);
                assert!((sum - 1.0).abs() < 1e-5, "{d:?}: {sum}");
            }
        }
    }

    #[test]
    fn samples_have_the_density_of_the_normals() {
        // E[1/(D·z)] over D·z within the polar cap θ < θ₀ is the cap's solid angle 2π(1 − cosθ₀).
        for d in all(0.5, 0.3) {
            let n = 400;
            let (mut sum, cos0) = (0.0, 0.8);
            for i in 0..n {
                for j in 0..n {
                    let u = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
                    let h = d.sample_normal(u(i), u(j));
                    assert!((h.length() - 1.0).abs() < 1e-12);
                    if h.z > cos0 {
                        sum += 1.0 / (d.density(h) * h.z) / f64::from(n * n);
                    }
                }
            }
            let cap = std::f64::consts::TAU * (1.0 - cos0);
            assert!((sum / cap - 1.0).abs() < 5e-3, "{d:?}: {sum} vs {cap}");
        }
    }
}
