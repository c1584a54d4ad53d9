//! The hemisphere around +z, weighted by the cosine or by a power of it.

use super::disk::{concentric, uniform_disk_inverse};
use super::{around_axis, azimuth_inverse};
use gonio_num::{Real, Vec3};
use std::f64::consts::FRAC_1_PI;

/// A direction of the hemisphere z ≥ 0 with density cosθ/π: a uniform point of the disk lifted onto the sphere (Malley's
/// method; Nusselt's analogue).
///
/// On the border of the square (u₀ or u₁ is 0 or 1) z = 0 and the density is 0.
#[inline(always)]
pub fn cosine_hemisphere<R: Real>(u: [R; 2]) -> Vec3<R> {
    let ([x, y], radius) = concentric(u);
    let z = ((R::one() - radius) * (R::one() + radius)).safe_sqrt();
    Vec3::new(x, y, z)
}

/// Density of [`cosine_hemisphere`] at the unit direction `w` (sr⁻¹): w.z/π, 0 below the horizon.
#[inline(always)]
pub fn cosine_hemisphere_density<R: Real>(w: Vec3<R>) -> R {
    w.z.max(R::zero()) * R::lit(FRAC_1_PI)
}

/// The u in [0, 1]² that [`cosine_hemisphere`] maps to `w`; (½, ½) at the pole.
#[inline(always)]
pub fn cosine_hemisphere_inverse<R: Real>(w: Vec3<R>) -> [R; 2] {
    uniform_disk_inverse([w.x, w.y])
}

/// A direction of the hemisphere z ≥ 0 with density ∝ cosᵖθ, the Phong lobe: cosθ = (1 − u₀)^(1/(p+1)), φ = 2π u₁.
///
/// - `exponent`: p ≥ 0; 0 is uniform, 1 the cosine. Narrow lobes (large p) keep their digits
///
/// Source: Lafortune and Willems 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering".
#[inline(always)]
pub fn cosine_power_hemisphere<R: Real>(u: [R; 2], exponent: R) -> Vec3<R> {
    // t = −2 ln cosθ, so that sin²θ = 1 − e⁻ᵗ.
    let rest = (R::one() - u[0]).max(R::lit(1e-37));
    let t = R::lit(-2.0) * rest.ln() / (exponent + R::one());
    let cos = (R::lit(-0.5) * t).exp();
    // The series of 1 − e⁻ᵗ below t = 0.01, where the difference cancels: the next term is t⁶/5040 of it, 2e-16.
    let mut series = R::lit(1.0 / 720.0);
    for factor in [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 1.0 / 2.0, 1.0] {
        series = R::lit(factor) - t * series;
    }
    let series = t * series;
    let sin2 = R::select(
        t.lt(R::lit(0.01)),
        series,
        (R::one() - cos) * (R::one() + cos),
    );
    around_axis(u[1], sin2.safe_sqrt(), cos)
}

/// Density of [`cosine_power_hemisphere`] at the unit direction `w` (sr⁻¹): (p + 1)/2π · cosᵖθ, 0 below the horizon.
#[inline(always)]
pub fn cosine_power_hemisphere_density<R: Real>(w: Vec3<R>, exponent: R) -> R {
    let density = (exponent + R::one()) * R::lit(0.5 * FRAC_1_PI) * (exponent * ln_cosine(w)).exp();
    // At the horizon ln cosθ stands for −∞: the density is 0 there unless the lobe is uniform.
    let horizon = w.z.le(R::zero()) & R::zero().lt(exponent);
    R::select(w.z.lt(R::zero()) | horizon, R::zero(), density)
}

/// The u in [0, 1]² that [`cosine_power_hemisphere`] maps to `w`; u₁ = 0 at the pole.
#[inline(always)]
pub fn cosine_power_hemisphere_inverse<R: Real>(w: Vec3<R>, exponent: R) -> [R; 2] {
    let rest = ((exponent + R::one()) * ln_cosine(w)).exp();
    [(R::one() - rest).saturate(), azimuth_inverse(w)]
}

/// ln w.z of a unit w, from x² + y² near the pole, where w.z is rounded to 1; of at least 1e-37.
#[inline(always)]
fn ln_cosine<R: Real>(w: Vec3<R>) -> R {
    // −½ s (1 + s/2 + s²/3 + …) below s = 0.01: the next term is s⁷/8 of it, 2e-15.
    let s = w.x * w.x + w.y * w.y;
    let mut series = R::lit(1.0 / 7.0);
    for k in [6.0, 5.0, 4.0, 3.0, 2.0, 1.0] {
        series = R::lit(1.0 / k) + s * series;
    }
    let series = R::lit(-0.5) * s * series;
    let near = s.lt(R::lit(0.01)) & R::zero().lt(w.z);
    R::select(near, series, w.z.max(R::lit(1e-37)).ln())
}
