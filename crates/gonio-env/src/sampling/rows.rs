//! Sampling by inversion: the marginal of θ, then the conditional of φ. It keeps stratified points stratified.
//!
//! The running integral of an interpolated row is the interpolation of its neighbours' running integrals, so one such table a node
//! row is all that is stored.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::nodes::{Band, Nodes, U_MAX, U_MIN, sample_linear};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3};

/// Running integrals over the node rows and over the bands.
#[derive(Debug)]
pub(super) struct Rows {
    /// For each node row, `width + 1` pairs, from node 0 around the circle: the running integral in units of a cell, and the value.
    cells: Vec<[f32; 2]>,
    /// For each node row the running integral at its end.
    whole: Vec<f32>,
    /// For each band and each k below `guides` the first and the last column where the running integral of a row between its two
    /// node rows may reach a fraction from k / `guides` to (k + 1) / `guides` of the row's: where a search begins and ends (Chen and
    /// Asau 1974, "On Generating Random Variates from an Empirical Distribution").
    guide: Vec<[u32; 2]>,
    guides: usize,
    /// For each node row the mean over the circle.
    row_mean: Vec<f64>,
    /// Running probability of the bands: `height + 2`, from 0 to 1.
    bands: Vec<f64>,
    /// For each k of 0..=`band_guides` the band where it reaches k / `band_guides`.
    band_guide: Vec<u32>,
    band_guides: usize,
}

/// Columns that a search chooses among, on average: what a line of the cache holds.
const COLUMNS_A_GUIDE: usize = 8;

impl Rows {
    pub fn new(nodes: &Nodes) -> Self {
        let (width, height) = (nodes.width, nodes.height);
        let mut cells = Vec::with_capacity((width + 1) * height);
        let (mut row_mean, mut whole) = (Vec::new(), Vec::new());
        for row in nodes.values.chunks_exact(width) {
            let mut sum = 0.0;
            for i in 0..=width {
                let value = row[i % width];
                cells.push([sum as f32, value]);
                let next = row[(i + 1) % width];
                if i < width {
                    sum += 0.5 * (f64::from(value) + f64::from(next));
                }
            }
            whole.push(sum as f32);
            row_mean.push(sum / width as f64);
        }
        let guides = width.div_ceil(COLUMNS_A_GUIDE);
        // For each node row and each k, the largest column whose running integral is at most k / guides of the row's.
        let mut reached = Vec::with_capacity((guides + 1) * height);
        for (row, whole) in cells.chunks_exact(width + 1).zip(&whole) {
            let mut i = 0;
            for k in 0..=guides {
                let bound = k as f64 / guides as f64 * f64::from(*whole);
                while i + 1 < width && f64::from(row[i + 1][0]) <= bound {
                    i += 1;
                }
                reached.push(i as u32);
            }
        }
        let mut guide = Vec::with_capacity(guides * (height + 1));
        for band in 0..=height {
            let (above, below) = nodes.rows_of(band);
            let of = |row: usize| &reached[row * (guides + 1)..(row + 1) * (guides + 1)];
            let (a, b) = (of(above), of(below));
            guide.extend((0..guides).map(|k| [a[k].min(b[k]), a[k + 1].max(b[k + 1])]));
        }
        let mut bands = vec![0.0];
        let mut sum = 0.0;
        for k in 0..=height {
            let (above, below) = nodes.rows_of(k);
            sum += nodes.band_mass(k, row_mean[above], row_mean[below]);
            bands.push(sum);
        }
        for b in &mut bands {
            *b /= sum;
        }
        let band_guides = height.clamp(64, 4096);
        let band_guide = (0..=band_guides).map(|k| {
            let v = k as f64 / band_guides as f64;
            (bands.partition_point(|&b| b <= v) - 1).min(height) as u32
        });
        Self {
            band_guide: band_guide.collect(),
            band_guides,
            cells,
            whole,
            guide,
            guides,
            row_mean,
            bands,
        }
    }

    /// A unit direction distributed by the density, from `u` in [0, 1)².
    ///
    /// u\[1\] chooses θ from the zenith down, u\[0\] the longitude; both maps are continuous but for the turn.
    #[inline]
    pub fn sample(&self, nodes: &Nodes, u: [f32; 2]) -> Vec3<f32> {
        self.samples::<1>(nodes, u.map(|u| Lanes([u]))).extract(0)
    }

    /// [`Rows::sample`] in every lane. The searches are made one lane after the other.
    #[inline(always)]
    pub fn samples<const L: usize>(&self, nodes: &Nodes, u: [Lanes<L>; 2]) -> Vec3<Lanes<L>> {
        let (least, most) = (DoubleLanes::lit(U_MIN), DoubleLanes::lit(U_MAX));
        let v = u[1].to_double().clamp(least, most);
        let zero = DoubleLanes([0.0; L]);
        let chosen = self.bands_of(v);
        let (mut start, mut end, mut means) = (zero, zero, [zero; 2]);
        let mut band = Band {
            low: zero,
            at_low: (zero, zero),
            at_high: (zero, zero),
            width: zero,
            moments: [zero; 2],
            narrow: nodes.is_narrow(),
        };
        for lane in 0..L {
            let k = chosen[lane];
            let (above, below) = nodes.rows_of(k);
            let one = nodes.band(k);
            start.0[lane] = self.bands[k];
            end.0[lane] = self.bands[k + 1];
            means[0].0[lane] = self.row_mean[above];
            means[1].0[lane] = self.row_mean[below];
            band.low.0[lane] = one.low;
            band.at_low.0.0[lane] = one.at_low.0;
            band.at_low.1.0[lane] = one.at_low.1;
            band.at_high.0.0[lane] = one.at_high.0;
            band.at_high.1.0[lane] = one.at_high.1;
            band.width.0[lane] = one.width;
            band.moments[0].0[lane] = one.moments[0];
            band.moments[1].0[lane] = one.moments[1];
        }
        let inside = (v - start) / (end - start);
        let (t, sin_cos) = band.invert(means[0], means[1], inside);
        let (column, s) = self.sample_turn(nodes, &chosen, t, u[0].to_double().clamp(least, most));
        nodes.directions(column, s, sin_cos)
    }

    /// The band where the running probability reaches `v`, in every lane.
    #[inline(always)]
    fn bands_of<const L: usize>(&self, v: DoubleLanes<L>) -> [usize; L] {
        let (mut low, mut length) = ([0; L], [0; L]);
        for lane in 0..L {
            let k = (v.0[lane] * self.band_guides as f64) as usize;
            low[lane] = self.band_guide[k] as usize;
            length[lane] = self.band_guide[k + 1] as usize + 1 - low[lane];
        }
        while longest(&length) > 1 {
            for lane in 0..L {
                let half = length[lane] / 2;
                let reached = self.bands[low[lane] + half] <= v.0[lane];
                low[lane] += if reached { half } else { 0 };
                length[lane] -= half;
            }
        }
        low
    }

    /// Column, and the place in it, of the fraction `u` of the row at `t` between two node rows.
    #[inline(always)]
    fn sample_turn<const L: usize>(
        &self,
        nodes: &Nodes,
        bands: &[usize; L],
        t: DoubleLanes<L>,
        u: DoubleLanes<L>,
    ) -> (DoubleLanes<L>, DoubleLanes<L>) {
        let zero = DoubleLanes([0.0; L]);
        let mut wholes = [zero; 2];
        let mut rows = [[0; L]; 2];
        for lane in 0..L {
            let (above, below) = nodes.rows_of(bands[lane]);
            for (k, row) in [above, below].into_iter().enumerate() {
                rows[k][lane] = row * (nodes.width + 1);
                wholes[k].0[lane] = f64::from(self.whole[row]);
            }
        }
        let x = u * t.lerp(wholes[0], wholes[1]);
        let low = self.search_turn(nodes.width, bands, &rows, t, u, x);
        let mut column = zero;
        // Of the two rows: the running integrals at both ends of the cell that was found, and the values there.
        let mut ends = [[zero; 2]; 2];
        let mut values = [[zero; 2]; 2];
        for lane in 0..L {
            column.0[lane] = low[lane] as f64;
            for k in 0..2 {
                let cells = &self.cells[rows[k][lane] + low[lane]..][..2];
                for (side, [running, value]) in cells.iter().enumerate() {
                    ends[k][side].0[lane] = f64::from(*running);
                    values[k][side].0[lane] = f64::from(*value);
                }
            }
        }
        let start = t.lerp(ends[0][0], ends[1][0]);
        let end = t.lerp(ends[0][1], ends[1][1]);
        let left = t.lerp(values[0][0], values[1][0]);
        let right = t.lerp(values[0][1], values[1][1]);
        let wide = start.lt(end);
        let length = DoubleLanes::select(wide, end - start, DoubleLanes::one());
        let inside = ((x - start) / length).saturate();
        let inside = DoubleLanes::select(wide, inside, DoubleLanes::lit(0.5));
        (column, sample_linear(left, right, inside))
    }

    /// The largest column whose running integral, between two node rows that begin at `rows`, is at most `x`, which is the fraction
    /// `u` of the whole; in every lane.
    #[inline(always)]
    fn search_turn<const L: usize>(
        &self,
        w: usize,
        bands: &[usize; L],
        rows: &[[usize; L]; 2],
        t: DoubleLanes<L>,
        u: DoubleLanes<L>,
        x: DoubleLanes<L>,
    ) -> [usize; L] {
        let at = |lane: usize, i: usize| {
            let [a, b] =
                [rows[0][lane], rows[1][lane]].map(|row| f64::from(self.cells[row + i][0]));
            (1.0 - t.0[lane]) * a + t.0[lane] * b
        };
        let (mut low, mut length) = ([0; L], [0; L]);
        for lane in 0..L {
            let k = (u.0[lane] * self.guides as f64) as usize;
            let [first, last] = self.guide[bands[lane] * self.guides + k];
            low[lane] = first as usize;
            length[lane] = (last + 1 - first) as usize;
        }
        // Halving without branches, which no processor predicts, all lanes in step: while one waits for memory, so do the others.
        while longest(&length) > 1 {
            for lane in 0..L {
                let half = length[lane] / 2;
                let reached = at(lane, low[lane] + half) <= x.0[lane];
                low[lane] += if reached { half } else { 0 };
                length[lane] -= half;
            }
        }
        for lane in 0..L {
            // The guides are right but for roundings.
            let (i, x) = (low[lane], x.0[lane]);
            if at(lane, i) > x || (i + 1 < w && at(lane, i + 1) <= x) {
                low[lane] = (1..w).rfind(|&i| at(lane, i) <= x).unwrap_or(0);
            }
        }
        low
    }
}

#[inline(always)]
fn longest<const L: usize>(lengths: &[usize; L]) -> usize {
    let mut most = 0;
    for length in lengths {
        most = most.max(*length);
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beside a peak, in rows of every share of the mass, guided searches end in the cell that a search of all cells finds.
    #[test]
    fn guided_searches_find_the_same_cell() {
        for (w, h) in [(1, 2), (2, 2), (7, 3), (200, 4), (1024, 2)] {
            let values = (0..w * h)
                .map(|k| match k % w {
                    x if x == w / 3 => 1e5,
                    x if x % 5 == 0 => 0.0,
                    x => (1 + x % 7 + k / w) as f32,
                })
                .collect();
            let nodes = Nodes::new(w, h, values).unwrap();
            let rows = Rows::new(&nodes);
            let mut misled = Rows::new(&nodes);
            // Guides that lead astray are noticed, and all cells are searched.
            misled.guide.fill([0; 2]);
            for row in 1..h {
                for (t, u) in (0..997).map(|i| (f64::from(i % 13) / 12.0, f64::from(i) / 997.0)) {
                    let u = u.clamp(U_MIN, U_MAX);
                    let whole = [row - 1, row].map(|r| f64::from(rows.whole[r]));
                    let x = u * ((1.0 - t) * whole[0] + t * whole[1]);
                    let starts = [[(row - 1) * (w + 1)], [row * (w + 1)]];
                    let found = |rows: &Rows| {
                        let [t, u, x] = [t, u, x].map(|x| DoubleLanes([x]));
                        rows.search_turn(w, &[row], &starts, t, u, x)
                    };
                    assert_eq!(found(&rows), found(&misled), "{w} {row} {t} {u}");
                }
            }
        }
    }
}
