//! D = 1 / (π αx αy e²), e = (h.x/αx)² + (h.y/αy)² + h.z².
//!
//! Source: Trowbridge & Reitz 1975; Walter et al. 2007, eq. 33; Burley 2012 for two slope scales.

use super::{Distribution, rest, slopes};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::FRAC_1_PI;

#[inline(always)]
pub(super) fn density<R: Real>(d: &Distribution<R>, h: Vec3<R>) -> R {
    let (ax, ay) = (d.alpha_x, d.alpha_y);
    // With s = αx αy and q = s² e: s³/(π q²), one division. e ≥ 1 for unit h, as no α is above 1.
    let s = ax * ay;
    let q = (h.x * ay).sq() + (h.y * ax).sq() + (h.z * s).sq();
    let q = q.max(R::lit(0.5) * s * s);
    R::lit(FRAC_1_PI) * (s * s * s) / (q * q)
}

/// D of the direction of `sum`, whose square is `length2`.
#[inline(always)]
pub(super) fn density_along<R: Real>(d: &Distribution<R>, sum: Vec3<R>, length2: R) -> R {
    let (ax, ay) = (d.alpha_x, d.alpha_y);
    // With s = αx αy and q = s² e |sum|²: s (s |sum|²/q)²/π, one division.
    let s = ax * ay;
    let q = (sum.x * ay).sq() + (sum.y * ax).sq() + (sum.z * s).sq();
    let q = q.max(R::lit(0.5) * s * s * length2).max(R::lit(1e-37));
    let t = s * length2 / q;
    R::lit(FRAC_1_PI) * s * t * t
}

/// Slopes of length √(u1/(1 − u1)), stretched.
#[inline(always)]
pub(super) fn sample<R: Real>(d: &Distribution<R>, u0: R, u1: R) -> Vec3<R> {
    slopes(d, (u1 / rest(u1)).safe_sqrt(), u0)
}

/// In the frame stretched by (αx, αy) the distribution is a hemisphere, and its reflections of w are a spherical cap.
///
/// Source: Dupuy & Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps", listing 3.
#[inline(always)]
pub(super) fn sample_visible<R: Real>(d: &Distribution<R>, w: Vec3<R>, u0: R, u1: R) -> Vec3<R> {
    let (ax, ay) = (d.alpha_x, d.alpha_y);
    let std = Vec3::new(ax * w.x, ay * w.y, w.z).normalize();
    let z = (R::one() - u1) * (R::one() + std.z) - std.z;
    let sin = (R::one() - z * z).safe_sqrt();
    let h = around_axis(u0, sin, z) + std;
    let n = Vec3::new(ax * h.x, ay * h.y, h.z.max(R::zero()));
    // Only a grazing w at the cap's rim gives a zero vector; the normal then is +z.
    let length2 = n.length_squared();
    let bad = length2.lt(R::lit(1e-30));
    let up = Vec3::new(R::zero(), R::zero(), R::one());
    let unit = n * length2.max(R::lit(1e-30)).sqrt().recip();
    Vec3::select(bad, up, unit)
}
