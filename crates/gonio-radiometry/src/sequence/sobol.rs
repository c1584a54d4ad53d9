//! Owen-scrambled Sobol' points in three dimensions, each set shuffled and scrambled by a key of its own.
//!
//! Sobol' points of more dimensions pair badly: some of their two-dimensional projections need thousands of points
//! before they are even. So a set has at most three dimensions, and sets are padded: the order of the points of each is
//! shuffled independently, by a permutation that keeps every aligned block of 2ᵏ points together, and with it the net.
//!
//! Sources: Sobol' 1967; Owen 1995, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences"; the scramble as a hash: Laine
//! and Karras 2011, "Stratified Sampling for Stochastic Transparency"; shuffled and padded: Burley 2020, "Practical
//! Hash-based Owen Scrambling".

use super::hash;

/// Dimensions of a set.
pub(super) const DIMENSIONS: usize = 3;

/// The first `D` coordinates of a point, as 32-bit fractions.
///
/// - `reversed_index`: the point's index with its bits reversed
/// - `key`: names the set; its shuffle and scrambles derive from it
#[inline(always)]
pub(super) fn scrambled<const D: usize>(reversed_index: u32, key: u64) -> [u32; D] {
    // A nested scramble of the index's bits, most significant first, permutes indices within every aligned block.
    let index = scramble_reversed(reversed_index, key as u32).reverse_bits();
    let mut out = [0; D];
    if D > 0 {
        out[0] = scramble_reversed(index, (key >> 32) as u32).reverse_bits();
    }
    if D > 1 {
        let more = hash::combine(key, 0);
        out[1] = scramble_reversed(second_reversed(index), more as u32).reverse_bits();
        if D > 2 {
            out[2] = scramble_reversed(third_reversed(index), (more >> 32) as u32).reverse_bits();
        }
    }
    out
}

/// Nested uniform (Owen) scramble of a fraction whose bits are reversed: each bit is flipped by a hash of `seed` and of
/// the bits below it, which are the fraction's more significant bits.
///
/// Multiplying by an even number and xoring, adding, and multiplying by an odd number: each only carries upward.
/// Source: the construction is Laine and Karras 2011, section 3.1; constants of Vegdahl 2021, "Building a Better LK Hash".
#[inline(always)]
fn scramble_reversed(x: u32, seed: u32) -> u32 {
    let mut x = x;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^ x.wrapping_mul(0x53a2_2864)
}

/// Coordinate 2 of the Sobol' point `index`, its bits reversed. (Coordinate 1, reversed, is the index itself.)
///
/// The generator matrix is Pascal's triangle modulo 2: digit j is the sum of the index's bits i with binomial(i, j) odd,
/// which by Lucas's theorem are the i whose bits include those of j. A sum over supersets takes one step a bit of j.
#[inline(always)]
fn second_reversed(index: u32) -> u32 {
    let mut v = index;
    v ^= (v >> 1) & 0x5555_5555;
    v ^= (v >> 2) & 0x3333_3333;
    v ^= (v >> 4) & 0x0f0f_0f0f;
    v ^= (v >> 8) & 0x00ff_00ff;
    v ^ (v >> 16)
}

/// Coordinate 3 of the Sobol' point `index`, its bits reversed.
#[inline(always)]
fn third_reversed(index: u32) -> u32 {
    let mut v = 0;
    let mut rest = index;
    for table in &THIRD {
        v ^= table[(rest & 15) as usize];
        rest >>= 4;
    }
    v
}

/// [`third_reversed`] of each value of each group of four bits.
static THIRD: [[u32; 16]; 8] = third_tables();

/// Columns of coordinate 3: the primitive polynomial x² + x + 1 with initial numbers 1, 3, whose recurrence is
/// m(k) = 2 m(k−1) ⊕ 4 m(k−2) ⊕ m(k−2), and v(k) = m(k) / 2ᵏ. Source: Joe and Kuo 2008, table of direction numbers.
const fn third_tables() -> [[u32; 16]; 8] {
    let mut m = [0u64; 32];
    m[0] = 1;
    m[1] = 3;
    let mut k = 2;
    while k < 32 {
        m[k] = (m[k - 1] << 1) ^ (m[k - 2] << 2) ^ m[k - 2];
        k += 1;
    }
    let mut tables = [[0; 16]; 8];
    let mut bit = 0;
    while bit < 32 {
        let column = ((m[bit] << (31 - bit)) as u32).reverse_bits();
        let mut value = 0;
        while value < 16 {
            if value >> (bit % 4) & 1 == 1 {
                tables[bit / 4][value] ^= column;
            }
            value += 1;
        }
        bit += 1;
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The first points of the unscrambled sequence, by hand from the direction numbers (times 8).
    #[test]
    fn the_first_points_are_sobols() {
        let eighths = |reversed: u32| reversed.reverse_bits() >> 29;
        let first: Vec<u32> = (0..8).map(eighths).collect();
        let second: Vec<u32> = (0..8).map(|i| eighths(second_reversed(i))).collect();
        let third: Vec<u32> = (0..8).map(|i| eighths(third_reversed(i))).collect();
        assert_eq!(first, [0, 4, 2, 6, 1, 5, 3, 7]);
        // m = 1, 3, 5 gives the columns 1/2, 3/4, 5/8; m = 1, 3, 3 gives 1/2, 3/4, 3/8.
        assert_eq!(second, [0, 4, 6, 2, 5, 1, 3, 7]);
        assert_eq!(third, [0, 4, 6, 2, 3, 7, 5, 1]);
    }

    /// A nested scramble keeps the order of the tree: two fractions that share their first k digits still share exactly k.
    #[test]
    fn scrambling_keeps_common_prefixes() {
        for seed in [0, 1, 0xdead_beef, u32::MAX] {
            for (a, b) in [(5u32, 13u32), (0, 1), (0x1234_5678, 0x9234_5678), (7, 6)] {
                let before = (a ^ b).trailing_zeros();
                let after =
                    (scramble_reversed(a, seed) ^ scramble_reversed(b, seed)).trailing_zeros();
                assert_eq!(before, after);
            }
        }
    }
}
