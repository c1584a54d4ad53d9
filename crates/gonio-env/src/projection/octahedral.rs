//! The octahedron, unfolded onto a square.
//!
//! With square coordinates p = (2u − 1, 1 − 2v) and w = 1 − |p.x| − |p.y|,
//!
//! ```text
//! w ≥ 0:  d ∝ (p.x, p.y, −w)
//! w < 0:  d ∝ (± (1 − |p.y|),  ± (1 − |p.x|),  −w), with the signs of p.x and p.y
//! ```
//!
//! The centre looks forward along −z, right is +x and up is +y; the four corners all show +z. An edge of the square is
//! folded upon itself about its middle. Source: Engelhardt & Dachsbacher 2008, "Octahedron Environment Maps".

use super::{disc_from_uv, uv_from_disc};
use gonio_num::{Real, Vec3};

/// ± `magnitude`, with the sign of `like`; positive at 0.
#[inline(always)]
pub(super) fn with_sign<R: Real>(magnitude: R, like: R) -> R {
    R::select(like.lt(R::zero()), R::zero() - magnitude, magnitude)
}

/// The point of the octahedron |x| + |y| + |z| = 1 shown at (u, v).
#[inline(always)]
fn point<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let [x, y] = disc_from_uv(uv);
    let w = R::one() - x.abs() - y.abs();
    let far = w.lt(R::zero());
    Vec3::new(
        R::select(far, with_sign(R::one() - y.abs(), x), x),
        R::select(far, with_sign(R::one() - x.abs(), y), y),
        R::zero() - w,
    )
}

/// The unit direction shown at (u, v).
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let p = point(uv);
    p * p.dot(p).sqrt().recip()
}

/// Where the direction `d` is shown. +z, which every corner shows, is at (1, 0).
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>) -> [R; 2] {
    let over = (d.x.abs() + d.y.abs() + d.z.abs())
        .max(R::lit(1e-30))
        .recip();
    let (x, y) = (d.x * over, d.y * over);
    let far = d.z.gt(R::zero());
    uv_from_disc([
        R::select(far, with_sign(R::one() - y.abs(), x), x),
        R::select(far, with_sign(R::one() - x.abs(), y), y),
    ])
}

/// dω / (du dv) = 4 / r³ \[sr], r the distance of the octahedron's point from its centre.
#[inline(always)]
pub fn jacobian<R: Real>(uv: [R; 2]) -> R {
    let p = point(uv);
    let r2 = p.dot(p);
    R::lit(4.0) / (r2 * r2.sqrt())
}
