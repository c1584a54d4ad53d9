//! Measurements in the adaptive parameterization of Dupuy & Jakob, as the RGL material database has them.
//!
//! Reflection is tabulated over the unit square that the material's own visible microfacet normals are drawn from: where it reflects
//! much, the table is fine. A table holds the density D of normals and their projected area σ, and for each direction of the
//! viewer the density of visible normals, and colours or spectra with their luminance.
//!
//! - Evaluating: ωi and ωr have a half vector; the inverse of drawing visible normals maps it to the square, where the value c stands;
//!   f = c · D(ωh) / (4 σ(ωr) cosθi).
//! - Sampling: two uniform numbers are warped by the luminance, then by the visible normals to a half vector, about which ωr is reflected.
//!   The density is exact for that: what it lacks to the integral 1 is the probability of drawing a direction below the
//!   horizon, which is no direction.
//!
//! Source: Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering".

mod batch;
mod block;
mod evaluate;
mod fields;
mod geometry;
mod plane;
mod slices;
mod tables;
#[cfg(test)]
mod tests;
mod warp;

pub(crate) use evaluate::AdaptiveTable;
pub(super) use fields::Fields;
pub(super) use tables::check_finite;
pub use tables::{Nodes, Tables};

use super::file::Fault;
use super::values::Values;
use crate::{BrdfError, Number};
use geometry::Geometry;
use gonio_num::Vec3;
use std::sync::Arc;

/// Values over the unit square that visible normals are drawn from, for each direction of the viewer and each channel.
///
/// Bilinear on the square, linear in the viewer's angles, constant beyond the outermost. Numbers below zero, as measurements near black
/// contain, stay as they are unless they are repaired by filling; what they interpolate to counts as 0 where it is negative.
#[derive(Debug, Clone)]
pub struct Adaptive {
    tables: Arc<Tables>,
    channels: usize,
    values: Values,
    geometry: Arc<Geometry>,
}

impl PartialEq for Adaptive {
    fn eq(&self, other: &Self) -> bool {
        // The geometry follows from the tables.
        self.tables == other.tables
            && self.channels == other.channels
            && self.values == other.values
    }
}

impl Adaptive {
    /// `values`: for each slice, each channel, each node of `tables.luminance`.
    ///
    /// # Errors
    /// [`BrdfError::Parameter`] if tables and values don't fit each other, angles don't increase or are out of range, a number of the tables
    /// is not finite, or a density of visible normals is 0 everywhere.
    pub fn new(
        tables: Tables,
        channels: usize,
        values: impl Into<Values>,
    ) -> Result<Self, BrdfError> {
        Self::checked(tables, channels, values.into()).map_err(|fault| BrdfError::Parameter {
            model: "table".into(),
            parameter: fault.place,
            found: fault.found,
            expected: fault.expected,
        })
    }

    pub(super) fn checked(tables: Tables, channels: usize, values: Values) -> Result<Self, Fault> {
        tables.check()?;
        let expected = tables.slices() * channels * tables.luminance.size();
        if expected == 0 || values.len() != expected {
            return Err(Fault::new(
                "values",
                format!("{} numbers", values.len()),
                format!(
                    "{} slices × {channels} channels × {}×{} nodes, as `luminance` has",
                    tables.slices(),
                    tables.luminance.height,
                    tables.luminance.width
                ),
            ));
        }
        Ok(Self {
            geometry: Arc::new(Geometry::new(&tables)),
            tables: Arc::new(tables),
            channels,
            values,
        })
    }

    /// What directions the values stand for.
    pub fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Numbers for each slice and node.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// The numbers.
    pub fn values(&self) -> &Values {
        &self.values
    }

    pub(super) fn with_values(&self, values: Values) -> Self {
        Self {
            values,
            ..self.clone()
        }
    }

    /// Whether it is the same in every azimuth of the viewer.
    pub fn is_isotropic(&self) -> bool {
        self.tables.phi_i.len() == 1
    }

    /// The nodes of one function: width and height.
    pub(super) fn shape(&self) -> [usize; 2] {
        [self.tables.luminance.width, self.tables.luminance.height]
    }

    /// Slice, channel, row and column of a number.
    pub(super) fn place(&self, at: usize) -> [usize; 4] {
        let [width, height] = self.shape();
        let function = at / (width * height);
        [
            function / self.channels,
            function % self.channels,
            at / width % height,
            at % width,
        ]
    }

    /// All channels, whatever side the directions are on.
    pub(super) fn lookup(&self, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        match self.tables.phi_i.len() {
            1 => self.lookup_in::<1>(wi, wo, out),
            _ => self.lookup_in::<2>(wi, wo, out),
        }
    }

    fn lookup_in<const C: usize>(&self, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        let place = self.geometry.place(wi, wo);
        let blend = self.geometry.slices.blend::<f64, C>(place.at);
        let (p, _) = self.geometry.vndf.invert(place.half, &blend);
        let [w, h] = self.shape();
        let (i, tx) = (p[0] * (w - 1) as f64).cell(w as u32);
        let (j, ty) = (p[1] * (h - 1) as f64).cell(h as u32);
        let corner = j as usize * w + i as usize;
        let corners = [
            (0, (1.0 - tx) * (1.0 - ty)),
            (1, tx * (1.0 - ty)),
            (w, (1.0 - tx) * ty),
            (w + 1, tx * ty),
        ];
        let scale = self.geometry.scale(wi.z, wo.z, place.viewer, place.half);
        for (channel, x) in out.iter_mut().enumerate() {
            let mut sum = 0.0;
            for c in 0..C {
                for k in 0..2 {
                    let slice = self.stored_slice(blend.slice[c] as usize + k);
                    let function = (slice * self.channels + channel) * w * h;
                    for (step, weight) in corners {
                        let value = self.values[function + corner + step];
                        sum += weight * blend.weight[c][k] * f64::from(value);
                    }
                }
            }
            *x = sum.max(0.0) * scale;
        }
    }

    /// A slice among the values: where there is one elevation, two of the geometry are the same.
    fn stored_slice(&self, slice: usize) -> usize {
        match self.tables.theta_i.len() {
            1 => slice / 2,
            _ => slice,
        }
    }
}
