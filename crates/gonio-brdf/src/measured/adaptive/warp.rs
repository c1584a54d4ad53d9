//! [`Warp`], densities over the unit square that are drawn from by inversion.

use super::slices::{Blend, Slices};
use crate::{Index, Number};

/// A density over the unit square for each slice, bilinear between `width`×`height` nodes, with its cumulative sums.
///
/// A point is drawn by its row first, from the density of rows, and then along the row. Between slices everything is the weighted
/// mean of theirs: densities, sums along rows, sums of rows. So drawing, inverting and the density fit each other exactly
/// there too.
#[derive(Debug, Clone)]
pub(super) struct Warp {
    width: u32,
    height: u32,
    slices: u32,
    /// For each pair of slices, row and column: the density, and its sum along the row up to here. In units of cells: the mass of a
    /// cell is the mean of its corners.
    nodes: Vec<f32>,
    /// For each pair and row: the sum of the rows below, and the sum of the whole row.
    rows: Vec<f32>,
    /// For each row and every [`STRIDE`]th column, of all slices: the sum along the row. So small that the first steps of a search stay in
    /// the cache.
    coarse: Vec<f32>,
}

/// The nodes of a row that are in one cache line.
const STRIDE: u32 = 4;

/// The cumulative sums of one slice, scaled to the integral 1.
struct Sums {
    density: Vec<f32>,
    along: Vec<f32>,
    below: Vec<f32>,
    whole: Vec<f32>,
}

impl Sums {
    fn new(table: &[f32], width: usize) -> Self {
        // Sums are made in double precision and rounded once.
        let trapezoid = |a: f64, b: f64| 0.5 * (a + b);
        let along_row = |row: &[f32]| -> Vec<f64> {
            let mut sum = 0.0;
            let steps = row.windows(2).map(|p| {
                sum += trapezoid(p[0].max(0.0).into(), p[1].max(0.0).into());
                sum
            });
            std::iter::once(0.0).chain(steps).collect()
        };
        let along: Vec<f64> = table.chunks_exact(width).flat_map(along_row).collect();
        let whole: Vec<f64> = along
            .chunks_exact(width)
            .map(|row| row[width - 1])
            .collect();
        let mut total = 0.0;
        let mut below = vec![0.0];
        for w in whole.windows(2) {
            total += trapezoid(w[0], w[1]);
            below.push(total);
        }
        let scaled = |v: Vec<f64>| v.into_iter().map(|x| (x / total) as f32).collect();
        Self {
            density: scaled(table.iter().map(|v| f64::from(v.max(0.0))).collect()),
            along: scaled(along),
            below: scaled(below),
            whole: scaled(whole),
        }
    }
}

impl Warp {
    /// From `width`×`height` values for each slice, row by row, of which negative ones count as 0; each slice is scaled to the integral 1. A slice that is 0
    /// everywhere becomes uniform.
    pub fn new(values: &[f32], width: usize, height: usize, slices: &Slices) -> Self {
        let size = width * height;
        let uniform = vec![1.0; size];
        let sums_of = |table: &[f32]| {
            let black = table.iter().all(|v| *v <= 0.0);
            Sums::new(if black { &uniform } else { table }, width)
        };
        let sums: Vec<Sums> = values.chunks_exact(size).map(sums_of).collect();
        let (mut nodes, mut rows, mut coarse) = (Vec::new(), Vec::new(), Vec::new());
        for first in slices.pairs() {
            let (a, b) = (&sums[first], &sums[first + 1]);
            for k in 0..size {
                nodes.extend([a.density[k], b.density[k], a.along[k], b.along[k]]);
            }
            for j in 0..height {
                rows.extend([a.below[j], b.below[j], a.whole[j], b.whole[j]]);
            }
        }
        for j in 0..height {
            for i in (0..width - 1).step_by(STRIDE as usize) {
                coarse.extend(sums.iter().map(|s| s.along[j * width + i]));
            }
        }
        Self {
            width: width as u32,
            height: height as u32,
            slices: sums.len() as u32,
            nodes,
            rows,
            coarse,
        }
    }

    /// Density per area of the unit square of a density in units of cells.
    #[inline(always)]
    pub fn cells<R: Number>(&self) -> R {
        R::lit(f64::from(self.width - 1) * f64::from(self.height - 1))
    }

    /// The densities of the two slices of pair `pair` at its nodes in units of cells, row by row.
    pub fn densities(&self, pair: usize) -> impl Iterator<Item = [f32; 2]> {
        let size = (self.width * self.height) as usize;
        let nodes = &self.nodes[4 * pair * size..][..4 * size];
        nodes.chunks_exact(4).map(|n| [n[0], n[1]])
    }

    /// The densities and the sums along rows at the corners of the cell whose lower left is `node`: there, right of it, above, and above
    /// right.
    #[inline(always)]
    fn corners<R: Number, const C: usize>(
        &self,
        node: R::Index,
        blend: &Blend<R, C>,
    ) -> [[R; 2]; 4] {
        let (size, up) = (self.width * self.height, self.width);
        blend.two(&self.nodes, size, node, [0, 1, up, up + 1])
    }

    /// The sums of the rows below a row and the next, and those of the whole rows.
    #[inline(always)]
    fn two_rows<R: Number, const C: usize>(
        &self,
        row: R::Index,
        blend: &Blend<R, C>,
    ) -> [[R; 2]; 2] {
        blend.two(&self.rows, self.height, row, [0, 1])
    }

    /// The lower left node of the cell of a point, and the place in the cell.
    #[inline(always)]
    fn cell<R: Number>(&self, [x, y]: [R; 2]) -> (R::Index, R::Index, R, R) {
        let (i, tx) = (x * R::lit(f64::from(self.width - 1))).cell(self.width);
        let (j, ty) = (y * R::lit(f64::from(self.height - 1))).cell(self.height);
        (j.times(self.width).plus(i), j, tx, ty)
    }

    /// The point `[x, y]` is drawn from, and the density at it: the inverse of [`Warp::draw`]. Where the density along a whole row is 0,
    /// nothing draws the point; the result is then 0 along the row.
    #[inline(always)]
    pub fn invert<R: Number, const C: usize>(&self, p: [R; 2], blend: &Blend<R, C>) -> ([R; 2], R) {
        let (node, j, tx, ty) = self.cell(p);
        let [[v00, c0], [v10, _], [v01, c1], [v11, _]] = self.corners(node, blend);
        let [[below, r0], [_, r1]] = self.two_rows(j, blend);
        let (left, right) = (ty.lerp(v00, v01), ty.lerp(v10, v11));
        let half = R::lit(0.5);
        let along = ty.lerp(c0, c1) + tx * (left + half * tx * (right - left));
        let whole = ty.lerp(r0, r1).max(R::lit(1e-30));
        let before = below + ty * (r0 + half * ty * (r1 - r0));
        ([along / whole, before], tx.lerp(left, right) * self.cells())
    }

    /// The point that the uniform numbers `[x, y]` in [0, 1) draw; `y` draws the row.
    #[inline(always)]
    pub fn draw<R: Number, const C: usize>(&self, [x, y]: [R; 2], blend: &Blend<R, C>) -> [R; 2] {
        let mut j = R::Index::splat(0);
        let mut count = self.row_steps();
        while count > 1 {
            j = self.row_step(y, j, count / 2, blend);
            count -= count / 2;
        }
        let [ty, x] = self.row_end(x, y, j, blend);
        let mut i = R::Index::splat(0);
        let mut count = self.column_steps();
        while count > 1 {
            i = self.column_step(x, ty, j, i, count / 2, blend);
            count -= count / 2;
        }
        self.column_end(x, ty, j, i, blend)
    }

    /// Rows among which [`Warp::row_step`] searches.
    pub fn row_steps(&self) -> u32 {
        self.height - 1
    }

    /// Columns among which [`Warp::column_step`] searches: every [`STRIDE`]th.
    pub fn column_steps(&self) -> u32 {
        (self.width - 1).div_ceil(STRIDE)
    }

    /// A step of the search for the last row whose sum of the rows below is not above `y`: from row `j`, known to be one, to
    /// the one `half` above, if that is one too.
    #[inline(always)]
    pub fn row_step<R: Number, const C: usize>(
        &self,
        y: R,
        j: R::Index,
        half: u32,
        blend: &Blend<R, C>,
    ) -> R::Index {
        let probe = j.plus(R::Index::splat(half));
        let [below] = blend.one(&self.rows, 4, self.height, probe, [0]);
        R::select_index(below.le(y), probe, j)
    }

    /// How far above row `j` the point is, in [0, 1]; and what `x` is as a sum along the mixture of this row and the next.
    #[inline(always)]
    pub fn row_end<R: Number, const C: usize>(
        &self,
        x: R,
        y: R,
        j: R::Index,
        blend: &Blend<R, C>,
    ) -> [R; 2] {
        let [[below, r0], [_, r1]] = self.two_rows(j, blend);
        let ty = trapezoid_inverse(y - below, r0, r1);
        [ty, x * ty.lerp(r0, r1)]
    }

    /// A step of the search for the last of every [`STRIDE`] columns whose sum along the row is not above `x`, as
    /// [`Warp::row_step`].
    #[inline(always)]
    pub fn column_step<R: Number, const C: usize>(
        &self,
        x: R,
        ty: R,
        j: R::Index,
        i: R::Index,
        half: u32,
        blend: &Blend<R, C>,
    ) -> R::Index {
        let probe = i.plus(R::Index::splat(half));
        let columns = self.column_steps();
        let node = j.times(columns).plus(probe);
        let [c0, c1] = blend.of_slices(&self.coarse, self.slices, node, [0, columns]);
        R::select_index(ty.lerp(c0, c1).le(x), probe, i)
    }

    /// The point, from the `i`th of every [`STRIDE`] columns on.
    #[inline(always)]
    pub fn column_end<R: Number, const C: usize>(
        &self,
        x: R,
        ty: R,
        j: R::Index,
        i: R::Index,
        blend: &Blend<R, C>,
    ) -> [R; 2] {
        let row = j.times(self.width);
        let (size, up) = (self.width * self.height, self.width);
        let last = self.width - 2;
        // The sums stand behind the densities.
        let sums = &self.nodes[2..];
        let mut i = i.times(STRIDE);
        let mut half = STRIDE / 2;
        while half > 0 {
            // Beyond the last column it is the last that is looked at.
            let probe = i.plus(R::Index::splat(half)).least(last);
            let node = row.plus(probe);
            let [c0, c1] = blend.one(sums, 4, size, node, [0, up]);
            i = R::select_index(ty.lerp(c0, c1).le(x), probe, i);
            half /= 2;
        }
        let node = row.plus(i);
        let [[v00, c0], [v10, _], [v01, c1], [v11, _]] = self.corners(node, blend);
        let rest = x - ty.lerp(c0, c1);
        let tx = trapezoid_inverse(rest, ty.lerp(v00, v01), ty.lerp(v10, v11));
        [
            (R::from_index(i) + tx) * R::lit(1.0 / f64::from(self.width - 1)),
            (R::from_index(j) + ty) * R::lit(1.0 / f64::from(self.height - 1)),
        ]
    }
}

/// t in [0, 1] with a t + ½ (b − a) t² = `area`, for a, b ≥ 0.
///
/// t = 2 area / (a + √(a² + 2 (b − a) area)), the root in the form that loses no digits for a ≈ b.
#[inline(always)]
fn trapezoid_inverse<R: Number>(area: R, a: R, b: R) -> R {
    let area = area.max(R::zero());
    let two = R::lit(2.0);
    let root = (a * a + two * (b - a) * area).safe_sqrt();
    (two * area / (a + root).max(R::lit(1e-30))).saturate()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    fn slices() -> Slices {
        Slices {
            theta: vec![0.0, 1.0],
            phi: vec![0.0, 1.0],
        }
    }

    /// Four slices of 5×4 nodes; the last is 0 in one corner.
    fn warp() -> Warp {
        let mut rng = Rng::from_name("warp");
        let mut values: Vec<f32> = (0..80).map(|_| rng.next_f32()).collect();
        values[60..62].fill(0.0);
        values[65..67].fill(0.0);
        Warp::new(&values, 5, 4, &slices())
    }

    #[test]
    fn inverting_undoes_drawing() {
        let (warp, slices) = (warp(), slices());
        let mut rng = Rng::from_name("inverting");
        for _ in 0..2000 {
            let blend = slices.blend::<f64, 2>(slices.around(rng.next_f64(), rng.next_f64()));
            let u = [rng.next_f64(), rng.next_f64()];
            let p = warp.draw(u, &blend);
            let (back, density) = warp.invert(p, &blend);
            assert!(density > 0.0);
            for k in 0..2 {
                // The sums are rounded to single precision, each by up to 6e-8 of the whole.
                assert!((back[k] - u[k]).abs() < 1e-6, "{u:?} {p:?} {back:?}");
            }
        }
    }

    /// The density is the Jacobian of the inverse: ∂(u)/∂(p), by differences within a cell.
    #[test]
    fn density_is_that_of_drawing() {
        let (warp, slices) = (warp(), slices());
        let mut rng = Rng::from_name("density");
        let blend = slices.blend::<f64, 2>(slices.around(0.3, 0.8));
        let mut integral = 0.0;
        let n = 2000;
        for _ in 0..n {
            // Within a cell: differences across its edges are of the order of the step.
            let p = [
                (f64::floor(4.0 * rng.next_f64()) + 0.1 + 0.8 * rng.next_f64()) / 4.0,
                (f64::floor(3.0 * rng.next_f64()) + 0.1 + 0.8 * rng.next_f64()) / 3.0,
            ];
            let at = |x, y| warp.invert([x, y], &blend).0;
            let step = 1e-5;
            let [a, c] = [0, 1]
                .map(|k| (at(p[0] + step, p[1])[k] - at(p[0] - step, p[1])[k]) / (2.0 * step));
            let [b, d] = [0, 1]
                .map(|k| (at(p[0], p[1] + step)[k] - at(p[0], p[1] - step)[k]) / (2.0 * step));
            let (_, density) = warp.invert(p, &blend);
            assert!(
                (a * d - b * c - density).abs() < 1e-5 * (1.0 + density),
                "{p:?}"
            );
            integral += density / f64::from(n);
        }
        // A mean over uniform points; its standard deviation is below 0.6 / √2000.
        assert!((integral - 1.0).abs() < 0.06, "{integral}");
    }

    #[test]
    fn ends_and_darkness_are_drawn_from() {
        let slices = slices();
        let dark = Warp::new(&[0.0; 80], 5, 4, &slices);
        let blend = slices.blend::<f64, 2>(slices.around(0.5, 0.5));
        for u in [[0.0, 0.0], [0.25, 0.75], [1.0, 1.0]] {
            let p = dark.draw(u, &blend);
            assert!(
                (p[0] - u[0]).abs() < 1e-7 && (p[1] - u[1]).abs() < 1e-7,
                "{p:?}"
            );
            assert!((dark.invert(p, &blend).1 - 1.0).abs() < 1e-6);
        }
        // Nothing is drawn where the density is 0.
        let mut values = [0.0f32; 80];
        for slice in 0..4 {
            values[slice * 20 + 12] = 1.0;
        }
        let peak = Warp::new(&values, 5, 4, &slices);
        let mut rng = Rng::from_name("peak");
        for k in 0..500 {
            let u = match k {
                0 => [0.0, 0.0],
                1 => [1.0 - f64::EPSILON, 1.0 - f64::EPSILON],
                _ => [rng.next_f64(), rng.next_f64()],
            };
            let [x, y] = peak.draw(u, &blend);
            assert!(
                (0.25..=0.75).contains(&x) && (1.0 / 3.0 - 1e-9..=1.0).contains(&y),
                "{u:?}: {x} {y}"
            );
        }
        for value in peak.invert([0.9, 0.1], &blend).0 {
            assert!(value.is_finite());
        }
    }
}
