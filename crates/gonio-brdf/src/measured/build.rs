//! [`tabulate`], a function as a measurement: at the nodes of a grid, or its means over patches or squares.

use super::channel::Channel;
use super::grid::Axis;
use super::grid::{Grid, Parameterization};
use super::klems::{Basis, Klems};
use super::measurement::{Component, Data, Measurement, Side};
use super::metadata::{Found, Metadata, Repair};
use super::repair::repair;
use super::tree::{Child, Growing, square_to_direction};
use crate::BrdfError;
use gonio_num::Vec3;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// A layout to be filled.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant)] // there are few of them
pub enum Layout {
    /// A grid over these axes.
    Grid(Parameterization, Vec<Axis>),
    /// Patches of the incoming and of the outgoing hemisphere.
    Klems(Basis, Basis),
    /// A tensor tree.
    TensorTree {
        /// 3 (isotropic) or 4.
        rank: u32,
        /// Levels: squares of 2^−depth.
        depth: u32,
        /// Squares whose values differ by at most this share of their mean become one.
        tolerance: f64,
    },
}

/// Called with the done share in [0, 1] now and then; `false` stops the work.
pub type Progress<'a> = dyn FnMut(f64) -> bool + 'a;

/// A function that is tabulated: it writes its channels at a pair of directions, whose signs say the side, to the slice.
pub type Sampled<'a> = dyn FnMut(Vec3<f64>, Vec3<f64>, &mut [f64]) + 'a;

/// The function `f` of `channels`, tabulated for each of `sides`.
///
/// Of a grid a node's value is the function's there; at 90°, where reflection functions are 0 by convention, it is that a quarter of the
/// way to the node before, and nodes below the horizon are filled from those above. Of patches and squares it is the mean, weighted by the projected solid
/// angles of both directions, over 4 × 4 × 4 × 4 points of each pair of patches, or 2 points along each side of a square.
///
/// # Errors
/// If a tree's rank or depth makes no sense, the function is not finite somewhere, or `progress` stops it
/// ([`BrdfError::Interrupted`]).
pub fn tabulate(
    layout: &Layout,
    channels: &[Channel],
    sides: &[Side],
    f: &mut Sampled<'_>,
    progress: &mut Progress<'_>,
) -> Result<Measurement, BrdfError> {
    let mut components = Vec::new();
    for (k, side) in sides.iter().enumerate() {
        let put = |w: Vec3<f64>, front: bool| {
            if front { w } else { Vec3::new(w.x, w.y, -w.z) }
        };
        let mut on_side = |wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]| {
            f(put(wi, side.from_front()), put(wo, side.to_front()), out);
        };
        let mut of_all = |share: f64| progress((k as f64 + share) / sides.len() as f64);
        let mut work = Work {
            channels: channels.len(),
            f: &mut on_side,
            progress: &mut of_all,
            done: 0,
            of: 1,
        };
        let data = match layout {
            Layout::Grid(parameterization, axes) => work.grid(*parameterization, axes)?,
            Layout::Klems(incoming, outgoing) => work.klems(incoming, outgoing)?,
            Layout::TensorTree {
                rank,
                depth,
                tolerance,
            } => work.tree(*rank, *depth, *tolerance)?,
        };
        components.push(Component {
            side: *side,
            data,
            uncertainty: None,
        });
    }
    let mut measurement = Measurement::new(components, channels.to_vec(), Metadata::default())?;
    let mut found = Found::default();
    // Nothing is negative or missing here but what is below the horizon, or what the function says.
    repair(
        Path::new("table"),
        &mut measurement,
        Repair::Zero,
        Repair::Refuse,
        &mut found,
    )?;
    Ok(measurement)
}

struct Work<'a> {
    channels: usize,
    f: &'a mut Sampled<'a>,
    progress: &'a mut Progress<'a>,
    done: u64,
    of: u64,
}

impl Work<'_> {
    /// Counts a step; an error if the user wishes to stop.
    fn step(&mut self) -> Result<(), BrdfError> {
        self.done += 1;
        if self.done.is_multiple_of(1024) {
            let share = (self.done as f64 / self.of as f64).min(1.0);
            if !(self.progress)(share) {
                return Err(BrdfError::Interrupted);
            }
        }
        Ok(())
    }

    fn grid(
        &mut self,
        parameterization: Parameterization,
        axes: &[Axis],
    ) -> Result<Data, BrdfError> {
        let cells: usize = axes.iter().map(Axis::len).product();
        self.of = cells as u64;
        let empty = vec![0.0f32; cells * self.channels];
        let wrong = |(found, expected): (String, String)| BrdfError::Unsupported {
            what: format!("a grid with {found}, expected {expected}"),
        };
        let grid =
            Grid::new(parameterization, axes.to_vec(), self.channels, empty).map_err(wrong)?;
        let nodes: Vec<Vec<f64>> = parameterization
            .axes()
            .iter()
            .zip(axes)
            .map(|(name, axis)| above_the_horizon(name, axis))
            .collect();
        let mut values = Vec::with_capacity(cells * self.channels);
        let mut out = vec![0.0; self.channels];
        for cell in 0..cells {
            self.step()?;
            let mut x = [0.0; 4];
            for (x, (k, nodes)) in x.iter_mut().zip(grid.place(cell).iter().zip(&nodes)) {
                *x = nodes[*k];
            }
            let (wi, wo) = parameterization.directions(x);
            out.fill(0.0);
            if wi.z > 0.0 && wo.z > 0.0 {
                (self.f)(wi, wo, &mut out);
            }
            values.extend(out.iter().map(|x| *x as f32));
        }
        Ok(Data::Grid(grid.with_values(values.into())))
    }

    fn klems(&mut self, incoming: &Basis, outgoing: &Basis) -> Result<Data, BrdfError> {
        const POINTS: usize = 4;
        let points = |basis: &Basis, patch: usize| -> Vec<Vec3<f64>> {
            (0..POINTS * POINTS)
                .map(|k| {
                    let at = |k: usize| (k as f64 + 0.5) / POINTS as f64;
                    basis.direction(patch, [at(k / POINTS), at(k % POINTS)])
                })
                .collect()
        };
        let light: Vec<_> = (0..incoming.len()).map(|k| points(incoming, k)).collect();
        self.of = (incoming.len() * outgoing.len()) as u64;
        let mut values = Vec::with_capacity(incoming.len() * outgoing.len() * self.channels);
        let mut out = vec![0.0; self.channels];
        for o in 0..outgoing.len() {
            let seen = points(outgoing, o);
            for light in &light {
                self.step()?;
                let mut sum = vec![0.0; self.channels];
                for w in light {
                    let wi = Vec3::new(-w.x, -w.y, w.z);
                    for wo in &seen {
                        out.fill(0.0);
                        (self.f)(wi, *wo, &mut out);
                        for (s, x) in sum.iter_mut().zip(&out) {
                            *s += x;
                        }
                    }
                }
                let over = 1.0 / (light.len() * seen.len()) as f64;
                values.extend(sum.iter().map(|s| (s * over) as f32));
            }
        }
        let klems = Klems::new(incoming.clone(), outgoing.clone(), self.channels, values);
        let klems = klems.map_err(|(found, expected)| BrdfError::Unsupported {
            what: format!("patches with {found}, expected {expected}"),
        })?;
        Ok(Data::Klems(klems))
    }

    fn tree(&mut self, rank: u32, depth: u32, tolerance: f64) -> Result<Data, BrdfError> {
        if !(rank == 3 || rank == 4) || depth == 0 || rank * depth > 28 {
            return Err(BrdfError::Unsupported {
                what: format!(
                    "a tensor tree of rank {rank} with squares of 2^-{depth}: rank 3 goes to 2^-9, rank 4 to 2^-7"
                ),
            });
        }
        self.of = 1 << (rank * depth);
        let mut growing = Growing::new(rank, self.channels);
        let root = self.square(&mut growing, rank, depth, [0.0; 4], 1.0, tolerance)?;
        let tree = match root {
            Grown::Child(_) => growing.done(),
            Grown::Value(v) => {
                growing.leaf(v);
                growing.done()
            }
        };
        Ok(Data::TensorTree(tree))
    }

    /// The hypercube at `corner` with this side, `levels` above the finest.
    fn square(
        &mut self,
        growing: &mut Growing,
        rank: u32,
        levels: u32,
        corner: [f64; 4],
        side: f64,
        tolerance: f64,
    ) -> Result<Grown, BrdfError> {
        // The half of a tree of rank 3 in which there are no directions.
        if rank == 3 && corner[0] >= 0.5 {
            self.done += 1 << (rank * levels);
            return Ok(Grown::Value(vec![0.0; self.channels]));
        }
        if levels == 0 {
            self.step()?;
            return Ok(Grown::Value(self.mean(rank, corner, side)));
        }
        let half = 0.5 * side;
        let mut branch = None;
        let mut values: Vec<Vec<f32>> = Vec::new();
        for place in 0..1usize << rank {
            let mut at = corner;
            for (k, x) in at.iter_mut().enumerate() {
                *x += half * (place >> k & 1) as f64;
            }
            // A branch has its number before its children have theirs: the root is 0.
            if branch.is_none() && levels > 1 {
                branch = Some(growing.branch());
            }
            match self.square(growing, rank, levels - 1, at, half, tolerance)? {
                Grown::Value(v) => values.push(v),
                Grown::Child(child) => {
                    if let Some(branch) = branch {
                        growing.set(branch, place, child);
                    }
                    values.push(Vec::new());
                }
            }
        }
        let alone = branch.is_none_or(|b| growing.is_last(b));
        if alone && let Some(mean) = merged(&values, tolerance) {
            if branch.is_some() {
                growing.forget_last();
            }
            return Ok(Grown::Value(mean));
        }
        let branch = branch.unwrap_or_else(|| growing.branch());
        for (place, value) in values.into_iter().enumerate() {
            if !value.is_empty() {
                let leaf = growing.leaf(value);
                growing.set(branch, place, leaf);
            }
        }
        Ok(Grown::Child(Child::Branch(branch)))
    }

    /// The mean over 2 points along each side.
    fn mean(&mut self, rank: u32, corner: [f64; 4], side: f64) -> Vec<f32> {
        let mut sum = vec![0.0; self.channels];
        let mut out = vec![0.0; self.channels];
        let points = 1usize << rank;
        for point in 0..points {
            let mut x = corner;
            for (k, x) in x.iter_mut().enumerate() {
                *x += side * (0.25 + 0.5 * (point >> k & 1) as f64);
            }
            let (wi, wo) = if rank == 4 {
                let travels: Vec3<f64> = square_to_direction(x[0], x[1]);
                (
                    Vec3::new(-travels.x, -travels.y, travels.z),
                    square_to_direction(x[2], x[3]),
                )
            } else {
                let sin = 1.0 - 2.0 * x[0];
                let cos = (1.0 - sin * sin).max(0.0).sqrt();
                (Vec3::new(-sin, 0.0, cos), square_to_direction(x[1], x[2]))
            };
            out.fill(0.0);
            (self.f)(wi, wo, &mut out);
            for (s, x) in sum.iter_mut().zip(&out) {
                *s += x / points as f64;
            }
        }
        sum.iter().map(|x| *x as f32).collect()
    }
}

enum Grown {
    Child(Child),
    Value(Vec<f32>),
}

/// The mean of the values, if all are there and near it in every channel.
fn merged(values: &[Vec<f32>], tolerance: f64) -> Option<Vec<f32>> {
    let channels = values.first()?.len();
    if channels == 0 || values.iter().any(Vec::is_empty) {
        return None;
    }
    let mut mean = vec![0.0; channels];
    for c in 0..channels {
        let all = values.iter().map(|v| f64::from(v[c]));
        let m = all.clone().sum::<f64>() / values.len() as f64;
        if all.into_iter().any(|x| (x - m).abs() > tolerance * m.abs()) {
            return None;
        }
        mean[c] = m as f32;
    }
    Some(mean)
}

/// An axis's nodes, of which one at 90° of a direction's elevation is moved towards the one before by a quarter of the way: reflection
/// functions are 0 there by convention, and some grow without limit towards it.
fn above_the_horizon(name: &str, axis: &Axis) -> Vec<f64> {
    let mut nodes = axis.nodes().to_vec();
    if let [.., before, last] = &mut nodes[..]
        && matches!(name, "theta_i" | "theta_o")
        && *last > FRAC_PI_2 - 1e-6
    {
        *last -= 0.25 * (*last - *before);
    }
    nodes
}
