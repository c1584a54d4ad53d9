//! The angular map, or light probe: distance from the centre is proportional to the angle from −z.
//!
//! With disc coordinates p = (2u − 1, 1 − 2v) and r = |p|,
//!
//! ```text
//! θ = π r,   d = (sin θ · p.x / r,  sin θ · p.y / r,  −cos θ)
//! ```
//!
//! The centre looks forward along −z, the whole rim backward along +z; right is +x and up is +y, so the picture reads
//! unmirrored from inside. Source: Debevec 1998, "Rendering Synthetic Objects into Real Scenes".

use super::{disc_from_uv, uv_from_disc};
use gonio_num::{Real, Vec3};

/// sin(πr) / r, π at r = 0.
#[inline(always)]
fn sin_pi_over<R: Real>(r: R) -> R {
    // Below 1e-4 two terms of the series are exact to 1e-16.
    let near = R::lit(1e-4);
    let a = R::pi() * r;
    let series = R::pi() * (R::one() - a * a * R::lit(1.0 / 6.0));
    R::select(r.lt(near), series, a.sin() / r.max(near))
}

/// The unit direction shown at (u, v).
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let [x, y] = disc_from_uv(uv);
    let r = (x * x + y * y).sqrt();
    let k = sin_pi_over(r);
    Vec3::new(k * x, k * y, R::zero() - (R::pi() * r).cos())
}

/// Where the unit direction `d` is shown. +z, which the whole rim shows, is at the right end (1, 1/2).
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>) -> [R; 2] {
    let s = (d.x * d.x + d.y * d.y).sqrt();
    let r = (s.atan2(R::zero() - d.z) * R::lit(std::f64::consts::FRAC_1_PI)).min(R::one());
    let tiny = R::lit(1e-30);
    let on_axis = s.lt(tiny);
    let k = r / s.max(tiny);
    let x = R::select(on_axis, r, d.x * k);
    let y = R::select(on_axis, R::zero(), d.y * k);
    uv_from_disc([x, y])
}

/// dω / (du dv) = 4π² sin(πr) / (πr) \[sr]: 4π² at the centre, 0 at the rim and outside.
#[inline(always)]
pub fn jacobian<R: Real>(uv: [R; 2]) -> R {
    let [x, y] = disc_from_uv(uv);
    let r = (x * x + y * y).sqrt();
    let inside = r.le(R::one());
    let j = R::lit(4.0) * R::pi() * sin_pi_over(r.min(R::one()));
    R::select(inside, j.max(R::zero()), R::zero())
}
