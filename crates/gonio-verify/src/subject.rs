//! What is checked: a reflection function as closures, and what it declares of itself.

use crate::directions::Region;
use gonio_num::Vec3;

/// f(wi, wo) in sr⁻¹, without the cosine, in three channels.
pub type EvalFn<'a> = dyn Fn(Vec3<f64>, Vec3<f64>) -> [f64; 3] + Sync + 'a;
/// The density per solid angle of sampling wi given wo.
pub type PdfFn<'a> = dyn Fn(Vec3<f64>, Vec3<f64>) -> f64 + Sync + 'a;
/// Draws wi given wo and three numbers in [0, 1); `None` when nothing is reflected.
pub type SampleFn<'a> = dyn Fn(Vec3<f64>, [f64; 3]) -> Option<SubjectSample> + Sync + 'a;

/// A direction that a reflection function drew.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SubjectSample {
    /// Towards the light, unit, local frame.
    pub wi: Vec3<f64>,
    /// f·|cosθi| / pdf, or for a Dirac delta the reflected fraction over the probability of this direction.
    pub weight: [f64; 3],
    /// Density per solid angle; for a Dirac delta the probability of choosing this direction. A sample of density 0
    /// counts as no sample.
    pub pdf: f64,
    /// Whether the direction belongs to a Dirac delta.
    pub delta: bool,
}

/// A reflection function as closures in `f64`. Both directions leave the surface: `wi` to the light, `wo` to the viewer;
/// unit length, local frame, normal +z.
///
/// A closure over `f32` code rounds its arguments and widens its results; [`crate::Settings::precision`] then
/// has to say so.
#[derive(Clone)]
pub struct Subject<'a> {
    /// Name in the report.
    pub name: String,
    /// f(wi, wo), see [`EvalFn`].
    pub eval: &'a EvalFn<'a>,
    /// Density of `sample`, see [`PdfFn`]. 0 for Dirac deltas.
    pub pdf: Option<&'a PdfFn<'a>>,
    /// Importance sampling, see [`SampleFn`].
    pub sample: Option<&'a SampleFn<'a>>,
    /// `None`: it only reflects, and everything below the horizon must be exactly 0. Otherwise light may pass to the other
    /// side, z < 0, from either side, and this is the index of refraction there over the one above, each channel.
    pub relative_ior: Option<[f64; 3]>,
}

impl<'a> Subject<'a> {
    /// A reflection function that can only be evaluated.
    pub fn new(name: impl Into<String>, eval: &'a EvalFn<'a>) -> Self {
        Self {
            name: name.into(),
            eval,
            pdf: None,
            sample: None,
            relative_ior: None,
        }
    }

    /// Adds the density of sampling wi given wo.
    pub fn with_pdf(mut self, pdf: &'a PdfFn<'a>) -> Self {
        self.pdf = Some(pdf);
        self
    }

    /// Adds importance sampling.
    pub fn with_sample(mut self, sample: &'a SampleFn<'a>) -> Self {
        self.sample = Some(sample);
        self
    }

    /// Says that the subject also transmits, into a medium of this index of refraction (each channel) relative to the
    /// one above the surface; [1; 3] for what only lets through or scatters, as a leaf does.
    ///
    /// `eval` then scatters *radiance*, which a refracting boundary scales by the square of the index: reciprocity is
    /// f(ωi→ωr) n(ωi)² = f(ωr→ωi) n(ωr)², and energy is conserved if ∫ f(ωi→ωr) n(ωi)²/n(ωr)² |cosθi| dωi ≤ 1 over the
    /// sphere, with n the index of the side that a direction is on (Veach 1997, eqs 5.14 and 5.29).
    pub fn transmitting(mut self, relative_ior: [f64; 3]) -> Self {
        self.relative_ior = Some(relative_ior);
        self
    }

    /// Whether nothing passes to the other side.
    pub(crate) fn only_reflects(&self) -> bool {
        self.relative_ior.is_none()
    }

    /// n² of the side that `w` is on, each channel.
    pub(crate) fn index_squared(&self, w: Vec3<f64>) -> [f64; 3] {
        match self.relative_ior {
            Some(n) if w.z < 0.0 => n.map(|n| n * n),
            _ => [1.0; 3],
        }
    }

    /// `colour`·n(ωi)²/n(ωr)²: what becomes of the factor on radiance when radiance is counted in units of n².
    pub(crate) fn basic(&self, colour: [f64; 3], wi: Vec3<f64>, wo: Vec3<f64>) -> [f64; 3] {
        let (i, o) = (self.index_squared(wi), self.index_squared(wo));
        [0, 1, 2].map(|k| colour[k] * i[k] / o[k])
    }

    /// Where directions are looked for.
    pub(crate) fn region(&self) -> Region {
        match self.relative_ior {
            None => Region::Above,
            Some([r, g, b]) => Region::Sphere {
                relative_ior: (r + g + b) / 3.0,
            },
        }
    }

    /// What `sample` gives at `u`, with samples of density 0 taken as nothing.
    pub(crate) fn draw(&self, wo: Vec3<f64>, u: [f64; 3]) -> Option<SubjectSample> {
        let sample = self.sample?;
        sample(wo, u).filter(|s| s.pdf != 0.0)
    }
}

impl std::fmt::Debug for Subject<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Subject")
            .field("name", &self.name)
            .field("pdf", &self.pdf.is_some())
            .field("sample", &self.sample.is_some())
            .field("relative_ior", &self.relative_ior)
            .finish_non_exhaustive()
    }
}

/// What a reflection function declares of itself. A property declared as lacking doesn't fail: what its lack costs is
/// measured and printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Expectation {
    /// f(ωi→ωr) = f(ωr→ωi); for what transmits see [`Subject::transmitting`].
    pub reciprocal: bool,
    /// Radiant exitance ≤ irradiance.
    pub energy_conserving: bool,
    /// f doesn't change when both directions turn about the normal.
    pub isotropic: bool,
}

impl Expectation {
    /// Reciprocal, energy conserving and isotropic.
    pub const PHYSICAL: Self = Self {
        reciprocal: true,
        energy_conserving: true,
        isotropic: true,
    };
}

impl Default for Expectation {
    fn default() -> Self {
        Self::PHYSICAL
    }
}
