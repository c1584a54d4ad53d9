//! D = K exp(−θh²/α²), with K such that ∫ D h.z dh = 1.
//!
//! Source: Torrance & Sparrow 1967, eq. 8 (there unnormalised, c² = 1/α²); Blinn 1977 calls it D₂.

use super::super::special::{exp_m1, integral, ln_1p};
use super::{Distribution, sin2};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, TAU};

/// K = 1/(2π ∫ exp(−θ²/α²) sinθ cosθ dθ).
pub(super) fn peak<R: Real>(alpha: R) -> R {
    // θ = α t: beyond t = 6 nothing is left; a wide lobe ends at the horizon.
    let end = alpha.recip() * R::lit(FRAC_PI_2);
    let end = end.min(R::lit(6.0));
    let sum: R = integral(0.0, 1.0, 4, |x: R| {
        let t = x * end;
        let (sin, cos) = (alpha * t).sin_cos();
        (-(t * t)).exp() * (sin / alpha) * cos
    });
    (R::lit(TAU) * alpha * alpha * end * sum).recip()
}

#[inline(always)]
fn theta<R: Real>(h: Vec3<R>) -> R {
    sin2(h).safe_sqrt().atan2(h.z)
}

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    d.peak * (-(theta(h) / d.alpha_x).sq()).exp()
}

/// −(1 − the share of the lobe above the horizon) of 2θ/α² exp(−θ²/α²).
#[inline(always)]
fn below<R: Real>(alpha: R) -> R {
    exp_m1(-(R::lit(FRAC_PI_2) / alpha).sq())
}

/// θ² = −α² ln(1 − u1 (1 − exp(−π²/4α²))): the density is 2θ/α² exp(−θ²/α²), without h.z.
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    let log = ln_1p((u1 * below(d.alpha_x)).max(R::lit(-1.0 + 1e-12)));
    let theta = d.alpha_x * (-log).safe_sqrt();
    let (sin, cos) = theta.min(R::lit(FRAC_PI_2)).sin_cos();
    around_axis(u0, sin, cos.max(R::zero()))
}

#[inline(always)]
pub(super) fn sample_density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let theta = theta(h);
    let sin = sin2(h).safe_sqrt();
    let tiny = sin.lt(R::lit(1e-15));
    let over_sin = R::select(tiny, R::one(), theta / R::select(tiny, R::one(), sin));
    let a2 = d.alpha_x * d.alpha_x;
    -(R::lit(FRAC_1_PI) * over_sin * (-(theta * theta / a2)).exp() / (a2 * below(d.alpha_x)))
}
