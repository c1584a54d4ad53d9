//! [`Direct`], light that comes straight from the lights to the points of a wave.

use super::surface::{Reflects, Vertices, directions};
use super::{RayCounts, dimension, power_heuristic};
use gonio_brdf::{Brdf, batch};
use gonio_env::Guide;
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
    /// What is reflected, of the points that any is, if nothing stands in between.
    reflected: Vec<(u32, [f32; 3])>,
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
        let base = dimension::of_bounce(bounce);
        vertices.streams.draw(base, [&mut self.choice]);
        let [u, v] = &mut self.u;
        vertices.streams.draw(base + 1, [u, v]);
        let u = [&self.u[0][..], &self.u[1]];
        (scene.lights).sample_many(guide, &vertices.surfaces, &self.choice, u, &mut self.light);
    }

    /// Evaluates the reflection functions, and follows the shadow rays where anything would be reflected.
    pub fn reflect(&mut self, scene: &Scene, vertices: &Vertices<'_>, counts: &mut RayCounts) {
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
        self.reflected.clear();
        self.ends.clear();
        self.origins.resize(count);
        self.directions.resize(count);
        for i in 0..count {
            let sampled = light.pdf[i];
            let f = [0, 1, 2].map(|k| self.f[k][i]);
            if sampled <= 0.0 || f == [0.0; 3] {
                continue;
            }
            let weight = if light.delta[i] {
                1.0
            } else {
                power_heuristic(sampled, self.pdf[i])
            };
            let (cos, factor) = (self.wi.get(i).z.abs(), weight / sampled);
            if cos == 0.0 {
                continue;
            }
            let mut reflected = [0.0; 3];
            for k in 0..3 {
                reflected[k] = f[k] * cos * light.radiance[k][i] * factor;
            }
            if reflected == [0.0; 3] {
                continue;
            }
            let ray = if light.infinite[i] {
                vertices.surfaces.spawn_ray(i, light.wi.get(i))
            } else {
                vertices.surfaces.spawn_ray_to(i, light.target.get(i))
            };
            self.origins.set(self.ends.len(), ray.origin);
            self.directions.set(self.ends.len(), ray.direction);
            self.ends.push(ray.t_max);
            self.reflected.push((i as u32, reflected));
        }
        counts.shadow += self.ends.len() as u64;
        self.origins.resize(self.ends.len());
        self.directions.resize(self.ends.len());
        let rays = [&self.origins, &self.directions];
        (scene.geometry).occluded_many(rays, &self.ends, &mut self.hidden);
    }

    /// The points that reflect anything, and what.
    pub fn contributions(&self) -> impl Iterator<Item = (usize, [f32; 3])> + '_ {
        let seen = |&(_, hidden): &(_, &bool)| !*hidden;
        let all = self.reflected.iter().zip(&self.hidden);
        all.filter(seen).map(|(&(i, light), _)| (i as usize, light))
    }
}
