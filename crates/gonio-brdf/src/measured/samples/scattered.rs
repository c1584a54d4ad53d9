//! Rows that form no grid, interpolated onto one.

use super::{Samples, azimuths, elevations};
use crate::measured::grid::{Axis, Boundary, Grid, Parameterization, Scale};
use gonio_num::Vec3;
use gonio_radiometry::direction::spherical_direction;
use std::f64::consts::{FRAC_PI_2, PI};

/// Rows that a value is interpolated between.
const NEAREST: usize = 8;

type Wrong = (String, String);

/// A point for each row, in a space where rows that should resemble each other are near, and its values.
struct Cloud<'a> {
    /// Ascending in their first coordinate.
    points: Vec<([f64; 6], usize)>,
    samples: &'a Samples,
    channels: usize,
}

impl<'a> Cloud<'a> {
    fn new(mut points: Vec<([f64; 6], usize)>, samples: &'a Samples, channels: usize) -> Self {
        points.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        Self {
            points,
            samples,
            channels,
        }
    }

    /// Means of the nearest points' values, weighted by 1/distance², continued into `out`; the row `without` is left out.
    fn interpolate(&self, x: [f64; 6], without: Option<usize>, out: &mut [f64]) {
        let mut best: Vec<(f64, usize)> = Vec::with_capacity(NEAREST + 1);
        let worst = |best: &Vec<(f64, usize)>| {
            if best.len() < NEAREST {
                f64::INFINITY
            } else {
                best[NEAREST - 1].0
            }
        };
        let start = self.points.partition_point(|p| p.0[0] < x[0]);
        let (mut left, mut right) = (start, start);
        loop {
            let gap = |k: usize| (self.points[k].0[0] - x[0]).powi(2);
            let to_left = (left > 0).then(|| gap(left - 1));
            let to_right = (right < self.points.len()).then(|| gap(right));
            let (k, gap) = match (to_left, to_right) {
                (Some(l), Some(r)) if l <= r => (left - 1, l),
                (_, Some(r)) => (right, r),
                (Some(l), None) => (left - 1, l),
                (None, None) => break,
            };
            // Along the first coordinate alone it is farther than what was found: so are all others.
            if gap >= worst(&best) {
                break;
            }
            if k < left {
                left -= 1;
            } else {
                right += 1;
            }
            let (point, row) = self.points[k];
            if without == Some(row) {
                continue;
            }
            let distance: f64 = point.iter().zip(x).map(|(a, b)| (a - b) * (a - b)).sum();
            if distance < worst(&best) {
                let at = best.partition_point(|b| b.0 <= distance);
                best.insert(at, (distance, row));
                best.truncate(NEAREST);
            }
        }
        out.fill(0.0);
        let mut total = 0.0;
        for (distance, row) in best {
            let weight = 1.0 / (distance + 1e-12);
            total += weight;
            let values = &self.samples.values[row * self.channels..][..self.channels];
            for (sum, value) in out.iter_mut().zip(values) {
                *sum += weight * f64::from(*value);
            }
        }
        for sum in out {
            *sum /= f64::max(total, 1e-300);
        }
    }

    /// The grid of the interpolated values where each node's point is given, and how well rows are foretold by the others.
    fn grid(
        &self,
        parameterization: Parameterization,
        axes: Vec<Axis>,
        point: &dyn Fn([f64; 4]) -> [f64; 6],
        notes: &mut Vec<String>,
    ) -> Result<Grid, Wrong> {
        let cells: usize = axes.iter().map(Axis::len).product();
        let empty = vec![0.0f32; cells * self.channels];
        let grid = Grid::new(parameterization, axes, self.channels, empty)?;
        let mut values = Vec::with_capacity(cells * self.channels);
        let mut out = vec![0.0; self.channels];
        for cell in 0..cells {
            let mut x = [0.0; 4];
            for (x, (k, axis)) in x.iter_mut().zip(grid.place(cell).iter().zip(grid.axes())) {
                *x = axis.nodes()[*k];
            }
            self.interpolate(point(x), None, &mut out);
            values.extend(out.iter().map(|v| *v as f32));
        }
        // Of at most a thousand rows.
        let step = self.points.len().div_ceil(1000).max(1);
        let (mut error, mut size) = (0.0, 0.0);
        for (x, row) in self.points.iter().step_by(step) {
            self.interpolate(*x, Some(*row), &mut out);
            let values = &self.samples.values[row * self.channels..][..self.channels];
            for (a, b) in out.iter().zip(values) {
                error += (a - f64::from(*b)).powi(2);
                size += f64::from(*b).powi(2);
            }
        }
        notes.push(format!(
            "{} rows form no grid: interpolated onto one of {} nodes between the {NEAREST} nearest; left out in turn, a row is \
             foretold by the others with a relative RMS error of {:.3}",
            self.samples.angles.len(),
            cells,
            (error / f64::max(size, 1e-300)).sqrt()
        ));
        Ok(grid.with_values(values.into()))
    }
}

/// Isotropic rows: a grid over half and difference angles, in which highlights stay in place. Reciprocal: each row counts for both
/// orders of its directions.
pub(super) fn isotropic(
    samples: &Samples,
    channels: usize,
    mirrored: bool,
    notes: &mut Vec<String>,
) -> Result<Grid, Wrong> {
    let wrong = |found: String| (found, "nodes".to_owned());
    let centres = |n: usize| (0..n).map(move |k| (k as f64 + 0.5) / n as f64);
    let axis = |nodes: Vec<f64>, boundary, scale| Axis::new(nodes, boundary, scale).map_err(wrong);
    let phi = if mirrored {
        axis(
            centres(12).map(|x| x * FRAC_PI_2).collect(),
            Boundary::Mirrored(PI),
            Scale::Linear,
        )?
    } else {
        axis(
            centres(24).map(|x| x * PI).collect(),
            Boundary::Periodic(PI),
            Scale::Linear,
        )?
    };
    let axes = vec![
        axis(
            centres(45).map(|x| x * x * FRAC_PI_2).collect(),
            Boundary::Clamped,
            Scale::SquareRoot,
        )?,
        axis(
            centres(18).map(|x| x * FRAC_PI_2).collect(),
            Boundary::Clamped,
            Scale::Linear,
        )?,
        phi,
    ];
    // √θh, θd, and a circle of φd of twice the frequency (it closes after half a turn), as large as θd and θh allow.
    let point = move |[theta_h, theta_d, phi_d, _]: [f64; 4]| {
        let h = (theta_h / FRAC_PI_2).max(0.0).sqrt();
        let d = theta_d / FRAC_PI_2;
        let r = 0.3 * d.min(1.0) * h.min(1.0);
        let (sin, cos) = gonio_num::Real::sin_cos(2.0 * phi_d);
        let y = if mirrored { sin.abs() } else { sin };
        [3.0 * h, d, r * cos, r * y, 0.0, 0.0]
    };
    let p = Parameterization::HalfDifference;
    let points = rows(samples, |wi, wo| point(p.coordinates(wi, wo)));
    Cloud::new(points, samples, channels).grid(p, axes, &point, notes)
}

/// Rows of any kind: a grid over both directions.
pub(super) fn anisotropic(
    samples: &Samples,
    channels: usize,
    notes: &mut Vec<String>,
) -> Result<Grid, Wrong> {
    let wrong = |found: String| (found, "nodes".to_owned());
    let axes = vec![
        elevations(10).map_err(wrong)?,
        azimuths(15.0).map_err(wrong)?,
        elevations(10).map_err(wrong)?,
        azimuths(15.0).map_err(wrong)?,
    ];
    let point = |wi: Vec3<f64>, wo: Vec3<f64>| [wi.x, wi.y, wi.z, wo.x, wo.y, wo.z];
    let p = Parameterization::SphericalAnisotropic;
    let of_node = |x: [f64; 4]| {
        let (wi, wo) = p.directions(x);
        point(wi, wo)
    };
    let points = rows(samples, point);
    Cloud::new(points, samples, channels).grid(p, axes, &of_node, notes)
}

fn rows(
    samples: &Samples,
    point: impl Fn(Vec3<f64>, Vec3<f64>) -> [f64; 6],
) -> Vec<([f64; 6], usize)> {
    let angles = samples.angles.iter().enumerate();
    angles
        .map(|(row, a)| {
            let wi = spherical_direction(a[0], a[1]);
            let wo = spherical_direction(a[2], a[3]);
            (point(wi, wo), row)
        })
        .collect()
}
