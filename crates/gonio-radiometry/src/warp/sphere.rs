//! The whole sphere and the hemisphere around +z, uniform by solid angle.

use super::{around_axis, azimuth_inverse};
use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_1_PI, PI};

/// A direction of the hemisphere z ≥ 0, uniform by solid angle: z = u₀, φ = 2π u₁ (Archimedes' projection).
#[inline(always)]
pub fn uniform_hemisphere<R: Real>(u: [R; 2]) -> Vec3<R> {
    let z = u[0];
    let across = ((R::one() - z) * (R::one() + z)).safe_sqrt();
    around_axis(u[1], across, z)
}

/// Density of [`uniform_hemisphere`] at the unit direction `w` (sr⁻¹): 1/2π for w.z ≥ 0, else 0.
#[inline(always)]
pub fn uniform_hemisphere_density<R: Real>(w: Vec3<R>) -> R {
    R::select(w.z.lt(R::zero()), R::zero(), R::lit(0.5 * FRAC_1_PI))
}

/// The u in [0, 1]² that [`uniform_hemisphere`] maps to `w`; u₁ = 0 at the pole.
#[inline(always)]
pub fn uniform_hemisphere_inverse<R: Real>(w: Vec3<R>) -> [R; 2] {
    [w.z.saturate(), azimuth_inverse(w)]
}

/// A direction of the sphere, uniform by solid angle: z = 1 − 2u₀, φ = 2π u₁.
#[inline(always)]
pub fn uniform_sphere<R: Real>(u: [R; 2]) -> Vec3<R> {
    let z = R::one() - R::lit(2.0) * u[0];
    let across = R::lit(2.0) * (u[0] * (R::one() - u[0])).safe_sqrt();
    around_axis(u[1], across, z)
}

/// Density of [`uniform_sphere`] (sr⁻¹): 1/4π for every direction.
#[inline(always)]
pub fn uniform_sphere_density<R: Real>(_w: Vec3<R>) -> R {
    R::lit(1.0 / (4.0 * PI))
}

/// The u in [0, 1]² that [`uniform_sphere`] maps to `w`; u₁ = 0 at the poles.
#[inline(always)]
pub fn uniform_sphere_inverse<R: Real>(w: Vec3<R>) -> [R; 2] {
    let half = R::lit(0.5);
    [(half - half * w.z).saturate(), azimuth_inverse(w)]
}
