//! The ways in: closures for one pair of directions, and [`Reflection`] for whoever answers many at once.

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

/// A reflection function that answers many queries at once: a shader on lanes, another process behind a pipe, a graphics
/// card. A check asks some thousands a call, and a few where it searches.
///
/// The slices of one call are equally long. The same query gets the same answer, whatever stands beside it. Where an
/// operation fails (a process ended, a shader can't run) the check ends with that error, and there is no verdict: a value that
/// isn't a number, on the other hand, is an answer.
///
/// ```
/// use gonio_num::Vec3;
/// use gonio_verify::{Effort, Expectation, Reflection, Subject, SubjectFailed, check};
///
/// /// A diffuse surface.
/// struct Diffuse(f64);
///
/// impl Reflection for Diffuse {
///     fn eval(&self, wi: &[Vec3<f64>], wo: &[Vec3<f64>], f: &mut [[f64; 3]]) -> Result<(), SubjectFailed> {
///         for ((wi, wo), f) in wi.iter().zip(wo).zip(f) {
///             *f = [if wi.z > 0.0 && wo.z > 0.0 { self.0 / std::f64::consts::PI } else { 0.0 }; 3];
///         }
///         Ok(())
///     }
/// }
///
/// let subject = Subject::batched("diffuse", &Diffuse(0.8));
/// let report = check(&subject, &Expectation::PHYSICAL, Effort::Quick, "documentation")?;
/// assert!(report.passed(), "{report}");
/// # Ok::<(), SubjectFailed>(())
/// ```
pub trait Reflection: Sync {
    /// f(wi, wo) in sr⁻¹, without the cosine, in three channels, for each pair.
    ///
    /// # Errors
    /// If there is no answer.
    fn eval(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), SubjectFailed>;

    /// The density per solid angle of sampling wi given wo, 0 for Dirac deltas, for each pair. Asked only if there
    /// [is one](Reflection::has_pdf).
    ///
    /// # Errors
    /// If there is no answer.
    fn pdf(
        &self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        pdf: &mut [f64],
    ) -> Result<(), SubjectFailed> {
        let _ = (wi, wo, pdf);
        Err(SubjectFailed::new("it has no pdf"))
    }

    /// Draws wi given wo and three numbers in [0, 1), for each pair of those; `None` when nothing is reflected. Asked only
    /// if there [is sampling](Reflection::has_sample).
    ///
    /// # Errors
    /// If there is no answer.
    fn sample(
        &self,
        wo: &[Vec3<f64>],
        u: &[[f64; 3]],
        samples: &mut [Option<SubjectSample>],
    ) -> Result<(), SubjectFailed> {
        let _ = (wo, u, samples);
        Err(SubjectFailed::new("it can't be sampled"))
    }

    /// Whether there is a [`Reflection::pdf`].
    fn has_pdf(&self) -> bool {
        false
    }

    /// Whether there is a [`Reflection::sample`].
    fn has_sample(&self) -> bool {
        false
    }

    /// See [`crate::Subject::transmitting`]; `None` for what only reflects.
    fn relative_ior(&self) -> Option<[f64; 3]> {
        None
    }
}

/// A reflection function could not answer, so there is no verdict on it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{why}")]
pub struct SubjectFailed {
    /// What happened, in one line.
    pub why: String,
}

impl SubjectFailed {
    /// With what happened, in one line.
    pub fn new(why: impl Into<String>) -> Self {
        Self { why: why.into() }
    }
}
