//! [`SphereTable`], a piecewise bilinear density over the sphere of directions.
//!
//! Nodes stand at the texel centres of a latitude–longitude grid. Between them the value is interpolated linearly in
//! longitude and in y = cos θ; beyond the first and last row it is constant along meridians. As dω = dφ dy, the value,
//! divided by its integral, is itself the density per steradian: no Jacobian appears, and the poles are no exception.
//!
//! Sampling inverts the marginal of y and then the conditional of φ exactly. The running integral of an interpolated row
//! is the interpolation of its neighbours' running integrals, so one such table a node row is all that is stored.

use crate::lookup::Bilinear;
use gonio_num::{Real, Vec3};
use std::f64::consts::{PI, TAU};

/// Half a step of a 24-bit random number: the smallest u that is used, so that a density that starts from 0 is left
/// at a point where it is positive.
const U_MIN: f64 = 0.5 / 16_777_216.0;
/// The largest: sampling never runs past the last cell.
const U_MAX: f64 = 1.0 - 1.0 / 16_777_216.0;

/// Intervals of probability that a node row's guide tells apart.
const GUIDES: usize = 64;

/// A density over the sphere, with its sampling.
#[derive(Debug)]
pub(crate) struct SphereTable {
    width: usize,
    height: usize,
    /// Row-major node values relative to the largest.
    values: Vec<f32>,
    /// For each node row, `width + 1` running integrals in units of a cell, from node 0 around the circle.
    running: Vec<f32>,
    /// For each node row and each k of 0..=[`GUIDES`], the largest index whose running integral is at most k / [`GUIDES`] of the
    /// row's: where a search may begin and end (Chen and Asau 1974, "On Generating Random Variates from an Empirical
    /// Distribution").
    guide: Vec<u32>,
    /// y at the zenith, at each node row, at the nadir: `height + 2` of them, falling.
    y: Vec<f64>,
    /// For each node row the mean over the circle.
    row_mean: Vec<f64>,
    /// Running probability of the bands between neighbouring y: `height + 2`, from 0 to 1.
    bands: Vec<f64>,
    /// 1 / ∫ value dω.
    scale: f64,
}

/// The solution t in [0, 1] of ∫₀ᵗ ((1 − s) a + s b) ds = u (a + b) / 2, for a, b ≥ 0 with a + b > 0.
#[inline(always)]
fn sample_linear(a: f64, b: f64, u: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    (u * (a + b) / (a + root)).min(1.0)
}

impl SphereTable {
    /// A table of `width` × `height` node values, each finite and ≥ 0. `None` if all are 0.
    pub fn new(width: usize, height: usize, mut values: Vec<f32>) -> Option<Self> {
        debug_assert_eq!(values.len(), width * height);
        let largest = values.iter().copied().fold(0.0, f32::max);
        if largest <= 0.0 {
            return None;
        }
        // Relative values keep running sums in range whatever the unit of the picture.
        for v in &mut values {
            *v = (f64::from(*v) / f64::from(largest)) as f32;
        }
        let mut running = Vec::with_capacity((width + 1) * height);
        let mut row_mean = Vec::with_capacity(height);
        for row in values.chunks_exact(width) {
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
        let mut y = vec![1.0];
        y.extend((0..height).map(|j| Real::cos(PI * (j as f64 + 0.5) / height as f64)));
        y.push(-1.0);
        let mut bands = vec![0.0];
        let mut sum = 0.0;
        for k in 0..=height {
            let (above, below) = Self::rows_of_band(k, height);
            sum += (y[k] - y[k + 1]) * 0.5 * (row_mean[above] + row_mean[below]);
            bands.push(sum);
        }
        for b in &mut bands {
            *b /= sum;
        }
        Some(Self {
            width,
            height,
            values,
            running,
            guide,
            y,
            row_mean,
            bands,
            scale: 1.0 / (TAU * sum),
        })
    }

    /// Node rows above and below band `k` of 0..=height. The two polar bands have one row.
    #[inline(always)]
    fn rows_of_band(k: usize, height: usize) -> (usize, usize) {
        (k.saturating_sub(1), k.min(height - 1))
    }

    /// A unit direction distributed by the density, from `u` in [0, 1)².
    ///
    /// u\[1\] chooses y from the zenith down, u\[0\] the longitude; both maps are continuous but for the turn.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Vec3<f32> {
        let (k, t) = self.sample_band(f64::from(u[1]).clamp(U_MIN, U_MAX));
        let (above, below) = Self::rows_of_band(k, self.height);
        let turn = self.sample_turn(above, below, t, f64::from(u[0]).clamp(U_MIN, U_MAX));
        let y = self.y[k] + t * (self.y[k + 1] - self.y[k]);
        let r = ((1.0 - y) * (1.0 + y)).max(0.0).sqrt() as f32;
        let (sin, cos) = Real::sin_cos((TAU * (turn - 0.5)) as f32);
        Vec3::new(r * sin, y as f32, -r * cos)
    }

    /// Band and place in it (0 above, 1 below).
    #[inline(always)]
    fn sample_band(&self, u: f64) -> (usize, f64) {
        let k = (self.bands.partition_point(|&b| b <= u) - 1).min(self.height);
        let (above, below) = Self::rows_of_band(k, self.height);
        let inside = (u - self.bands[k]) / (self.bands[k + 1] - self.bands[k]);
        (
            k,
            sample_linear(self.row_mean[above], self.row_mean[below], inside),
        )
    }

    /// Longitude in turns (the panorama's u) in the row at `t` between two node rows.
    #[inline(always)]
    fn sample_turn(&self, above: usize, below: usize, t: f64, u: f64) -> f64 {
        let w = self.width;
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
            (1.0 - t) * f64::from(self.values[above * w + i])
                + t * f64::from(self.values[below * w + i])
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
        let turn = (0.5 + low as f64 + s) / w as f64;
        if turn >= 1.0 { turn - 1.0 } else { turn }
    }

    /// Density per steradian at the unit direction `d`, whose lat-long coordinates are `uv`.
    #[inline]
    pub fn density(&self, d: Vec3<f32>, uv: [f32; 2]) -> f32 {
        let b = Bilinear::wrapped(uv, self.width, self.height);
        // Band 0 lies above the first node row, band k between rows k − 1 and k.
        let k = (uv[1] * self.height as f32 + 0.5).clamp(0.0, self.height as f32) as usize;
        let (above, below) = Self::rows_of_band(k, self.height);
        // 1 − |y| from x² + z²: exact where y itself, near a pole, has no digits left.
        let s2 = f64::from(d.x) * f64::from(d.x) + f64::from(d.z) * f64::from(d.z);
        let y_abs = 1.0 - s2 / (1.0 + f64::from(d.y.abs()));
        let y = if d.y < 0.0 { -y_abs } else { y_abs };
        let t = ((self.y[k] - y) / (self.y[k] - self.y[k + 1])).clamp(0.0, 1.0);
        let s = f64::from(b.fu);
        let row = |j: usize| {
            let row = j * self.width;
            (1.0 - s) * f64::from(self.values[row + b.left])
                + s * f64::from(self.values[row + b.right])
        };
        (((1.0 - t) * row(above) + t * row(below)) * self.scale) as f32
    }
}

/// A unit direction of the uniform density 1 / 4π, from `u` in [0, 1)².
#[inline]
pub(crate) fn uniform_direction(u: [f32; 2]) -> Vec3<f32> {
    let y = 1.0 - 2.0 * u[1];
    // 1 − y² = 4u(1 − u), without cancellation at the zenith.
    let r = (4.0 * u[1] * (1.0 - u[1])).max(0.0).sqrt();
    let (sin, cos) = Real::sin_cos(std::f32::consts::TAU * (u[0] - 0.5));
    Vec3::new(r * sin, y, -r * cos)
}

/// The uniform density over the sphere \[sr⁻¹].
pub(crate) const UNIFORM_DENSITY: f32 = (0.25 / PI) as f32;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Layout;

    #[test]
    fn the_linear_density_is_inverted() {
        for (a, b) in [
            (1.0, 1.0),
            (0.0, 1.0),
            (1.0, 0.0),
            (1e-30, 1.0),
            (1.0, 1e-30),
            (3.0, 5.0),
        ] {
            for u in [U_MIN, 0.1, 0.5, 0.9, U_MAX] {
                let t = sample_linear(a, b, u);
                let mass = (a * t + 0.5 * (b - a) * t * t) / (0.5 * (a + b));
                assert!(
                    (mass - u).abs() < 1e-12,
                    "a = {a}, b = {b}, u = {u}: t = {t}, mass {mass}"
                );
            }
        }
    }

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
            let table = SphereTable::new(w, h, values).unwrap();
            let mut misled = SphereTable::new(w, h, table.values.clone()).unwrap();
            // Guides that lead astray are noticed, and all cells are searched.
            misled.guide.fill(0);
            for row in 1..h {
                for (t, u) in (0..997).map(|i| (f64::from(i % 13) / 12.0, f64::from(i) / 997.0)) {
                    let u = u.clamp(U_MIN, U_MAX);
                    let guided = table.sample_turn(row - 1, row, t, u);
                    let plain = misled.sample_turn(row - 1, row, t, u);
                    assert_eq!(guided.to_bits(), plain.to_bits(), "{w} {row} {t} {u}");
                }
            }
        }
    }

    #[test]
    fn black_has_no_density() {
        assert!(SphereTable::new(2, 1, vec![0.0, 0.0]).is_none());
    }

    #[test]
    fn one_node_is_uniform() {
        let table = SphereTable::new(1, 1, vec![7.0]).unwrap();
        for u in [[0.0, 0.0], [0.5, 0.25], [0.999_999_94, 0.999_999_94]] {
            let d = table.sample(u);
            assert!((d.length() - 1.0).abs() < 3e-7);
            let p = table.density(d, Layout::LatLong.uv(d));
            assert!((p - UNIFORM_DENSITY).abs() <= UNIFORM_DENSITY * 1e-6, "{p}");
        }
    }

    #[test]
    fn density_near_the_poles_keeps_its_digits() {
        // Between the first two rows the value is linear in cos θ. Their angles differ by 3e-3 only.
        let (w, h) = (4, 1024);
        let mut values = vec![0.0; w * h];
        values[..w].fill(1.0);
        let table = SphereTable::new(w, h, values).unwrap();
        for step in 1..20 {
            let theta = PI / h as f64 * (0.5 + 0.05 * f64::from(step));
            let (sin, cos) = Real::sin_cos(theta);
            let d = Vec3::new(sin, cos, 0.0).to_f32();
            let (top, bottom) = (
                Real::sin(0.25 * PI / h as f64),
                Real::sin(0.75 * PI / h as f64),
            );
            let at = Real::sin(0.5 * theta);
            // cos a − cos b = 2 (sin² b/2 − sin² a/2).
            let t = (at * at - top * top) / (bottom * bottom - top * top);
            let p = f64::from(table.density(d, Layout::LatLong.uv(d))) / table.scale;
            assert!(
                (p - (1.0 - t)).abs() < 1e-5,
                "θ = {theta}: {p} against {}",
                1.0 - t
            );
        }
    }
}
