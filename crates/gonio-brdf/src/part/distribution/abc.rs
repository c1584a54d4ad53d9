//! D = K (1 + B (1 − cosθh))^−C, B = 2/α², with K such that ∫ D h.z dh = 1.
//!
//! So near the pole D falls as (1 + tan²θh/α²)^−C. Source: Löw, Kronander, Ynnerman & Unger 2012, "BRDF Models for Accurate and
//! Efficient Rendering of Glossy Surfaces", eq. 13, there with a free scale A for K.

use super::super::special::{exp_m1, exp_m1_over, ln_1p};
use super::{Distribution, rest, sin2};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::TAU;

#[inline(always)]
fn b<R: Real>(alpha: R) -> R {
    R::lit(2.0) / (alpha * alpha)
}

/// ∫ y^−k dy from 1 to 1 + B, from ln(1 + B).
#[inline(always)]
fn power_integral<R: Real>(k: R, log: R) -> R {
    log * exp_m1_over((R::one() - k) * log)
}

/// With y = 1 + B (1 − cosθ): 1/K = 2π/B ((1 + 1/B) P(C) − P(C − 1)/B), P(k) = ∫ y^−k dy from 1 to 1 + B.
pub(super) fn peak<R: Real>(alpha: R, c: R) -> R {
    let b = b(alpha);
    let log = ln_1p(b);
    let first = (R::one() + b.recip()) * power_integral(c, log);
    let second = power_integral(c - R::one(), log) / b;
    b / (R::lit(TAU) * (first - second))
}

/// 1 − cosθ, with its digits near the pole.
#[inline(always)]
fn versine<R: Real>(h: Vec3<R>) -> R {
    sin2(h) / (R::one() + h.z.max(R::zero()))
}

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    d.peak * (-(d.tail * ln_1p(b(d.alpha_x) * versine(h)))).exp()
}

/// The density of cosθ is ∝ (1 + B (1 − cosθ))^−C, without h.z.
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    let (b, e) = (b(d.alpha_x), R::one() - d.tail);
    let u = R::one() - rest(u1);
    let v = ln_1p(u * exp_m1(e * ln_1p(b))) / e;
    let versine = (exp_m1(v) / b).saturate();
    let sin = (versine * (R::lit(2.0) - versine)).safe_sqrt();
    around_axis(u0, sin, R::one() - versine)
}

#[inline(always)]
pub(super) fn sample_density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let b = b(d.alpha_x);
    let log = ln_1p(b);
    let power = (-(d.tail * ln_1p(b * versine(h)))).exp();
    b * power / (R::lit(TAU) * power_integral(d.tail, log))
}
