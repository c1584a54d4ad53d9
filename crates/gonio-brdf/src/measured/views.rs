//! [`Views`], importance sampling from tables: for each of a number of directions of the viewer a density over cells of directions.

use super::grid::axis::{Axis, Between};
use super::grid::parameterization::{azimuth, elevation, horizontal};
use super::search::{interval, last_not_above};
use crate::part::geometry::mirrored_about;
use crate::{Index, Number};
use gonio_num::Vec3;
use gonio_radiometry::warp::{around_axis, cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::TAU;

/// What a cell holds directions of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Chart {
    /// Directions to the light: for tables by these, whose cells they share.
    Incoming,
    /// Half vectors: for tables by these. A highlight stays in its place there whatever the viewer's direction is.
    Half,
}

/// Cells of directions: rings of equal sin²θ within a ring's edges, each cut into equal steps of azimuth.
#[derive(Debug, Clone)]
pub(super) struct Cells {
    pub chart: Chart,
    /// sin²θ at the rings' edges, from 0 to 1.
    pub edges: Vec<f64>,
    /// Steps of azimuth.
    pub columns: usize,
    /// Whether azimuths count from the viewer's.
    pub isotropic: bool,
}

/// Share of the samples that come from a cosine lobe instead: it reaches what the cells miss by rounding or between the viewer's
/// directions.
const COSINE_SHARE: f64 = 1.0 / 32.0;

/// A density for each of a grid of viewers' directions, constant in each cell but for the cosine of its direction.
///
/// Between the viewer's directions k a neighbour is chosen with probability ∝ wₖ Aₖ, where wₖ is its weight in linear interpolation and
/// Aₖ the integral of f·cosθi for it: so the mixture is Σ wₖ f(·, ωₖ) cosθi over its integral, proportional to the interpolant
/// where that is linear between the same directions, and its density is known exactly.
#[derive(Debug, Clone)]
pub(super) struct Views {
    chart: Chart,
    isotropic: bool,
    theta: Axis,
    phi: Axis,
    edges: Vec<f32>,
    rows: u32,
    columns: u32,
    /// ∫ f·cosθi of each view.
    totals: Vec<f32>,
    /// Cumulative probabilities of the rings of each view, rows + 1 numbers.
    rings: Vec<f32>,
    /// Cumulative probabilities within each ring of each view, columns + 1 numbers.
    steps: Vec<f32>,
    /// Probability over measure of each cell of each view, where the measure is that of the cosine-weighted solid angle of the chart.
    density: Vec<f32>,
}

impl Views {
    /// For viewers at the nodes of `theta` × `phi`; `f` is the luminance of the function at (wi, wo), without regard to the horizon of wo.
    pub fn new(
        cells: &Cells,
        theta: Axis,
        phi: Axis,
        f: &impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
    ) -> Self {
        let (rows, columns) = (cells.edges.len() - 1, cells.columns);
        let views = theta.len() * phi.len();
        let mut this = Self {
            chart: cells.chart,
            isotropic: cells.isotropic,
            edges: cells.edges.iter().map(|e| *e as f32).collect(),
            rows: rows as u32,
            columns: columns as u32,
            totals: Vec::with_capacity(views),
            rings: Vec::with_capacity(views * (rows + 1)),
            steps: Vec::with_capacity(views * rows * (columns + 1)),
            density: Vec::with_capacity(views * rows * columns),
            theta,
            phi,
        };
        let mut masses = vec![0.0; rows * columns];
        for (k, theta) in this.theta.nodes().to_vec().into_iter().enumerate() {
            for phi in this.phi.nodes().to_vec() {
                // At exactly 90° nothing is seen by half vectors; just above it everything is as it is there.
                let wo = if cells.chart == Chart::Half {
                    gonio_radiometry::direction::spherical_direction(theta.min(1.5705), phi)
                } else {
                    gonio_radiometry::direction::spherical_direction(theta, phi)
                };
                debug_assert!(k < this.theta.len());
                this.push(cells, wo, &mut masses, f);
            }
        }
        this
    }

    /// Appends a view.
    fn push(
        &mut self,
        cells: &Cells,
        wo: Vec3<f64>,
        masses: &mut [f64],
        f: &impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
    ) {
        let columns = cells.columns;
        let width = TAU / columns as f64;
        let start = if cells.isotropic { azimuth(wo) } else { 0.0 };
        // Two points of Gauss–Legendre along each side: exact where the integrand is cubic along it.
        const POINTS: [f64; 2] = [0.211_324_865_405_187_1, 0.788_675_134_594_812_9];
        for (row, pair) in cells.edges.windows(2).enumerate() {
            let rise = pair[1] - pair[0];
            for column in 0..columns {
                let mut sum = 0.0;
                for u in POINTS {
                    let s = pair[0] + u * rise;
                    for v in POINTS {
                        let phi = start + (column as f64 + v) * width;
                        let q = around_axis(phi / TAU, s.sqrt(), (1.0 - s).sqrt());
                        sum += integrand(cells.chart, q, wo, f);
                    }
                }
                masses[row * columns + column] = 0.25 * sum * 0.5 * rise * width;
            }
        }
        let total: f64 = masses.iter().sum();
        self.totals.push(total as f32);
        let ring_masses = masses.chunks(columns).map(|ring| ring.iter().sum());
        let first = self.rings.len();
        accumulate(ring_masses, &mut self.rings);
        for (row, ring) in masses.chunks(columns).enumerate() {
            let start = self.steps.len();
            accumulate(ring.iter().copied(), &mut self.steps);
            // Of the rounded numbers, so that what is reported is what is drawn.
            let of_ring = f64::from(self.rings[first + row + 1] - self.rings[first + row]);
            let measure = 0.5 * (cells.edges[row + 1] - cells.edges[row]) * width;
            for column in 0..columns {
                let step = f64::from(self.steps[start + column + 1] - self.steps[start + column]);
                self.density.push((of_ring * step / measure) as f32);
            }
        }
    }

    /// The views around `wo`, and the probability of each.
    #[inline(always)]
    fn around<R: Number>(&self, wo: Vec3<R>) -> ([R::Index; 4], [R; 4], R) {
        let theta = self.theta.around(elevation(wo));
        let along_phi = self.phi.len() > 1;
        let phi = if along_phi {
            self.phi.around(azimuth(wo))
        } else {
            let zero = R::Index::splat(0);
            Between {
                low: zero,
                high: zero,
                t: R::zero(),
            }
        };
        let stride = self.phi.len() as u32;
        let (low, high) = (theta.low.times(stride), theta.high.times(stride));
        let views = [
            low.plus(phi.low),
            high.plus(phi.low),
            low.plus(phi.high),
            high.plus(phi.high),
        ];
        let (one, t, p) = (R::one(), theta.t, phi.t);
        let mut weights = [(one - t) * (one - p), t * (one - p), (one - t) * p, t * p];
        let mut sum = R::zero();
        for k in 0..4 {
            if k < 2 || along_phi {
                weights[k] = weights[k] * R::gather::<1>(&self.totals, views[k])[0];
                sum = sum + weights[k];
            }
        }
        let some = sum.gt(R::lit(1e-30));
        let over = R::select(some, sum, one).recip();
        for k in 0..4 {
            weights[k] = R::select(some, weights[k] * over, R::zero());
        }
        let share = R::select(some, R::lit(COSINE_SHARE), one);
        (views, weights, share)
    }

    /// Density per solid angle of drawing `wi` for `wo`, both above the horizon.
    #[inline(always)]
    pub fn pdf<R: Number>(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (views, weights, share) = self.around(wo);
        let (q, jacobian) = match self.chart {
            Chart::Incoming => (wi, wi.z),
            Chart::Half => {
                let sum = wi + wo;
                let length = sum.length_squared().max(R::lit(1e-30)).sqrt();
                let h = sum * length.recip();
                // 4 ωo·h = 2 |ωi + ωo|.
                (h, h.z * (R::lit(2.0) * length).recip())
            }
        };
        let s = q.x * q.x + q.y * q.y;
        let row = last_not_above(&self.edges, R::Index::splat(0), self.rows, s);
        let q = self.turned_back(q, wo);
        let turns = azimuth(q) * R::lit(1.0 / TAU);
        let turns = turns - turns.floor();
        let column = (turns * R::lit(f64::from(self.columns))).index(self.columns - 1);
        let mut sum = R::zero();
        for k in 0..4 {
            if k < 2 || self.phi.len() > 1 {
                let at = views[k].times(self.rows).plus(row).times(self.columns);
                let [d] = R::gather(&self.density, at.plus(column));
                sum = sum + weights[k] * d;
            }
        }
        share * cosine_hemisphere_density(wi) + (R::one() - share) * sum * jacobian.max(R::zero())
    }

    /// Draws a direction for `wo` above the horizon; below the horizon where that gives nothing.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let (views, weights, share) = self.around(wo);
        let from_cosine = u[2].lt(share);
        let rest = (u[2] - share) / (R::one() - share).max(R::lit(1e-30));
        let mut view = views[0];
        let mut below = weights[0];
        for k in 1..4 {
            if k < 2 || self.phi.len() > 1 {
                view = R::select_index(below.le(rest) & weights[k].gt(R::zero()), views[k], view);
                below = below + weights[k];
            }
        }
        let (row, t) = interval(&self.rings, view.times(self.rows + 1), self.rows, u[1]);
        let at = view.times(self.rows).plus(row).times(self.columns + 1);
        let (column, turn) = interval(&self.steps, at, self.columns, u[0]);
        let [low, high] = R::gather(&self.edges, row);
        let s = t.lerp(low, high);
        let turns = (R::from_index(column) + turn) * R::lit(1.0 / f64::from(self.columns));
        let q = around_axis(turns, s.safe_sqrt(), (R::one() - s).safe_sqrt());
        let q = self.turned(q, wo);
        let wi = match self.chart {
            Chart::Incoming => q,
            Chart::Half => mirrored_about(wo, q),
        };
        Vec3::select(from_cosine, cosine_hemisphere([u[0], u[1]]), wi)
    }

    /// `q` turned about the normal by the viewer's azimuth, if azimuths count from there.
    #[inline(always)]
    fn turned<R: Number>(&self, q: Vec3<R>, wo: Vec3<R>) -> Vec3<R> {
        if !self.isotropic {
            return q;
        }
        let [cos, sin] = viewer(wo);
        crate::part::geometry::turned(q, cos, sin)
    }

    /// The inverse of `turned`.
    #[inline(always)]
    fn turned_back<R: Number>(&self, q: Vec3<R>, wo: Vec3<R>) -> Vec3<R> {
        if !self.isotropic {
            return q;
        }
        let [cos, sin] = viewer(wo);
        crate::part::geometry::turned(q, cos, -sin)
    }

    /// The luminous albedo for `wo`, by interpolation.
    #[inline(always)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        let theta = self.theta.around(elevation(wo));
        let stride = self.phi.len() as u32;
        let [low] = R::gather(&self.totals, theta.low.times(stride));
        let [high] = R::gather(&self.totals, theta.high.times(stride));
        theta.t.lerp(low, high)
    }
}

/// Cosine and sine of the viewer's azimuth.
#[inline(always)]
fn viewer<R: Number>(wo: Vec3<R>) -> [R; 2] {
    let [x, y] = horizontal(wo);
    let over = (x * x + y * y).sqrt().recip();
    [x * over, y * over]
}

/// f·cosθi by the chart's cosine-weighted solid angle, at the cell's point `q`.
fn integrand(
    chart: Chart,
    q: Vec3<f64>,
    wo: Vec3<f64>,
    f: &impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
) -> f64 {
    match chart {
        Chart::Incoming => f(q, wo),
        Chart::Half => {
            let cos = wo.dot(q);
            let wi = wo.reflect(q);
            if cos <= 0.0 || wi.z <= 0.0 {
                return 0.0;
            }
            f(wi, wo) * wi.z * 4.0 * cos / q.z.max(1e-4)
        }
    }
}

/// Appends the cumulative sums of `masses` ≥ 0 over their total, from 0 to exactly 1; even steps if they are all 0.
pub(super) fn accumulate(masses: impl Iterator<Item = f64> + Clone, into: &mut Vec<f32>) {
    let (mut total, mut count) = (0.0, 0);
    for m in masses.clone() {
        total += m;
        count += 1;
    }
    let mut sum = 0.0;
    into.push(0.0);
    for (k, m) in masses.enumerate() {
        sum += m;
        let end = if total > 0.0 {
            sum / total
        } else {
            (k + 1) as f64 / f64::from(count)
        };
        into.push(if k + 1 == count as usize {
            1.0
        } else {
            end.min(1.0) as f32
        });
    }
}
