//! The mirrored ball: an orthographic photograph of a perfectly reflecting ball.
//!
//! The camera stands on the +z side and looks along −z, as a camera does by default, with +x to its right and +y up.
//! With disc coordinates p = (2u − 1, 1 − 2v), the ball's normal there is n = (p.x, p.y, √(1 − |p|²)) and the view
//! vector is +z, so the light comes from
//!
//! ```text
//! d = 2 (n · z) n − z = (2 n.z p.x,  2 n.z p.y,  1 − 2 |p|²)
//! ```
//!
//! The centre shows the camera itself (+z), the rim what is hidden behind the ball (−z). A photograph is a mirror
//! image: writing on it reads backwards, while the environment made of it reads correctly from inside. Equal areas of
//! the picture are equal solid angles. So a mirrored ball that is rendered with that camera gives the photograph back.
//!
//! Other programs put the picture's centre at −z, unflipped; such a picture is a flipped photograph turned by 180°.

use super::{disc_from_uv, uv_from_disc};
use gonio_num::{Real, Vec3};

/// The unit direction shown at (u, v).
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let [x, y] = disc_from_uv(uv);
    let q = x * x + y * y;
    let k = R::lit(2.0) * (R::one() - q).safe_sqrt();
    Vec3::new(k * x, k * y, R::one() - R::lit(2.0) * q)
}

/// Where the unit direction `d` is shown: the normal half-way between `d` and +z, seen along z. −z, which the whole rim
/// shows, is at the right end (1, 1/2).
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>) -> [R; 2] {
    let s2 = d.x * d.x + d.y * d.y;
    // 1 + z without cancellation on the far side.
    let far = s2 / (R::one() - d.z).max(R::one());
    let w = R::select(d.z.lt(R::zero()), far, R::one() + d.z);
    let length = (s2 + w * w).sqrt();
    let tiny = R::lit(1e-30);
    let on_axis = length.lt(tiny);
    let k = length.max(tiny).recip();
    let x = R::select(on_axis, R::one(), d.x * k);
    let y = R::select(on_axis, R::zero(), d.y * k);
    uv_from_disc([x, y])
}

/// dω / (du dv) = 16 \[sr] on the disc, 0 outside.
#[inline(always)]
pub fn jacobian<R: Real>(uv: [R; 2]) -> R {
    let [x, y] = disc_from_uv(uv);
    R::select((x * x + y * y).le(R::one()), R::lit(16.0), R::zero())
}
