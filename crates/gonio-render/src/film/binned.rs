//! Sums of non-negative numbers whose bits do not depend on the order of the numbers, nor on how they are grouped.
//!
//! Addition of floating-point numbers is not associative: two machines that add the same samples in other groups get other last
//! bits. Here each number is cut into 32-bit digits at fixed powers of two, and the digits of each place are added as integers,
//! which is exact in any order. Kept are only the K places from the highest digit of the largest number down:
//!
//! - `top`: the place of that digit; digit t weighs 2^(32t − 1075), so that the places of all `f64` begin at 0
//! - `bins[i]`: the sum of the digits of place top − i
//!
//! The largest number decides which places are kept, so both are functions of the *set* of numbers: a place that is given up when a
//! larger number comes would be given up as well had that number come first. 2³² numbers fit, since a digit is below 2³².
//!
//! What is cut off is less than 2^(−32(K − 1)) of the largest number, for each number. With K = 2 and n numbers the mean is low by
//! less than 2⁻³² of the largest, while a mean of n samples with one such number has a standard error of about 1/n of it: the cut is
//! invisible. Equal numbers are kept whole, if they have 33 significant bits at most with K = 2, and 65 with K = 3: any `f32`
//! and the square of any `f32`.
//!
//! The idea is that of Demmel & Nguyen 2015, "Parallel reproducible summation", with integers instead of floating-point bins, so
//! that no carry is ever needed.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

/// Adds `value`, finite and not negative.
#[inline]
pub(crate) fn add<const K: usize>(bins: &mut [u64; K], top: &mut u8, value: f64) {
    const { assert!(K <= 3, "a number has three digits") };
    debug_assert!(value >= 0.0 && value.is_finite());
    let bits = value.to_bits();
    let exponent = (bits >> 52) as u32;
    if exponent == 0 {
        return;
    }
    let mantissa = (bits & ((1 << 52) - 1)) | 1 << 52;
    raise(bins, top, place(value));
    // By how much the number's unit is above that of the lowest digit that is kept: 12 at most with K = 2 and 43 with K = 3, as the number
    // has no digit above the top.
    let above = exponent as i32 - 32 * (i32::from(*top) - (K as i32 - 1));
    let digits = if above < 0 {
        u128::from(mantissa >> above.unsigned_abs().min(63))
    } else {
        u128::from(mantissa) << above
    };
    for (i, bin) in bins.iter_mut().rev().enumerate() {
        *bin += u64::from((digits >> (32 * i)) as u32);
    }
}

/// The place of a number's highest digit: at most (2046 + 52) / 32 = 65. 0 for 0, and for denormal numbers, which are no `f32`s and no squares
/// of them.
#[inline(always)]
pub(crate) fn place(value: f64) -> u8 {
    match value.to_bits() >> 52 {
        0 => 0,
        exponent => ((exponent + 52) / 32) as u8,
    }
}

/// Whether any of the numbers has a digit above its sum's highest.
#[inline(always)]
pub(crate) fn are_above<const N: usize>(tops: &[u8; N], values: &[f64; N]) -> bool {
    let mut above = 0;
    for i in 0..N {
        above |= u8::from(place(values[i]) > tops[i]);
    }
    above != 0
}

/// [`add`] to many sums of three digits side by side, without a branch: `digits[k][i]` is digit k of sum i.
///
/// No number has a digit above its sum's highest ([`are_above`]).
#[inline(always)]
pub(crate) fn add_all<const N: usize>(
    digits: &mut [[u64; N]; 3],
    tops: &[u8; N],
    values: &[f64; N],
) {
    for i in 0..N {
        let bits = values[i].to_bits();
        let exponent = bits >> 52;
        let mantissa = (bits & ((1 << 52) - 1)) | 1 << 52;
        let mantissa = if exponent == 0 { 0 } else { mantissa };
        for k in 0..3 {
            // By how much the number's unit is above that of digit k; as an unsigned number it is large if it is below.
            let above = (exponent + 32 * k as u64).wrapping_sub(32 * u64::from(tops[i]));
            let below = above.wrapping_neg();
            let raised = if above < 64 { mantissa << above } else { 0 };
            let lowered = if below < 64 { mantissa >> below } else { 0 };
            digits[k][i] += (raised | lowered) & u64::from(u32::MAX);
        }
    }
}

/// Adds another sum.
pub(crate) fn merge<const K: usize>(
    bins: &mut [u64; K],
    top: &mut u8,
    (others, others_top): (&[u64; K], u8),
) {
    raise(bins, top, others_top);
    let below = usize::from(*top - others_top);
    for (bin, other) in bins.iter_mut().skip(below).zip(others) {
        *bin += other;
    }
}

/// The sum.
#[inline]
pub(crate) fn value<const K: usize>(bins: &[u64; K], top: u8) -> f64 {
    let mut sum = 0.0;
    for (i, bin) in bins.iter().enumerate().rev() {
        // At least LEAST_TOP − 2 digits up: no power below the normal ones.
        let exponent = 32 * (i64::from(top) - i as i64) - 1075;
        if *bin > 0 {
            sum += *bin as f64 * f64::from_bits(((exponent + 1023) as u64) << 52);
        }
    }
    sum
}

/// The places that the highest digits of `f32`s and their squares have: from (2⁻¹⁴⁹)² up to (2¹²⁸)².
pub(crate) const TOPS: std::ops::RangeInclusive<u8> = 24..=41;

/// Whether a sum read from a file can be one of at most `count` numbers.
pub(crate) fn is_sound<const K: usize>(bins: &[u64; K], top: u8, count: u32) -> bool {
    let most = u64::from(count) * u64::from(u32::MAX);
    match top {
        0 => bins.iter().all(|bin| *bin == 0),
        _ => TOPS.contains(&top) && bins[0] > 0 && bins.iter().all(|bin| *bin <= most),
    }
}

/// Makes `place` the highest, if it is higher than `top`.
#[inline]
pub(crate) fn raise<const K: usize>(bins: &mut [u64; K], top: &mut u8, place: u8) {
    if place <= *top {
        return;
    }
    let by = usize::from(place - *top);
    for i in (0..K).rev() {
        bins[i] = if i >= by { bins[i - by] } else { 0 };
    }
    *top = place;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum<const K: usize>(values: &[f64]) -> ([u64; K], u8) {
        let (mut bins, mut top) = ([0; K], 0);
        for v in values {
            add(&mut bins, &mut top, *v);
        }
        (bins, top)
    }

    fn any_f32() -> impl Strategy<Value = f64> {
        // Every exponent as often: denormal numbers, and those near the largest.
        (0_u32..0x7f80_0000).prop_map(|bits| f64::from(f32::from_bits(bits)))
    }

    proptest! {
        #[test]
        fn the_order_and_the_grouping_do_not_matter(
            values in prop::collection::vec(any_f32(), 0..40),
            cut in 0_usize..40,
            squared in any::<bool>(),
        ) {
            let values: Vec<f64> = values.iter().map(|v| if squared { v * v } else { *v }).collect();
            let (whole, top) = sum::<3>(&values);
            let reversed: Vec<f64> = values.iter().rev().copied().collect();
            prop_assert_eq!(sum::<3>(&reversed), (whole, top));
            let (a, b) = values.split_at(cut.min(values.len()));
            for (first, second) in [(a, b), (b, a)] {
                let (mut bins, mut joint) = sum::<3>(first);
                let (others, others_top) = sum::<3>(second);
                merge(&mut bins, &mut joint, (&others, others_top));
                prop_assert_eq!((bins, joint), (whole, top));
            }
            prop_assert!(is_sound(&whole, top, values.len() as u32));
        }

        #[test]
        fn sums_side_by_side_are_those_one_by_one(
            values in prop::collection::vec([any_f32(), any_f32(), any_f32()], 1..20),
        ) {
            let some_zero = |(k, [a, b, c]): (usize, [f64; 3])| [a, b, if k % 2 == 0 { 0.0 } else { c }];
            let values: Vec<[f64; 3]> = values.into_iter().enumerate().map(some_zero).collect();
            let mut digits = [[0; 3]; 3];
            let mut tops = [0; 3];
            for values in &values {
                if are_above(&tops, values) {
                    for i in 0..3 {
                        let mut one = [0, 1, 2].map(|k: usize| digits[k][i]);
                        raise(&mut one, &mut tops[i], place(values[i]));
                        (0..3).for_each(|k| digits[k][i] = one[k]);
                    }
                }
                add_all(&mut digits, &tops, values);
            }
            for i in 0..3 {
                let column: Vec<f64> = values.iter().map(|v| v[i]).collect();
                let found = [0, 1, 2].map(|k: usize| digits[k][i]);
                prop_assert_eq!((found, tops[i]), sum::<3>(&column));
                // Two digits are the first two of three.
                prop_assert_eq!((found[..2].to_vec(), tops[i]), { let (two, top) = sum::<2>(&column); (two.to_vec(), top) });
            }
        }

        #[test]
        fn the_cut_is_as_small_as_said(values in prop::collection::vec(any_f32(), 1..40)) {
            // The same by integers of 2⁻¹⁴⁹, as far as they go.
            let values: Vec<f64> = values.into_iter().filter(|v| *v < 1e-10).collect();
            let unit = 2.0_f64.powi(-149);
            let exact: u128 = values.iter().map(|v| (v / unit) as u128).sum();
            let largest = values.iter().copied().fold(0.0, f64::max);
            let (bins, top) = sum::<2>(&values);
            let found = value(&bins, top);
            let exact = exact as f64 * unit;
            // What is cut, and three roundings to 53 bits: of the exact sum, of a bin, of the sum of the two.
            let allowed = values.len() as f64 * 2.0_f64.powi(-32) * largest + 3.0 * 2.0_f64.powi(-53) * exact;
            prop_assert!(found <= exact * (1.0 + f64::EPSILON) && exact - found <= allowed, "{} {}", found, exact);
        }
    }

    #[test]
    fn equal_numbers_are_summed_exactly() {
        for v in [0.3_f32, 1.0, 1e-45, f32::MAX, 1.000_000_1] {
            let (l, square) = (f64::from(v), f64::from(v) * f64::from(v));
            let (bins, top) = sum::<2>(&[l; 7]);
            assert_eq!(value(&bins, top), 7.0 * l);
            let (bins, top) = sum::<3>(&[square; 8]);
            assert_eq!(value(&bins, top), 8.0 * square);
        }
        assert_eq!(value(&[0; 2], 0), 0.0);
    }

    /// The negative control: plain addition depends on the order.
    #[test]
    fn plain_addition_is_not_enough() {
        let values = [1e8, 0.1, 0.3, -0.0, 1e-9];
        let forward: f64 = values.iter().sum();
        let backward: f64 = values.iter().rev().sum();
        assert_ne!(forward, backward);
    }
}
