//! [`Gathered`], the light of a wave.

use super::{Plan, sum};
use crate::film::FilmSample;
use crate::integrator::shares::{Shares, Split};

/// The samples of a wave as their light comes together.
#[derive(Debug)]
pub(crate) struct Gathered<'a> {
    split: &'a Split,
    /// Paths of a sample.
    paths: usize,
    /// One a ray.
    pub samples: Vec<FilmSample>,
    /// One a path.
    arrived: Vec<[f32; 3]>,
    /// As many a path as are told apart.
    shares: Vec<[f32; 3]>,
}

impl<'a> Gathered<'a> {
    pub fn new(plan: &Plan<'a>) -> Self {
        Self {
            split: plan.split,
            paths: plan.paths,
            samples: Vec::new(),
            arrived: Vec::new(),
            shares: Vec::new(),
        }
    }

    pub(super) fn begin(&mut self, count: usize) {
        let black = FilmSample {
            radiance: [0.0; 3],
            first: None,
        };
        self.samples.clear();
        self.samples.resize(count, black);
        self.arrived.clear();
        self.arrived.resize(count * self.paths, [0.0; 3]);
        self.shares.clear();
        let shares = count * self.paths * self.split.count();
        self.shares.resize(shares, [0.0; 3]);
    }

    /// Adds the paths of each sample.
    pub(super) fn end(&mut self) {
        let of_samples = self.arrived.chunks_exact(self.paths);
        for (sample, arrived) in self.samples.iter_mut().zip(of_samples) {
            for &one in arrived {
                sample.radiance = sum(sample.radiance, one);
            }
        }
        let each = self.split.count();
        if each == 0 || self.paths == 1 {
            return;
        }
        for of_sample in self.shares.chunks_exact_mut(each * self.paths) {
            let (all, others) = of_sample.split_at_mut(each);
            for of_path in others.chunks_exact(each) {
                for (all, &one) in all.iter_mut().zip(of_path) {
                    *all = sum(*all, one);
                }
            }
        }
    }

    /// All samples, and the shares of each.
    pub fn samples_and_shares<'s>(
        &'s mut self,
    ) -> (&'s mut [FilmSample], impl Fn(usize) -> &'s [[f32; 3]]) {
        let (each, paths, shares) = (self.split.count(), self.paths, &self.shares);
        let of = move |i| &shares[i * paths * each..][..each];
        (&mut self.samples, of)
    }

    /// Adds light to the path `id`, as [`Shares::add`] does to its shares.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        id: u32,
        light: Option<u32>,
        reflections: u32,
        radiance: [f32; 3],
    ) {
        let arrived = &mut self.arrived[id as usize];
        *arrived = sum(*arrived, radiance);
        self.tell_apart(id, light, reflections, radiance);
    }

    /// [`Shares::add`] alone.
    #[inline(always)]
    pub(super) fn tell_apart(
        &mut self,
        id: u32,
        light: Option<u32>,
        reflections: u32,
        arrived: [f32; 3],
    ) {
        let each = self.split.count();
        if each == 0 {
            return;
        }
        let first = id as usize * each;
        let mut shares = Shares {
            split: self.split,
            values: &mut self.shares[first..first + each],
        };
        shares.add(light, reflections, arrived);
    }
}
