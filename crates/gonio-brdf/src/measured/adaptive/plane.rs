//! Bilinear tables without slices, and with them.

use super::slices::{Blend, Slices};
use super::warp::Warp;
use crate::{Index, Number};

/// A function over the unit square, bilinear between its nodes.
#[derive(Debug, Clone)]
pub(super) struct Plane {
    width: u32,
    height: u32,
    /// The four corners of each cell: one look-up finds them all.
    cells: Vec<f32>,
}

impl Plane {
    /// From `width`×`height` values, row by row, of which negative ones count as 0. A single row holds everywhere.
    pub fn new(values: &[f32], width: usize, height: usize) -> Self {
        let row = |j: usize| &values[j.min(height - 1) * width..][..width];
        let height = height.max(2);
        let mut cells = Vec::with_capacity(4 * (width - 1) * (height - 1));
        for j in 0..height - 1 {
            for (low, high) in row(j).windows(2).zip(row(j + 1).windows(2)) {
                cells.extend([low[0], low[1], high[0], high[1]].map(|v| v.max(0.0)));
            }
        }
        Self {
            width: width as u32,
            height: height as u32,
            cells,
        }
    }

    /// The value at `[x, y]`.
    #[inline(always)]
    pub fn at<R: Number>(&self, [x, y]: [R; 2]) -> R {
        let (i, tx) = (x * R::lit(f64::from(self.width - 1))).cell(self.width);
        let (j, ty) = (y * R::lit(f64::from(self.height - 1))).cell(self.height);
        let cell = j.times(self.width - 1).plus(i).times(4);
        let [v00, v10, v01, v11] = R::gather(&self.cells, cell);
        tx.lerp(ty.lerp(v00, v01), ty.lerp(v10, v11))
    }
}

/// Red, green, blue and the density of luminance over the unit square, for each slice.
#[derive(Debug, Clone)]
pub(super) struct Colours {
    width: u32,
    height: u32,
    /// For each pair of slices, row and column: red, green, blue and the density in units of cells, of the first slice and of the
    /// second.
    nodes: Vec<f32>,
    /// The densities again, side by side, for when nothing else is asked for; and two numbers more, beside the last.
    densities: Vec<f32>,
    /// Density per area of the unit square of a density in units of cells.
    cells: f32,
}

impl Colours {
    /// From red, green and blue of each slice, colour by colour, row by row, and the densities of `luminance`.
    pub fn new(
        rgb: &[f32],
        luminance: &Warp,
        width: usize,
        height: usize,
        slices: &Slices,
    ) -> Self {
        let size = width * height;
        let colour = |slice: usize, i: usize| [0, 1, 2].map(|k| rgb[(3 * slice + k) * size + i]);
        let mut nodes = Vec::with_capacity(8 * size * slices.pairs().count());
        let mut all = Vec::new();
        for (pair, first) in slices.pairs().enumerate() {
            for (i, densities) in luminance.densities(pair).enumerate() {
                for k in 0..2 {
                    nodes.extend(colour(first + k, i));
                    nodes.push(densities[k]);
                }
                all.extend(densities);
            }
        }
        all.extend([0.0; 2]);
        Self {
            width: width as u32,
            height: height as u32,
            nodes,
            densities: all,
            cells: luminance.cells(),
        }
    }

    /// `[red, green, blue, density]` at a point, the density per area of the unit square.
    #[inline(always)]
    pub fn at<R: Number, const C: usize>(&self, p: [R; 2], blend: &Blend<R, C>) -> [R; 4] {
        let (node, tx, ty) = self.cell(p);
        let size = self.width * self.height;
        let [v00, v10, v01, v11] = blend.four(&self.nodes, size, node, self.width);
        [
            tx.lerp(ty.lerp(v00[0], v01[0]), ty.lerp(v10[0], v11[0])),
            tx.lerp(ty.lerp(v00[1], v01[1]), ty.lerp(v10[1], v11[1])),
            tx.lerp(ty.lerp(v00[2], v01[2]), ty.lerp(v10[2], v11[2])),
            tx.lerp(ty.lerp(v00[3], v01[3]), ty.lerp(v10[3], v11[3])) * R::lit(self.cells.into()),
        ]
    }

    /// The density at a point, the same to the bit as in [`Colours::at`].
    #[inline(always)]
    pub fn density<R: Number, const C: usize>(&self, p: [R; 2], blend: &Blend<R, C>) -> R {
        let (node, tx, ty) = self.cell(p);
        let size = self.width * self.height;
        let [[v00, v10], [v01, v11]] =
            blend.neighbours(&self.densities, size, node, [0, self.width]);
        tx.lerp(ty.lerp(v00, v01), ty.lerp(v10, v11)) * R::lit(self.cells.into())
    }

    /// The lower left node of a point's cell, and the place in the cell.
    #[inline(always)]
    fn cell<R: Number>(&self, [x, y]: [R; 2]) -> (R::Index, R, R) {
        let (i, tx) = (x * R::lit(f64::from(self.width - 1))).cell(self.width);
        let (j, ty) = (y * R::lit(f64::from(self.height - 1))).cell(self.height);
        (j.times(self.width).plus(i), tx, ty)
    }
}
