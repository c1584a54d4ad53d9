//! [`Nodes`], a piecewise bilinear density over the sphere of directions.

use crate::lookup::Bilinear;
use gonio_num::{Real, Vec3};
use std::f64::consts::{PI, TAU};

/// Half a step of a 24-bit random number: the smallest u that is used, so that a density that starts from 0 is left
/// at a point where it is positive.
pub(super) const U_MIN: f64 = 0.5 / 16_777_216.0;
/// The largest: sampling never runs past the last cell.
pub(super) const U_MAX: f64 = 1.0 - 1.0 / 16_777_216.0;

/// Node values at the texel centres of a latitude–longitude grid, and the density that they interpolate: linear in longitude and in
/// the polar angle θ, constant beyond the first and last row. The same interpolation as radiance's, so that the density is exactly
/// proportional to the luminance of the interpolated picture, per steradian; over the picture it is that times sin θ.
///
/// The cells between nodes are bands × columns: band 0 lies above the first row, band k between rows k − 1 and k.
#[derive(Debug)]
pub(super) struct Nodes {
    pub width: usize,
    pub height: usize,
    /// Row-major node values relative to the largest.
    pub values: Vec<f32>,
    /// Angles from the zenith: 0, the rows, π: `height + 2`.
    theta: Vec<f64>,
    /// Sine and cosine of each.
    sin_cos: Vec<(f64, f64)>,
    /// For each band ∫ (1 − t) sin θ dθ and ∫ t sin θ dθ, t running from 0 to 1.
    moments: Vec<[f64; 2]>,
    /// 1 / ∫ value dω.
    pub scale: f64,
}

/// The solution t in [0, 1] of ∫₀ᵗ ((1 − s) a + s b) ds = u (a + b) / 2, for a, b ≥ 0 with a + b > 0.
#[inline(always)]
pub(super) fn sample_linear(a: f64, b: f64, u: f64) -> f64 {
    let root = (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    (u * (a + b) / (a + root)).min(1.0)
}

/// ∫ sin x dx and ∫ (x − θ₀) sin x dx from θ₀ to θ, of which sin and cos are given.
#[inline(always)]
fn integrals(
    low: f64,
    (sin_low, cos_low): (f64, f64),
    high: f64,
    (sin, cos): (f64, f64),
) -> [f64; 2] {
    [cos_low - cos, sin - sin_low - (high - low) * cos]
}

impl Nodes {
    /// `width` × `height` node values, each finite and ≥ 0. `None` if all are 0.
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
        let mut theta = vec![0.0];
        theta.extend((0..height).map(|j| PI * (j as f64 + 0.5) / height as f64));
        theta.push(PI);
        let moments = theta
            .windows(2)
            .map(|ends| {
                let at = |x: f64| Real::sin_cos(x);
                let [whole, rising] = integrals(ends[0], at(ends[0]), ends[1], at(ends[1]));
                let lower = rising / (ends[1] - ends[0]);
                [whole - lower, lower]
            })
            .collect();
        let mut nodes = Self {
            width,
            height,
            values,
            sin_cos: theta.iter().map(|&x| Real::sin_cos(x)).collect(),
            theta,
            moments,
            scale: 1.0,
        };
        let sum: f64 = (0..=height)
            .map(|band| {
                let mean = |row: usize| {
                    let row = &nodes.values[row * width..(row + 1) * width];
                    row.iter().map(|v| f64::from(*v)).sum::<f64>() / width as f64
                };
                let (above, below) = nodes.rows_of(band);
                nodes.band_mass(band, mean(above), mean(below))
            })
            .sum();
        nodes.scale = 1.0 / (TAU * sum);
        Some(nodes)
    }

    /// Node rows above and below band `k` of 0..=height. The two polar bands have one row.
    #[inline(always)]
    pub fn rows_of(&self, band: usize) -> (usize, usize) {
        (band.saturating_sub(1), band.min(self.height - 1))
    }

    /// ∫ of a value that goes from `above` to `below` over a band, times sin θ dθ.
    #[inline(always)]
    pub fn band_mass(&self, band: usize, above: f64, below: f64) -> f64 {
        let [upper, lower] = self.moments[band];
        upper * above + lower * below
    }

    /// The angles from the zenith between which a band lies.
    pub fn band_ends(&self, band: usize) -> [f64; 2] {
        [self.theta[band], self.theta[band + 1]]
    }

    /// Values at the corners of a cell: upper left and right, lower left and right.
    #[inline(always)]
    pub fn corners(&self, band: usize, column: usize) -> [f64; 4] {
        let (above, below) = self.rows_of(band);
        let right = if column + 1 == self.width {
            0
        } else {
            column + 1
        };
        let at = |row: usize, x: usize| f64::from(self.values[row * self.width + x]);
        [
            at(above, column),
            at(above, right),
            at(below, column),
            at(below, right),
        ]
    }

    /// ∫ of the value over a cell, sin θ dθ du, in units of a column's width.
    pub fn cell_mass(&self, band: usize, column: usize) -> f64 {
        let [a, b, c, d] = self.corners(band, column);
        self.band_mass(band, 0.5 * (a + b), 0.5 * (c + d))
    }

    /// The cell that shows the lat-long coordinates `uv`: band and column.
    #[inline(always)]
    pub fn cell_of(&self, uv: [f32; 2]) -> (usize, usize) {
        let column = Bilinear::wrapped(uv, self.width, self.height).left;
        let band = (uv[1] * self.height as f32 + 0.5).clamp(0.0, self.height as f32) as usize;
        (band, column)
    }

    /// Density per steradian at the lat-long coordinates `uv`.
    #[inline(always)]
    pub fn density(&self, uv: [f32; 2]) -> f32 {
        let b = Bilinear::wrapped(uv, self.width, self.height);
        let row = |row: usize| {
            let at = |x: usize| self.values[row * self.width + x];
            at(b.left) * (1.0 - b.fu) + at(b.right) * b.fu
        };
        let value = row(b.top) * (1.0 - b.fv) + row(b.bottom) * b.fv;
        (f64::from(value) * self.scale) as f32
    }

    /// The place t in [0, 1] in a band where the running integral of a value that goes linearly in θ from `above` to `below`,
    /// times sin θ, reaches the fraction `u`; with sin and cos of the angle.
    ///
    /// Newton's method on the closed form, from where the product is taken to be linear in θ: one step is the rule.
    #[inline(always)]
    pub fn invert_band(&self, band: usize, above: f64, below: f64, u: f64) -> (f64, [f64; 2]) {
        let [low, high] = self.band_ends(band);
        let width = high - low;
        let (at_low, at_high) = (self.sin_cos[band], self.sin_cos[band + 1]);
        let target = u * self.band_mass(band, above, below);
        let mut t = sample_linear(above * at_low.0, below * at_high.0, u).clamp(0.0, 1.0);
        // At a pole both ends of the product may be 0, and the guess is no number.
        if t.is_nan() {
            t = 0.5;
        }
        let slope = (below - above) / width;
        for _ in 0..8 {
            let theta = low + t * width;
            let (sin, cos) = Real::sin_cos(theta);
            let [flat, rising] = integrals(low, at_low, theta, (sin, cos));
            let density = (above + slope * (theta - low)) * sin * width;
            if density <= 0.0 {
                break;
            }
            let next = (t - (above * flat + slope * rising - target) / density)
                .clamp(0.25 * t, 0.25 * t + 0.75);
            let step = next - t;
            t = next;
            // Quadratic: what is left is about the square of the step over the place.
            if step.abs() <= 1e-4 * t.min(1.0 - t) {
                // The angle is turned by at most 1e-4 more: to second order its sine is right to 1e-13.
                let turn = step * width;
                let half = 0.5 * turn * turn;
                return (
                    t,
                    [sin + turn * cos - half * sin, cos - turn * sin - half * cos],
                );
            }
        }
        let (sin, cos) = Real::sin_cos(low + t * width);
        (t, [sin, cos])
    }

    /// A point of a cell with the cell's share of the density, from `u` in [0, 1]²: u\[1] chooses θ, u\[0] the longitude.
    #[inline(always)]
    pub fn sample_cell(&self, band: usize, column: usize, u: [f64; 2]) -> Vec3<f32> {
        let u = u.map(|u| u.clamp(U_MIN, U_MAX));
        let [a, b, c, d] = self.corners(band, column);
        let (t, sin_cos) = self.invert_band(band, 0.5 * (a + b), 0.5 * (c + d), u[1]);
        let (left, right) = ((1.0 - t) * a + t * c, (1.0 - t) * b + t * d);
        let s = if left + right > 0.0 {
            sample_linear(left, right, u[0])
        } else {
            0.5
        };
        self.direction(column, s, sin_cos)
    }

    /// The direction at `s` in [0, 1] of a column and at an angle from the zenith given by its sine and cosine.
    #[inline(always)]
    pub fn direction(&self, column: usize, s: f64, [sin, cos]: [f64; 2]) -> Vec3<f32> {
        let turn = (0.5 + column as f64 + s) / self.width as f64;
        let turn = if turn >= 1.0 { turn - 1.0 } else { turn };
        let (sin_phi, cos_phi) = Real::sin_cos((TAU * (turn - 0.5)) as f32);
        let r = sin as f32;
        Vec3::new(r * sin_phi, cos as f32, -r * cos_phi)
    }

    /// The mean of the values over the sphere.
    pub fn mean(&self) -> f64 {
        1.0 / (4.0 * PI * self.scale)
    }
}
