//! D = K e^(−s) (1 + s/a)^−p / h.z⁴, s = tan²θh/a, a = α², with K such that ∫ D h.z dh = 1.
//!
//! This is the shifted gamma distribution in x = a + s: ∝ e^(−x) x^−p. Its α in the paper is a here, the square of a slope scale.
//! Source: Bagher, Soler & Holzschuch 2012, "Accurate Fitting of Measured Reflectances Using a Shifted Gamma Micro-facet
//! Distribution", eqs 10 and 11.

use super::super::special::{exp_m1, integral, ln_1p};
use super::{Distribution, cos2, rest, sin2};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::FRAC_1_PI;

/// K = e^(−a)/(π a I), I = ∫ (x/a)^−p e^(−x) dx from a to ∞ = aᵖ Γ(1 − p, a).
pub(super) fn peak<R: Real>(alpha: R, p: R) -> R {
    let a = alpha * alpha;
    // Up to x = 1 in ln x, x = a e^y; from there on x = 1 + t/(1 − t).
    let end = -(a.ln());
    let near: R = integral(0.0, 1.0, 6, |k: R| {
        let y = k * end;
        let x = a * y.exp();
        ((R::one() - p) * y - x).exp() * a * end
    });
    let far: R = integral(0.0, 1.0, 3, |t: R| {
        let left = R::one() - t;
        let x = t / left + R::one();
        (-(p * (x / a).ln()) - x).exp() / (left * left)
    });
    (-a).exp() / (R::pi() * a * (near + far))
}

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let (a, z2) = (d.alpha_x * d.alpha_x, cos2(h));
    let s = sin2(h) / (z2 * a);
    d.peak * (-s - d.tail * ln_1p(s / a)).exp() / (z2 * z2)
}

/// The density that is drawn: x^−p below x = 1, e^(−x) from there on, each at most e times too dense somewhere.
struct Proposal<R> {
    a: R,
    /// 1 − p, not 0.
    e: R,
    /// Share of x < 1.
    near: R,
    /// ∫ x^−p dx from a to 1.
    mass: R,
}

impl<R: Real> Proposal<R> {
    #[inline(always)]
    fn new(d: &Distribution<R>) -> Self {
        let a = d.alpha_x * d.alpha_x;
        let e = R::one() - d.tail;
        let mass = (-(exp_m1(e * a.ln()) / e)).max(R::zero());
        // Approximate masses of the target in the two ranges; they steer efficiency only.
        let near = R::lit(0.6) * mass;
        let far = R::lit(0.37) * (-(R::lit(0.45) * d.tail)).exp();
        Self {
            a,
            e,
            near: near / (near + far),
            mass,
        }
    }
}

#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    let q = Proposal::new(d);
    let is_near = u1.lt(q.near);
    let u = (u1 / q.near.max(R::lit(1e-20))).min(R::one());
    // x = a eᵛ, so that s = x − a keeps its digits.
    let v = ln_1p(u * exp_m1(-(q.e * q.a.ln()))) / q.e;
    let near = q.a * exp_m1(v);
    let left = (R::one() - q.near).max(R::lit(1e-20));
    let w = ((u1 - q.near) / left).saturate();
    let far = (R::one() - q.a) - rest(w).ln();
    let tan2 = R::select(is_near, near, far) * q.a;
    let tan = tan2.safe_sqrt();
    let cos = (R::one() + tan2).sqrt().recip();
    around_axis(u0, tan * cos, cos)
}

/// With q the density of x: q/(π a h.z³).
#[inline(always)]
pub(super) fn sample_density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let (q, z2) = (Proposal::new(d), cos2(h));
    let x = q.a + sin2(h) / (z2 * q.a);
    let near = q.near * (-(d.tail * x.ln())).exp() / q.mass.max(R::lit(1e-20));
    let far = (R::one() - q.near) * (R::one() - x).exp();
    let density = R::select(x.lt(R::one()), near, far);
    R::lit(FRAC_1_PI) * density / (q.a * z2 * z2.sqrt())
}
