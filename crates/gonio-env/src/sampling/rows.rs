//! Sampling by inversion: the marginal of θ, then the conditional of φ. It keeps stratified points stratified.
//!
//! The running integral of an interpolated row is the interpolation of its neighbours' running integrals, so one such table a node
//! row is all that is stored.

use super::nodes::{Nodes, U_MAX, U_MIN, sample_linear};
use gonio_num::Vec3;

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
        Self {
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
        let v = f64::from(u[1]).clamp(U_MIN, U_MAX);
        let band = (self.bands.partition_point(|&b| b <= v) - 1).min(nodes.height);
        let (above, below) = nodes.rows_of(band);
        let inside = (v - self.bands[band]) / (self.bands[band + 1] - self.bands[band]);
        let (t, sin_cos) =
            nodes.invert_band(band, self.row_mean[above], self.row_mean[below], inside);
        let (column, s) =
            self.sample_turn(nodes, above, below, t, f64::from(u[0]).clamp(U_MIN, U_MAX));
        nodes.direction(column, s, sin_cos)
    }

    /// Column, and the place in it, of the fraction `u` of the row at `t` between two node rows.
    #[inline(always)]
    fn sample_turn(
        &self,
        nodes: &Nodes,
        above: usize,
        below: usize,
        t: f64,
        u: f64,
    ) -> (usize, f64) {
        let w = nodes.width;
        let a = &self.running[above * (w + 1)..(above + 1) * (w + 1)];
        let b = &self.running[below * (w + 1)..(below + 1) * (w + 1)];
        let at = |i: usize| (1.0 - t) * f64::from(a[i]) + t * f64::from(b[i]);
        let x = u * at(w);
        // Largest i with at(i) ≤ x. It lies between those of the two rows.
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
        let value = |i: usize| {
            (1.0 - t) * f64::from(nodes.values[above * w + i])
                + t * f64::from(nodes.values[below * w + i])
        };
        let (start, end) = (at(low), at(low + 1));
        let next = if low + 1 == w { 0 } else { low + 1 };
        let (left, right) = (value(low), value(next));
        let inside = if end > start {
            ((x - start) / (end - start)).clamp(0.0, 1.0)
        } else {
            0.5
        };
        let s = if left + right > 0.0 {
            sample_linear(left, right, inside)
        } else {
            0.5
        };
        (low, s)
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
                    let guided = rows.sample_turn(&nodes, row - 1, row, t, u);
                    let plain = misled.sample_turn(&nodes, row - 1, row, t, u);
                    assert_eq!(guided, plain, "{w} {row} {t} {u}");
                }
            }
        }
    }
}
