//! [`Samples`], rows of two directions and values, as text formats list them, and how they become a grid.

use super::channel::Channel;
use super::grid::parameterization::{radians, wrapped};
use super::grid::{Axis, Boundary, Grid, Parameterization, Scale};
use super::input::{Input, MOST_VALUES};
use super::values::Values;
use crate::BrdfError;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

mod scattered;

/// Angles nearer than this are the same node.
const SAME: f64 = 2e-5;

/// Rows of two directions and values.
#[derive(Debug, Default)]
pub(super) struct Samples {
    /// θi, φi, θo, φo of each row, in radians.
    pub angles: Vec<[f64; 4]>,
    /// One number for each row and channel.
    pub values: Vec<f32>,
    /// Whether φ and −φ, the difference of the azimuths, are the same by the format's definition.
    pub bilateral: bool,
    /// Whether only the difference of the azimuths counts by the format's definition.
    pub isotropic: bool,
}

impl Samples {
    /// A grid of the rows: with their own angles for nodes if they form one, at least half of it; otherwise a regular one that is
    /// interpolated between them. What was done is added to `notes`.
    pub fn into_grid(
        self,
        input: &Input<'_>,
        channels: &[Channel],
        notes: &mut Vec<String>,
    ) -> Result<Grid, BrdfError> {
        let first = self.angles.first().map_or(0.0, |a| a[1]);
        let one_azimuth = self.angles.iter().all(|a| {
            let d = wrapped(a[1] - first + SAME);
            d < 2.0 * SAME || a[0] < SAME
        });
        if self.isotropic || one_azimuth {
            if !self.isotropic {
                notes.push("light came from one azimuth: taken as isotropic".into());
            }
            self.isotropic_grid(input, channels.len(), notes)
        } else {
            self.anisotropic_grid(input, channels.len(), notes)
        }
    }

    fn isotropic_grid(
        self,
        input: &Input<'_>,
        channels: usize,
        notes: &mut Vec<String>,
    ) -> Result<Grid, BrdfError> {
        let theta_i = Nodes::of(self.angles.iter().map(|a| a[0]));
        let theta_o = Nodes::of(self.angles.iter().map(|a| a[2]));
        let delta = |a: &[f64; 4]| wrapped(a[3] - a[1]);
        let folded = |a: &[f64; 4]| {
            let d = delta(a);
            d.min(TAU - d)
        };
        // Measured on one side of the plane of incidence, or the same on both by definition: mirrored.
        let one_side = self.bilateral || {
            let off_plane = |d: f64| d > SAME && (d - PI).abs() > SAME && d < TAU - SAME;
            let mut sides = self.angles.iter().map(delta).filter(|d| off_plane(*d));
            let first_is_left = sides.next().map(|d| d < PI);
            first_is_left.is_none_or(|left| sides.all(|d| (d < PI) == left))
        };
        if one_side && !self.bilateral {
            notes.push(
                "measured on one side of the plane of incidence: mirrored to the other".into(),
            );
        }
        let phi = |a: &[f64; 4]| if one_side { folded(a) } else { delta(a) };
        let boundary = if one_side {
            Boundary::Mirrored(TAU)
        } else {
            Boundary::Periodic(TAU)
        };
        let phis = Nodes::of_turn(self.angles.iter().map(phi));
        let place = |a: &[f64; 4]| {
            let columns = [theta_i.find(a[0])?, theta_o.find(a[2])?, phis.find(phi(a))?];
            Some((columns[0] * theta_o.len() + columns[1]) * phis.len() + columns[2])
        };
        let cells = theta_i.len() * theta_o.len() * phis.len();
        let axes = || -> Result<Vec<Axis>, String> {
            Ok(vec![
                Axis::new(theta_i.0.clone(), Boundary::Clamped, Scale::Linear)?,
                Axis::new(theta_o.0.clone(), Boundary::Clamped, Scale::Linear)?,
                Axis::new(phis.0.clone(), boundary, Scale::Linear)?,
            ])
        };
        if self.fills(cells, channels)
            && let Ok(axes) = axes()
        {
            let mut table = Table::new(cells, channels);
            for (row, a) in self.angles.iter().enumerate() {
                if let Some(at) = place(a) {
                    table.add(at, &self.values[row * channels..][..channels]);
                }
            }
            let shape = [theta_i.len(), theta_o.len(), phis.len()];
            // At the normal an azimuth has no meaning, and files often have one row for all of them.
            for (axis, nodes) in [(0, &theta_i), (1, &theta_o)] {
                if nodes.0[0] < SAME {
                    table.spread_over_azimuth(&shape, axis, 2);
                }
            }
            notes.extend(table.notes());
            return Grid::new(Parameterization::Spherical, axes, channels, table.done())
                .map_err(|(found, expected)| input.error("rows", found, expected));
        }
        scattered::isotropic(&self, channels, one_side, notes)
            .map_err(|(found, expected)| input.error("rows", found, expected))
    }

    fn anisotropic_grid(
        self,
        input: &Input<'_>,
        channels: usize,
        notes: &mut Vec<String>,
    ) -> Result<Grid, BrdfError> {
        let nodes = [0, 1, 2, 3].map(|k| {
            let angles = self.angles.iter().map(|a| a[k]);
            if k % 2 == 0 {
                Nodes::of(angles)
            } else {
                Nodes::of_turn(angles.map(wrapped))
            }
        });
        let shape = [0, 1, 2, 3].map(|k| nodes[k].len());
        let cells: usize = shape.iter().product();
        let boundaries = [
            Boundary::Clamped,
            Boundary::Periodic(TAU),
            Boundary::Clamped,
            Boundary::Periodic(TAU),
        ];
        let axes = || -> Result<Vec<Axis>, String> {
            nodes
                .iter()
                .zip(boundaries)
                .map(|(n, b)| Axis::new(n.0.clone(), b, Scale::Linear))
                .collect()
        };
        if self.fills(cells, channels)
            && let Ok(axes) = axes()
        {
            let mut table = Table::new(cells, channels);
            for (row, a) in self.angles.iter().enumerate() {
                let mut at = Some(0);
                for k in 0..4 {
                    let x = if k % 2 == 0 { a[k] } else { wrapped(a[k]) };
                    at = at.zip(nodes[k].find(x)).map(|(at, n)| at * shape[k] + n);
                }
                if let Some(at) = at {
                    table.add(at, &self.values[row * channels..][..channels]);
                }
            }
            for k in [0, 2] {
                if nodes[k].0[0] < SAME {
                    table.spread_over_azimuth(&shape, k, k + 1);
                }
            }
            notes.extend(table.notes());
            let p = Parameterization::SphericalAnisotropic;
            return Grid::new(p, axes, channels, table.done())
                .map_err(|(found, expected)| input.error("rows", found, expected));
        }
        scattered::anisotropic(&self, channels, notes)
            .map_err(|(found, expected)| input.error("rows", found, expected))
    }

    /// Whether a grid with so many cells is at least half full of the rows.
    fn fills(&self, cells: usize, channels: usize) -> bool {
        cells <= 2 * self.angles.len() && (cells * channels) as u64 <= MOST_VALUES
    }
}

/// Different angles, ascending.
struct Nodes(Vec<f64>);

impl Nodes {
    fn of(angles: impl Iterator<Item = f64>) -> Self {
        let mut all: Vec<f64> = angles.collect();
        all.sort_by(f64::total_cmp);
        all.dedup_by(|b, a| *b - *a < SAME);
        Self(all)
    }

    /// As `of`, where a whole turn is no turn.
    fn of_turn(angles: impl Iterator<Item = f64>) -> Self {
        let mut nodes = Self::of(angles);
        if nodes.0.len() > 1 && nodes.0[0] < SAME && nodes.0[nodes.0.len() - 1] > TAU - SAME {
            nodes.0.pop();
        }
        nodes
    }

    fn len(&self) -> usize {
        self.0.len()
    }

    fn find(&self, x: f64) -> Option<usize> {
        let x = if x > TAU - SAME && self.0[0] < SAME {
            0.0
        } else {
            x
        };
        let k = self.0.partition_point(|n| *n < x - SAME);
        (k < self.0.len() && (self.0[k] - x).abs() < 2.0 * SAME).then_some(k)
    }
}

/// Means of the rows that fall on each cell.
struct Table {
    sums: Vec<f64>,
    counts: Vec<u32>,
    channels: usize,
}

impl Table {
    fn new(cells: usize, channels: usize) -> Self {
        Self {
            sums: vec![0.0; cells * channels],
            counts: vec![0; cells],
            channels,
        }
    }

    fn add(&mut self, at: usize, values: &[f32]) {
        self.counts[at] += 1;
        for (sum, x) in self.sums[at * self.channels..].iter_mut().zip(values) {
            *sum += f64::from(*x);
        }
    }

    /// Gives the cells at the first node of axis `theta` that have no row the mean of those that have, over all nodes of axis `phi`.
    fn spread_over_azimuth(&mut self, shape: &[usize], theta: usize, phi: usize) {
        let stride = |axis: usize| shape[axis + 1..].iter().product::<usize>();
        let (by_theta, by_phi) = (stride(theta), stride(phi));
        let cells: usize = shape.iter().product();
        for first in 0..cells {
            let at_start = |stride: usize, n: usize| (first / stride).is_multiple_of(n);
            if !(at_start(by_theta, shape[theta]) && at_start(by_phi, shape[phi])) {
                continue;
            }
            let ring = (0..shape[phi]).map(|k| first + k * by_phi);
            let full: Vec<usize> = ring.clone().filter(|at| self.counts[*at] > 0).collect();
            if full.is_empty() {
                continue;
            }
            for at in ring.filter(|at| self.counts[*at] == 0).collect::<Vec<_>>() {
                for c in 0..self.channels {
                    let mean = |from: &usize| {
                        self.sums[from * self.channels + c] / f64::from(self.counts[*from])
                    };
                    let sum: f64 = full.iter().map(mean).sum();
                    self.sums[at * self.channels + c] = sum / full.len() as f64;
                }
                self.counts[at] = 1;
            }
        }
    }

    fn notes(&self) -> Vec<String> {
        let twice = self.counts.iter().filter(|n| **n > 1).count();
        if twice == 0 {
            return Vec::new();
        }
        vec![format!(
            "{twice} pairs of directions are listed more than once: their mean is taken"
        )]
    }

    fn done(self) -> Values {
        self.sums
            .iter()
            .enumerate()
            .map(|(k, sum)| match self.counts[k / self.channels] {
                0 => f32::NAN,
                n => (sum / f64::from(n)) as f32,
            })
            .collect()
    }
}

/// `n` nodes from 0 to 90°.
fn elevations(n: usize) -> Result<Axis, String> {
    Axis::regular(0.0, FRAC_PI_2 / (n - 1) as f64, n, Boundary::Clamped)
}

/// Nodes of a whole turn in steps of `deg`.
fn azimuths(deg: f64) -> Result<Axis, String> {
    let n = (360.0 / deg).round() as usize;
    Axis::regular(0.0, radians(deg), n, Boundary::Periodic(TAU))
}
