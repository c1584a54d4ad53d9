//! [`Scatter`], the directions in which the paths of a wave go on.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::kept::Kept;
use super::paths::Paths;
use super::surface::{Reflects, Vertices, directions};
use super::{Part, dimension};
use gonio_brdf::{Brdf, batch};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::{Vec3, Vectors, vectors::whole_steps};

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
    /// What each path would carry on.
    throughput: [Vec<f32>; 3],
    /// Whether each path goes on, as a number; and the vertices of those that do.
    alive: Vec<u32>,
    going: Kept,
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
        &mut self,
        vertices: &Vertices<'_>,
        (paths, order): (&Paths, &[u32]),
        part: Part,
        (next, mut place): (&mut Paths, usize),
    ) -> usize {
        let unscales = !next.unscaling[0].is_empty();
        if part.of == 1 && !unscales && vertices.are_even() {
            return self.go_on_evenly(vertices, (paths, order), (next, place));
        }
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
                next.vertex[place] = i as u32;
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

    /// [`Scatter::go_on`] from surfaces that reflect alone, each by one function.
    fn go_on_evenly(
        &mut self,
        vertices: &Vertices<'_>,
        (paths, order): (&Paths, &[u32]),
        (next, place): (&mut Paths, usize),
    ) -> usize {
        let count = vertices.len();
        for (column, (from, weight)) in
            (self.throughput.iter_mut()).zip(paths.throughput.iter().zip(&self.weight))
        {
            column.resize(whole_steps(count), 0.0);
            for (t, (&k, w)) in column.iter_mut().zip(order.iter().zip(weight)) {
                *t = from[k as usize] * w;
            }
        }
        self.alive.resize(whole_steps(count), 0);
        dispatch(Alive {
            pdf: &mut self.pdf[..count],
            delta: &self.delta[..count],
            throughput: self.throughput.each_ref().map(|c| &c[..]),
            wi: self.wi_world.axes(),
            wo: vertices.wo_world.axes(),
            ng: vertices.surfaces.ng.axes(),
            alive: &mut self.alive[..count],
        });
        let going = &mut self.going;
        going.choose(&self.alive[..count]);
        let end = place + going.len();
        next.vertex[place..end].copy_from_slice(&going.indices);
        for (id, &i) in next.id[place..end].iter_mut().zip(&going.indices) {
            *id = paths.id[order[i as usize] as usize];
        }
        let [ox, oy, oz] = next.origin.axes_mut();
        let [dx, dy, dz] = next.direction.axes_mut();
        let [r, g, b] = next.throughput.each_mut();
        let to = [ox, oy, oz, dx, dy, dz, r, g, b, &mut next.pdf];
        let [from_x, from_y, from_z] = self.origins.axes();
        let [wi_x, wi_y, wi_z] = self.wi_world.axes();
        let [from_r, from_g, from_b] = self.throughput.each_ref();
        let from = [
            from_x, from_y, from_z, wi_x, wi_y, wi_z, from_r, from_g, from_b, &self.pdf,
        ];
        for (to, from) in to.into_iter().zip(from) {
            going.copy(from, &mut to[place..end]);
        }
        end
    }
}

/// Which paths go on: those that carry something in a direction that lies on the viewer's side of the true surface. The density of one that was
/// the only one becomes ∞.
struct Alive<'a> {
    pdf: &'a mut [f32],
    delta: &'a [bool],
    throughput: [&'a [f32]; 3],
    wi: [&'a [f32]; 3],
    wo: [&'a [f32]; 3],
    ng: [&'a [f32]; 3],
    alive: &'a mut [u32],
}

impl Kernel for Alive<'_> {
    type Output = ();

    /// A plain loop over numbers, which a compiler turns into vector instructions by itself.
    #[inline(always)]
    fn run<const L: usize>(self) {
        let count = self.alive.len();
        let (pdf, delta) = (&mut self.pdf[..count], &self.delta[..count]);
        let [r, g, b] = columns(self.throughput, count);
        let (wi, wo, ng) = (
            columns(self.wi, count),
            columns(self.wo, count),
            columns(self.ng, count),
        );
        for i in 0..count {
            let n = Vec3::new(ng[0][i], ng[1][i], ng[2][i]);
            let inward = Vec3::new(wi[0][i], wi[1][i], wi[2][i]).dot(n);
            let outward = Vec3::new(wo[0][i], wo[1][i], wo[2][i]).dot(n);
            let carries = (r[i] != 0.0) | (g[i] != 0.0) | (b[i] != 0.0);
            let alive = (pdf[i] > 0.0) & (inward * outward > 0.0) & carries;
            self.alive[i] = u32::from(alive);
            pdf[i] = if delta[i] { f32::INFINITY } else { pdf[i] };
        }
    }
}

/// Columns of a length that a compiler then knows.
#[inline(always)]
fn columns(v: [&[f32]; 3], count: usize) -> [&[f32]; 3] {
    [&v[0][..count], &v[1][..count], &v[2][..count]]
}
