//! [`Block`], what lies between the steps of a batch.

use super::slices::At;
use crate::LaneIndex;
use crate::batch::Directions;
use gonio_num::Vec3;
use gonio_num::lanes::Lanes;

/// Directions in a block: a multiple of every number of lanes. All its arrays together take 12 KiB.
pub(super) const BLOCK: usize = 128;

/// A number for each direction of a block, on cache lines of its own.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Row(pub [f32; BLOCK]);

impl Row {
    pub const ZERO: Self = Self([0.0; BLOCK]);
}

/// A whole number for each direction of a block.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub(super) struct Indices([u32; BLOCK]);

impl Indices {
    pub const ZERO: Self = Self([0; BLOCK]);

    #[inline(always)]
    pub fn load<const N: usize>(&self, group: usize) -> LaneIndex<N> {
        LaneIndex(self.0.as_chunks().0[group])
    }

    #[inline(always)]
    pub fn store<const N: usize>(&mut self, i: LaneIndex<N>, group: usize) {
        self.0.as_chunks_mut().0[group] = i.0;
    }
}

/// A group of lanes of a row.
#[inline(always)]
pub(super) fn load<const N: usize>(row: &Row, group: usize) -> Lanes<N> {
    Lanes(row.0.as_chunks().0[group])
}

/// To a group of lanes of a row.
#[inline(always)]
pub(super) fn store<const N: usize>(x: Lanes<N>, row: &mut Row, group: usize) {
    row.0.as_chunks_mut().0[group] = x.0;
    // Keeps the compiler from vectorising the loop around, with the same lane of many groups in one vector.
    std::hint::black_box(());
}

/// The directions from number `at` on.
#[derive(Clone, Copy)]
pub(super) struct Part<'a> {
    pub all: &'a Directions<'a>,
    pub at: usize,
}

impl Part<'_> {
    /// A group of vectors, (0, 0, 0) where the directions end.
    #[inline(always)]
    pub fn load<const N: usize>(&self, group: usize) -> Vec3<Lanes<N>> {
        let at = self.at + group * N;
        Vec3::new(
            Lanes::load_or(&self.all.x[at..], 0.0),
            Lanes::load_or(&self.all.y[at..], 0.0),
            Lanes::load_or(&self.all.z[at..], 0.0),
        )
    }
}

/// A place among the slices for each direction.
pub(super) struct Places {
    theta: Indices,
    theta_rest: Row,
    phi: Indices,
    phi_rest: Row,
}

impl Places {
    #[inline(always)]
    pub fn load<const N: usize>(&self, group: usize) -> At<Lanes<N>> {
        At {
            theta: self.theta.load(group),
            theta_rest: load(&self.theta_rest, group),
            phi: self.phi.load(group),
            phi_rest: load(&self.phi_rest, group),
        }
    }

    #[inline(always)]
    pub fn store<const N: usize>(&mut self, at: At<Lanes<N>>, group: usize) {
        self.theta.store(at.theta, group);
        self.phi.store(at.phi, group);
        store(at.theta_rest, &mut self.theta_rest, group);
        store(at.phi_rest, &mut self.phi_rest, group);
    }
}

/// What lies between the steps. Past the last direction, the lanes that fill up a group calculate with whatever is there.
pub(super) struct Block {
    /// Directions.
    pub count: usize,
    pub at: Places,
    /// Half vectors and viewers on the unit square.
    pub half: [Row; 2],
    pub viewer: [Row; 2],
    /// dωi / dA.
    pub jacobian: Row,
    pub cos_i: Row,
    pub cos_o: Row,
    /// Points of the square that visible normals are drawn from.
    pub point: [Row; 2],
    /// Density of visible normals, and of luminance.
    pub visible: Row,
    pub luminance: Row,
    /// Colours, then f, then weights.
    pub f: [Row; 3],
    pub pdf: Row,
    /// Of a search: the row and the column of a point, where it lies between rows, and the sum along the row up to it.
    pub row: Indices,
    pub column: Indices,
    pub between_rows: Row,
    pub along_row: Row,
}

impl Block {
    pub fn new() -> Self {
        Self {
            count: 0,
            at: Places {
                theta: Indices::ZERO,
                theta_rest: Row::ZERO,
                phi: Indices::ZERO,
                phi_rest: Row::ZERO,
            },
            half: [Row::ZERO; 2],
            viewer: [Row::ZERO; 2],
            jacobian: Row::ZERO,
            cos_i: Row::ZERO,
            cos_o: Row::ZERO,
            point: [Row::ZERO; 2],
            visible: Row::ZERO,
            luminance: Row::ZERO,
            f: [Row::ZERO; 3],
            pdf: Row::ZERO,
            row: Indices::ZERO,
            column: Indices::ZERO,
            between_rows: Row::ZERO,
            along_row: Row::ZERO,
        }
    }

    /// Groups of `lanes` that the directions fill.
    #[inline(always)]
    pub fn groups(&self, lanes: usize) -> usize {
        self.count.min(BLOCK).div_ceil(lanes)
    }
}
