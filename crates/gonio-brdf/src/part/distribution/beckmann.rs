//! D = exp(−((h.x/αx)² + (h.y/αy)²)/h.z²) / (π αx αy h.z⁴).
//!
//! Source: Beckmann & Spizzichino 1963; Walter et al. 2007, eq. 25.

use super::{Distribution, cos2, rest, slopes};
use gonio_num::{Real, Vec3};

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let z2 = cos2(h);
    (-(d.stretched(h) / z2)).exp() / (R::pi() * d.alpha_x * d.alpha_y * (z2 * z2))
}

/// Slopes of length √(−ln(1 − u1)), stretched.
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    slopes(d, (-rest(u1).ln()).safe_sqrt(), u0)
}
