//! What is checked: a reflection function as closures, and what it declares of itself.

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
}

impl<'a> Subject<'a> {
    /// A reflection function that can only be evaluated.
    pub fn new(name: impl Into<String>, eval: &'a EvalFn<'a>) -> Self {
        Self {
            name: name.into(),
            eval,
            pdf: None,
            sample: None,
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
            .finish_non_exhaustive()
    }
}

/// What a reflection function declares of itself. A property declared as lacking doesn't fail: what its lack costs is
/// measured and printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Expectation {
    /// f(ωi→ωr) = f(ωr→ωi).
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
