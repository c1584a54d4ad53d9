//! [`Direct`], light that comes straight from the lights to the points of a wave.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::kept::Kept;
use super::surface::{Reflects, Vertices, directions};
use super::{RayCounts, dimension};
use crate::integrator::path::{Strategies, weight};
use gonio_brdf::{Brdf, batch};
use gonio_env::Guide;
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::{Vectors, vectors::whole_steps};
use gonio_scene::{LightSampler, LightSamples, Scene};

/// One light sample a point, and what is reflected of it.
#[derive(Debug, Default)]
pub(super) struct Direct {
    light: LightSamples,
    choice: Vec<f32>,
    u: [Vec<f32>; 2],
    /// Direction to the light, local; zero where the surface admits none.
    wi: Vectors,
    f: [Vec<f32>; 3],
    pdf: Vec<f32>,
    /// Whether each point reflects anything, if nothing stands in between, as a number; and those that do.
    bright: Vec<u32>,
    reflected: Kept,
    /// The rays that tell, one for each.
    origins: Vectors,
    directions: Vectors,
    ends: Vec<f32>,
    hidden: Vec<bool>,
    resampled: Resampled,
}

/// The candidate that each point keeps while others are drawn.
#[derive(Debug, Default)]
struct Resampled {
    wi: Vectors,
    target: Vectors,
    infinite: Vec<bool>,
    light: Vec<u32>,
    f: [Vec<f32>; 3],
    /// The sum of all candidates' weights.
    total: Vec<f32>,
    u: Vec<f32>,
}

impl Direct {
    /// Draws one light and a direction for each point.
    pub fn draw(
        &mut self,
        lights: LightSampler<'_>,
        guide: Guide,
        vertices: &Vertices<'_>,
        bounce: u32,
    ) {
        let count = vertices.len();
        for column in [&mut self.choice].into_iter().chain(&mut self.u) {
            column.resize(whole_steps(count), 0.0);
        }
        let [u, v] = &mut self.u;
        let at = dimension::of_bounce(bounce);
        vertices.streams.draw(at, [u, v, &mut self.choice]);
        let u = [&self.u[0][..], &self.u[1]];
        let (from, normals) = (&vertices.surfaces, &vertices.receiving);
        lights.sample_many(guide, from, normals, &self.choice, u, &mut self.light);
    }

    /// Evaluates the reflection functions.
    pub fn reflect(&mut self, vertices: &Vertices<'_>, strategies: Strategies) {
        let count = vertices.len();
        vertices.to_local(&self.light.wi, &mut self.wi);
        let room = whole_steps(count);
        for column in self.f.iter_mut().chain([&mut self.pdf]) {
            column.resize(room, 0.0);
        }
        let light = &self.light;
        for (group, reflects) in vertices.each_group() {
            let range = group.range.clone();
            match reflects {
                Reflects::Evenly(model) => {
                    let [r, g, b] = self.f.each_mut().map(|c| &mut c[range.clone()]);
                    let pdf = &mut self.pdf[range.clone()];
                    let (wi, wo) = (
                        directions(&self.wi, range.clone()),
                        directions(&vertices.wo, range),
                    );
                    batch::eval_and_pdf(model, wi, wo, [r, g, b], pdf);
                }
                Reflects::Unevenly(points) => {
                    for (i, vertex) in range.zip(points) {
                        let wi = light.wi.get(i);
                        let local = vertex.frame.to_local(wi);
                        let (mut f, mut pdf) = ([0.0; 3], 0.0);
                        if vertex.admits(wi, local) {
                            self.wi.set(i, local);
                            (f, pdf) = vertex.model.eval_and_pdf(local, vertex.wo);
                        }
                        for (column, value) in self.f.iter_mut().zip(f) {
                            column[i] = value;
                        }
                        self.pdf[i] = pdf;
                    }
                }
            }
        }
        self.bright.resize(room, 0);
        dispatch(Reflect {
            light,
            wi: &self.wi,
            f: &mut self.f,
            pdf: &self.pdf,
            strategies,
            bright: &mut self.bright[..count],
        });
    }

    /// Takes what was drawn last as the next candidate of each point, of which one is kept with a probability proportional to what it would
    /// reflect, as `Path::resample_lights` does.
    ///
    /// - `which`: the how many-th it is
    pub fn consider(&mut self, which: u32, vertices: &Vertices<'_>, bounce: u32) {
        let count = vertices.len();
        let (kept, room) = (&mut self.resampled, whole_steps(count));
        for column in (kept.f.iter_mut()).chain([&mut kept.total, &mut kept.u]) {
            column.resize(room, 0.0);
        }
        kept.wi.resize(count);
        kept.target.resize(count);
        kept.infinite.resize(room, false);
        kept.light.resize(room, 0);
        let at = dimension::of_bounce(bounce) + dimension::RESAMPLING;
        vertices.streams.draw(at, [&mut kept.u]);
        dispatch(Consider {
            first: which == 0,
            light: &self.light,
            f: &self.f,
            kept,
        });
    }

    /// Ends with the candidates: the one that each point kept stands for all of them.
    pub fn decide(&mut self, candidates: u32) {
        let (kept, light) = (&mut self.resampled, &mut self.light);
        std::mem::swap(&mut self.f, &mut kept.f);
        std::mem::swap(&mut light.wi, &mut kept.wi);
        std::mem::swap(&mut light.target, &mut kept.target);
        std::mem::swap(&mut light.infinite, &mut kept.infinite);
        std::mem::swap(&mut light.light, &mut kept.light);
        dispatch(Decide {
            candidates: candidates as f32,
            total: &kept.total,
            f: &mut self.f,
            bright: &mut self.bright,
        });
    }

    /// Follows the shadow rays where anything would be reflected.
    pub fn follow(&mut self, scene: &Scene, vertices: &Vertices<'_>, counts: &mut RayCounts) {
        let (count, light) = (vertices.len(), &self.light);
        let (origins, directions) = (&mut self.origins, &mut self.directions);
        vertices.surfaces.spawn_rays(
            (&light.wi, &light.target, &light.infinite),
            [origins, directions],
            &mut self.ends,
        );
        // The rays of those that reflect anything move to the front.
        self.reflected.choose(&self.bright[..count]);
        let some = self.reflected.len();
        let [ox, oy, oz] = origins.axes_mut();
        let [dx, dy, dz] = directions.axes_mut();
        for column in [ox, oy, oz, dx, dy, dz, &mut self.ends] {
            self.reflected.move_to_front(column);
        }
        self.ends.truncate(some);
        counts.shadow += self.ends.len() as u64;
        self.origins.resize(self.ends.len());
        self.directions.resize(self.ends.len());
        let rays = [&self.origins, &self.directions];
        (scene.geometry).occluded_many(rays, &self.ends, &mut self.hidden);
    }

    /// The points that reflect anything, and what.
    pub fn contributions(&self) -> impl Iterator<Item = (usize, [f32; 3])> + '_ {
        let seen = |&(_, hidden): &(_, &bool)| !*hidden;
        let all = self.reflected.indices.iter().zip(&self.hidden).filter(seen);
        all.map(|(&i, _)| (i as usize, [0, 1, 2].map(|c| self.f[c][i as usize])))
    }

    /// The light that was sampled at point `i`.
    pub fn light(&self, i: usize) -> u32 {
        self.light.light[i]
    }
}

/// Turns f into what is reflected of the light sample, with its weight.
struct Reflect<'a> {
    light: &'a LightSamples,
    wi: &'a Vectors,
    f: &'a mut [Vec<f32>; 3],
    pdf: &'a [f32],
    strategies: Strategies,
    bright: &'a mut [u32],
}

impl Kernel for Reflect<'_> {
    type Output = ();

    /// A plain loop over numbers, which a compiler turns into vector instructions by itself.
    #[inline(always)]
    fn run<const L: usize>(self) {
        let [_, _, cos] = self.wi.axes();
        let count = cos.len();
        let [r, g, b] = self.f;
        let (r, g, b) = (&mut r[..count], &mut g[..count], &mut b[..count]);
        let [lr, lg, lb] = &self.light.radiance;
        let (lr, lg, lb) = (&lr[..count], &lg[..count], &lb[..count]);
        let (sampled, delta) = (&self.light.pdf[..count], &self.light.delta[..count]);
        let (pdf, bright) = (&self.pdf[..count], &mut self.bright[..count]);
        let strategies = self.strategies;
        for i in 0..count {
            let cos = cos[i].abs();
            let found = (sampled[i] > 0.0) & (cos > 0.0);
            let own = if found {
                strategies.of_lights(sampled[i])
            } else {
                1.0
            };
            let ratio = strategies.of_directions(pdf[i]) / own;
            let heuristic = 1.0 / (1.0 + ratio * ratio);
            let weight = if delta[i] { 1.0 } else { heuristic };
            let factor = weight / own;
            r[i] = if found {
                r[i] * cos * lr[i] * factor
            } else {
                0.0
            };
            g[i] = if found {
                g[i] * cos * lg[i] * factor
            } else {
                0.0
            };
            b[i] = if found {
                b[i] * cos * lb[i] * factor
            } else {
                0.0
            };
            bright[i] = u32::from((r[i] != 0.0) | (g[i] != 0.0) | (b[i] != 0.0));
        }
    }
}

/// Keeps one of two candidates.
struct Consider<'a> {
    first: bool,
    light: &'a LightSamples,
    f: &'a [Vec<f32>; 3],
    kept: &'a mut Resampled,
}

impl Kernel for Consider<'_> {
    type Output = ();

    /// A plain loop over numbers, which a compiler turns into vector instructions by itself.
    #[inline(always)]
    fn run<const L: usize>(self) {
        let (kept, light) = (self.kept, self.light);
        let count = kept.wi.len();
        let [r, g, b] = self.f.each_ref().map(|c| &c[..count]);
        let (total, u) = (&mut kept.total[..count], &kept.u[..count]);
        let [wx, wy, wz] = light.wi.axes();
        let [tx, ty, tz] = light.target.axes();
        let (infinite, which) = (&light.infinite[..count], &light.light[..count]);
        let [kept_r, kept_g, kept_b] = kept.f.each_mut().map(|c| &mut c[..count]);
        let [kept_wx, kept_wy, kept_wz] = kept.wi.axes_mut();
        let [kept_tx, kept_ty, kept_tz] = kept.target.axes_mut();
        let columns = [
            (kept_wx, wx),
            (kept_wy, wy),
            (kept_wz, wz),
            (kept_tx, tx),
            (kept_ty, ty),
            (kept_tz, tz),
            (kept_r, r),
            (kept_g, g),
            (kept_b, b),
        ];
        // 1 where the new one is kept.
        let mut taken = [0_u32; super::WAVE];
        let taken = &mut taken[..count];
        for i in 0..count {
            let weight = weight([r[i], g[i], b[i]]);
            let before = if self.first { 0.0 } else { total[i] };
            total[i] = before + weight;
            taken[i] = u32::from(self.first | (u[i] * total[i] < weight));
        }
        for (to, from) in columns {
            let (to, from) = (&mut to[..count], &from[..count]);
            for i in 0..count {
                to[i] = if taken[i] != 0 { from[i] } else { to[i] };
            }
        }
        let (to, to_light) = (&mut kept.infinite[..count], &mut kept.light[..count]);
        for i in 0..count {
            to[i] = if taken[i] != 0 { infinite[i] } else { to[i] };
            to_light[i] = if taken[i] != 0 { which[i] } else { to_light[i] };
        }
    }
}

/// Lets what is kept stand for all candidates.
struct Decide<'a> {
    candidates: f32,
    total: &'a [f32],
    f: &'a mut [Vec<f32>; 3],
    bright: &'a mut [u32],
}

impl Kernel for Decide<'_> {
    type Output = ();

    #[inline(always)]
    fn run<const L: usize>(self) {
        let count = self.total.len();
        let [r, g, b] = self.f.each_mut().map(|c| &mut c[..count]);
        let bright = &mut self.bright[..count];
        for i in 0..count {
            let own = weight([r[i], g[i], b[i]]);
            let factor = self.total[i] / (self.candidates * own);
            let factor = if own > 0.0 { factor } else { 0.0 };
            r[i] *= factor;
            g[i] *= factor;
            b[i] *= factor;
            bright[i] = u32::from((r[i] != 0.0) | (g[i] != 0.0) | (b[i] != 0.0));
        }
    }
}
