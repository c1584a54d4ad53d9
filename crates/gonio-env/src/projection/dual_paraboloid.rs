//! The dual paraboloid: two discs side by side, the left one of what is in front, the right one of what is behind.
//!
//! With coordinates p of a disc, x to the right and y up, and q = |p|²,
//!
//! ```text
//! in front (−z):  d = (2 p.x,  2 p.y,  q − 1) / (1 + q)
//! behind (+z):    d = (−2 p.x, 2 p.y,  1 − q) / (1 + q)
//! ```
//!
//! so the distance from a disc's centre is tan(θ/2). Both read unmirrored from inside. Outside the discs is nothing.
//! Source: Heidrich & Seidel 1998, "View-independent Environment Maps".

use gonio_num::{Real, Vec3};

/// Whether (u, v) is in the right half, and the coordinates of that half's disc.
#[inline(always)]
fn disc<R: Real>(uv: [R; 2]) -> (R::Mask, [R; 2]) {
    let behind = uv[0].gt(R::lit(0.5));
    let centre = R::select(behind, R::lit(0.75), R::lit(0.25));
    let x = R::lit(4.0) * (uv[0] - centre);
    (behind, [x, R::one() - R::lit(2.0) * uv[1]])
}

/// The unit direction shown at (u, v).
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let (behind, [x, y]) = disc(uv);
    let q = x * x + y * y;
    let over = (R::one() + q).recip();
    let (two, zero) = (R::lit(2.0), R::zero());
    let d = Vec3::new(two * x * over, two * y * over, (q - R::one()) * over);
    Vec3::new(
        R::select(behind, zero - d.x, d.x),
        d.y,
        R::select(behind, zero - d.z, d.z),
    )
}

/// Where the unit direction `d` is shown. What is at right angles to z, which both rims show, is on the left.
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>) -> [R; 2] {
    let behind = d.z.gt(R::zero());
    let over = (R::one() + d.z.abs()).recip();
    let x = R::select(behind, R::zero() - d.x, d.x) * over;
    let y = d.y * over;
    let centre = R::select(behind, R::lit(0.75), R::lit(0.25));
    [centre + R::lit(0.25) * x, R::lit(0.5) - R::lit(0.5) * y]
}

/// dω / (du dv) = 32 / (1 + q)² \[sr] on the discs, 0 outside.
#[inline(always)]
pub fn jacobian<R: Real>(uv: [R; 2]) -> R {
    let (_, [x, y]) = disc(uv);
    let q = x * x + y * y;
    let k = R::one() + q;
    R::select(q.le(R::one()), R::lit(32.0) / (k * k), R::zero())
}

/// Whether (u, v) is on one of the discs.
#[inline(always)]
pub fn contains<R: Real>(uv: [R; 2]) -> R::Mask {
    let (_, [x, y]) = disc(uv);
    (x * x + y * y).le(R::one())
}
