//! [`Direct`], light that comes straight from the lights to the points of a wave.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::surface::{Reflects, Vertices, directions};
use super::{RayCounts, dimension};
use crate::integrator::path::Strategies;
use gonio_brdf::{Brdf, batch};
use gonio_env::Guide;
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::{Vectors, vectors::whole_steps};
use gonio_scene::{LightSamples, Scene};

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
    /// The points that reflect anything, if nothing stands in between.
    reflected: Vec<u32>,
    /// The rays that tell, one for each.
    origins: Vectors,
    directions: Vectors,
    ends: Vec<f32>,
    hidden: Vec<bool>,
}

impl Direct {
    /// Draws one light and a direction for each point.
    pub fn draw(&mut self, scene: &Scene, guide: Guide, vertices: &Vertices<'_>, bounce: u32) {
        let count = vertices.len();
        for column in [&mut self.choice].into_iter().chain(&mut self.u) {
            column.resize(whole_steps(count), 0.0);
        }
        let [u, v] = &mut self.u;
        let at = dimension::of_bounce(bounce);
        vertices.streams.draw(at, [u, v, &mut self.choice]);
        let u = [&self.u[0][..], &self.u[1]];
        let (from, normals) = (&vertices.surfaces, &vertices.receiving);
        (scene.lights).sample_many(guide, from, normals, &self.choice, u, &mut self.light);
    }

    /// Evaluates the reflection functions, and follows the shadow rays where anything would be reflected.
    pub fn reflect(
        &mut self,
        scene: &Scene,
        vertices: &Vertices<'_>,
        strategies: Strategies,
        counts: &mut RayCounts,
    ) {
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
        dispatch(Reflect {
            light,
            wi: &self.wi,
            f: &mut self.f,
            pdf: &self.pdf,
            strategies,
        });
        let (origins, directions) = (&mut self.origins, &mut self.directions);
        vertices.surfaces.spawn_rays(
            (&light.wi, &light.target, &light.infinite),
            [origins, directions],
            &mut self.ends,
        );
        // The rays of those that reflect anything move to the front.
        let [r, g, b] = self.f.each_ref().map(|c| &c[..count]);
        self.reflected.resize(count, 0);
        let mut some = 0;
        for i in 0..count {
            self.reflected[some] = i as u32;
            some += usize::from((r[i] != 0.0) | (g[i] != 0.0) | (b[i] != 0.0));
        }
        self.reflected.truncate(some);
        if some < count {
            let [ox, oy, oz] = origins.axes_mut();
            let [dx, dy, dz] = directions.axes_mut();
            for column in [ox, oy, oz, dx, dy, dz, &mut self.ends] {
                for (to, &i) in self.reflected.iter().enumerate() {
                    column[to] = column[i as usize];
                }
            }
        }
        self.ends.truncate(self.reflected.len());
        counts.shadow += self.ends.len() as u64;
        self.origins.resize(self.ends.len());
        self.directions.resize(self.ends.len());
        let rays = [&self.origins, &self.directions];
        (scene.geometry).occluded_many(rays, &self.ends, &mut self.hidden);
    }

    /// The points that reflect anything, and what.
    pub fn contributions(&self) -> impl Iterator<Item = (usize, [f32; 3])> + '_ {
        let seen = |&(_, hidden): &(_, &bool)| !*hidden;
        let all = self.reflected.iter().zip(&self.hidden).filter(seen);
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
        let pdf = &self.pdf[..count];
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
        }
    }
}
