//! The hashes that keys and scrambles are made from.

/// The fractional bits of the golden ratio: the odd constant whose multiples are spread most evenly.
pub(super) const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// Keeps the seed 0 away from the fixed point 0 of [`mix64`]: the fractional bits of √2.
pub(super) const SALT: u64 = 0x6a09_e667_f3bc_c908;

/// A bijection of 64 bits where each bit of the result depends on every bit of `x`; 0 stays 0.
///
/// Source: the finaliser of SplitMix64: Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators",
/// with Stafford's constants (variant 13).
#[inline(always)]
pub(super) fn mix64(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A new key from `key` and a further coordinate `x`; for a fixed key a bijection of `x`.
#[inline(always)]
pub(super) fn combine(key: u64, x: u64) -> u64 {
    mix64(key.wrapping_add(x.wrapping_add(1).wrapping_mul(GOLDEN)))
}

/// 64-bit hash of a text, FNV-1a.
pub(super) fn text(s: &str) -> u64 {
    s.bytes().fold(0xcbf2_9ce4_8422_2325, |h, b| {
        (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
