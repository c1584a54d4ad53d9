//! Sampling by inversion: the marginal of θ, then the conditional of φ. It keeps stratified points stratified.
//!
//! The running integral of an interpolated row is the interpolation of its neighbours' running integrals, so one such table a node
//! row is all that is stored.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::nodes::{Band, Nodes, U_MAX, U_MIN, sample_linear};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3};

/// Intervals of probability that a node row's guide tells apart.
const GUIDES: usize = 64;

/// Running integrals over the node rows and over the bands.
#[derive(Debug)]
pub(super) struct Rows {
    /// For each node row, `width + 1` running integrals in units of a cell, from node 0 around the circle.
    running: Vec<f32>,
    /// For each node row and each k of 0..=[`GUIDES`], the largest index whose running integral is at most k / [`GUIDES`] of the
    /// row's: where a search may begin and end (Chen and Asau 1974, "On Generating Random Variates from an Empirical
    /// Distribution").
    guide: Vec<u32>,
    /// For each node row the mean over the circle.
    row_mean: Vec<f64>,
    /// Running probability of the bands: `height + 2`, from 0 to 1.
    bands: Vec<f64>,
    /// For each k of 0..=[`GUIDES`] the band where it reaches k / [`GUIDES`].
    band_guide: Vec<u32>,
}

impl Rows {
    pub fn new(nodes: &Nodes) -> Self {
        let (width, height) = (nodes.width, nodes.height);
        let mut running = Vec::with_capacity((width + 1) * height);
        let mut row_mean = Vec::with_capacity(height);
        for row in nodes.values.chunks_exact(width) {
            let mut sum = 0.0;
            running.push(0.0);
            for i in 0..width {
                let next = row[if i + 1 == width { 0 } else { i + 1 }];
                sum += 0.5 * (f64::from(row[i]) + f64::from(next));
                running.push(sum as f32);
            }
            row_mean.push(sum / width as f64);
        }
        let mut guide = Vec::with_capacity((GUIDES + 1) * height);
        for row in running.chunks_exact(width + 1) {
            let mut i = 0;
            for k in 0..=GUIDES {
                let bound = k as f64 / GUIDES as f64 * f64::from(row[width]);
                while i + 1 < width && f64::from(row[i + 1]) <= bound {
                    i += 1;
                }
                guide.push(i as u32);
            }
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
        let band_guide = (0..=GUIDES).map(|k| {
            let v = k as f64 / GUIDES as f64;
            (bands.partition_point(|&b| b <= v) - 1).min(height) as u32
        });
        Self {
            band_guide: band_guide.collect(),
            running,
            guide,
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
        let mut rows = [[0_usize; 2]; L];
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
            let chosen = self.band_of(v.0[lane]);
            let (above, below) = nodes.rows_of(chosen);
            let one = nodes.band(chosen);
            rows[lane] = [above, below];
            start.0[lane] = self.bands[chosen];
            end.0[lane] = self.bands[chosen + 1];
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
        let (column, s) = self.sample_turn(nodes, &rows, t, u[0].to_double().clamp(least, most));
        nodes.directions(column, s, sin_cos)
    }

    /// The band where the running probability reaches `v`.
    #[inline(always)]
    fn band_of(&self, v: f64) -> usize {
        let k = (v * GUIDES as f64) as usize;
        let (mut low, high) = (
            self.band_guide[k] as usize,
            self.band_guide[k + 1] as usize + 1,
        );
        let mut length = high - low;
        while length > 1 {
            let half = length / 2;
            low += if self.bands[low + half] <= v { half } else { 0 };
            length -= half;
        }
        low
    }

    /// Column, and the place in it, of the fraction `u` of the row at `t` between two node rows.
    #[inline(always)]
    fn sample_turn<const L: usize>(
        &self,
        nodes: &Nodes,
        rows: &[[usize; 2]; L],
        t: DoubleLanes<L>,
        u: DoubleLanes<L>,
    ) -> (DoubleLanes<L>, DoubleLanes<L>) {
        let zero = DoubleLanes([0.0; L]);
        let mut column = zero;
        // Of the two rows: the running integrals at both ends of the cell that was found, the values there, and the whole.
        let mut ends = [[zero; 2]; 2];
        let mut values = [[zero; 2]; 2];
        let mut wholes = [zero; 2];
        let w = nodes.width;
        for lane in 0..L {
            let low = self.search_turn(w, rows[lane], t.0[lane], u.0[lane]);
            let next = if low + 1 == w { 0 } else { low + 1 };
            column.0[lane] = low as f64;
            for k in 0..2 {
                let row = rows[lane][k];
                let running = &self.running[row * (w + 1)..(row + 1) * (w + 1)];
                let value = &nodes.values[row * w..(row + 1) * w];
                ends[k][0].0[lane] = f64::from(running[low]);
                ends[k][1].0[lane] = f64::from(running[low + 1]);
                values[k][0].0[lane] = f64::from(value[low]);
                values[k][1].0[lane] = f64::from(value[next]);
                wholes[k].0[lane] = f64::from(running[w]);
            }
        }
        let x = u * t.lerp(wholes[0], wholes[1]);
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

    /// The largest column whose running integral, between two node rows, is at most the fraction `u` of the whole.
    #[inline(always)]
    fn search_turn(&self, w: usize, [above, below]: [usize; 2], t: f64, u: f64) -> usize {
        let a = &self.running[above * (w + 1)..(above + 1) * (w + 1)];
        let b = &self.running[below * (w + 1)..(below + 1) * (w + 1)];
        let at = |i: usize| (1.0 - t) * f64::from(a[i]) + t * f64::from(b[i]);
        let x = u * at(w);
        // It lies between those of the two rows.
        let k = (u * GUIDES as f64) as usize;
        let guides = |row: usize| {
            let at = row * (GUIDES + 1) + k;
            (self.guide[at] as usize, self.guide[at + 1] as usize)
        };
        let ((low_a, high_a), (low_b, high_b)) = (guides(above), guides(below));
        let (mut low, mut length) = (low_a.min(low_b), high_a.max(high_b) + 1);
        length -= low;
        // But for roundings.
        if at(low) > x || (low + length < w && at(low + length) <= x) {
            (low, length) = (0, w);
        }
        // Halving without branches: no processor predicts them.
        while length > 1 {
            let half = length / 2;
            low += if at(low + half) <= x { half } else { 0 };
            length -= half;
        }
        low
    }
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
            misled.guide.fill(0);
            for row in 1..h {
                for (t, u) in (0..997).map(|i| (f64::from(i % 13) / 12.0, f64::from(i) / 997.0)) {
                    let u = u.clamp(U_MIN, U_MAX);
                    let guided = rows.search_turn(w, [row - 1, row], t, u);
                    let plain = misled.search_turn(w, [row - 1, row], t, u);
                    assert_eq!(guided, plain, "{w} {row} {t} {u}");
                }
            }
        }
    }
}
