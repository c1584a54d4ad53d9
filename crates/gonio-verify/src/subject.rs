//! What is checked: a reflection function, and what it declares of itself.

use crate::directions::Region;
use crate::reflection::{EvalFn, PdfFn, Reflection, SampleFn, SubjectFailed, SubjectSample};
use gonio_num::Vec3;

/// The most queries that one call of a [`Reflection`] is given: some hundred kilobytes.
pub(crate) const BATCH: usize = 4096;

/// A reflection function under its name: closures for one pair of directions ([`Subject::new`]), or a [`Reflection`] that is
/// asked in batches ([`Subject::batched`]).
///
/// Both directions leave the surface: `wi` to the light, `wo` to the viewer; unit length, local frame, normal +z. What
/// computes in `f32` rounds its arguments and widens its results; [`crate::Settings::precision`] then has to say so.
#[derive(Clone)]
pub struct Subject<'a> {
    /// Name in the report.
    pub name: String,
    eval: Operation<'a, EvalFn<'a>>,
    pdf: Option<Operation<'a, PdfFn<'a>>>,
    sample: Option<Operation<'a, SampleFn<'a>>>,
    /// `None`: it only reflects, and everything below the horizon must be exactly 0. Otherwise light may pass to the other
    /// side, z < 0, from either side, and this is the index of refraction there over the one above, each channel.
    pub relative_ior: Option<[f64; 3]>,
    single: Option<&'a dyn Reflection>,
}

/// Where the answers to one kind of question come from.
enum Operation<'a, F: ?Sized> {
    One(&'a F),
    Batch(&'a dyn Reflection),
}

impl<F: ?Sized> Clone for Operation<'_, F> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<F: ?Sized> Copy for Operation<'_, F> {}

impl<'a> Subject<'a> {
    /// A reflection function that can only be evaluated, see [`EvalFn`].
    pub fn new(name: impl Into<String>, eval: &'a EvalFn<'a>) -> Self {
        Self {
            name: name.into(),
            eval: Operation::One(eval),
            pdf: None,
            sample: None,
            relative_ior: None,
            single: None,
        }
    }

    /// A reflection function that answers many queries at once, with what it says that it has.
    pub fn batched(name: impl Into<String>, reflection: &'a dyn Reflection) -> Self {
        let batch = Operation::Batch(reflection);
        Self {
            name: name.into(),
            eval: Operation::Batch(reflection),
            pdf: reflection.has_pdf().then_some(batch),
            sample: reflection
                .has_sample()
                .then_some(Operation::Batch(reflection)),
            relative_ior: reflection.relative_ior(),
            single: None,
        }
    }

    /// Adds the density of sampling wi given wo, 0 for Dirac deltas, or replaces it.
    pub fn with_pdf(mut self, pdf: &'a PdfFn<'a>) -> Self {
        self.pdf = Some(Operation::One(pdf));
        self
    }

    /// Adds importance sampling, or replaces it.
    pub fn with_sample(mut self, sample: &'a SampleFn<'a>) -> Self {
        self.sample = Some(Operation::One(sample));
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

    /// Adds the same function as it computes in single precision, for [`crate::Property::SinglePrecision`]. It is asked at
    /// directions that `f32` can hold.
    pub fn with_single(mut self, single: &'a dyn Reflection) -> Self {
        self.single = Some(single);
        self
    }

    /// The same function in single precision, as a subject.
    pub(crate) fn single(&self) -> Option<Subject<'a>> {
        Some(Subject::batched("single precision", self.single?))
    }

    /// Whether nothing passes to the other side.
    pub(crate) fn only_reflects(&self) -> bool {
        self.relative_ior.is_none()
    }

    pub(crate) fn has_pdf(&self) -> bool {
        self.pdf.is_some()
    }

    pub(crate) fn has_sample(&self) -> bool {
        self.sample.is_some()
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

    /// f at each pair (wi, wo).
    pub(crate) fn eval(&self, pairs: &[Pair]) -> Result<Vec<[f64; 3]>, SubjectFailed> {
        match self.eval {
            Operation::One(eval) => Ok(pairs.iter().map(|(wi, wo)| eval(*wi, *wo)).collect()),
            Operation::Batch(r) => in_batches(pairs, [0.0; 3], |wi, wo, f| r.eval(wi, wo, f)),
        }
    }

    /// The density at each pair (wi, wo); 0 where there is none.
    pub(crate) fn pdf(&self, pairs: &[Pair]) -> Result<Vec<f64>, SubjectFailed> {
        match self.pdf {
            None => Ok(vec![0.0; pairs.len()]),
            Some(Operation::One(pdf)) => Ok(pairs.iter().map(|(wi, wo)| pdf(*wi, *wo)).collect()),
            Some(Operation::Batch(r)) => in_batches(pairs, 0.0, |wi, wo, p| r.pdf(wi, wo, p)),
        }
    }

    /// What `sample` gives for each (wo, u), with samples of density 0 taken as nothing.
    pub(crate) fn draw(
        &self,
        queries: &[Draw],
    ) -> Result<Vec<Option<SubjectSample>>, SubjectFailed> {
        let mut all: Vec<Option<SubjectSample>> = match self.sample {
            None => vec![None; queries.len()],
            Some(Operation::One(sample)) => queries.iter().map(|(wo, u)| sample(*wo, *u)).collect(),
            Some(Operation::Batch(r)) => in_batches(queries, None, |wo, u, s| r.sample(wo, u, s))?,
        };
        for s in &mut all {
            *s = s.filter(|s| s.pdf != 0.0);
        }
        Ok(all)
    }
}

/// Directions (wi, wo).
pub(crate) type Pair = (Vec3<f64>, Vec3<f64>);
/// A direction wo and the numbers given to `sample`.
pub(crate) type Draw = (Vec3<f64>, [f64; 3]);

/// Asks `ask` for each of `queries`, at most [`BATCH`] at once.
fn in_batches<A: Copy, B: Copy, T: Copy>(
    queries: &[(A, B)],
    nothing: T,
    mut ask: impl FnMut(&[A], &[B], &mut [T]) -> Result<(), SubjectFailed>,
) -> Result<Vec<T>, SubjectFailed> {
    let mut answers = vec![nothing; queries.len()];
    for (queries, answers) in queries.chunks(BATCH).zip(answers.chunks_mut(BATCH)) {
        let (a, b): (Vec<A>, Vec<B>) = queries.iter().copied().unzip();
        ask(&a, &b, answers)?;
    }
    Ok(answers)
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
