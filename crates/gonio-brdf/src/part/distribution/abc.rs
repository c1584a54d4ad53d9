//! D = K (1 + B (1 − cosθh))^−C, B = 2/α², with K such that ∫ D h.z dh = 1.
//!
//! So near the pole D falls as (1 + tan²θh/α²)^−C. Source: Löw, Kronander, Ynnerman & Unger 2012, "BRDF Models for Accurate and
//! Efficient Rendering of Glossy Surfaces", eq. 13, there with a free scale A for K.

use super::super::inverse_power::{InversePower, versine};
use super::Distribution;
use gonio_num::{Real, Vec3};

#[inline(always)]
fn falloff<R: Real>(alpha: R, c: R) -> InversePower<R> {
    let b = R::lit(2.0) / (alpha * alpha);
    InversePower { b, c }
}

/// K.
pub(super) fn peak<R: Real>(alpha: R, c: R) -> R {
    falloff(alpha, c).cosine_integral().recip()
}

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    d.peak * falloff(d.alpha_x, d.tail).value(versine(h))
}

/// The density of cosθ is ∝ (1 + B (1 − cosθ))^−C, without h.z.
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    falloff(d.alpha_x, d.tail).sample_half(u0, u1)
}

#[inline(always)]
pub(super) fn sample_density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let falloff = falloff(d.alpha_x, d.tail);
    falloff.half_density(falloff.value(versine(h)))
}
