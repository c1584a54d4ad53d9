//! The latitude–longitude panorama: u is longitude, v the angle from the zenith.
//!
//! ```text
//! u = 1/2 + atan2(x, −z) / 2π        v = θ / π,  θ the angle from +y
//! x = sin θ sin φ,  y = cos θ,  z = −sin θ cos φ,  φ = 2π (u − 1/2)
//! ```
//!
//! The centre looks along −z, the left and right edges (the seam) along +z, the top row at the zenith +y.

use gonio_num::{Real, Vec3};

/// The unit direction shown at (u, v).
#[inline(always)]
pub fn direction<R: Real>(uv: [R; 2]) -> Vec3<R> {
    let (sin_phi, cos_phi) = (R::lit(std::f64::consts::TAU) * (uv[0] - R::lit(0.5))).sin_cos();
    let (sin_theta, cos_theta) = (R::pi() * uv[1]).sin_cos();
    Vec3::new(
        sin_theta * sin_phi,
        cos_theta,
        R::zero() - sin_theta * cos_phi,
    )
}

/// Where the unit direction `d` is shown. A pole is at u = 1/2.
///
/// θ comes from atan2(√(x² + z²), y): near a pole acos(y) would lose half of its digits.
#[inline(always)]
pub fn uv<R: Real>(d: Vec3<R>) -> [R; 2] {
    // 0 − z, not −z: at a pole the latter is −0, whose azimuth is π.
    let azimuth = d.x.atan2(R::zero() - d.z);
    let theta = (d.x * d.x + d.z * d.z).sqrt().atan2(d.y);
    [
        R::lit(0.5) + azimuth * R::lit(1.0 / std::f64::consts::TAU),
        theta * R::lit(std::f64::consts::FRAC_1_PI),
    ]
}

/// dω / (du dv) = 2π² sin(πv) \[sr].
#[inline(always)]
pub fn jacobian<R: Real>(uv: [R; 2]) -> R {
    let two_pi2 = R::lit(2.0 * std::f64::consts::PI * std::f64::consts::PI);
    // sin(π) rounds to a negative number in single precision.
    (two_pi2 * (R::pi() * uv[1]).sin()).max(R::zero())
}
