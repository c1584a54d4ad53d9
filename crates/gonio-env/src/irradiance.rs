//! Irradiance and mean radiance of an environment, by deterministic integration in double precision (T6).
//!
//! The integrand is the interpolated radiance that rendering sees, not a sum over constant texels. A lat-long picture is
//! bilinear between texel centres: each of those cells is integrated by products of Gauss–Legendre rules that are exact
//! to rounding, and a cell that the horizon crosses is integrated only where the cosine is positive. A disc-shaped
//! picture is integrated by a midpoint rule around its axis, twice as fine as its texels.

use crate::environment::{Environment, Source, yaw_sin_cos};
use crate::lookup::Map;
use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// An irradiance with an estimate of its numerical error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Irradiance {
    /// Irradiance [W m⁻²] of each channel.
    pub value: [f64; 3],
    /// Estimated numerical error of each channel, in the same unit: the change from integrating twice as coarsely, and
    /// rounding.
    pub error: [f64; 3],
}

/// Gauss–Legendre nodes and weights on [0, 1], exact for polynomials up to degree 9.
const GAUSS: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_094_54),
    (0.230_765_344_947_158_45, 0.239_314_335_249_683_24),
    (0.5, 0.284_444_444_444_444_44),
    (0.769_234_655_052_841_6, 0.239_314_335_249_683_24),
    (0.953_089_922_969_332, 0.118_463_442_528_094_54),
];

/// Intervals no wider than this are integrated by one rule: its error is then (0.05)¹⁰/10! ≈ 1e-20.
const WIDEST: f64 = PI / 64.0;

fn pieces(width: f64) -> usize {
    (width / WIDEST).ceil().max(1.0) as usize
}

/// ∫ of `f(x, t)` over [a, b], t running from 0 to 1 with x.
fn integrate<const K: usize>(a: f64, b: f64, f: impl Fn(f64, f64) -> [f64; K]) -> [f64; K] {
    let n = pieces(b - a);
    let mut sum = [0.0; K];
    for i in 0..n {
        for (node, weight) in GAUSS {
            let t = (i as f64 + node) / n as f64;
            let values = f(a + t * (b - a), t);
            for (s, v) in sum.iter_mut().zip(values) {
                *s += weight * v;
            }
        }
    }
    sum.map(|s| s * (b - a) / n as f64)
}

impl Environment {
    /// Irradiance [W m⁻²] on a surface with normal `n` (world, of any length), E = ∫ L cosθ dω over its hemisphere (T6).
    ///
    /// Exactly π times the radiance if that is uniform. See [`Environment::irradiance_with_error`] for the error. NaN if `n`
    /// is zero or not finite: such a normal has no hemisphere.
    pub fn irradiance(&self, n: Vec3<f32>) -> [f64; 3] {
        self.irradiance_with_error(n).value
    }

    /// [`Environment::irradiance`] with an estimate of its numerical error: for a lat-long picture about 1e-9 of the
    /// value, for the disc layouts about 1e-4.
    pub fn irradiance_with_error(&self, n: Vec3<f32>) -> Irradiance {
        self.irradiances(&[n.to_f64()])[0]
    }

    /// The irradiances of several normals; a disc-shaped picture is passed through once.
    pub(crate) fn irradiances(&self, normals: &[Vec3<f64>]) -> Vec<Irradiance> {
        let scale = self.scale.map(f64::from);
        let (s, c) = yaw_sin_cos(self.yaw_deg);
        let local: Vec<_> = normals
            .iter()
            .map(|n| n.normalize())
            .map(|n| Vec3::new(c * n.x - s * n.z, n.y, s * n.x + c * n.z))
            .collect();
        let mut found: Vec<Irradiance> = match &self.source {
            Source::Uniform(radiance) => local
                .iter()
                .map(|n| {
                    Irradiance {
                        value: radiance.map(|l| f64::from(l) * PI),
                        error: [0.0; 3],
                    }
                    .nan_unless(n.is_finite())
                })
                .collect(),
            Source::Picture(p) if p.map.layout.is_disc() => {
                let fine = disc(&p.map, &local, 2);
                let coarse = disc(&p.map, &local, 1);
                fine.into_iter()
                    .zip(coarse)
                    .map(|(fine, coarse)| estimate(fine, coarse))
                    .collect()
            }
            Source::Picture(p) => {
                let grid = Grid::new(&p.map);
                local
                    .iter()
                    .map(|n| {
                        if n.is_finite() {
                            grid.irradiance(*n)
                        } else {
                            estimate([f64::NAN; 3], [f64::NAN; 3])
                        }
                    })
                    .collect()
            }
        };
        for Irradiance { value, error } in &mut found {
            for k in 0..3 {
                value[k] *= scale[k];
                error[k] *= scale[k];
            }
        }
        found
    }

    /// Radiance [W m⁻² sr⁻¹] averaged over the sphere, each direction weighing the same.
    pub fn mean_radiance(&self) -> [f64; 3] {
        let mean = match &self.source {
            Source::Uniform(radiance) => radiance.map(f64::from),
            Source::Picture(p) if p.map.layout.is_disc() => disc_sum(&p.map, 2, |_, _| {}),
            Source::Picture(p) => Grid::new(&p.map).mean(),
        };
        [0, 1, 2].map(|k| mean[k] * f64::from(self.scale[k]))
    }
}

impl Irradiance {
    fn nan_unless(self, sound: bool) -> Self {
        if sound {
            self
        } else {
            estimate([f64::NAN; 3], [f64::NAN; 3])
        }
    }
}

/// Rounding of some 1e5 to 1e7 terms of one sign.
const ROUNDING: f64 = 1e-12;

fn estimate(fine: [f64; 3], coarse: [f64; 3]) -> Irradiance {
    Irradiance {
        value: fine,
        error: [0, 1, 2].map(|k| (fine[k] - coarse[k]).abs() + ROUNDING * fine[k]),
    }
}

/// The bilinear cells of a lat-long picture.
struct Grid<'a> {
    map: &'a Map,
    /// Angles from the zenith: 0, the rows' centres, π.
    theta: Vec<f64>,
    step_phi: f64,
}

/// ∫ over a band of (upper weight, lower weight) × (sinθ cosθ, sin²θ, sinθ) dθ.
type BandMoments = [f64; 6];
/// ∫ over a column of (left weight, right weight) × (sinφ, cosφ) dφ.
type ColumnMoments = [f64; 4];

impl<'a> Grid<'a> {
    fn new(map: &'a Map) -> Self {
        let h = map.height;
        let mut theta = vec![0.0];
        theta.extend((0..h).map(|j| PI * (j as f64 + 0.5) / h as f64));
        theta.push(PI);
        Self {
            map,
            theta,
            step_phi: TAU / map.width as f64,
        }
    }

    fn rows(&self, band: usize) -> (usize, usize) {
        (band.saturating_sub(1), band.min(self.map.height - 1))
    }

    fn phi(&self, column: usize) -> f64 {
        self.step_phi * (column as f64 + 0.5) - PI
    }

    fn band_moments(&self, band: usize) -> BandMoments {
        integrate(self.theta[band], self.theta[band + 1], |theta, t| {
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
        integrate(phi, phi + self.step_phi, |phi, s| {
            let (sin, cos) = Real::sin_cos(phi);
            [(1.0 - s) * sin, s * sin, (1.0 - s) * cos, s * cos]
        })
    }

    /// Upper left, upper right, lower left, lower right.
    fn corners(&self, band: usize, column: usize) -> [[f64; 3]; 4] {
        let (above, below) = self.rows(band);
        let w = self.map.width;
        let right = if column + 1 == w { 0 } else { column + 1 };
        let at = |x: usize, y: usize| self.map.texels[y * w + x].map(f64::from);
        [
            at(column, above),
            at(right, above),
            at(column, below),
            at(right, below),
        ]
    }

    fn mean(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for band in 0..=self.map.height {
            let m = self.band_moments(band);
            let (above, below) = self.rows(band);
            let w = self.map.width;
            for (row, moment) in [(above, m[4]), (below, m[5])] {
                for texel in &self.map.texels[row * w..(row + 1) * w] {
                    for k in 0..3 {
                        sum[k] += f64::from(texel[k]) * moment;
                    }
                }
            }
        }
        sum.map(|s| s * self.step_phi / (4.0 * PI))
    }

    fn irradiance(&self, n: Vec3<f64>) -> Irradiance {
        let columns: Vec<_> = (0..self.map.width)
            .map(|i| self.column_moments(i))
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
            for (column, of_column) in columns.iter().enumerate() {
                let (sin_phi, cos_phi) = Real::sin_cos(self.phi(column) + 0.5 * self.step_phi);
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
        let (a, b) = (self.theta[band], self.theta[band + 1]);
        let start = self.phi(column);
        let count = refine * pieces(self.step_phi);
        let step = self.step_phi / count as f64;
        let mut sum = [0.0; 4];
        for piece in 0..count {
            for (node, weight) in GAUSS {
                let phi = start + (piece as f64 + node) * step;
                let s = (phi - start) / self.step_phi;
                let (sin_phi, cos_phi) = Real::sin_cos(phi);
                let across = n.x * sin_phi - n.z * cos_phi;
                let beta = Real::atan2(across, n.y);
                let mut meridian = [0.0; 2];
                for beta in [beta, beta + TAU] {
                    let (low, high) = (a.max(beta - FRAC_PI_2), b.min(beta + FRAC_PI_2));
                    if low < high {
                        let part = integrate(low, high, |theta, _| {
                            let (sin, cos) = Real::sin_cos(theta);
                            let t = (theta - a) / (b - a);
                            let f = (across * sin + n.y * cos) * sin;
                            [(1.0 - t) * f, t * f]
                        });
                        meridian[0] += part[0];
                        meridian[1] += part[1];
                    }
                }
                let w = weight * step;
                sum[0] += w * (1.0 - s) * meridian[0];
                sum[1] += w * s * meridian[0];
                sum[2] += w * (1.0 - s) * meridian[1];
                sum[3] += w * s * meridian[1];
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

/// Irradiances of a disc-shaped picture.
fn disc(map: &Map, normals: &[Vec3<f64>], fineness: usize) -> Vec<[f64; 3]> {
    let mut sums = vec![[0.0; 3]; normals.len()];
    disc_sum(map, fineness, |d, radiance_dw| {
        for (sum, n) in sums.iter_mut().zip(normals) {
            let cos = n.dot(d);
            // Also for a NaN, which then shows.
            if !(cos <= 0.0) {
                for k in 0..3 {
                    sum[k] += cos * radiance_dw[k];
                }
            }
        }
    });
    sums
}

/// Visits directions on rings around the picture's axis with radiance × solid angle; returns the mean radiance.
fn disc_sum(map: &Map, fineness: usize, mut visit: impl FnMut(Vec3<f64>, [f64; 3])) -> [f64; 3] {
    let rings = (fineness * map.width).max(64 * fineness);
    let spokes = 2 * rings;
    let turns: Vec<_> = (0..spokes)
        .map(|i| Real::sin_cos(TAU * (i as f64 + 0.5) / spokes as f64))
        .collect();
    let mut total = [0.0; 3];
    for ring in 0..rings {
        let middle = PI * (ring as f64 + 0.5) / rings as f64;
        let (sin, cos) = Real::sin_cos(middle);
        // cos a − cos b = 2 sin((a + b)/2) sin((b − a)/2).
        let solid_angle = 2.0 * sin * Real::sin(0.5 * PI / rings as f64) * TAU / spokes as f64;
        for (s, c) in &turns {
            let d = Vec3::new(sin * c, sin * s, cos);
            let l = map.radiance(d.to_f32()).map(|l| f64::from(l) * solid_angle);
            for k in 0..3 {
                total[k] += l[k];
            }
            visit(d, l);
        }
    }
    total.map(|t| t / (4.0 * PI))
}
