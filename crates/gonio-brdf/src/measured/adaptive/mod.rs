//! Measurements in the adaptive parameterization of Dupuy & Jakob: the RGL material database and its `.bsdf` files.
//!
//! Reflection is tabulated over the unit square that the material's own visible microfacet normals are drawn from: where it reflects
//! much, the table is fine. A file holds the density D of normals and their projected area σ, and for each direction of the
//! viewer the density of visible normals, and colours or spectra with their luminance.
//!
//! - Evaluating: ωi and ωr have a half vector; the inverse of drawing visible normals maps it to the square, where the colour c stands;
//!   f = c · D(ωh) / (4 σ(ωr) cosθi).
//! - Sampling: two uniform numbers are warped by the luminance, then by the visible normals to a half vector, about which ωr is reflected.
//!   The density is exact for that: what it lacks to the integral 1 is the probability of drawing a direction below the
//!   horizon, which is no direction.
//!
//! Source: Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering".

mod batch;
mod block;
mod evaluate;
mod plane;
mod read;
mod slices;
mod spectra;
mod tables;
mod warp;
mod write;

pub(crate) use evaluate::{Draw, Eval, EvalAndPdf, Pdf};
pub use read::WHAT;
pub(crate) use read::isotropic_file;
pub use spectra::{Spectra, Values};
pub use tables::{Grid, Tables};

use crate::BrdfError;
use crate::measured::file::Fault;
use plane::{Colours, Plane};
use slices::Slices;
use warp::Warp;

/// A measured reflection function in the adaptive parameterization: a [`Brdf`](crate::Brdf) of RGB over every number type.
///
/// Values between the nodes are those of the format: bilinear on the unit square, linear in the viewer's angles. Stored values that
/// are negative, as measurements near black contain, stay as they are; where what they interpolate to is negative, the
/// function is 0.
#[derive(Debug, Clone)]
pub struct Adaptive {
    description: String,
    isotropic: bool,
    /// How often the azimuths of the slices repeat in a turn; 0 where azimuths are counted from the viewer's.
    symmetry: u32,
    slices: Slices,
    ndf: Plane,
    sigma: Plane,
    vndf: Warp,
    luminance: Warp,
    colours: Colours,
    jacobian: bool,
    /// Mean weight of a sample for each slice.
    albedo: Vec<f32>,
    spectra: Option<Spectra>,
    negative: u64,
}

impl Adaptive {
    /// From the content of a file. Spectra without RGB are projected once to linear sRGB: the colours of reflectances under D65 by
    /// the CIE 1931 observer.
    ///
    /// # Errors
    /// [`BrdfError::Parameter`] if tables don't fit each other, angles or wavelengths don't increase or are out of range, a value is not
    /// finite, or a density of visible normals is 0 everywhere.
    pub fn new(tables: Tables) -> Result<Self, BrdfError> {
        Self::from_tables(tables).map_err(|fault| BrdfError::Parameter {
            model: "table".into(),
            parameter: fault.place,
            found: fault.found,
            expected: fault.expected,
        })
    }

    fn from_tables(tables: Tables) -> Result<Self, Fault> {
        tables.check()?;
        let symmetry = tables.symmetry();
        let isotropic = symmetry == 0;
        let count = tables.slices();
        let mut negative = 0;
        let mut positive = |mut grid: Grid| {
            for v in &mut grid.values {
                negative += u64::from(*v < 0.0);
                *v = v.max(0.0);
            }
            grid
        };
        let Grid { width, height, .. } = tables.luminance;
        let (ndf, sigma) = (positive(tables.ndf), positive(tables.sigma));
        let (mut vndf, mut luminance) = (positive(tables.vndf), positive(tables.luminance));
        let mut rgb = match (tables.rgb, &tables.spectra) {
            (Some(rgb), _) => {
                negative += rgb.values.iter().filter(|v| **v < 0.0).count() as u64;
                rgb.values
            }
            (None, Some(spectra)) => {
                let (rgb, below) = spectra.project(count)?;
                negative += below;
                rgb
            }
            (None, None) => unreachable!("invariant: the check found one of them"),
        };
        let mut theta = tables.theta_i;
        if theta.len() == 1 {
            // The one elevation holds for all: it is stored twice, so that there are always two to mix.
            theta.push(theta[0] + 1.0);
            for values in [&mut vndf.values, &mut luminance.values, &mut rgb] {
                let size = values.len() / count;
                *values = values
                    .chunks_exact(size)
                    .flat_map(|s| [s, s])
                    .flatten()
                    .copied()
                    .collect();
            }
        }
        let slices = Slices {
            theta,
            phi: tables.phi_i,
        };
        let luminance = Warp::new(&luminance.values, width, height, &slices);
        let colours = Colours::new(&rgb, &luminance, width, height, &slices);
        let mut all = Self {
            description: tables.description,
            isotropic,
            symmetry,
            vndf: Warp::new(&vndf.values, vndf.width, vndf.height, &slices),
            ndf: Plane::new(&ndf.values, ndf.width, ndf.height),
            sigma: Plane::new(&sigma.values, sigma.width, sigma.height),
            luminance,
            colours,
            jacobian: tables.jacobian,
            albedo: vec![0.5; slices.count()],
            slices,
            spectra: tables.spectra,
            negative,
        };
        all.albedo = all.albedo_of_slices();
        Ok(all)
    }

    /// What was measured.
    pub fn description(&self) -> &str {
        &self.description
    }

    /// Whether it is the same in every azimuth of the viewer.
    pub fn is_isotropic(&self) -> bool {
        self.isotropic
    }

    /// How many stored numbers are negative: noise of the measurement near black.
    pub fn negative_values(&self) -> u64 {
        self.negative
    }

    /// The measured wavelengths in nanometres; none if only RGB is known.
    pub fn lambda_nm(&self) -> &[f32] {
        self.spectra.as_ref().map_or(&[], |s| &s.lambda_nm)
    }
}
