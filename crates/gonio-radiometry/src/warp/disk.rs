//! The unit disk, by the concentric map.

use gonio_num::Real;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_4};

/// A point of the unit disk, uniform by area: the concentric map, which takes concentric squares to concentric circles,
/// so that neighbouring samples stay neighbours and stratification survives.
///
/// With a = 2u₀ − 1, b = 2u₁ − 1: where |a| > |b|, radius a and angle (π/4) b/a; elsewhere radius b and angle π/2 − (π/4) a/b.
///
/// Source: Shirley and Chiu 1997, "A Low Distortion Map Between Disk and Square".
#[inline(always)]
pub fn uniform_disk<R: Real>(u: [R; 2]) -> [R; 2] {
    let (p, _) = concentric(u);
    p
}

/// [`uniform_disk`] with the signed radius, which is exact where √(x² + y²) would be rounded.
#[inline(always)]
pub(super) fn concentric<R: Real>(u: [R; 2]) -> ([R; 2], R) {
    let a = R::lit(2.0) * u[0] - R::one();
    let b = R::lit(2.0) * u[1] - R::one();
    let wide = b.abs().lt(a.abs());
    let radius = R::select(wide, a, b);
    let other = R::select(wide, b, a);
    let centre = radius.abs().le(R::zero());
    let turn = R::lit(FRAC_PI_4) * (other / R::select(centre, R::one(), radius));
    let (sin, cos) = turn.sin_cos();
    let (x, y) = (R::select(wide, cos, sin), R::select(wide, sin, cos));
    ([radius * x, radius * y], radius)
}

/// Density of [`uniform_disk`] at `p`, by area: 1/π in the closed disk, 0 outside.
#[inline(always)]
pub fn uniform_disk_density<R: Real>(p: [R; 2]) -> R {
    let inside = (p[0] * p[0] + p[1] * p[1]).le(R::one());
    R::select(inside, R::lit(FRAC_1_PI), R::zero())
}

/// The u in [0, 1]² that [`uniform_disk`] maps to `p`; (½, ½) at the centre.
#[inline(always)]
pub fn uniform_disk_inverse<R: Real>(p: [R; 2]) -> [R; 2] {
    let [x, y] = p;
    let wide = y.abs().lt(x.abs());
    let length = (x * x + y * y).sqrt();
    let along = R::select(wide, x, y);
    let across = R::select(wide, y, x);
    let radius = length.copysign(along);
    // The angle from the nearer axis, at most π/4 either way.
    let turn = across.copysign(across * along).atan2(along.abs());
    let other = turn * R::lit(1.0 / FRAC_PI_4) * radius;
    let a = R::select(wide, radius, other);
    let b = R::select(wide, other, radius);
    let half = R::lit(0.5);
    [(half * a + half).saturate(), (half * b + half).saturate()]
}
