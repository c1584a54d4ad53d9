//! Integration over the bilinear cells of a lat-long picture.

use super::{Irradiance, estimate};
use crate::lookup::Map;
use gonio_num::{Real, Vec3};
use gonio_radiometry::quadrature::GaussLegendre;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes of the quadrature rule.
const NODES: usize = 5;

/// Intervals no wider than this are integrated by one rule: its error is then (0.05)¹⁰/10! ≈ 1e-20.
const WIDEST: f64 = PI / 64.0;

fn pieces(width: f64) -> usize {
    (width / WIDEST).ceil().max(1.0) as usize
}

/// The bilinear cells of a lat-long picture.
pub(super) struct Grid<'a> {
    map: &'a Map,
    rule: GaussLegendre,
    /// Angles from the zenith: 0, the rows' centres, π.
    theta: Vec<f64>,
    step_phi: f64,
}

/// ∫ over a band of (upper weight, lower weight) × (sinθ cosθ, sin²θ, sinθ) dθ.
type BandMoments = [f64; 6];
/// ∫ over a column of (left weight, right weight) × (sinφ, cosφ) dφ.
type ColumnMoments = [f64; 4];

impl<'a> Grid<'a> {
    pub fn new(map: &'a Map) -> Self {
        let h = map.height;
        let mut theta = vec![0.0];
        theta.extend((0..h).map(|j| PI * (j as f64 + 0.5) / h as f64));
        theta.push(PI);
        Self {
            map,
            rule: GaussLegendre::new(NODES),
            theta,
            step_phi: TAU / map.width as f64,
        }
    }

    /// ∫ of `f(x, t)` over [a, b], t running from 0 to 1 with x.
    fn integrate<const K: usize>(
        &self,
        a: f64,
        b: f64,
        f: impl Fn(f64, f64) -> [f64; K],
    ) -> [f64; K] {
        let n = pieces(b - a);
        let step = (b - a) / n as f64;
        let mut sum = [0.0; K];
        for i in 0..n {
            let from = a + i as f64 * step;
            let part = self
                .rule
                .integrate(from, from + step, |x| f(x, (x - a) / (b - a)));
            for (s, p) in sum.iter_mut().zip(part) {
                *s += p;
            }
        }
        sum
    }

    fn rows(&self, band: usize) -> (usize, usize) {
        (band.saturating_sub(1), band.min(self.map.height - 1))
    }

    fn phi(&self, column: usize) -> f64 {
        self.step_phi * (column as f64 + 0.5) - PI
    }

    fn band_moments(&self, band: usize) -> BandMoments {
        self.integrate(self.theta[band], self.theta[band + 1], |theta, t| {
            let (sin, cos) = Real::sin_cos(theta);
            let (up, down) = (1.0 - t, t);
            [
                up * sin * cos,
                down * sin * cos,
                up * sin * sin,
                down * sin * sin,
                up * sin,
                down * sin,
            ]
        })
    }

    fn column_moments(&self, column: usize) -> ColumnMoments {
        let phi = self.phi(column);
        self.integrate(phi, phi + self.step_phi, |phi, s| {
            let (sin, cos) = Real::sin_cos(phi);
            [(1.0 - s) * sin, s * sin, (1.0 - s) * cos, s * cos]
        })
    }

    /// Upper left, upper right, lower left, lower right.
    fn corners(&self, band: usize, column: usize) -> [[f64; 3]; 4] {
        let (above, below) = self.rows(band);
        let w = self.map.width;
        let right = if column + 1 == w { 0 } else { column + 1 };
        let at = |x: usize, y: usize| self.map.texels()[y * w + x].map(f64::from);
        [
            at(column, above),
            at(right, above),
            at(column, below),
            at(right, below),
        ]
    }

    /// Mean radiance.
    pub fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for band in 0..=self.map.height {
            let m = self.band_moments(band);
            let (above, below) = self.rows(band);
            let w = self.map.width;
            for (row, moment) in [(above, m[4]), (below, m[5])] {
                for texel in &self.map.texels()[row * w..(row + 1) * w] {
                    for k in 0..3 {
                        sum[k] += f64::from(texel[k]) * moment;
                    }
                }
            }
        }
        sum.map(|s| s * self.step_phi / (4.0 * PI))
    }

    /// Irradiance on a surface with the unit normal `n`.
    pub fn irradiance(&self, n: Vec3<f64>) -> Irradiance {
        let columns: Vec<_> = (0..self.map.width)
            .map(|i| {
                let centre = Real::sin_cos(self.phi(i) + 0.5 * self.step_phi);
                (centre, self.column_moments(i))
            })
            .collect();
        let mut whole = [0.0; 3];
        let (mut coarse, mut fine) = ([0.0; 3], [0.0; 3]);
        for band in 0..=self.map.height {
            let moments = self.band_moments(band);
            let (a, b) = (self.theta[band], self.theta[band + 1]);
            let (sin, cos) = Real::sin_cos(0.5 * (a + b));
            let widest_sin = if a <= FRAC_PI_2 && b >= FRAC_PI_2 {
                1.0
            } else {
                Real::sin(a).max(Real::sin(b))
            };
            // No point of the cell is farther from its centre than this.
            let reach = 0.5 * (b - a) + 0.5 * self.step_phi * widest_sin;
            let limit = if reach < FRAC_PI_2 {
                Real::sin(reach)
            } else {
                f64::INFINITY
            };
            for (column, ((sin_phi, cos_phi), of_column)) in columns.iter().enumerate() {
                let centre = n.dot(Vec3::new(sin * sin_phi, cos, -sin * cos_phi));
                if centre <= -limit {
                    continue;
                }
                let corners = self.corners(band, column);
                if centre >= limit {
                    let weights = self.whole_cell(n, &moments, of_column);
                    add(&mut whole, &corners, weights);
                } else {
                    add(&mut coarse, &corners, self.crossed_cell(n, band, column, 1));
                    add(&mut fine, &corners, self.crossed_cell(n, band, column, 2));
                }
            }
        }
        let total = |part: [f64; 3]| [0, 1, 2].map(|k| whole[k] + part[k]);
        estimate(total(fine), total(coarse))
    }

    /// ∫ of each corner's weight × n·ω dω over a cell above the horizon.
    fn whole_cell(&self, n: Vec3<f64>, band: &BandMoments, column: &ColumnMoments) -> [f64; 4] {
        let half = 0.5 * self.step_phi;
        let around = [
            n.x * column[0] - n.z * column[2],
            n.x * column[1] - n.z * column[3],
        ];
        [
            n.y * band[0] * half + band[2] * around[0],
            n.y * band[0] * half + band[2] * around[1],
            n.y * band[1] * half + band[3] * around[0],
            n.y * band[1] * half + band[3] * around[1],
        ]
    }

    /// As [`Grid::whole_cell`] where the horizon crosses: along each meridian n·ω = R cos(θ − β), which is positive
    /// within a right angle of β.
    fn crossed_cell(&self, n: Vec3<f64>, band: usize, column: usize, refine: usize) -> [f64; 4] {
        let start = self.phi(column);
        let breaks = self.breaks(n, band, start);
        let mut sum = [0.0; 4];
        for ends in breaks.windows(2) {
            let count = refine * pieces(ends[1] - ends[0]);
            let step = (ends[1] - ends[0]) / count as f64;
            for piece in 0..count {
                let from = ends[0] + piece as f64 * step;
                for (phi, weight) in self.rule.on(from, from + step) {
                    let s = (phi - start) / self.step_phi;
                    let [up, down] = self.meridian(n, band, phi);
                    sum[0] += weight * (1.0 - s) * up;
                    sum[1] += weight * s * up;
                    sum[2] += weight * (1.0 - s) * down;
                    sum[3] += weight * s * down;
                }
            }
        }
        sum
    }

    /// The longitudes between which the horizon crosses a cell's band smoothly: the cell's sides, and where the horizon
    /// meets its upper or lower edge.
    fn breaks(&self, n: Vec3<f64>, band: usize, start: f64) -> Vec<f64> {
        let end = start + self.step_phi;
        let mut breaks = vec![start, end];
        let amplitude = (n.x * n.x + n.z * n.z).sqrt();
        for theta in [self.theta[band], self.theta[band + 1]] {
            // n·ω = 0 there: amplitude · sin θ · sin(φ − φ₀) = −n.y cos θ.
            let (sin, cos) = Real::sin_cos(theta);
            let (height, reach) = (-n.y * cos, amplitude * sin);
            if height.abs() <= reach && reach > 0.0 {
                let zero = Real::atan2(n.z, n.x);
                let rise = Real::asin(height / reach);
                for root in [zero + rise, zero + PI - rise] {
                    let turns = ((start - root) / TAU).ceil();
                    let root = root + turns * TAU;
                    if root < end {
                        breaks.push(root);
                    }
                }
            }
        }
        breaks.sort_by(f64::total_cmp);
        breaks
    }

    /// ∫ of the upper and of the lower weight × max(0, n·ω) sinθ dθ along the meridian `phi` of a band.
    fn meridian(&self, n: Vec3<f64>, band: usize, phi: f64) -> [f64; 2] {
        let (a, b) = (self.theta[band], self.theta[band + 1]);
        let (sin_phi, cos_phi) = Real::sin_cos(phi);
        let across = n.x * sin_phi - n.z * cos_phi;
        let beta = Real::atan2(across, n.y);
        let mut sum = [0.0; 2];
        for beta in [beta, beta + TAU] {
            let (low, high) = (a.max(beta - FRAC_PI_2), b.min(beta + FRAC_PI_2));
            if low < high {
                let part = self.integrate(low, high, |theta, _| {
                    let (sin, cos) = Real::sin_cos(theta);
                    let t = (theta - a) / (b - a);
                    let f = (across * sin + n.y * cos) * sin;
                    [(1.0 - t) * f, t * f]
                });
                sum[0] += part[0];
                sum[1] += part[1];
            }
        }
        sum
    }
}

fn add(sum: &mut [f64; 3], corners: &[[f64; 3]; 4], weights: [f64; 4]) {
    for k in 0..3 {
        for (corner, weight) in corners.iter().zip(weights) {
            sum[k] += corner[k] * weight;
        }
    }
}
