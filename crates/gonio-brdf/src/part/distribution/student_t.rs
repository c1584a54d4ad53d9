//! D = (1 + e/(γ − 1))^−γ / (π αx αy h.z⁴), e = ((h.x/αx)² + (h.y/αy)²)/h.z²: Student's t-distribution of slopes.
//!
//! γ = 2 is GGX, γ → ∞ Beckmann. Source: Ribardière, Bringier, Meneveaux & Simonot 2017, "STD: Student's t-Distribution of
//! Slopes for Microfacet Based BSDFs", eq. 11.

use super::super::special::{exp_m1, ln_1p, ln_gamma};
use super::{Distribution, cos2, rest, slopes};
use gonio_num::{Real, Vec3};
use std::f64::consts::FRAC_2_SQRT_PI;

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let z2 = cos2(h);
    let e = d.stretched(h) / (z2 * (d.tail - R::one()));
    (-(d.tail * ln_1p(e))).exp() / (R::pi() * d.alpha_x * d.alpha_y * (z2 * z2))
}

/// σ/α = √(γ − 1) Γ(γ − 3/2)/(√π Γ(γ − 1)), from the mean length of the slopes.
pub(super) fn spread<R: Real>(gamma: R) -> R {
    let log = ln_gamma(gamma - R::lit(1.5)) - ln_gamma(gamma - R::one());
    (gamma - R::one()).sqrt() * log.exp() * R::lit(FRAC_2_SQRT_PI * 0.5)
}

/// Slopes of squared length (γ − 1) ((1 − u1)^(−1/(γ − 1)) − 1), stretched.
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    let e = d.tail - R::one();
    let r2 = e * exp_m1(-(rest(u1).ln() / e));
    slopes(d, r2.safe_sqrt(), u0)
}
