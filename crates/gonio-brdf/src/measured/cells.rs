//! Where a direction lies among a table's cells.

use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// (θh, θd, φd) with φd in [0, π).
pub(super) fn half_difference(wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3] {
    let (sum, difference) = (wi + wo, wi - wo);
    let length = sum.length().max(1e-15);
    let h = sum * (1.0 / length);
    let sin_h = (h.x * h.x + h.y * h.y).sqrt();
    let (cos_phi, sin_phi) = if sin_h > 1e-12 {
        (h.x / sin_h, h.y / sin_h)
    } else {
        (1.0, 0.0)
    };
    // wi in the frame whose z axis is h and whose x axis lies in the plane of h and the normal.
    let x = h.z * (cos_phi * wi.x + sin_phi * wi.y) - sin_h * wi.z;
    let y = cos_phi * wi.y - sin_phi * wi.x;
    let phi = Real::atan2(y, x);
    let phi = if phi < 0.0 { phi + PI } else { phi };
    [
        Real::atan2(sin_h, h.z),
        Real::atan2(difference.length(), length),
        if phi >= PI { 0.0 } else { phi },
    ]
}

/// θ in [0, π/2] of a direction above the horizon.
pub(super) fn theta(w: Vec3<f64>) -> f64 {
    Real::acos(w.z)
}

/// φ/2π in [0, 1).
pub(super) fn turn(w: Vec3<f64>) -> f64 {
    let t = Real::atan2(w.y, w.x) / TAU;
    if t < 0.0 { t + 1.0 } else { t }
}

/// Rec.709 luminance.
pub(super) fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// The cell that x in [0, 1] lies in.
pub(super) fn nearest(x: f64, n: usize) -> usize {
    ((x * n as f64) as usize).min(n - 1)
}

/// The centres around x in [0, 1] and the weight of the upper one; constant beyond the outermost.
pub(super) fn clamped(x: f64, n: usize) -> (usize, usize, f64) {
    let f = (x * n as f64 - 0.5).clamp(0.0, (n - 1) as f64);
    let low = f as usize;
    (low, (low + 1).min(n - 1), f - low as f64)
}

/// The centres around x in [0, 1) of an axis that closes on itself.
pub(super) fn periodic(x: f64, n: usize) -> (usize, usize, f64) {
    let f = x * n as f64 + n as f64 - 0.5;
    let low = f as usize;
    (low % n, (low + 1) % n, f - low as f64)
}

/// Cosines of θh at the inner and outer edge of ring `k`.
pub(super) fn ring_cosines(k: usize, n: usize) -> (f64, f64) {
    let edge = |k: usize| {
        let s = k as f64 / n as f64;
        if k == n {
            0.0
        } else {
            Real::cos(s * s * FRAC_PI_2)
        }
    };
    (edge(k), edge(k + 1))
}

/// Cosines of θ at the upper and lower edge of row `k` of n equal steps.
pub(super) fn row_cosines(k: usize, n: usize) -> (f64, f64) {
    let edge = |k: usize| {
        if k == n {
            0.0
        } else {
            Real::cos(k as f64 / n as f64 * FRAC_PI_2)
        }
    };
    (edge(k), edge(k + 1))
}

/// Solid angle of a cell of equal steps in θ and φ.
pub(super) fn cell_solid_angle(row: usize, rows: usize, columns: usize) -> f64 {
    let (low, high) = row_cosines(row, rows);
    TAU * (low - high) / columns as f64
}
