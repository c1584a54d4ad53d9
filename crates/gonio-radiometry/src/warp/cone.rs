//! Cones around +z, uniform by solid angle: the directions of a distant sphere.

use super::{around_axis, azimuth_inverse};
use gonio_num::{Real, Vec3};
use std::f64::consts::TAU;

/// A direction of the cone w.z ≥ `cos_max`, uniform by solid angle.
///
/// - `cos_max`: cosine of the half-angle, in [−1, 1); 0 is the hemisphere, −1 the sphere
///
/// 1 − `cos_max` loses digits for narrow cones: [`uniform_cap`] takes that height itself.
#[inline(always)]
pub fn uniform_cone<R: Real>(u: [R; 2], cos_max: R) -> Vec3<R> {
    uniform_cap(u, R::one() - cos_max)
}

/// Density of [`uniform_cone`] at the unit direction `w` (sr⁻¹): 1/(2π (1 − `cos_max`)) inside, else 0.
#[inline(always)]
pub fn uniform_cone_density<R: Real>(w: Vec3<R>, cos_max: R) -> R {
    uniform_cap_density(w, R::one() - cos_max)
}

/// The u in [0, 1]² that [`uniform_cone`] maps to `w`.
#[inline(always)]
pub fn uniform_cone_inverse<R: Real>(w: Vec3<R>, cos_max: R) -> [R; 2] {
    uniform_cap_inverse(w, R::one() - cos_max)
}

/// A direction of the spherical cap of height `height`, uniform by solid angle: 1 − z = u₀ `height`, φ = 2π u₁.
///
/// - `height`: 1 − cos θmax, in (0, 2]. Of a sphere of radius r at distance d it is s²/(1 + √(1 − s²)) with s = r/d,
///   which keeps every digit however far the sphere is
#[inline(always)]
pub fn uniform_cap<R: Real>(u: [R; 2], height: R) -> Vec3<R> {
    let below = u[0] * height;
    let across = (below * (R::lit(2.0) - below)).safe_sqrt();
    around_axis(u[1], across, R::one() - below)
}

/// Density of [`uniform_cap`] at the unit direction `w` (sr⁻¹): 1/(2π `height`) inside, else 0. Infinite for height 0.
#[inline(always)]
pub fn uniform_cap_density<R: Real>(w: Vec3<R>, height: R) -> R {
    let outside = height.lt(depth(w));
    R::select(outside, R::zero(), (R::lit(TAU) * height).recip())
}

/// The u in [0, 1]² that [`uniform_cap`] maps to `w`; u₁ = 0 at the pole.
#[inline(always)]
pub fn uniform_cap_inverse<R: Real>(w: Vec3<R>, height: R) -> [R; 2] {
    let tiny = R::lit(1e-37);
    [(depth(w) / height.max(tiny)).saturate(), azimuth_inverse(w)]
}

/// 1 − w.z without cancellation near the pole: (x² + y²) / (1 + z) in the upper half.
#[inline(always)]
fn depth<R: Real>(w: Vec3<R>) -> R {
    let upper = (w.x * w.x + w.y * w.y) / (R::one() + w.z.max(R::zero()));
    R::select(w.z.lt(R::zero()), R::one() - w.z, upper)
}
