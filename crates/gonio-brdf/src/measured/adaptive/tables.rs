//! [`Tables`], what directions an adaptive table's values stand for.

use super::super::file::Fault;
use super::super::tensor_file::dimensions_of;
use super::super::values::Values;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes along an axis that are believed.
const MOST_NODES: usize = 8192;
/// Directions of the viewer that are believed, along θ or φ.
const MOST_DIRECTIONS: usize = 1024;
/// Numbers of a table that is made ready in memory. Ready it has eight times as many, and addresses have 32 bits.
pub(super) const MOST_NUMBERS: usize = 1 << 26;

/// One or more functions over the unit square, bilinear between `width`×`height` nodes that stand at its edges too.
#[derive(Debug, Clone, PartialEq)]
pub struct Nodes {
    /// Nodes along the first coordinate.
    pub width: usize,
    /// Nodes along the second coordinate.
    pub height: usize,
    /// Values, row by row, function by function.
    pub values: Values,
}

impl Nodes {
    /// Nodes of one function.
    pub fn size(&self) -> usize {
        self.width * self.height
    }
}

/// What directions an adaptive table's values stand for.
///
/// Directions on the unit square: the first coordinate is √(2θ/π), the second φ/2π + ½. "Slice" is a direction of the viewer: each
/// `phi_i` with each `theta_i`, the latter varying faster. The viewer is the direction that files call "incident".
#[derive(Debug, Clone, PartialEq)]
pub struct Tables {
    /// Azimuths of the viewer, increasing, in radians. One or two: φ of half vectors is counted from the viewer's; one: the material is
    /// isotropic. More: they begin at −π and span 2π, or a half or a quarter of it, which the material's symmetry repeats.
    pub phi_i: Vec<f32>,
    /// Elevations of the viewer from the normal, increasing, within [0, π/2], in radians.
    pub theta_i: Vec<f32>,
    /// Density D of microfacet normals, sr⁻¹, over directions.
    pub ndf: Nodes,
    /// Projected area σ of the microfacets towards a direction, over directions.
    pub sigma: Nodes,
    /// Density of visible normals, for each slice, over directions; in any unit.
    pub vndf: Nodes,
    /// Luminance of the values for each slice, over the numbers that visible normals are drawn from; in any unit.
    pub luminance: Nodes,
    /// Whether values are f·cosθi · 4σ/D, else f·cosθi.
    pub jacobian: bool,
}

impl Tables {
    /// How many slices.
    pub fn slices(&self) -> usize {
        self.phi_i.len() * self.theta_i.len()
    }

    /// How often the material's symmetry repeats the measured azimuths in a turn; 0 if azimuths are counted from the viewer's.
    pub(super) fn symmetry(&self) -> u32 {
        symmetry(&self.phi_i)
    }

    /// Everything that evaluating relies on.
    pub(super) fn check(&self) -> Result<(), Fault> {
        check_directions(&self.phi_i, &self.theta_i)?;
        let slices = self.slices();
        // A single row holds for every azimuth.
        check_nodes("ndf", &self.ndf, 1, 1)?;
        check_nodes("sigma", &self.sigma, 1, 1)?;
        check_nodes("vndf", &self.vndf, slices, 2)?;
        check_nodes("luminance", &self.luminance, slices, 2)?;
        for (slice, values) in self.vndf.values.chunks(self.vndf.size()).enumerate() {
            if values.iter().all(|v| *v <= 0.0) {
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
        Ok(())
    }
}

/// Angles of the viewer that increase, within their ranges.
pub(super) fn check_directions(phi_i: &[f32], theta_i: &[f32]) -> Result<(), Fault> {
    for (name, angles) in [("theta_i", theta_i), ("phi_i", phi_i)] {
        let place = format!("field `{name}`");
        if !(1..=MOST_DIRECTIONS).contains(&angles.len()) {
            let found = format!("{} angles", angles.len());
            return Err(Fault::new(place, found, format!("1 to {MOST_DIRECTIONS}")));
        }
        check_finite(name, angles)?;
        if let Some(k) = angles.windows(2).position(|a| a[0] >= a[1]) {
            let found = format!("{} after {}", angles[k + 1], angles[k]);
            return Err(Fault::new(place, found, "increasing angles"));
        }
    }
    // Grids end at π/2 rounded to single precision, up or down.
    let (first, last) = (theta_i[0], theta_i[theta_i.len() - 1]);
    if first < 0.0 || f64::from(last) > FRAC_PI_2 + 1e-3 {
        return Err(Fault::new(
            "field `theta_i`",
            format!("angles from {first} to {last}"),
            "radians from 0 to π/2",
        ));
    }
    if let [first, _, .., last] = phi_i {
        let parts = symmetry(phi_i);
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

fn symmetry(phi_i: &[f32]) -> u32 {
    match phi_i {
        [first, _, .., last] => (TAU / f64::from(last - first)).round() as u32,
        _ => 0,
    }
}

/// Whether a table of this size can be made ready; `least` is the smallest height.
pub(super) fn check_size(
    name: &str,
    [width, height, count]: [usize; 3],
    least: usize,
) -> Result<(), Fault> {
    let place = format!("field `{name}`");
    if !(2..=MOST_NODES).contains(&width) || !(least..=MOST_NODES).contains(&height) {
        let expected = format!("{least}×2 to {MOST_NODES}×{MOST_NODES}");
        return Err(Fault::new(
            place,
            format!("{height}×{width} nodes"),
            expected,
        ));
    }
    match (width * height).checked_mul(count) {
        Some(numbers) if numbers <= MOST_NUMBERS => Ok(()),
        _ => Err(Fault::new(
            place,
            format!("{} values", dimensions_of(&[count, height, width])),
            format!("at most {MOST_NUMBERS}"),
        )),
    }
}

fn check_nodes(name: &str, nodes: &Nodes, count: usize, least: usize) -> Result<(), Fault> {
    let (w, h) = (nodes.width, nodes.height);
    check_size(name, [w, h, count], least)?;
    if nodes.values.len() != w * h * count {
        return Err(Fault::new(
            format!("field `{name}`"),
            format!("{} values", nodes.values.len()),
            format!("{} values", dimensions_of(&[count, h, w])),
        ));
    }
    check_finite(name, &nodes.values)
}

pub(in super::super) fn check_finite(name: &str, values: &[f32]) -> Result<(), Fault> {
    match values.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(k) => Err(Fault::new(
            format!("field `{name}`, value {k}"),
            values[k],
            "a finite number",
        )),
    }
}

/// Where azimuths are counted from the viewer's, σ is the same in every azimuth.
fn check_rows_agree(sigma: &Nodes) -> Result<(), Fault> {
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
