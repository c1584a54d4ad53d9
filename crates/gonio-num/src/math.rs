//! Single-precision elementary functions with the same bits on every processor.
//!
//! Each function is a straight line of additions, multiplications, comparisons with selection, and integer operations on
//! the bit pattern: no branch, no table, no fused operation, no call of the platform. So a compiler may run it on one
//! number or on sixteen lanes at once and the bits stay the same; [`Lanes`](crate::lanes::Lanes) runs these very
//! functions lane by lane.
//!
//! The method is the usual one: reduce the argument to a short interval with constants split so that the products
//! are exact (Cody & Waite 1980, "Software Manual for the Elementary Functions"), then evaluate a polynomial. Each polynomial
//! keeps the first terms of the Taylor series exactly and multiplies the rest, whose coefficients minimise the largest
//! relative error of the whole: found by Lawson's iteratively reweighted least squares (1961) on 1500 Chebyshev nodes, from
//! 40-digit values, and then rounded to `f32`. The rounding to `f32` of the coefficients is part of the errors stated.
//!
//! Errors are stated in units in the last place (ulp) of the exact result, the largest found against double precision
//! over at least every eighth `f32` of the range (60 million points for `atan2`). A correctly rounded function has 0.5.
//!
//! The sign and payload of a NaN differ between processors; whether a result is NaN does not.

/// 1.5 · 2²³: adding and subtracting it rounds |x| < 2²² to the nearest whole number, which then also stands in
/// the low bits of the sum's pattern.
const ROUND: f32 = 12_582_912.0;

/// π/2 in two parts: the nearest `f32`, and what it misses.
const FRAC_PI_2: (f32, f32) = (std::f32::consts::FRAC_PI_2, -4.371_139e-8);
/// π in two parts.
const PI: (f32, f32) = (std::f32::consts::PI, -8.742_278e-8);

/// ln 2 in two parts; the first has 15 bits, so its product with an exponent is exact.
const LN_2: (f32, f32) = (0.693_145_75, 1.428_606_8e-6);

/// `a` where `mask`, else `b`, both evaluated: the one form of choice used here.
#[inline(always)]
fn select(mask: bool, a: f32, b: f32) -> f32 {
    if mask { a } else { b }
}

/// The largest whole number ≤ `x`, exactly; NaN and infinities stay themselves, −0 stays −0.
#[inline(always)]
pub fn floor(x: f32) -> f32 {
    const WHOLE: f32 = 8_388_608.0; // 2²³: from here on every f32 is a whole number
    let magnitude = x.abs();
    let nearest = ((magnitude + WHOLE) - WHOLE).copysign(x);
    let below = nearest - select(nearest > x, 1.0, 0.0);
    select(magnitude < WHOLE, below, x)
}

/// eˣ. Largest error 0.98 ulp; for subnormal results half the smallest subnormal more.
///
/// exp(−∞) = 0, exp(∞) = ∞, NaN stays NaN; above 88.7228 the result is ∞, below −103.98 it is 0.
#[inline(always)]
pub fn exp(x: f32) -> f32 {
    // Written so that NaN, for which comparisons are false, passes.
    let x = select(x < -104.0, -104.0, x);
    let x = select(x > 89.0, 89.0, x);
    let rounded = x * std::f32::consts::LOG2_E + ROUND;
    let n = rounded - ROUND;
    let r = (x - n * LN_2.0) - n * LN_2.1;
    let q = ((((1.381_454e-3 * r + 8.368_745e-3) * r + 4.166_839e-2) * r + 1.666_652_1e-1) * r)
        + 4.999_999_4e-1;
    let e = 1.0 + (r + (r * r) * q);
    // 2ⁿ in two factors, so that subnormal results and overflow come out rounded once.
    let n = (rounded.to_bits() as i32).wrapping_sub(ROUND.to_bits() as i32);
    let half = n >> 1;
    e * power_of_two(half) * power_of_two(n.wrapping_sub(half))
}

/// 2ⁿ for −126 ≤ n ≤ 127.
#[inline(always)]
fn power_of_two(n: i32) -> f32 {
    f32::from_bits((n.wrapping_add(127) as u32) << 23)
}

/// Natural logarithm. Largest error 0.84 ulp.
///
/// ln(±0) = −∞, ln(∞) = ∞; NaN below 0 and for NaN.
#[inline(always)]
pub fn ln(x: f32) -> f32 {
    const SQRT_HALF: i32 = 0x3f35_04f3; // the bits of √½
    let subnormal = x < f32::MIN_POSITIVE;
    let bits = select(subnormal, x * 8_388_608.0, x).to_bits() as i32;
    // x = m · 2ᵏ with m in [√½, √2).
    let k = bits.wrapping_sub(SQRT_HALF) >> 23;
    let m = f32::from_bits(bits.wrapping_sub(k.wrapping_shl(23)) as u32);
    let k = k as f32 - select(subnormal, 23.0, 0.0);
    let f = m - 1.0;
    let z = f * f;
    let p = ((((((-7.634_497_4e-2 * f + 1.276_157_8e-1) * f - 1.316_018_3e-1) * f
        + 1.420_175_7e-1)
        * f
        - 1.662_335_7e-1)
        * f
        + 2.000_122_7e-1)
        * f
        - 2.500_082e-1)
        * f
        + 3.333_333e-1;
    let tail = ((f * z) * p + k * LN_2.1) - 0.5 * z;
    let y = (f + tail) + k * LN_2.0;
    let y = select(x > 0.0, y, f32::NEG_INFINITY);
    let y = select(x < 0.0, f32::NAN, y);
    select(x < f32::INFINITY, y, x)
}

/// Quarter turns to the nearest multiple of π/2 (modulo 2²²), and the angle left, in [−π/4, π/4].
#[inline(always)]
fn quarter_turns(x: f32) -> (u32, f32) {
    // The first three parts of π/2 have 11 bits: their products with up to 13 bits of quarter turns are exact.
    const PARTS: [f32; 4] = [1.570_312_5, 4.837_513e-4, 7.549_533_6e-8, 2.563_344e-12];
    let rounded = x * std::f32::consts::FRAC_2_PI + ROUND;
    let n = rounded - ROUND;
    let r = ((x - n * PARTS[0]) - n * PARTS[1]) - n * PARTS[2] - n * PARTS[3];
    // Far outside the documented range the reduction is wrong; the result stays in [−1, 1] all the same.
    let r = select(r < -0.79, -0.79, r);
    let r = select(r > 0.79, 0.79, r);
    (rounded.to_bits(), r)
}

/// sin(r + turns · π/2).
#[inline(always)]
fn sin_of_quarter(turns: u32, r: f32) -> f32 {
    let z = r * r;
    let s = (-1.951_495_8e-4 * z + 8.332_158e-3) * z - 1.666_665_5e-1;
    let sin = r + (r * z) * s;
    let c = (2.443_278_6e-5 * z - 1.388_731_3e-3) * z + 4.166_664_6e-2;
    let cos = (1.0 - 0.5 * z) + (z * z) * c;
    let value = select(turns & 1 == 1, cos, sin);
    f32::from_bits(value.to_bits() ^ ((turns & 2) << 30))
}

/// Sine of an angle in radians. Largest error 2.32 ulp for |x| ≤ 8192.
///
/// Farther out the error grows with |x|, and past 4·10⁶ the result is only known to lie in [−1, 1]. NaN for ±∞ and NaN.
#[inline(always)]
pub fn sin(x: f32) -> f32 {
    let (turns, r) = quarter_turns(x);
    sin_of_quarter(turns, r)
}

/// Cosine of an angle in radians. Largest error 2.32 ulp for |x| ≤ 8192; beyond as [`sin`].
#[inline(always)]
pub fn cos(x: f32) -> f32 {
    let (turns, r) = quarter_turns(x);
    sin_of_quarter(turns.wrapping_add(1), r)
}

/// Angle in [0, π] whose cosine is `x`. Largest error 1.14 ulp.
///
/// `x` is clamped to [−1, 1]; NaN stays NaN.
#[inline(always)]
pub fn acos(x: f32) -> f32 {
    let a = x.abs();
    let a = select(a > 1.0, 1.0, a);
    let steep = a > 0.5;
    // acos a = 2 asin √((1 − a)/2), where 1 − a is exact.
    let z = select(steep, 0.5 * (1.0 - a), a * a);
    let s = select(steep, z.sqrt(), a);
    let p = (((4.216_630_4e-2 * z + 2.417_951_6e-2) * z + 4.547_037_6e-2) * z + 7.495_297_5e-2) * z
        + 1.666_675_2e-1;
    let asin = s + (s * z) * p;
    let negative = x < 0.0;
    let flat = {
        let signed = select(negative, -asin, asin);
        FRAC_PI_2.0 - (signed - FRAC_PI_2.1)
    };
    let twice = 2.0 * asin;
    let steep_value = select(negative, PI.0 - (twice - PI.1), twice);
    select(steep, steep_value, flat)
}

/// Angle of the point (x, y) in [−π, π]. Largest error 1.58 ulp.
///
/// 0 at the origin, whatever the sign of `x`. The result has the sign of `y`, that of −0 too:
/// atan2(−0, −1) = −π. Infinities are taken as limits along the diagonal: atan2(∞, ∞) = π/4. NaN if either is NaN.
#[inline(always)]
pub fn atan2(y: f32, x: f32) -> f32 {
    let (a, b) = (y.abs(), x.abs());
    let flat = a < b;
    let low = select(flat, a, b);
    let high = select(flat, b, a);
    let q = select(low == high, 1.0, low / high);
    let q = select(high == 0.0, 0.0, q);
    let z = q * q;
    let p = (((((((-1.793_622_3e-3 * z + 1.091_460_9e-2) * z - 3.117_785_2e-2) * z
        + 5.795_76e-2)
        * z
        - 8.403_451e-2)
        * z
        + 1.095_218_6e-1)
        * z
        - 1.426_424_3e-1)
        * z
        + 1.999_854_9e-1)
        * z
        - 3.333_33e-1;
    let atan = q + (q * z) * p;
    // One of: atan, π/2 − atan, π/2 + atan, π − atan.
    let (steep, left) = (a > b, x < 0.0);
    let signed = select(steep != left, -atan, atan);
    let high = select(steep, FRAC_PI_2.0, select(left, PI.0, 0.0));
    let low = select(steep, FRAC_PI_2.1, select(left, PI.1, 0.0));
    (high + (signed + low)).copysign(y)
}
