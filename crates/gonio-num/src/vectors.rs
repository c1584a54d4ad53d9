//! [`Vectors`], many vectors as a structure of arrays, for kernels over lanes.

use crate::{Vec3, lanes::Lanes};

/// The most lanes of an instruction set: arrays that kernels read in whole steps have a length that it divides.
pub const MOST_LANES: usize = 16;

/// The length of an array of `count` numbers with room for whole steps.
#[inline]
pub fn whole_steps(count: usize) -> usize {
    count.next_multiple_of(MOST_LANES)
}

/// Vectors as three arrays of coordinates.
///
/// Behind the last vector the arrays go on to a multiple of [`MOST_LANES`], so that a kernel may load and store whole steps; what
/// stands there means nothing.
#[derive(Debug, Clone, Default)]
pub struct Vectors {
    count: usize,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Vectors {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Makes it `count` vectors; those that were there keep their values.
    pub fn resize(&mut self, count: usize) {
        self.count = count;
        // Never shorter: what is there needn't be written again.
        let room = whole_steps(count).max(self.x.len());
        for axis in [&mut self.x, &mut self.y, &mut self.z] {
            axis.resize(room, 0.0);
        }
    }

    /// Becomes what `other` is.
    pub fn copy_from(&mut self, other: &Self) {
        self.resize(other.count);
        for (to, from) in self.axes_mut().into_iter().zip(other.axes()) {
            to.copy_from_slice(from);
        }
    }

    /// The vector at `i`.
    #[inline(always)]
    pub fn get(&self, i: usize) -> Vec3<f32> {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Puts a vector at `i`.
    #[inline(always)]
    pub fn set(&mut self, i: usize, v: Vec3<f32>) {
        self.x[i] = v.x;
        self.y[i] = v.y;
        self.z[i] = v.z;
    }

    /// The coordinates, each axis as a slice of all vectors.
    #[inline]
    pub fn axes(&self) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z].map(|axis| &axis[..self.count])
    }

    /// The coordinates, to be written.
    #[inline]
    pub fn axes_mut(&mut self) -> [&mut [f32]; 3] {
        let count = self.count;
        [&mut self.x, &mut self.y, &mut self.z].map(|axis| &mut axis[..count])
    }

    /// The `L` vectors from `at` on, a multiple of `L`.
    #[inline(always)]
    pub fn load<const L: usize>(&self, at: usize) -> Vec3<Lanes<L>> {
        Vec3::new(
            Lanes::load(&self.x[at..]),
            Lanes::load(&self.y[at..]),
            Lanes::load(&self.z[at..]),
        )
    }

    /// Writes `L` vectors from `at` on, a multiple of `L`.
    #[inline(always)]
    pub fn store<const L: usize>(&mut self, at: usize, v: Vec3<Lanes<L>>) {
        v.x.store(&mut self.x[at..]);
        v.y.store(&mut self.y[at..]);
        v.z.store(&mut self.z[at..]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_steps_are_there() {
        let mut v = Vectors::default();
        v.resize(17);
        for i in 0..17 {
            v.set(i, Vec3::new(i as f32, 1.0, -(i as f32)));
        }
        let step = v.load::<16>(16);
        assert_eq!(step.extract(0), v.get(16));
        v.store(0, step);
        assert_eq!(v.get(0), Vec3::new(16.0, 1.0, -16.0));
        assert_eq!(v.axes().map(<[f32]>::len), [17; 3]);
        let mut w = Vectors::default();
        w.copy_from(&v);
        assert_eq!((w.len(), w.get(16)), (17, v.get(16)));
        v.resize(3);
        assert_eq!((v.len(), v.axes()[0].len()), (3, 3));
        v.resize(0);
        assert!(v.is_empty());
    }
}
