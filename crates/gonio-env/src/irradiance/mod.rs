//! Irradiance and mean radiance of an environment, by deterministic integration in double precision (T6).
//!
//! The integrand is the interpolated radiance that rendering sees, not a sum over constant texels. A lat-long picture is
//! bilinear between texel centres: each of those cells is integrated by products of Gauss–Legendre rules that are exact
//! to rounding, and a cell that the horizon crosses is integrated only where the cosine is positive. A disc-shaped
//! picture is integrated by a midpoint rule around its axis, twice as fine as its texels.

mod disc;
mod grid;
mod texels;

pub use texels::LatLongTexels;

use crate::environment::{Environment, Source, yaw_sin_cos};
use gonio_num::Vec3;
use grid::Grid;
use std::f64::consts::PI;

/// An irradiance with an estimate of its numerical error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Irradiance {
    /// Irradiance \[W m⁻²] of each channel.
    pub value: [f64; 3],
    /// Estimated numerical error of each channel, in the same unit: the change from integrating twice as coarsely, and
    /// rounding.
    pub error: [f64; 3],
}

impl Environment {
    /// Irradiance \[W m⁻²] on a surface with normal `n` (world, of any length), E = ∫ L cosθ dω over its hemisphere (T6).
    ///
    /// Exactly π times the radiance if that is uniform. See [`Environment::irradiance_with_error`] for the error. NaN if `n`
    /// is zero or not finite: such a normal has no hemisphere.
    pub fn irradiance(&self, n: Vec3<f32>) -> [f64; 3] {
        self.irradiance_with_error(n).value
    }

    /// [`Environment::irradiance`] with an estimate of its numerical error: for a lat-long picture about 1e-12 of the
    /// value, for the disc layouts about 1e-4.
    pub fn irradiance_with_error(&self, n: Vec3<f32>) -> Irradiance {
        self.irradiances(&[n.to_f64()])[0]
    }

    /// The irradiances of several normals; a disc-shaped picture is passed through once.
    pub(crate) fn irradiances(&self, normals: &[Vec3<f64>]) -> Vec<Irradiance> {
        let (s, c) = yaw_sin_cos(self.yaw_deg);
        let local: Vec<_> = normals
            .iter()
            .map(|n| n.normalize())
            .map(|n| Vec3::new(c * n.x - s * n.z, n.y, s * n.x + c * n.z))
            .collect();
        let undefined = Irradiance {
            value: [f64::NAN; 3],
            error: [f64::NAN; 3],
        };
        let mut found: Vec<Irradiance> = match &self.source {
            Source::Uniform(radiance) => {
                let value = radiance.map(|l| f64::from(l) * PI);
                vec![
                    Irradiance {
                        value,
                        error: [0.0; 3]
                    };
                    normals.len()
                ]
            }
            Source::Sky(sky) => local
                .iter()
                .map(|n| estimate(sky.irradiance(*n, 256), sky.irradiance(*n, 128)))
                .collect(),
            Source::Picture(p) if p.map.layout.is_disc() => {
                let fine = disc::irradiances(&p.map, &local, 2);
                let coarse = disc::irradiances(&p.map, &local, 1);
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
                            undefined
                        }
                    })
                    .collect()
            }
        };
        for (found, n) in found.iter_mut().zip(&local) {
            if !n.is_finite() {
                *found = undefined;
            }
            for k in 0..3 {
                found.value[k] *= f64::from(self.scale[k]);
                found.error[k] *= f64::from(self.scale[k]);
            }
        }
        found
    }

    /// Radiance \[W m⁻² sr⁻¹] averaged over the sphere, each direction weighing the same.
    pub fn mean_radiance(&self) -> [f64; 3] {
        let mean = match &self.source {
            Source::Uniform(radiance) => radiance.map(f64::from),
            Source::Sky(sky) => sky.mean_radiance(),
            Source::Picture(p) if p.map.layout.is_disc() => disc::mean(&p.map),
            Source::Picture(p) => Grid::new(&p.map).mean(),
        };
        [0, 1, 2].map(|k| mean[k] * f64::from(self.scale[k]))
    }
}

/// Relative rounding of a sum of some 1e5 to 1e7 terms of one sign.
const ROUNDING: f64 = 1e-12;

fn estimate(fine: [f64; 3], coarse: [f64; 3]) -> Irradiance {
    Irradiance {
        value: fine,
        error: [0, 1, 2].map(|k| (fine[k] - coarse[k]).abs() + ROUNDING * fine[k]),
    }
}
