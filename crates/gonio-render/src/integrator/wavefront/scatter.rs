//! [`Scatter`], the directions in which the paths of a wave go on.

use super::paths::Paths;
use super::surface::{Reflects, Vertices, directions};
use super::{Part, dimension};
use gonio_brdf::{Brdf, batch};
use gonio_num::{Vectors, vectors::whole_steps};

/// One direction a point, drawn by its reflection function.
#[derive(Debug, Default)]
pub(super) struct Scatter {
    u: [Vec<f32>; 3],
    /// Local.
    wi: Vectors,
    wi_world: Vectors,
    /// Where the paths go on from, off the surface.
    origins: Vectors,
    weight: [Vec<f32>; 3],
    pdf: Vec<f32>,
    delta: Vec<bool>,
}

impl Scatter {
    pub fn draw(&mut self, vertices: &Vertices<'_>, bounce: u32) {
        let count = vertices.len();
        let room = whole_steps(count);
        for column in (self.u.iter_mut())
            .chain(&mut self.weight)
            .chain([&mut self.pdf])
        {
            column.resize(room, 0.0);
        }
        self.delta.resize(room, false);
        self.wi.resize(count);
        self.wi_world.resize(count);
        let [a, b, c] = &mut self.u;
        let at = dimension::of_bounce(bounce) + dimension::DIRECTION;
        vertices.streams.draw(at, [a, b, c]);
        for (group, reflects) in vertices.each_group() {
            let range = group.range.clone();
            match reflects {
                Reflects::Evenly(model) => {
                    let u = self.u.each_ref().map(|c| &c[range.clone()]);
                    let samples = batch::Samples {
                        wi: self.wi.axes_mut().map(|axis| &mut axis[range.clone()]),
                        weight: self.weight.each_mut().map(|c| &mut c[range.clone()]),
                        pdf: &mut self.pdf[range.clone()],
                        delta: &mut self.delta[range.clone()],
                    };
                    batch::sample(model, directions(&vertices.wo, range), u, samples);
                }
                Reflects::Unevenly(points) => {
                    for (i, vertex) in range.zip(points) {
                        let u = [0, 1, 2].map(|k| self.u[k][i]);
                        let sample = vertex.model.sample(vertex.wo, u);
                        self.wi.set(i, sample.wi);
                        self.pdf[i] = sample.pdf;
                        self.delta[i] = sample.delta;
                        for (column, value) in self.weight.iter_mut().zip(sample.weight) {
                            column[i] = value;
                        }
                    }
                }
            }
        }
        vertices.to_world(&self.wi, &mut self.wi_world);
        vertices
            .surfaces
            .offset_origins(&self.wi_world, &mut self.origins);
    }

    /// Lets the paths in `order` go on from their vertices, those that carry anything: as this part of several.
    ///
    /// - `next`: the paths that go on, and where the next of them goes
    ///
    /// Where the one after the last of them would go.
    pub fn go_on(
        &self,
        vertices: &Vertices<'_>,
        (paths, order): (&Paths, &[u32]),
        part: Part,
        (next, mut place): (&mut Paths, usize),
    ) -> usize {
        let (unscales, faces) = (!next.unscaling[0].is_empty(), !next.facing.is_empty());
        for (group, reflects) in vertices.each_group() {
            let even = match &reflects {
                Reflects::Evenly(model) => Some((model.transmits(), model.relative_ior())),
                Reflects::Unevenly(_) => None,
            };
            for i in group.range.clone() {
                if self.pdf[i] <= 0.0 {
                    continue;
                }
                let of = if part.of > 1 && reflects.is_delta(i - group.range.start) {
                    1
                } else {
                    part.of
                };
                if part.which >= of {
                    continue;
                }
                let (wi, ng) = (self.wi_world.get(i), vertices.surfaces.ng.get(i));
                let (transmits, ior) = match (&reflects, even) {
                    (_, Some(even)) => even,
                    (Reflects::Unevenly(points), None) => {
                        let vertex = &points[i - group.range.start];
                        (vertex.transmits, vertex.model.relative_ior())
                    }
                    (Reflects::Evenly(_), None) => continue,
                };
                let (inward, outward) = (wi.dot(ng), vertices.wo_world.get(i).dot(ng));
                let same_side = inward * outward > 0.0;
                let admitted = if transmits {
                    inward * self.wi.get(i).z > 0.0
                } else {
                    same_side
                };
                if !admitted {
                    continue;
                }
                let k = order[i] as usize;
                let mut throughput = paths.throughput(k);
                for (t, w) in throughput.iter_mut().zip(&self.weight) {
                    *t = *t * w[i] * (1.0 / of as f32);
                }
                if throughput == [0.0; 3] {
                    continue;
                }
                if unscales {
                    let mut unscaling = paths.unscaling(k);
                    if transmits && !same_side {
                        for (u, n) in unscaling.iter_mut().zip(ior) {
                            *u *= if inward < 0.0 { n * n } else { 1.0 / (n * n) };
                        }
                    }
                    for (column, value) in next.unscaling.iter_mut().zip(unscaling) {
                        column[place] = value;
                    }
                }
                next.id[place] = paths.id[k] + part.which;
                next.origin.set(place, self.origins.get(i));
                next.direction.set(place, wi);
                next.from.set(place, vertices.surfaces.p.get(i));
                if faces {
                    next.facing.set(place, vertices.receiving.get(i));
                }
                for (column, value) in next.throughput.iter_mut().zip(throughput) {
                    column[place] = value;
                }
                next.pdf[place] = if self.delta[i] {
                    f32::INFINITY
                } else {
                    of as f32 * self.pdf[i]
                };
                place += 1;
            }
        }
        place
    }
}
