//! [`Tables`], the content of a `.bsdf` file.

use super::spectra::Spectra;
use crate::measured::file::Fault;
use crate::measured::tensor_file::dimensions_of;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes along an axis that are believed.
const MOST_NODES: usize = 8192;
/// Directions of the viewer that are believed, along θ or φ.
const MOST_DIRECTIONS: usize = 1024;
/// Numbers of the largest table in memory: addresses have 32 bits.
const MOST_NUMBERS: usize = 1 << 30;

/// One or more functions over the unit square, bilinear between `width`×`height` nodes that stand at its edges too.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Nodes along the first coordinate.
    pub width: usize,
    /// Nodes along the second coordinate.
    pub height: usize,
    /// Values, row by row, function by function.
    pub values: Vec<f32>,
}

impl Grid {
    /// How many functions.
    pub fn count(&self) -> usize {
        self.values.len() / (self.width * self.height).max(1)
    }
}

/// The content of a `.bsdf` file: what [`Adaptive`](super::Adaptive) is made of, and what is written.
///
/// Directions on the unit square: the first coordinate is √(2θ/π), the second φ/2π + ½. "Slice" is a direction of the viewer: each
/// `phi_i` with each `theta_i`, the latter varying faster. The viewer is the direction that the file calls "incident".
#[derive(Debug, Clone)]
pub struct Tables {
    /// What was measured.
    pub description: String,
    /// Azimuths of the viewer, increasing, in radians. One or two: the material is isotropic, and φ of half vectors is counted from the
    /// viewer's. More: they begin at −π and span 2π, or a half or a quarter of it, which the material's symmetry repeats.
    pub phi_i: Vec<f32>,
    /// Elevations of the viewer from the normal, increasing, within [0, π/2], in radians.
    pub theta_i: Vec<f32>,
    /// Density D of microfacet normals, sr⁻¹, over directions.
    pub ndf: Grid,
    /// Projected area σ of the microfacets towards a direction, over directions.
    pub sigma: Grid,
    /// Density of visible normals, for each slice, over directions; in any unit.
    pub vndf: Grid,
    /// Luminance of the colours for each slice, over the numbers that visible normals are drawn from; in any unit.
    pub luminance: Grid,
    /// Red, green and blue for each slice, over the same numbers as `luminance`. Linear, with the primaries and the white of sRGB.
    pub rgb: Option<Grid>,
    /// The same for wavelengths.
    pub spectra: Option<Spectra>,
    /// Whether colours and spectra are f·cosθi · 4σ/D, else f·cosθi.
    pub jacobian: bool,
}

impl Tables {
    /// How many slices.
    pub fn slices(&self) -> usize {
        self.phi_i.len() * self.theta_i.len()
    }

    /// How often the material's symmetry repeats the measured azimuths in a turn; 0 if it is isotropic.
    pub(super) fn symmetry(&self) -> u32 {
        match self.phi_i.as_slice() {
            [first, _, .., last] => (TAU / f64::from(last - first)).round() as u32,
            _ => 0,
        }
    }

    /// Everything that [`Adaptive`](super::Adaptive) relies on.
    pub(super) fn check(&self) -> Result<(), Fault> {
        self.check_directions()?;
        let slices = self.slices();
        check_grid("ndf", &self.ndf, 1)?;
        check_grid("sigma", &self.sigma, 1)?;
        check_grid("vndf", &self.vndf, slices)?;
        check_grid("luminance", &self.luminance, slices)?;
        for slice in 0..slices {
            let size = self.vndf.width * self.vndf.height;
            if self.vndf.values[slice * size..][..size]
                .iter()
                .all(|v| *v <= 0.0)
            {
                return Err(Fault::new(
                    format!("field `vndf`, slice {slice}"),
                    "no positive value",
                    "a density",
                ));
            }
        }
        if self.symmetry() == 0 {
            check_rows_agree(&self.sigma)?;
        }
        let (width, height) = (self.luminance.width, self.luminance.height);
        let same_size = |name: &str, w: usize, h: usize| match (w, h) == (width, height) {
            true => Ok(()),
            false => Err(Fault::new(
                format!("field `{name}`"),
                format!("{h}×{w} nodes"),
                format!("{height}×{width}, as `luminance` has"),
            )),
        };
        if let Some(rgb) = &self.rgb {
            check_grid("rgb", rgb, 3 * slices)?;
            same_size("rgb", rgb.width, rgb.height)?;
        }
        if let Some(spectra) = &self.spectra {
            spectra.check(slices)?;
            same_size("spectra", spectra.width, spectra.height)?;
        }
        if self.rgb.is_none() && self.spectra.is_none() {
            return Err(Fault::new(
                "fields",
                "neither `rgb` nor `spectra`",
                "one of them",
            ));
        }
        Ok(())
    }

    fn check_directions(&self) -> Result<(), Fault> {
        for (name, angles) in [("theta_i", &self.theta_i), ("phi_i", &self.phi_i)] {
            let place = format!("field `{name}`");
            if !(1..=MOST_DIRECTIONS).contains(&angles.len()) {
                let expected = format!("1 to {MOST_DIRECTIONS}");
                return Err(Fault::new(
                    place,
                    format!("{} angles", angles.len()),
                    expected,
                ));
            }
            check_finite(name, angles)?;
            if let Some(k) = angles.windows(2).position(|a| a[0] >= a[1]) {
                let found = format!("{} after {}", angles[k + 1], angles[k]);
                return Err(Fault::new(place, found, "increasing angles"));
            }
        }
        // Grids end at π/2 rounded to single precision, up or down.
        let (first, last) = (self.theta_i[0], self.theta_i[self.theta_i.len() - 1]);
        if first < 0.0 || f64::from(last) > FRAC_PI_2 + 1e-3 {
            return Err(Fault::new(
                "field `theta_i`",
                format!("angles from {first} to {last}"),
                "radians from 0 to π/2",
            ));
        }
        if let [first, _, .., last] = self.phi_i.as_slice() {
            let parts = self.symmetry();
            let span = f64::from(last - first) * f64::from(parts);
            let begins = (f64::from(*first) + PI).abs() < 1e-2;
            if !(matches!(parts, 1 | 2 | 4) && (span - TAU).abs() < 1e-2 && begins) {
                return Err(Fault::new(
                    "field `phi_i`",
                    format!("angles from {first} to {last}"),
                    "radians from −π over a whole turn, a half or a quarter",
                ));
            }
        }
        Ok(())
    }
}

fn check_grid(name: &str, grid: &Grid, count: usize) -> Result<(), Fault> {
    let place = format!("field `{name}`");
    let (w, h) = (grid.width, grid.height);
    // A single row holds for every azimuth.
    let least = if count == 1 { 1 } else { 2 };
    if !(2..=MOST_NODES).contains(&w) || !(least..=MOST_NODES).contains(&h) {
        let expected = format!("{least}×2 to {MOST_NODES}×{MOST_NODES}");
        return Err(Fault::new(place, format!("{h}×{w} nodes"), expected));
    }
    if grid.values.len() > MOST_NUMBERS {
        let expected = format!("at most {MOST_NUMBERS}");
        return Err(Fault::new(
            place,
            format!("{} values", grid.values.len()),
            expected,
        ));
    }
    if grid.values.len() != w * h * count {
        return Err(Fault::new(
            place,
            format!("{} values", grid.values.len()),
            format!("{} values", dimensions_of(&[count, h, w])),
        ));
    }
    check_finite(name, &grid.values)
}

pub(super) fn check_finite(name: &str, values: &[f32]) -> Result<(), Fault> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(k) => Err(Fault::new(
            format!("field `{name}`, value {k}"),
            values[k],
            "a finite number",
        )),
    }
}

/// σ of an isotropic material is the same in every azimuth.
fn check_rows_agree(sigma: &Grid) -> Result<(), Fault> {
    let (first, rest) = sigma.values.split_at(sigma.width);
    for row in rest.chunks_exact(sigma.width) {
        for (a, b) in first.iter().zip(row) {
            // Rows are copies of one, or integrals of the same function over other points: a thousandth is much.
            if (a - b).abs() > 1e-3 * a.abs().max(b.abs()) {
                return Err(Fault::new(
                    "field `sigma`",
                    format!("{a} and {b} at the same θ"),
                    "rows that agree, as the material has one azimuth",
                ));
            }
        }
    }
    Ok(())
}
