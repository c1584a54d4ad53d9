//! S(x) = (1 + B x)^−C, the fall-off of Löw's models and of the distribution `abc`: value, integral, sampling.

use super::special::{exp_m1, exp_m1_over, ln_1p};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::TAU;

/// S(x) = (1 + B x)^−C for x ≥ 0.
///
/// The ABC model of Church & Takacs 1991, as Löw, Kronander, Ynnerman & Unger 2012 use it.
#[derive(Debug, Clone, Copy)]
pub struct InversePower<R> {
    /// B > 0.
    pub b: R,
    /// C ≥ 0.
    pub c: R,
}

impl<R: Real> InversePower<R> {
    /// S(x).
    #[inline(always)]
    pub fn value(&self, x: R) -> R {
        (-(self.c * ln_1p(self.b * x))).exp()
    }

    /// ∫ S dx from 0 to `end`.
    #[inline(always)]
    pub fn integral(&self, end: R) -> R {
        let log = ln_1p(self.b * end);
        log * exp_m1_over((R::one() - self.c) * log) / self.b
    }

    /// An x in [0, `end`] with the density S(x)/∫ S: y = 1 + B x has a density ∝ y^−C.
    #[inline(always)]
    pub fn sample(&self, u: R, end: R) -> R {
        let e = R::one() - self.c;
        // C = 1 is a logarithm. In single precision no other C is so near to 1; in double precision this is wrong by 2e-9.
        let e = R::select(e.abs().lt(R::lit(1e-10)), R::lit(1e-10), e);
        let v = ln_1p(u * exp_m1(e * ln_1p(self.b * end))) / e;
        (exp_m1(v) / self.b).max(R::zero()).min(end)
    }

    /// A half vector with the density S(1 − h.z)/(2π ∫ S), in sr⁻¹; see [`InversePower::half_density`].
    #[inline(always)]
    pub fn sample_half(&self, u0: R, u1: R) -> Vec3<R> {
        let versine = self.sample(u1, R::one());
        let sin = (versine * (R::lit(2.0) - versine)).safe_sqrt();
        around_axis(u0, sin, R::one() - versine)
    }

    /// The density of [`InversePower::sample_half`], where S(1 − h.z) = `value`.
    #[inline(always)]
    pub fn half_density(&self, value: R) -> R {
        value / (R::lit(TAU) * self.integral(R::one()))
    }

    /// ∫ S(1 − h.z) h.z dh over the hemisphere: 2π ∫ (1 − x) S dx from 0 to 1, where 1 − x = 1 + 1/B − (1 + B x)/B.
    #[inline(always)]
    pub fn cosine_integral(&self) -> R {
        let over = self.b.recip();
        let less = Self {
            c: self.c - R::one(),
            ..*self
        };
        let (first, second) = (self.integral(R::one()), less.integral(R::one()));
        R::lit(TAU) * ((R::one() + over) * first - second * over)
    }

    /// The same with another number type.
    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> InversePower<S> {
        InversePower {
            b: f(self.b),
            c: f(self.c),
        }
    }
}

/// 1 − h.z of a unit vector above the horizon, with its digits near the pole.
#[inline(always)]
pub fn versine<R: Real>(h: Vec3<R>) -> R {
    (h.x * h.x + h.y * h.y) / (R::one() + h.z.max(R::zero()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the antiderivatives, and by the midpoint rule.
    #[test]
    fn integrals() {
        for (b, c) in [(10.0f64, 2.0f64), (1000.0, 0.5), (300.0, 1.0), (5.0, 3.0)] {
            let s = InversePower { b, c };
            let y: f64 = 1.0 + 0.7 * b;
            let expected = if c == 1.0 {
                y.ln() / b
            } else {
                (1.0 - y.powf(1.0 - c)) / (b * (c - 1.0))
            };
            assert!((s.integral(0.7) / expected - 1.0).abs() < 1e-13, "{b} {c}");
            let n = 200_000;
            let sum: f64 = (0..n)
                .map(|k| (f64::from(k) + 0.5) / f64::from(n))
                .map(|x| (1.0 - x) * s.value(x) * TAU / f64::from(n))
                .sum();
            // h² |f′|/24 with h = 5e-6 and |f′| up to B C = 500.
            assert!((s.cosine_integral() / sum - 1.0).abs() < 1e-7, "{b} {c}");
        }
    }

    /// The integral up to the x that is drawn is u of the whole; also where C is 1 and next to it.
    #[test]
    fn draws_are_the_inverse_of_the_integral() {
        for c in [0.0, 0.02, 1.0 - 1e-9, 1.0, 1.0 + 1e-9, 1.3, 3.0] {
            for b in [0.01, 30.0, 1e7] {
                let s = InversePower::<f64> { b, c };
                for u in [0.0, 1e-6, 0.3, 0.999] {
                    let x = s.sample(u, 1.5);
                    let found = s.integral(x) / s.integral(1.5);
                    // 2e-9 for C = 1, as said there.
                    assert!((found - u).abs() < 4e-9, "{b} {c} {u}: {found}");
                }
            }
        }
    }
}
