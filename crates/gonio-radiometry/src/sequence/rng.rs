//! [`Rng`], a small counter-based generator.

use super::{hash, unit_f32};

/// A uniform generator for tests and plain Monte Carlo: number i of the seed s is a hash of (s, i).
///
/// Period 2⁶⁴; not for cryptography.
///
/// ```
/// use gonio_radiometry::sequence::Rng;
/// let mut rng = Rng::from_name("a test");
/// let mean = (0..10_000).map(|_| rng.next_f64()).sum::<f64>() / 10_000.0;
/// assert!((mean - 0.5).abs() < 0.02);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rng {
    key: u64,
    counter: u64,
}

impl Rng {
    /// The generator of `seed`, at its start. Every seed is valid, and different seeds give independent numbers.
    #[inline]
    pub fn from_seed(seed: u64) -> Self {
        Self {
            key: hash::mix64(seed ^ hash::SALT),
            counter: 0,
        }
    }

    /// The generator whose seed is a hash of `name`: a statistical test names itself instead of choosing a seed.
    pub fn from_name(name: &str) -> Self {
        Self::from_seed(hash::text(name))
    }

    /// The next 64 random bits.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        let i = self.counter;
        self.counter = i.wrapping_add(1);
        hash::mix64(hash::combine(0, i) ^ self.key)
    }

    /// The next 32 random bits.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        (self.next_u64() >> 32) as u32
    }

    /// The next number in [0, 1): a multiple of 2⁻²⁴, at most 1 − 2⁻²⁴.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_f32(self.next_u32())
    }

    /// The next number in [0, 1): a multiple of 2⁻⁵³, at most 1 − 2⁻⁵³.
    #[inline]
    pub fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / 9_007_199_254_740_992.0)
    }
}
