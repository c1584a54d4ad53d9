//! [`Grid`], values at the nodes of a grid of angles, and how they are evaluated and drawn from.

pub(super) mod axis;
pub(super) mod parameterization;
mod table;

pub use axis::{Axis, Boundary, Scale};
pub use parameterization::Parameterization;
pub(super) use table::GridTable;

use super::values::Values;
use axis::Between;
use gonio_num::Vec3;

/// Values at the nodes of a grid of angles, linear between them along every axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    parameterization: Parameterization,
    axes: Vec<Axis>,
    channels: usize,
    values: Values,
}

impl Grid {
    /// `values` has `channels` numbers for each node, the last axis fastest. NaN stands for a value that is missing.
    ///
    /// # Errors
    /// If the number of axes is not the parameterization's, or that of the values not the product of the axes' lengths and of `channels`,
    /// in words: what was found and what was expected.
    pub fn new(
        parameterization: Parameterization,
        axes: Vec<Axis>,
        channels: usize,
        values: impl Into<Values>,
    ) -> Result<Self, (String, String)> {
        let values = values.into();
        if axes.len() != parameterization.rank() {
            return Err((
                format!("{} axes", axes.len()),
                format!("{}", parameterization.rank()),
            ));
        }
        let expected = axes
            .iter()
            .try_fold(channels, |n, axis| n.checked_mul(axis.len()));
        if channels == 0 || expected != Some(values.len()) {
            let shape: Vec<usize> = axes.iter().map(Axis::len).collect();
            return Err((
                format!("{} values", values.len()),
                format!("{channels} for each of {shape:?} nodes, at least 1"),
            ));
        }
        Ok(Self {
            parameterization,
            axes,
            channels,
            values,
        })
    }

    /// Which angles its axes are.
    pub fn parameterization(&self) -> Parameterization {
        self.parameterization
    }

    /// Its axes.
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// Numbers for each node.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The numbers, node by node.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// The same grid with other numbers, as many.
    pub(super) fn with_values(&self, values: Values) -> Self {
        Self {
            values,
            ..self.clone()
        }
    }

    /// Number of nodes.
    pub fn cells(&self) -> usize {
        self.values.len() / self.channels
    }

    /// Nodes along each axis.
    pub fn shape(&self) -> Vec<usize> {
        self.axes.iter().map(Axis::len).collect()
    }

    /// The place of node `cell` along each axis.
    pub fn place(&self, cell: usize) -> Vec<usize> {
        let mut rest = cell;
        let mut place = vec![0; self.axes.len()];
        for (at, axis) in place.iter_mut().zip(&self.axes).rev() {
            *at = rest % axis.len();
            rest /= axis.len();
        }
        place
    }

    /// The pair of directions (wi, wo) of node `cell`; either may lie below the horizon.
    pub fn directions(&self, cell: usize) -> (Vec3<f64>, Vec3<f64>) {
        let mut x = [0.0; 4];
        for (x, (k, axis)) in x.iter_mut().zip(self.place(cell).iter().zip(&self.axes)) {
            *x = axis.nodes()[*k];
        }
        self.parameterization.directions(x)
    }

    /// All channels at a pair of directions on the same side, whether above the horizon or not.
    pub(super) fn interpolate(&self, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        let x = self.parameterization.coordinates(wi, wo);
        let around: Vec<Between<f64>> = self
            .axes
            .iter()
            .zip(x)
            .map(|(axis, x)| axis.around(x))
            .collect();
        out.fill(0.0);
        for corner in 0..1usize << around.len() {
            let (mut at, mut weight) = (0usize, 1.0);
            for (k, (b, axis)) in around.iter().zip(&self.axes).enumerate() {
                let up = corner >> k & 1 == 1;
                at = at * axis.len() + if up { b.high } else { b.low } as usize;
                weight *= if up { b.t } else { 1.0 - b.t };
            }
            if weight > 0.0 {
                let cell = &self.values[at * self.channels..][..self.channels];
                for (sum, value) in out.iter_mut().zip(cell) {
                    *sum += weight * f64::from(*value);
                }
            }
        }
    }
}
