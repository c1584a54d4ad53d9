//! Sample sequences: the numbers in [0, 1) that Monte Carlo estimates are made of.
//!
//! A value is a function of (seed, pixel, sample, dimension) alone. So an estimate has the same bits for any order of
//! evaluation, any number of threads, and any split of the samples among machines.
//!
//! [`SampleStream`] walks the dimensions of one sample. [`Rng`] is a plain generator for tests and for Monte Carlo where
//! no stratification is wanted.

mod hash;
mod rng;
mod sobol;
mod streams;

pub use rng::Rng;
pub use streams::SampleStreams;

/// How the samples of a pixel relate to each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum SamplerKind {
    /// Independent, uniform numbers from a counter-based hash.
    Independent,
    /// Sobol' points with Owen scrambling, padded: each draw of one, two or three numbers is a set of its own, well
    /// stratified over the samples of its pixel, and independent of every other draw and pixel.
    #[default]
    Sobol,
}

/// The numbers of sample `sample` of pixel `pixel` under `seed`, dimension after dimension.
///
/// Each draw takes as many dimensions as it returns numbers. Under [`SamplerKind::Sobol`], over the samples 0 … 2ᵏ − 1
/// (and over every later aligned block of 2ᵏ samples):
/// - [`next_1d`](Self::next_1d) has one value in each of 2ᵏ equal intervals;
/// - [`next_2d`](Self::next_2d) is a (0, k, 2)-net: one point in each elementary interval of area 2⁻ᵏ;
/// - [`next_3d`](Self::next_3d) is a (1, k, 3)-net, and its first two coordinates are a (0, k, 2)-net.
///
/// What stands at a dimension therefore depends on how it is drawn: `next_2d` at dimension d isn't two `next_1d` (its first
/// number is that of `next_1d` at d, its second has no other name). Two programs that draw in the same order see the
/// same numbers.
///
/// Values are multiples of 2⁻²⁴ in [0, 1 − 2⁻²⁴].
///
/// ```
/// use gonio_radiometry::sequence::{SampleStream, SamplerKind};
/// let mut stream = SampleStream::new(SamplerKind::Sobol, 7, 1234, 0);
/// let film = stream.next_2d();
/// let choice = stream.next_1d();
/// assert!(film[0] < 1.0 && film[1] < 1.0 && choice < 1.0);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampleStream {
    kind: SamplerKind,
    /// Hash of (seed, pixel), and of the sample too if the kind is independent.
    key: u64,
    /// The sample's index with its bits reversed.
    reversed_index: u32,
    dimension: u32,
}

impl SampleStream {
    /// The stream of sample `sample` of pixel `pixel` under `seed`, at dimension 0. Every value of every argument is valid.
    #[inline]
    pub fn new(kind: SamplerKind, seed: u64, pixel: u32, sample: u32) -> Self {
        let pixel_key = hash::combine(hash::mix64(seed ^ hash::SALT), pixel.into());
        let key = match kind {
            SamplerKind::Independent => hash::combine(pixel_key, sample.into()),
            SamplerKind::Sobol => pixel_key,
        };
        Self {
            kind,
            key,
            reversed_index: sample.reverse_bits(),
            dimension: 0,
        }
    }

    /// The dimension that the next draw starts at.
    #[inline]
    pub fn dimension(&self) -> u32 {
        self.dimension
    }

    /// Goes to `dimension`: the next draw starts there. Past 2³² − 1 dimensions wrap around to 0.
    #[inline]
    pub fn seek(&mut self, dimension: u32) {
        self.dimension = dimension;
    }

    /// Part `which` of `count` that this sample splits into, at the same dimension: a stream of its own for each.
    ///
    /// Parts of the samples 0, 1, 2, … are the samples `count` times as many of one sequence: under [`SamplerKind::Sobol`] they are stratified
    /// over the samples as well as within each, if `count` is a power of two. The only part of one is the sample itself.
    ///
    /// ```
    /// use gonio_radiometry::sequence::{SampleStream, SamplerKind};
    /// let sample = |k| SampleStream::new(SamplerKind::Sobol, 7, 1234, k);
    /// assert_eq!(sample(5).split(4, 3), sample(23));
    /// ```
    #[inline]
    #[must_use]
    pub fn split(&self, count: u32, which: u32) -> Self {
        let (key, reversed_index) = split(
            self.kind,
            (self.key, self.reversed_index),
            count.max(1),
            which,
        );
        Self {
            key,
            reversed_index,
            ..*self
        }
    }

    /// One number in [0, 1).
    #[inline]
    pub fn next_1d(&mut self) -> f32 {
        let [x] = self.draw();
        x
    }

    /// Two numbers in [0, 1), stratified together.
    #[inline]
    pub fn next_2d(&mut self) -> [f32; 2] {
        self.draw()
    }

    /// Three numbers in [0, 1), stratified together.
    #[inline]
    pub fn next_3d(&mut self) -> [f32; 3] {
        self.draw()
    }

    /// The next `D` ≤ 3 numbers.
    #[inline(always)]
    fn draw<const D: usize>(&mut self) -> [f32; D] {
        const { assert!(D <= sobol::DIMENSIONS) };
        let first = self.dimension;
        self.dimension = first.wrapping_add(D as u32);
        match self.kind {
            SamplerKind::Independent => independent(self.key, first),
            SamplerKind::Sobol => padded(self.key, self.reversed_index, first),
        }
    }
}

/// The key and the reversed index of part `which` of `count`.
#[inline(always)]
fn split(kind: SamplerKind, (key, reversed): (u64, u32), count: u32, which: u32) -> (u64, u32) {
    if count == 1 {
        return (key, reversed);
    }
    match kind {
        SamplerKind::Independent => (hash::combine(key, which.into()), reversed),
        SamplerKind::Sobol => {
            let index = u64::from(reversed.reverse_bits()) * u64::from(count) + u64::from(which);
            // What an index has no digits for is another sequence.
            let key = match index >> 32 {
                0 => key,
                more => hash::combine(key, more),
            };
            (key, (index as u32).reverse_bits())
        }
    }
}

/// `D` independent numbers from dimension `first` on.
#[inline(always)]
fn independent<const D: usize>(key: u64, first: u32) -> [f32; D] {
    let mut out = [0.0; D];
    for (i, x) in out.iter_mut().enumerate() {
        let dimension = first.wrapping_add(i as u32);
        *x = unit_f32((hash::combine(key, dimension.into()) >> 32) as u32);
    }
    out
}

/// The point of the Sobol' set of dimension `first`.
#[inline(always)]
fn padded<const D: usize>(key: u64, reversed_index: u32, first: u32) -> [f32; D] {
    let bits = sobol::scrambled::<D>(reversed_index, hash::combine(key, first.into()));
    let mut out = [0.0; D];
    for i in 0..D {
        out[i] = unit_f32(bits[i]);
    }
    out
}

/// The fraction x / 2³², truncated to 24 bits: in [0, 1 − 2⁻²⁴], exactly representable.
#[inline(always)]
fn unit_f32(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests;
