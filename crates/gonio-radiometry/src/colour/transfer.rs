//! The transfer function of sRGB.

use gonio_num::Real;

/// Linear light to the encoded value of sRGB.
///
/// 12.92 c for c ≤ 0.003 130 8, else 1.055 c^(1/2.4) − 0.055. Odd: below 0 it is −encode(−c), and it goes on beyond 1.
///
/// Source: IEC 61966-2-1.
#[inline(always)]
pub fn srgb_encode<R: Real>(linear: R) -> R {
    let a = linear.abs();
    let curve = R::lit(1.055) * a.max(R::lit(1e-6)).powf(R::lit(1.0 / 2.4)) - R::lit(0.055);
    R::select(a.le(R::lit(0.003_130_8)), a * R::lit(12.92), curve).copysign(linear)
}

/// The encoded value of sRGB to linear light: the inverse of [`srgb_encode`].
///
/// e / 12.92 for e ≤ 0.040 45, else ((e + 0.055)/1.055)^2.4. Odd, as [`srgb_encode`].
///
/// The two pieces of the standard meet to 4 × 10⁻⁸ only: a value between the two thresholds returns to within that.
#[inline(always)]
pub fn srgb_decode<R: Real>(encoded: R) -> R {
    let a = encoded.abs();
    let curve = ((a + R::lit(0.055)) * R::lit(1.0 / 1.055)).powf(R::lit(2.4));
    R::select(a.le(R::lit(0.040_45)), a * R::lit(1.0 / 12.92), curve).copysign(encoded)
}
