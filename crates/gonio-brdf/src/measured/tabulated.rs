//! [`Tabulated`], a reflection function as a table in memory (T19).

use super::cells::{
    cell_solid_angle, clamped, half_difference, luminance, nearest, periodic, ring_cosines,
    row_cosines, theta, turn,
};
use super::choice::Choice;
use crate::BrdfError;
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{around_axis, cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How a table's cells are laid out. The value of a cell stands at its centre; the last axis varies fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Axes {
    /// Isotropic and reciprocal: half vector and difference vector (Rusinkiewicz 1998), as in the MERL database.
    ///
    /// Cells: √(θh/90°) in `theta_h` steps, θd in [0, 90°], φd in [0, 180°) with period 180°.
    HalfDifference {
        /// Cells along √θh.
        theta_h: usize,
        /// Cells along θd.
        theta_d: usize,
        /// Cells along φd.
        phi_d: usize,
    },
    /// Any function of the two directions: θi, φi, θr, φr in equal steps, θ in [0, 90°], φ in [0, 360°).
    Directions {
        /// Cells along θi.
        theta_i: usize,
        /// Cells along φi.
        phi_i: usize,
        /// Cells along θr.
        theta_r: usize,
        /// Cells along φr.
        phi_r: usize,
    },
}

impl Axes {
    /// Cells along each axis; 1 for an axis that it doesn't have.
    pub fn shape(&self) -> [usize; 4] {
        match *self {
            Self::HalfDifference {
                theta_h,
                theta_d,
                phi_d,
            } => [1, theta_h, theta_d, phi_d],
            Self::Directions {
                theta_i,
                phi_i,
                theta_r,
                phi_r,
            } => [theta_i, phi_i, theta_r, phi_r],
        }
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.shape().iter().product()
    }

    /// The pair of directions at the centre of cell `index`. Some cells of half and difference angles lie below the
    /// horizon: `None`.
    pub fn directions(&self, index: usize) -> Option<(Vec3<f64>, Vec3<f64>)> {
        let shape = self.shape();
        let mut rest = index;
        let mut at = [0.0; 4];
        for axis in (0..4).rev() {
            at[axis] = ((rest % shape[axis]) as f64 + 0.5) / shape[axis] as f64;
            rest /= shape[axis];
        }
        let along = |theta: f64, turn: f64| around_axis(turn, Real::sin(theta), Real::cos(theta));
        match self {
            Self::HalfDifference { .. } => {
                let theta_h = at[1] * at[1] * FRAC_PI_2;
                let h = along(theta_h, 0.0);
                let d = along(at[2] * FRAC_PI_2, 0.5 * at[3]);
                // The difference vector turned by θh about the y axis.
                let wi = Vec3::new(h.z * d.x + h.x * d.z, d.y, h.z * d.z - h.x * d.x);
                let wo = wi.reflect(h);
                (wi.z > 0.0 && wo.z > 0.0).then_some((wi, wo))
            }
            Self::Directions { .. } => Some((
                along(at[0] * FRAC_PI_2, at[1]),
                along(at[2] * FRAC_PI_2, at[3]),
            )),
        }
    }
}

/// Share of the samples that are drawn from the cosine lobe rather than from the table.
const COSINE_SHARE: f64 = 0.3;

/// A reflection function as a table of linear RGB values in sr⁻¹.
///
/// Between cell centres it is interpolated linearly along every axis, constant beyond the outermost centres and periodic in azimuth,
/// hence continuous (but where an azimuth has no meaning). Negative values, which measurements contain, are
/// set to 0 and counted.
///
/// Sampling mixes a cosine lobe with a piecewise constant density from the table: of half vectors, by rings of θh, for [`Axes::HalfDifference`]; of
/// ωi for each cell of ωr, for [`Axes::Directions`]. The reported density is exact for it.
#[derive(Debug, Clone)]
pub struct Tabulated {
    axes: Axes,
    values: Vec<[f32; 3]>,
    negative: u64,
    choices: Vec<Choice>,
}

impl Tabulated {
    /// A table of one RGB value a cell, in sr⁻¹.
    ///
    /// # Errors
    /// If an axis has no cell, the number of values is not the number of cells, or a value is not finite.
    pub fn new(axes: Axes, mut values: Vec<[f32; 3]>) -> Result<Self, BrdfError> {
        let bad = |parameter: &str, found: String, expected: String| BrdfError::Parameter {
            model: "table".into(),
            parameter: parameter.into(),
            found,
            expected,
        };
        if axes.cells() == 0 || axes.cells() != values.len() {
            return Err(bad(
                "values",
                format!("{} cells", values.len()),
                format!("the {} cells of {axes:?}, at least 1", axes.cells()),
            ));
        }
        let mut negative = 0;
        for (k, value) in values.iter_mut().enumerate() {
            for x in value {
                if !x.is_finite() {
                    return Err(bad(
                        &format!("values[{k}]"),
                        x.to_string(),
                        "a finite number".into(),
                    ));
                }
                if *x < 0.0 {
                    negative += 1;
                    *x = 0.0;
                }
            }
        }
        let mut table = Self {
            axes,
            values,
            negative,
            choices: Vec::new(),
        };
        table.choices = table.make_choices();
        Ok(table)
    }

    /// The function `f(wi, wo)` at the cell centres; 0 in cells below the horizon.
    ///
    /// # Errors
    /// As [`Tabulated::new`].
    pub fn from_fn(
        axes: Axes,
        mut f: impl FnMut(Vec3<f64>, Vec3<f64>) -> [f64; 3],
    ) -> Result<Self, BrdfError> {
        let mut values = Vec::with_capacity(axes.cells());
        for k in 0..axes.cells() {
            let value = axes.directions(k).map_or([0.0; 3], |(wi, wo)| f(wi, wo));
            values.push(value.map(|x| x as f32));
        }
        Self::new(axes, values)
    }

    /// The layout.
    pub fn axes(&self) -> Axes {
        self.axes
    }

    /// The values, negative ones set to 0.
    pub fn values(&self) -> &[[f32; 3]] {
        &self.values
    }

    /// How many numbers were negative and set to 0.
    pub fn negative_values(&self) -> u64 {
        self.negative
    }

    /// f(wi→wo) in sr⁻¹; 0 below the horizon.
    pub fn eval(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3] {
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return [0.0; 3];
        }
        let shape = self.axes.shape();
        let axes = match self.axes {
            Axes::HalfDifference { .. } => {
                let a = half_difference(wi, wo);
                [
                    (0, 0, 0.0),
                    clamped((a[0] / FRAC_PI_2).sqrt(), shape[1]),
                    clamped(a[1] / FRAC_PI_2, shape[2]),
                    periodic(a[2] / PI, shape[3]),
                ]
            }
            Axes::Directions { .. } => [
                clamped(theta(wi) / FRAC_PI_2, shape[0]),
                periodic(turn(wi), shape[1]),
                clamped(theta(wo) / FRAC_PI_2, shape[2]),
                periodic(turn(wo), shape[3]),
            ],
        };
        let mut sum = [0.0; 3];
        for corner in 0..16u32 {
            let (mut index, mut weight) = (0, 1.0);
            for (axis, (low, high, t)) in axes.into_iter().enumerate() {
                let up = corner >> axis & 1 == 1;
                index = index * shape[axis] + if up { high } else { low };
                weight *= if up { t } else { 1.0 - t };
            }
            if weight > 0.0 {
                for (s, x) in sum.iter_mut().zip(self.values[index]) {
                    *s += weight * f64::from(x);
                }
            }
        }
        sum
    }

    /// Density in sr⁻¹ of drawing `wi` for `wo`.
    pub fn pdf(&self, wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
        if !(wi.z > 0.0 && wo.z > 0.0) {
            return 0.0;
        }
        let shape = self.axes.shape();
        let table = match self.axes {
            Axes::HalfDifference { theta_h, .. } => {
                let [theta, theta_d, _] = half_difference(wi, wo);
                let ring = nearest((theta / FRAC_PI_2).sqrt(), theta_h);
                let (low, high) = ring_cosines(ring, theta_h);
                let density = self.choices[0].probability(ring) / (TAU * (low - high));
                density / (4.0 * Real::cos(theta_d)).max(1e-15)
            }
            Axes::Directions { theta_i, phi_i, .. } => {
                let i = nearest(theta(wi) / FRAC_PI_2, theta_i);
                let j = nearest(turn(wi), phi_i);
                let choice = &self.choices[self.outgoing_cell(wo, shape)];
                choice.probability(i * phi_i + j) / cell_solid_angle(i, theta_i, phi_i)
            }
        };
        COSINE_SHARE * cosine_hemisphere_density(wi) + (1.0 - COSINE_SHARE) * table
    }

    /// Draws a direction for `wo`; `None` where that gives nothing.
    pub fn sample(&self, wo: Vec3<f64>, u: [f64; 3]) -> Option<Vec3<f64>> {
        if wo.z.is_nan() || wo.z <= 0.0 {
            return None;
        }
        let wi = if u[2] < COSINE_SHARE {
            cosine_hemisphere([u[0], u[1]])
        } else {
            match self.axes {
                Axes::HalfDifference { theta_h, .. } => {
                    let (ring, rest) = self.choices[0].sample(u[1]);
                    let (low, high) = ring_cosines(ring, theta_h);
                    let cos = low + rest * (high - low);
                    let h = around_axis(u[0], (1.0 - cos * cos).safe_sqrt(), cos);
                    if wo.dot(h) <= 0.0 {
                        return None;
                    }
                    wo.reflect(h)
                }
                Axes::Directions { theta_i, phi_i, .. } => {
                    let choice = &self.choices[self.outgoing_cell(wo, self.axes.shape())];
                    let (cell, rest) = choice.sample(u[1]);
                    let (i, j) = (cell / phi_i, cell % phi_i);
                    let (low, high) = row_cosines(i, theta_i);
                    let cos = low + rest * (high - low);
                    let turn = (j as f64 + u[0]) / phi_i as f64;
                    around_axis(turn, (1.0 - cos * cos).safe_sqrt(), cos)
                }
            }
        };
        (wi.z > 0.0).then_some(wi)
    }

    /// Mean of the values: a rough albedo estimate over π.
    pub(crate) fn mean(&self) -> f64 {
        let sum: f64 = self.values.iter().map(|v| luminance(*v)).sum();
        sum / self.values.len() as f64
    }

    fn make_choices(&self) -> Vec<Choice> {
        let shape = self.axes.shape();
        // Every cell keeps a little, so that no direction with f > 0 is never drawn and no distribution is all 0.
        let floor = 0.01 * self.mean() + 1e-12;
        match self.axes {
            Axes::HalfDifference { theta_h, .. } => {
                let ring_size = shape[2] * shape[3];
                let ring = |k: usize| {
                    let cells = &self.values[k * ring_size..(k + 1) * ring_size];
                    let sum: f64 = cells.iter().map(|v| luminance(*v)).sum();
                    let (low, high) = ring_cosines(k, theta_h);
                    // ∫ cosθh dh over the ring is proportional to the difference of squared cosines.
                    (sum / ring_size as f64 + floor) * (low * low - high * high)
                };
                vec![Choice::new((0..theta_h).map(ring))]
            }
            Axes::Directions { theta_i, phi_i, .. } => {
                let outgoing = shape[2] * shape[3];
                let weight = |cell: usize, out: usize| {
                    let (low, high) = row_cosines(cell / phi_i, theta_i);
                    let value = luminance(self.values[cell * outgoing + out]);
                    (value + floor) * (low * low - high * high)
                };
                (0..outgoing)
                    .map(|out| Choice::new((0..theta_i * phi_i).map(|cell| weight(cell, out))))
                    .collect()
            }
        }
    }

    fn outgoing_cell(&self, wo: Vec3<f64>, shape: [usize; 4]) -> usize {
        nearest(theta(wo) / FRAC_PI_2, shape[2]) * shape[3] + nearest(turn(wo), shape[3])
    }
}
