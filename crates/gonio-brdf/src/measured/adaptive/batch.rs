//! Evaluating and sampling [`AdaptiveTable`] for many directions at once.
//!
//! Directions go in blocks through the steps of an evaluation: each step is a loop of its own over lanes, and what lies between
//! two steps is in arrays that stay in the cache. So a processor has many look-ups in flight, where a chain of them for one group
//! of lanes would wait for each; and a compiler has short loops to translate, which evaluating and sampling share. The steps are the
//! functions that single calls use, in the same order: the results have the same bits.
//!
//! A step is handed over by reference. By value it would be copied in larger pieces than it was written in, for which a processor
//! waits until everything before it is in memory: the results of the last block.

use super::AdaptiveTable;
use super::block::{BLOCK, Block, Indices, Part, Row, load, store};
use super::geometry::Geometry;
use super::warp::Warp;
use crate::Sample;
use crate::batch::{Directions, Samples};
use crate::part::colour::scale;
use gonio_num::dispatch::{InstructionSet, Kernel, dispatch_on};
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};
use std::ops::Range;

/// Half vectors, and the places of viewers among the slices.
struct Place<'a> {
    all: &'a AdaptiveTable,
    wi: Part<'a>,
    wo: Part<'a>,
    /// Whether more than a density is asked for, which needs the viewers' places on the square.
    viewer: bool,
    block: &'a mut Block,
}

impl Kernel for &mut Place<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let (wi, wo) = (self.wi.load::<N>(group), self.wo.load::<N>(group));
            let place = self.all.geometry.place(wi, wo);
            for k in 0..2 {
                store(place.half[k], &mut block.half[k], group);
            }
            if self.viewer {
                for k in 0..2 {
                    store(place.viewer[k], &mut block.viewer[k], group);
                }
            }
            store(place.jacobian, &mut block.jacobian, group);
            store(wi.z, &mut block.cos_i, group);
            store(wo.z, &mut block.cos_o, group);
            block.at.store(place.at, group);
        }
    }
}

/// Where half vectors are drawn from, and the density of visible normals.
struct Invert<'a, const C: usize> {
    all: &'a AdaptiveTable,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut Invert<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let blend = self
                .all
                .geometry
                .slices
                .blend::<Lanes<N>, C>(block.at.load(group));
            let half = [load(&block.half[0], group), load(&block.half[1], group)];
            let ([x, y], visible) = self.all.geometry.vndf.invert(half, &blend);
            store(x, &mut block.point[0], group);
            store(y, &mut block.point[1], group);
            store(visible, &mut block.visible, group);
        }
    }
}

/// Colours, and the density of luminance.
struct Colour<'a, const C: usize> {
    all: &'a AdaptiveTable,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut Colour<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let blend = self
                .all
                .geometry
                .slices
                .blend::<Lanes<N>, C>(block.at.load(group));
            let p = [load(&block.point[0], group), load(&block.point[1], group)];
            let [r, g, b, luminance] = self.all.colours.at(p, &blend);
            store(r, &mut block.f[0], group);
            store(g, &mut block.f[1], group);
            store(b, &mut block.f[2], group);
            store(luminance, &mut block.luminance, group);
        }
    }
}

/// The density of luminance alone.
struct Luminance<'a, const C: usize> {
    all: &'a AdaptiveTable,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut Luminance<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let blend = self
                .all
                .geometry
                .slices
                .blend::<Lanes<N>, C>(block.at.load(group));
            let p = [load(&block.point[0], group), load(&block.point[1], group)];
            let luminance = self.all.colours.density(p, &blend);
            store(luminance, &mut block.luminance, group);
        }
    }
}

/// f from colours, times a factor.
struct Shade<'a> {
    all: &'a AdaptiveTable,
    factor: [f32; 3],
    block: &'a mut Block,
}

impl Kernel for &mut Shade<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        let [x, y, z] = self.factor.map(Lanes::<N>::splat);
        for group in 0..block.groups(N) {
            let scale = self.all.geometry.scale(
                load::<N>(&block.cos_i, group),
                load(&block.cos_o, group),
                [load(&block.viewer[0], group), load(&block.viewer[1], group)],
                [load(&block.half[0], group), load(&block.half[1], group)],
            );
            let rgb = [
                load(&block.f[0], group),
                load(&block.f[1], group),
                load(&block.f[2], group),
            ];
            let [r, g, b] = Geometry::shade(scale, rgb);
            store(x * r, &mut block.f[0], group);
            store(y * g, &mut block.f[1], group);
            store(z * b, &mut block.f[2], group);
        }
    }
}

/// Densities per solid angle.
struct Density<'a> {
    block: &'a mut Block,
}

impl Kernel for &mut Density<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let pdf = Geometry::density(
                load::<N>(&block.cos_i, group),
                load(&block.cos_o, group),
                load(&block.visible, group),
                load(&block.luminance, group),
                load(&block.jacobian, group),
            );
            store(pdf, &mut block.pdf, group);
        }
    }
}

/// The places of viewers among the slices.
struct FindSlices<'a> {
    all: &'a AdaptiveTable,
    wo: Part<'a>,
    block: &'a mut Block,
}

impl Kernel for &mut FindSlices<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        for group in 0..self.block.groups(N) {
            let at = self.all.geometry.slices_of(self.wo.load::<N>(group));
            self.block.at.store(at, group);
        }
    }
}

/// The rows of drawn points. Each step of the search is made for all directions before the next: their look-ups overlap.
struct FindRow<'a, const C: usize> {
    all: &'a AdaptiveTable,
    warp: &'a Warp,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut FindRow<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        block.row = Indices::ZERO;
        let mut count = self.warp.row_steps();
        while count > 1 {
            for group in 0..block.groups(N) {
                let blend = self
                    .all
                    .geometry
                    .slices
                    .blend::<Lanes<N>, C>(block.at.load(group));
                let y = load(&block.point[1], group);
                let row = block.row.load(group);
                let row = self.warp.row_step(y, row, count / 2, &blend);
                block.row.store(row, group);
            }
            count -= count / 2;
        }
    }
}

/// Where drawn points lie between rows, and what was drawn along them as a sum.
struct EndRow<'a, const C: usize> {
    all: &'a AdaptiveTable,
    warp: &'a Warp,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut EndRow<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let blend = self
                .all
                .geometry
                .slices
                .blend::<Lanes<N>, C>(block.at.load(group));
            let (x, y) = (load(&block.point[0], group), load(&block.point[1], group));
            let [ty, along] = self.warp.row_end(x, y, block.row.load(group), &blend);
            store(ty, &mut block.between_rows, group);
            store(along, &mut block.along_row, group);
        }
    }
}

/// The columns of drawn points, as [`FindRow`].
struct FindColumn<'a, const C: usize> {
    all: &'a AdaptiveTable,
    warp: &'a Warp,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut FindColumn<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        block.column = Indices::ZERO;
        let mut count = self.warp.column_steps();
        while count > 1 {
            for group in 0..block.groups(N) {
                let blend = self
                    .all
                    .geometry
                    .slices
                    .blend::<Lanes<N>, C>(block.at.load(group));
                let (x, ty) = (
                    load(&block.along_row, group),
                    load(&block.between_rows, group),
                );
                let (row, column) = (block.row.load(group), block.column.load(group));
                let column = self.warp.column_step(x, ty, row, column, count / 2, &blend);
                block.column.store(column, group);
            }
            count -= count / 2;
        }
    }
}

/// Drawn points.
struct EndColumn<'a, const C: usize> {
    all: &'a AdaptiveTable,
    warp: &'a Warp,
    block: &'a mut Block,
}

impl<const C: usize> Kernel for &mut EndColumn<'_, C> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let block = &mut *self.block;
        for group in 0..block.groups(N) {
            let blend = self
                .all
                .geometry
                .slices
                .blend::<Lanes<N>, C>(block.at.load(group));
            let (x, ty) = (
                load(&block.along_row, group),
                load(&block.between_rows, group),
            );
            let (row, column) = (block.row.load(group), block.column.load(group));
            let [x, y] = self.warp.column_end(x, ty, row, column, &blend);
            store(x, &mut block.point[0], group);
            store(y, &mut block.point[1], group);
        }
    }
}

/// Directions mirrored about drawn half vectors.
struct Reflect<'a> {
    all: &'a AdaptiveTable,
    wo: Part<'a>,
    wi: &'a mut [Row; 3],
    block: &'a Block,
}

impl Kernel for &mut Reflect<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        for group in 0..self.block.groups(N) {
            let point = &self.block.point;
            let p = [load(&point[0], group), load(&point[1], group)];
            let wi = self
                .all
                .geometry
                .reflect(self.wo.load::<N>(group), p)
                .to_array();
            for k in 0..3 {
                store(wi[k], &mut self.wi[k], group);
            }
        }
    }
}

/// Samples of directions, f and densities, in their places.
struct Weigh<'a> {
    wi: &'a mut [Row; 3],
    block: &'a mut Block,
}

impl Kernel for &mut Weigh<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const N: usize>(self) {
        let (block, wi) = (&mut *self.block, &mut *self.wi);
        for group in 0..block.groups(N) {
            let w = Vec3::new(
                load::<N>(&wi[0], group),
                load(&wi[1], group),
                load(&wi[2], group),
            );
            let f = [
                load(&block.f[0], group),
                load(&block.f[1], group),
                load(&block.f[2], group),
            ];
            let f_cos = scale(f, w.z.max(Lanes::zero()));
            let s = Sample::continuous(w, f_cos, load(&block.pdf, group));
            let w = s.wi.to_array();
            for k in 0..3 {
                store(w[k], &mut wi[k], group);
                store(s.weight[k], &mut block.f[k], group);
            }
            store(s.pdf, &mut block.pdf, group);
        }
    }
}

/// What is asked of an evaluation.
#[derive(Clone, Copy, PartialEq)]
enum Ask {
    F,
    Pdf,
    Both,
}

/// Evaluations with one representation of the slices: `C` is 1 where there is one azimuth, otherwise 2.
struct Batch<'a, const C: usize> {
    set: InstructionSet,
    all: &'a AdaptiveTable,
    factor: [f32; 3],
}

impl<const C: usize> Batch<'_, C> {
    /// f and the density of a block, as asked.
    fn evaluate(&self, ask: Ask, wi: Part<'_>, wo: Part<'_>, block: &mut Block) {
        let (set, all) = (self.set, self.all);
        let viewer = ask != Ask::Pdf;
        dispatch_on(
            set,
            &mut Place {
                all,
                wi,
                wo,
                viewer,
                block,
            },
        );
        dispatch_on(set, &mut Invert::<C> { all, block });
        if ask == Ask::Pdf {
            dispatch_on(set, &mut Luminance::<C> { all, block });
        } else {
            let factor = self.factor;
            dispatch_on(set, &mut Colour::<C> { all, block });
            dispatch_on(set, &mut Shade { all, factor, block });
        }
        if ask != Ask::F {
            dispatch_on(set, &mut Density { block });
        }
    }

    /// The points that `block.point` draws from a warp, in its place.
    fn draw(&self, warp: &Warp, block: &mut Block) {
        let (set, all) = (self.set, self.all);
        dispatch_on(set, &mut FindRow::<C> { all, warp, block });
        dispatch_on(set, &mut EndRow::<C> { all, warp, block });
        dispatch_on(set, &mut FindColumn::<C> { all, warp, block });
        dispatch_on(set, &mut EndColumn::<C> { all, warp, block });
    }

    /// A draw for each direction of a block: directions in `wi`, weights in `block.f`, densities in `block.pdf`.
    fn sample(&self, wo: Part<'_>, wi: &mut [Row; 3], block: &mut Block) {
        let (set, all) = (self.set, self.all);
        dispatch_on(set, &mut FindSlices { all, wo, block });
        self.draw(&all.geometry.luminance, block);
        self.draw(&all.geometry.vndf, block);
        dispatch_on(set, &mut Reflect { all, wo, wi, block });
        let drawn = Directions {
            x: &wi[0].0,
            y: &wi[1].0,
            z: &wi[2].0,
        };
        let part = Part { all: &drawn, at: 0 };
        self.evaluate(Ask::Both, part, wo, block);
        dispatch_on(set, &mut Weigh { wi, block });
    }
}

/// The blocks of a batch.
fn blocks(length: usize) -> impl Iterator<Item = Range<usize>> {
    (0..length)
        .step_by(BLOCK)
        .map(move |at| at..length.min(at + BLOCK))
}

impl AdaptiveTable {
    /// f times `factor` for each pair of directions; see [`batch::eval`](crate::batch::eval).
    pub(crate) fn eval_batch(
        &self,
        set: InstructionSet,
        factor: [f32; 3],
        [wi, wo]: [Directions<'_>; 2],
        result: [&mut [f32]; 3],
    ) {
        let mut block = Block::new();
        for here in blocks(wo.len()) {
            block.count = here.len();
            let [wi, wo] = [&wi, &wo].map(|all| Part {
                all,
                at: here.start,
            });
            self.evaluate_block(set, factor, Ask::F, [wi, wo], &mut block);
            for k in 0..3 {
                result[k][here.clone()].copy_from_slice(&block.f[k].0[..here.len()]);
            }
        }
    }

    /// The density for each pair of directions; see [`batch::pdf`](crate::batch::pdf).
    pub(crate) fn pdf_batch(
        &self,
        set: InstructionSet,
        [wi, wo]: [Directions<'_>; 2],
        result: &mut [f32],
    ) {
        let mut block = Block::new();
        for here in blocks(wo.len()) {
            block.count = here.len();
            let [wi, wo] = [&wi, &wo].map(|all| Part {
                all,
                at: here.start,
            });
            self.evaluate_block(set, [1.0; 3], Ask::Pdf, [wi, wo], &mut block);
            result[here.clone()].copy_from_slice(&block.pdf.0[..here.len()]);
        }
    }

    /// A draw for each direction, with weights times `factor`; see [`batch::sample`](crate::batch::sample).
    pub(crate) fn sample_batch(
        &self,
        set: InstructionSet,
        factor: [f32; 3],
        wo: Directions<'_>,
        u: [&[f32]; 3],
        result: Samples<'_, 3>,
    ) {
        let mut block = Block::new();
        let mut wi = [Row::ZERO; 3];
        for here in blocks(wo.len()) {
            let n = here.len();
            block.count = n;
            // The first number draws the row, as in the format's other programs.
            block.point[0].0[..n].copy_from_slice(&u[1][here.clone()]);
            block.point[1].0[..n].copy_from_slice(&u[0][here.clone()]);
            let wo = Part {
                all: &wo,
                at: here.start,
            };
            match self.geometry.slices.phi.len() {
                1 => self.batch::<1>(set, factor).sample(wo, &mut wi, &mut block),
                _ => self.batch::<2>(set, factor).sample(wo, &mut wi, &mut block),
            }
            for k in 0..3 {
                result.wi[k][here.clone()].copy_from_slice(&wi[k].0[..n]);
                result.weight[k][here.clone()].copy_from_slice(&block.f[k].0[..n]);
            }
            result.pdf[here.clone()].copy_from_slice(&block.pdf.0[..n]);
            result.delta[here].fill(false);
        }
    }

    fn evaluate_block(
        &self,
        set: InstructionSet,
        factor: [f32; 3],
        ask: Ask,
        [wi, wo]: [Part<'_>; 2],
        block: &mut Block,
    ) {
        match self.geometry.slices.phi.len() {
            1 => self.batch::<1>(set, factor).evaluate(ask, wi, wo, block),
            _ => self.batch::<2>(set, factor).evaluate(ask, wi, wo, block),
        }
    }

    fn batch<const C: usize>(&self, set: InstructionSet, factor: [f32; 3]) -> Batch<'_, C> {
        Batch {
            set,
            all: self,
            factor,
        }
    }
}
