//! D = h.zᵖ / (π αx αy), p = px cos²φ + py sin²φ, p· = 2/α·² − 2.
//!
//! Source: Blinn 1977; Walter et al. 2007, eq. 30; Ashikhmin & Shirley 2000, eq. 4, for two slope scales.

use super::super::special::{exp_m1, ln_1p};
use super::{Distribution, cos2, rest, sin2};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    // h.zᵖ = exp(−p/2 · ln(1 + tan²θ)), which keeps its digits near the pole.
    let sin2 = sin2(h);
    let weighted = d.stretched(h) - sin2; // = sin²θ · p/2
    let half_p = weighted / sin2.max(R::lit(1e-30));
    (-(half_p * ln_1p(sin2 / cos2(h)))).exp() / (R::pi() * d.alpha_x * d.alpha_y)
}

/// tanφ = (αy/αx) tan 2πu0; then cosθ = (1 − u1)^(1/(p + 2)), p + 2 = 2 (cos²φ/αx² + sin²φ/αy²).
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    let (ax, ay) = (d.alpha_x, d.alpha_y);
    let v = around_axis(u0, R::one(), R::zero());
    let (x, y) = (ax * v.x, ay * v.y);
    let over = (x * x + y * y).max(R::lit(1e-30)).sqrt().recip();
    let (cos, sin) = (x * over, y * over);
    let half = (cos / ax).sq() + (sin / ay).sq();
    let log = rest(u1).ln() / half; // 2 ln cosθ
    let sin_theta = (-exp_m1(log)).safe_sqrt();
    Vec3::new(sin_theta * cos, sin_theta * sin, (log * R::lit(0.5)).exp())
}
