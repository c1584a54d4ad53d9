//! [`LightSamples`], directions to lights from many points.

use super::{LightTarget, Lights};
use crate::Surfaces;
use gonio_env::Guide;
use gonio_num::{Vectors, vectors::whole_steps};

/// Directions to lights, as [`LightSample`](super::LightSample) has them, as a structure of arrays.
#[derive(Debug, Clone, Default)]
pub struct LightSamples {
    /// Towards the light; world, unit.
    pub wi: Vectors,
    /// Where the shadow ray ends, where `infinite` is false.
    pub target: Vectors,
    /// Whether the light is infinitely far away.
    pub infinite: Vec<bool>,
    /// Radiance, or irradiance of a delta light.
    pub radiance: [Vec<f32>; 3],
    /// Density of `wi`; 0: there is no sample.
    pub pdf: Vec<f32>,
    /// Whether the light is a delta light.
    pub delta: Vec<bool>,
}

impl LightSamples {
    fn resize(&mut self, count: usize) {
        self.wi.resize(count);
        self.target.resize(count);
        let room = whole_steps(count);
        for column in self.radiance.iter_mut().chain([&mut self.pdf]) {
            column.resize(room, 0.0);
        }
        self.infinite.resize(room, false);
        self.delta.resize(room, false);
    }
}

impl Lights {
    /// [`Lights::sample_by`] from many points, the same to the bit.
    ///
    /// - `choice`, `u`: one number a point, uniform in \[0, 1), independent
    ///
    /// # Panics
    /// If there are fewer numbers than points.
    pub fn sample_many(
        &self,
        guide: Guide,
        from: &Surfaces,
        choice: &[f32],
        u: [&[f32]; 2],
        samples: &mut LightSamples,
    ) {
        let count = from.p.len();
        samples.resize(count);
        for i in 0..count {
            let (p, error) = (from.p.get(i), from.error[i]);
            let found = self.sample_at(guide, p, error, choice[i], [u[0][i], u[1][i]]);
            let Some(found) = found else {
                samples.pdf[i] = 0.0;
                continue;
            };
            samples.wi.set(i, found.wi);
            samples.pdf[i] = found.pdf;
            samples.delta[i] = found.delta;
            samples.infinite[i] = matches!(found.target, LightTarget::Infinite);
            if let LightTarget::Point(target) = found.target {
                samples.target.set(i, target);
            }
            for (column, value) in samples.radiance.iter_mut().zip(found.radiance) {
                column[i] = value;
            }
        }
    }
}
