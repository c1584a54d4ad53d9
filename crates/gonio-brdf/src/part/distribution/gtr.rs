//! D = K (1 + (1/α² − 1) sin²θh)^−γ = c/(α² cos²θh + sin²θh)^γ, with K such that ∫ D h.z dh = 1.
//!
//! γ = 2 is GGX; 1 is Berry 1923. Source: Burley 2012, "Physically Based Shading at Disney", appendix B.1.

use super::super::special::{exp_m1, exp_m1_over, ln_1p};
use super::{Distribution, at_sin2, rest, sin2};
use gonio_num::{Real, Vec3};

/// α², and 1 − α², which must not vanish.
#[inline(always)]
fn squares<R: Real>(alpha: R) -> (R, R) {
    let a2 = (alpha * alpha).min(R::lit(0.998));
    (a2, R::one() - a2)
}

/// With L = ln α² and g(x) = (eˣ − 1)/x: K = g(L)/(π α² g((γ − 1) L)).
pub(super) fn peak<R: Real>(alpha: R, gamma: R) -> R {
    let (a2, _) = squares(alpha);
    let l = a2.ln();
    exp_m1_over(l) / (R::pi() * a2 * exp_m1_over((gamma - R::one()) * l))
}

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let (a2, one_minus) = squares(d.alpha_x);
    d.peak * (-(d.tail * ln_1p(sin2(h) * one_minus / a2))).exp()
}

/// sin²θ = α² (eᵛ − 1)/(1 − α²), v = ln(1 + u1 (e^((γ − 1) L) − 1))/(1 − γ), L = ln α².
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    let (a2, one_minus) = squares(d.alpha_x);
    let e = R::one() - d.tail;
    let u = R::one() - rest(u1);
    let v = ln_1p(u * exp_m1(-(e * a2.ln()))) / e;
    at_sin2(a2 * exp_m1(v) / one_minus, u0)
}
