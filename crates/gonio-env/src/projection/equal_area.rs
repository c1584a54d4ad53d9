//! The octahedron with equal areas: equal areas of the square are equal solid angles.
//!
//! With square coordinates p = (2u − 1, 1 − 2v), w = 1 − |p.x| − |p.y| and r = 1 − |w|,
//!
//! ```text
//! φ = (π/4) ((|p.y| − |p.x|) / r + 1),   h = r √(2 − r²)
//! d = (± h cos φ,  ± h sin φ,  ∓ (1 − r²)), with the signs of p.x, p.y and w
//! ```
//!
//! The centre looks forward along −z, right is +x and up is +y; the four corners all show +z. Edges fold as those of the
//! octahedron. Source: Clarberg 2008, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD".

use super::octahedral::with_sign;
use super::{disc_from_uv, uv_from_disc};
use gonio_num::{Real, Vec3};

/// The unit direction shown at (u, v).
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let [x, y] = disc_from_uv(uv);
    let w = R::one() - x.abs() - y.abs();
    let r = R::one() - w.abs();
    // At the centre and the corners r is 0, and so is the numerator.
    let turn = (y.abs() - x.abs()) / r.max(R::lit(1e-30)) + R::one();
    let (sin, cos) = (turn * R::lit(std::f64::consts::FRAC_PI_4)).sin_cos();
    let h = r * (R::lit(2.0) - r * r).safe_sqrt();
    Vec3::new(
        with_sign(h * cos, x),
        with_sign(h * sin, y),
        with_sign(r * r - R::one(), w),
    )
}

/// Where the unit direction `d` is shown. +z, which every corner shows, is at (1, 0).
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>) -> [R; 2] {
    // 1 − |z| without cancellation near the axis.
    let r = ((d.x * d.x + d.y * d.y) / (R::one() + d.z.abs())).safe_sqrt();
    let turn = d.y.abs().atan2(d.x.abs()) * R::lit(std::f64::consts::FRAC_2_PI);
    let b = r * turn;
    let a = r - b;
    let far = d.z.gt(R::zero());
    let x = R::select(far, R::one() - b, a);
    let y = R::select(far, R::one() - a, b);
    uv_from_disc([with_sign(x, d.x), with_sign(y, d.y)])
}

/// dω / (du dv) = 4π \[sr] everywhere.
#[inline(always)]
pub fn jacobian<R: Real>(_uv: [R; 2]) -> R {
    R::lit(4.0) * R::pi()
}
