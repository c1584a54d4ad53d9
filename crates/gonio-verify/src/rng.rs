//! Random numbers for the searches and samples, derived from a name.

/// A counter-based generator: draw n is a hash of (seed, n).
///
/// Source: Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators" (the mixing function of SplitMix64).
pub(crate) struct Rng {
    state: u64,
}

impl Rng {
    /// The generator of a name; the same name gives the same numbers everywhere. FNV-1a hash.
    pub(crate) fn from_name(name: &str) -> Self {
        let hash = name.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| {
            (h ^ u64::from(b)).wrapping_mul(0x0000_0100_0000_01b3)
        });
        Self { state: hash }
    }

    /// The next 64 random bits.
    pub(crate) fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1), a multiple of 2⁻⁵³.
    pub(crate) fn next_f64(&mut self) -> f64 {
        (self.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}
