//! [`Nodes`], a piecewise bilinear density over the sphere of directions.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use crate::lookup::{Bilinear, Taps};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3};
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

/// The solution t in [0, 1] of ∫₀ᵗ ((1 − s) a + s b) ds = u (a + b) / 2, for a, b ≥ 0; 1/2 where both are 0.
#[inline(always)]
pub(super) fn sample_linear<R: Real>(a: R, b: R, u: R) -> R {
    let root = (a * a + u * (b * b - a * a)).safe_sqrt();
    let some = (a + b).gt(R::zero());
    let below = R::select(some, a + root, R::one());
    R::select(some, (u * (a + b) / below).min(R::one()), R::lit(0.5))
}

/// ∫ sin x dx and ∫ (x − θ₀) sin x dx from θ₀ to θ, of which sin and cos are given.
#[inline(always)]
fn integrals<R: Real>(low: R, (sin_low, cos_low): (R, R), high: R, (sin, cos): (R, R)) -> [R; 2] {
    [cos_low - cos, sin - sin_low - (high - low) * cos]
}

/// What the inversion of a band needs to know of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Band<R> {
    /// The angle from the zenith at its upper end.
    low: R,
    /// Sine and cosine there.
    at_low: (R, R),
    /// Its width as an angle.
    width: R,
    /// The value at its upper end, and how fast it rises.
    above: R,
    slope: R,
    /// ∫ of the value times sin θ dθ.
    mass: R,
    /// The value times sin θ at both ends.
    products: [R; 2],
    /// Whether bands are so narrow that a short series gives sines and cosines within one.
    narrow: bool,
}

/// The numbers that a [`Band`] is made of.
pub(super) const BAND_NUMBERS: usize = 9;

impl<R: Real> Band<R> {
    /// The band of these [`Band::numbers`].
    #[inline(always)]
    pub fn of(numbers: [R; BAND_NUMBERS], narrow: bool) -> Self {
        let [low, sin, cos, width, above, slope, mass, first, last] = numbers;
        Self {
            low,
            at_low: (sin, cos),
            width,
            above,
            slope,
            mass,
            products: [first, last],
            narrow,
        }
    }

    /// All but [`Nodes::is_narrow`], for a table.
    pub fn numbers(&self) -> [R; BAND_NUMBERS] {
        let (sin, cos) = self.at_low;
        let [first, last] = self.products;
        let (low, width, above) = (self.low, self.width, self.above);
        [
            low, sin, cos, width, above, self.slope, self.mass, first, last,
        ]
    }

    /// Sine and cosine at the angle `low` + `turn`, 0 ≤ turn ≤ width.
    ///
    /// In a narrow band turn < 1/16: the series leave out less than 1/16⁷ / 7! = 7e-13 and 1/16⁸ / 8! = 6e-15.
    #[inline(always)]
    fn sin_cos(&self, turn: R) -> (R, R) {
        if !self.narrow {
            return (self.low + turn).sin_cos();
        }
        let x2 = turn * turn;
        let (third, fifth) = (R::lit(-1.0 / 6.0), R::lit(1.0 / 120.0));
        let sin = turn * (R::one() + x2 * (third + x2 * fifth));
        let (second, fourth, sixth) = (R::lit(-0.5), R::lit(1.0 / 24.0), R::lit(-1.0 / 720.0));
        let cos = R::one() + x2 * (second + x2 * (fourth + x2 * sixth));
        let (s, c) = self.at_low;
        (s * cos + c * sin, c * cos - s * sin)
    }

    /// The place t in [0, 1] where the running integral of the value, which goes linearly in θ, times sin θ, reaches the fraction
    /// `u`; with sin and cos of the angle.
    ///
    /// Newton's method on the closed form, from where the product is taken to be linear in θ: one step is the rule.
    #[inline(always)]
    pub fn invert(&self, u: R) -> (R, [R; 2]) {
        let Self {
            low,
            at_low,
            width,
            above,
            slope,
            mass,
            products,
            ..
        } = *self;
        let target = u * mass;
        // At a pole both ends of the product may be 0: the guess is then the middle.
        let guess = sample_linear(products[0], products[1], u).saturate();
        let [t] = R::repeat(8, [guess], |_, [t]| {
            let turn = t * width;
            let (sin, cos) = self.sin_cos(turn);
            let [flat, rising] = integrals(low, at_low, low + turn, (sin, cos));
            let density = (above + slope * turn) * sin * width;
            let some = density.gt(R::zero());
            let error = above * flat + slope * rising - target;
            let quarter = R::lit(0.25) * t;
            let next = (t - error / R::select(some, density, R::one()))
                .clamp(quarter, quarter + R::lit(0.75));
            // Quadratic: what is left is about the square of the step over the place.
            let far = (R::lit(1e-4) * t.min(R::one() - t)).lt((next - t).abs());
            ([R::select(some, next, t)], some & far)
        });
        let (sin, cos) = self.sin_cos(t * width);
        (t, [sin, cos])
    }
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

    /// [`Nodes::density`] in every lane, at taps of a grid of this size.
    #[inline(always)]
    pub fn densities<const L: usize>(&self, taps: &Taps<L>) -> Lanes<L> {
        let mut values = [Lanes([0.0; L]); 4];
        for k in 0..4 {
            for lane in 0..L {
                values[k].0[lane] = self.values[taps.corners[k][lane] as usize];
            }
        }
        let (gu, gv) = (Lanes::one() - taps.fu, Lanes::one() - taps.fv);
        let high = values[0] * gu + values[1] * taps.fu;
        let low = values[2] * gu + values[3] * taps.fu;
        let value = high * gv + low * taps.fv;
        (value.to_double() * DoubleLanes::splat(self.scale)).to_single()
    }

    /// What the inversion of a band needs to know of it, of a value that goes from `above` to `below`.
    #[inline(always)]
    pub fn band(&self, band: usize, above: f64, below: f64) -> Band<f64> {
        let [low, high] = self.band_ends(band);
        let [at_low, at_high] = [self.sin_cos[band], self.sin_cos[band + 1]];
        let width = high - low;
        Band {
            low,
            at_low,
            width,
            above,
            slope: (below - above) / width,
            mass: self.band_mass(band, above, below),
            products: [above * at_low.0, below * at_high.0],
            narrow: self.is_narrow(),
        }
    }

    /// [`Band::narrow`].
    #[inline(always)]
    pub fn is_narrow(&self) -> bool {
        self.height > 50
    }

    /// [`Band::invert`].
    #[inline(always)]
    pub fn invert_band(&self, band: usize, above: f64, below: f64, u: f64) -> (f64, [f64; 2]) {
        self.band(band, above, below).invert(u)
    }

    /// A point of a cell with the cell's share of the density, from `u` in [0, 1]²: u\[1] chooses θ, u\[0] the longitude.
    #[inline(always)]
    pub fn sample_cell(&self, band: usize, column: usize, u: [f64; 2]) -> Vec3<f32> {
        let u = u.map(|u| u.clamp(U_MIN, U_MAX));
        let [a, b, c, d] = self.corners(band, column);
        let (t, sin_cos) = self.invert_band(band, 0.5 * (a + b), 0.5 * (c + d), u[1]);
        let (left, right) = ((1.0 - t) * a + t * c, (1.0 - t) * b + t * d);
        let s = sample_linear(left, right, u[0]);
        self.direction(column, s, sin_cos)
    }

    /// The direction at `s` in [0, 1] of a column and at an angle from the zenith given by its sine and cosine.
    #[inline(always)]
    pub fn direction(&self, column: usize, s: f64, sin_cos: [f64; 2]) -> Vec3<f32> {
        let sin_cos = sin_cos.map(|x| DoubleLanes([x]));
        let (column, s) = (DoubleLanes([column as f64]), DoubleLanes([s]));
        self.directions::<1>(column, s, sin_cos).extract(0)
    }

    /// [`Nodes::direction`] in every lane.
    #[inline(always)]
    pub fn directions<const L: usize>(
        &self,
        column: DoubleLanes<L>,
        s: DoubleLanes<L>,
        [sin, cos]: [DoubleLanes<L>; 2],
    ) -> Vec3<Lanes<L>> {
        let one = DoubleLanes::one();
        let turn = (DoubleLanes::lit(0.5) + column + s) / DoubleLanes::lit(self.width as f64);
        let turn = DoubleLanes::select(one.le(turn), turn - one, turn);
        let angle = DoubleLanes::lit(TAU) * (turn - DoubleLanes::lit(0.5));
        let (sin_phi, cos_phi) = angle.to_single().sin_cos();
        let r = sin.to_single();
        Vec3::new(r * sin_phi, cos.to_single(), -(r * cos_phi))
    }

    /// The mean of the values over the sphere.
    pub fn mean(&self) -> f64 {
        1.0 / (4.0 * PI * self.scale)
    }
}
