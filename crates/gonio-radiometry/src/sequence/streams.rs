//! [`SampleStreams`], the numbers of many samples at once.

use super::{SampleStream, SamplerKind, independent, padded};
use gonio_num::dispatch::{Kernel, dispatch};

/// Many [`SampleStream`]s of one kind, which draw from the same dimension together: the same numbers, to the bit.
///
/// ```
/// use gonio_radiometry::sequence::{SampleStream, SampleStreams, SamplerKind};
/// let mut streams = SampleStreams::new(SamplerKind::Sobol);
/// for sample in 0..5 {
///     streams.push(&SampleStream::new(SamplerKind::Sobol, 7, 1234, sample));
/// }
/// let (mut x, mut y) = ([0.0; 5], [0.0; 5]);
/// streams.draw(2, [&mut x, &mut y]);
/// let mut third = SampleStream::new(SamplerKind::Sobol, 7, 1234, 3);
/// third.seek(2);
/// assert_eq!([x[3], y[3]], third.next_2d());
/// ```
#[derive(Debug, Clone)]
pub struct SampleStreams {
    kind: SamplerKind,
    keys: Vec<u64>,
    reversed_indices: Vec<u32>,
}

impl SampleStreams {
    /// None yet.
    pub fn new(kind: SamplerKind) -> Self {
        Self {
            kind,
            keys: Vec::new(),
            reversed_indices: Vec::new(),
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Takes all away.
    pub fn clear(&mut self) {
        self.keys.clear();
        self.reversed_indices.clear();
    }

    /// Adds one.
    ///
    /// # Panics
    /// If it is of another kind.
    #[inline]
    pub fn push(&mut self, stream: &SampleStream) {
        assert_eq!(stream.kind, self.kind, "streams of two kinds don't mix");
        self.keys.push(stream.key);
        self.reversed_indices.push(stream.reversed_index);
    }

    /// Becomes all parts of others' streams, [`SampleStream::split`]: those of the first, then those of the second, and so on.
    pub fn split(&mut self, others: &Self, count: u32) {
        self.kind = others.kind;
        self.clear();
        for (&key, &reversed) in others.keys.iter().zip(&others.reversed_indices) {
            for which in 0..count {
                let (key, reversed) = super::split(self.kind, (key, reversed), count, which);
                self.keys.push(key);
                self.reversed_indices.push(reversed);
            }
        }
    }

    /// Puts `stream` in the place of number `i`.
    ///
    /// # Panics
    /// If there is none.
    #[inline]
    pub fn set(&mut self, i: usize, stream: &SampleStream) {
        self.keys[i] = stream.key;
        self.reversed_indices[i] = stream.reversed_index;
    }

    /// Becomes those of `others` that `order` names, in its order.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn gather(&mut self, others: &Self, order: &[u32]) {
        self.kind = others.kind;
        self.clear();
        let keys = order.iter().map(|&i| others.keys[i as usize]);
        self.keys.extend(keys);
        let indices = order.iter().map(|&i| others.reversed_indices[i as usize]);
        self.reversed_indices.extend(indices);
    }

    /// Number `i` as a stream of its own, at dimension 0.
    ///
    /// # Panics
    /// If there is none.
    pub fn get(&self, i: usize) -> SampleStream {
        SampleStream {
            kind: self.kind,
            key: self.keys[i],
            reversed_index: self.reversed_indices[i],
            dimension: 0,
        }
    }

    /// The `D` ≤ 3 numbers that each stream draws together at `dimension`, one slice a number.
    ///
    /// # Panics
    /// If a slice is shorter than there are streams.
    pub fn draw<const D: usize>(&self, dimension: u32, out: [&mut [f32]; D]) {
        let count = self.len();
        let out = out.map(|slice| &mut slice[..count]);
        dispatch(Draw {
            streams: self,
            dimension,
            out,
        });
    }
}

struct Draw<'a, const D: usize> {
    streams: &'a SampleStreams,
    dimension: u32,
    out: [&'a mut [f32]; D],
}

impl<const D: usize> Kernel for Draw<'_, D> {
    type Output = ();

    /// Plain loops over whole numbers, which a compiler turns into vector instructions by itself.
    #[inline(always)]
    fn run<const L: usize>(self) {
        let Self {
            streams,
            dimension,
            out,
        } = self;
        let (keys, indices) = (&streams.keys[..], &streams.reversed_indices[..]);
        let count = keys.len();
        let mut at = 0;
        while at + L <= count {
            let (mut key, mut index) = ([0; L], [0; L]);
            key.copy_from_slice(&keys[at..at + L]);
            index.copy_from_slice(&indices[at..at + L]);
            let drawn = draw::<L, D>(streams.kind, dimension, &key, &index);
            for d in 0..D {
                out[d][at..at + L].copy_from_slice(&drawn[d]);
            }
            at += L;
        }
        let left = count - at;
        let (mut key, mut index) = ([0; L], [0; L]);
        key[..left].copy_from_slice(&keys[at..]);
        index[..left].copy_from_slice(&indices[at..]);
        let drawn = draw::<L, D>(streams.kind, dimension, &key, &index);
        for d in 0..D {
            out[d][at..count].copy_from_slice(&drawn[d][..left]);
        }
    }
}

/// What the streams of these keys and indices draw.
#[inline(always)]
fn draw<const L: usize, const D: usize>(
    kind: SamplerKind,
    dimension: u32,
    key: &[u64; L],
    index: &[u32; L],
) -> [[f32; L]; D] {
    let mut drawn = [[0.0; L]; D];
    for lane in 0..L {
        let numbers = match kind {
            SamplerKind::Independent => independent::<D>(key[lane], dimension),
            SamplerKind::Sobol => padded::<D>(key[lane], index[lane], dimension),
        };
        for d in 0..D {
            drawn[d][lane] = numbers[d];
        }
    }
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_streams_draw_what_one_draws() {
        for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
            for count in [0, 1, 7, 16, 61] {
                let alone: Vec<SampleStream> = (0..count)
                    .map(|k| SampleStream::new(kind, 3, k / 5, k % 5 + 1000))
                    .collect();
                let mut streams = SampleStreams::new(kind);
                alone.iter().for_each(|s| streams.push(s));
                let mut drawn = vec![0.0; 3 * count as usize];
                let (x, yz) = drawn.split_at_mut(count as usize);
                let (y, z) = yz.split_at_mut(count as usize);
                streams.draw(11, [&mut *x, &mut *y, &mut *z]);
                for (i, stream) in alone.iter().enumerate() {
                    let mut stream = *stream;
                    stream.seek(11);
                    assert_eq!([x[i], y[i], z[i]], stream.next_3d(), "{kind:?} {i}");
                    assert_eq!(streams.get(i).dimension(), 0);
                }
                streams.draw(11, [&mut *x]);
                streams.draw(12, [&mut *y, &mut *z]);
                for (i, stream) in alone.iter().enumerate() {
                    let mut stream = *stream;
                    stream.seek(11);
                    assert_eq!(x[i], stream.next_1d());
                    assert_eq!([y[i], z[i]], stream.next_2d());
                }
                let mut parts = SampleStreams::new(kind);
                parts.split(&streams, 4);
                assert_eq!(parts.len(), 4 * alone.len());
                for (i, stream) in alone.iter().enumerate() {
                    for which in 0..4 {
                        let part = stream.split(4, which);
                        assert_eq!(parts.get(4 * i + which as usize), part);
                    }
                }
                if count > 5 {
                    parts.set(3, &alone[5]);
                    assert_eq!(parts.get(3), alone[5]);
                }
                let backwards: Vec<u32> = (0..count).rev().collect();
                let mut turned = SampleStreams::new(SamplerKind::default());
                turned.gather(&streams, &backwards);
                for (i, stream) in alone.iter().rev().enumerate() {
                    assert_eq!(turned.get(i), *stream);
                }
            }
        }
    }
}
