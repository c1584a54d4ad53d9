//! [`Paths`], the paths of a wave between two surfaces.

use crate::integrator::{power_heuristic, product, scaled};
use gonio_num::Vectors;
use gonio_scene::Ray;

/// Paths on their way, as a structure of arrays.
#[derive(Debug)]
pub(super) struct Paths {
    /// Number of the path: those of the wave's first sample, then those of the second, and so on. Up to the first surface that of a sample's first.
    pub id: Vec<u32>,
    pub origin: Vectors,
    pub direction: Vectors,
    pub throughput: [Vec<f32>; 3],
    /// What takes the scaling of radiance by n² out of the throughput, for roulette; empty where nothing scales.
    pub unscaling: [Vec<f32>; 3],
    /// The number of the vertex that each has left: what lights were sampled from.
    pub vertex: Vec<u32>,
    /// The density with which the reflection function drew the direction; ∞ for a single direction, which no light sample finds.
    pub pdf: Vec<f32>,
}

impl Paths {
    pub fn new() -> Self {
        Self {
            id: Vec::new(),
            origin: Vectors::default(),
            direction: Vectors::default(),
            throughput: [const { Vec::new() }; 3],
            unscaling: [const { Vec::new() }; 3],
            vertex: Vec::new(),
            pdf: Vec::new(),
        }
    }

    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Makes room for up to `most` paths, of which there are none yet.
    ///
    /// - `unscales`: whether there is an unscaling
    pub fn begin(&mut self, most: usize, unscales: bool) {
        for v in [&mut self.origin, &mut self.direction] {
            v.resize(most);
        }
        // Nothing of what was there needs to be written again.
        for column in [&mut self.id, &mut self.vertex] {
            column.resize(most, 0);
        }
        for column in self.throughput.iter_mut().chain([&mut self.pdf]) {
            column.resize(most, 0.0);
        }
        for column in &mut self.unscaling {
            column.resize(if unscales { most } else { 0 }, 0.0);
        }
    }

    /// Ends what [`Paths::begin`] began, with `count` paths.
    pub fn end(&mut self, count: usize) {
        self.id.truncate(count);
        for v in [&mut self.origin, &mut self.direction] {
            v.resize(count);
        }
    }

    pub fn ray(&self, i: usize) -> Ray {
        Ray::new(self.origin.get(i), self.direction.get(i))
    }

    pub fn throughput(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|k| self.throughput[k][i])
    }

    /// Light that path `i` met, with the weight against a light sample of this density.
    #[inline(always)]
    pub fn weighted(&self, i: usize, radiance: [f32; 3], density: f32) -> [f32; 3] {
        // From ∞ the weight is 1, whatever the other density.
        let weight = power_heuristic(self.pdf[i], density);
        scaled(product(self.throughput(i), radiance), weight)
    }

    /// 1 where nothing scales.
    pub fn unscaling(&self, i: usize) -> [f32; 3] {
        [0, 1, 2].map(|k| self.unscaling[k].get(i).copied().unwrap_or(1.0))
    }
}
