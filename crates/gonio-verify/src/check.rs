//! The entry point: every property of one subject.

use crate::property;
use crate::reflection::{EvalFn, SubjectFailed};
use crate::report::Report;
use crate::settings::{Effort, Settings};
use crate::subject::{Expectation, Subject};
use crate::verdict::{Outcome, Property};
use std::sync::atomic::{AtomicU64, Ordering};

/// Checks every property of `subject` against what it declares.
///
/// The random numbers are derived from `seed_name` and the property alone: the same arguments give the same report.
/// The bounds are those of double precision; [`Checker`] has the other choices.
///
/// # Errors
/// If the subject fails to answer; closures never do.
pub fn check(
    subject: &Subject,
    expect: &Expectation,
    effort: Effort,
    seed_name: impl AsRef<str>,
) -> Result<Report, SubjectFailed> {
    Checker::new(subject, expect, effort).run(seed_name)
}

/// A check with all its choices.
///
/// ```
/// use gonio_verify::{Checker, Effort, Expectation, Precision, Settings, Subject};
/// let lambertian = |wi: gonio_num::Vec3<f64>, wo: gonio_num::Vec3<f64>| {
///     let f = if wi.z > 0.0 && wo.z > 0.0 { 0.8 / std::f64::consts::PI } else { 0.0 };
///     [f; 3]
/// };
/// let subject = Subject::new("lambertian", &lambertian);
/// let report = Checker::new(&subject, &Expectation::PHYSICAL, Effort::Quick)
///     .settings(Settings::new(Effort::Quick).with_precision(Precision::Single))
///     .run("documentation")?;
/// assert!(report.passed(), "{report}");
/// # Ok::<(), gonio_verify::SubjectFailed>(())
/// ```
pub struct Checker<'a> {
    pub(crate) subject: &'a Subject<'a>,
    pub(crate) expect: Expectation,
    pub(crate) settings: Settings,
    pub(crate) components: &'a [&'a EvalFn<'a>],
    pub(crate) seed_name: String,
    effort: Effort,
    allowed: Vec<Property>,
    progress: Option<&'a Progress<'a>>,
    done: AtomicU64,
}

/// Is told how many steps of how many are done, from any thread.
pub type Progress<'a> = dyn Fn(u64, u64) + Sync + 'a;

impl<'a> Checker<'a> {
    /// A check of `subject` with the usual settings of `effort`.
    pub fn new(subject: &'a Subject<'a>, expect: &Expectation, effort: Effort) -> Self {
        Self {
            subject,
            expect: *expect,
            settings: Settings::new(effort),
            components: &[],
            seed_name: String::new(),
            effort,
            allowed: Vec::new(),
            progress: None,
            done: AtomicU64::new(0),
        }
    }

    /// Other sample counts and bounds. Counts of 0 are taken as 1.
    pub fn settings(mut self, settings: Settings) -> Self {
        self.settings = Settings {
            pairs: settings.pairs.max(1),
            directions: settings.directions.max(1),
            density_samples: settings.density_samples.max(1),
            cells: settings.cells.max(1),
            ..settings
        };
        self
    }

    /// The functions whose sum the subject claims to be, for [`crate::Property::Linearity`].
    pub fn components(mut self, components: &'a [&'a EvalFn<'a>]) -> Self {
        self.components = components;
        self
    }

    /// Properties that may be violated by the choice of the one who asks: [`crate::Outcome::Allowed`].
    pub fn allow(mut self, properties: &[Property]) -> Self {
        self.allowed = properties.to_vec();
        self
    }

    /// Tells `progress` after each step.
    pub fn progress(mut self, progress: &'a Progress<'a>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// One of the steps that [`property::steps`] counts is done.
    pub(crate) fn step(&self) {
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        if let Some(progress) = self.progress {
            progress(done, property::steps(self));
        }
    }

    /// Runs every property with random numbers derived from `seed_name`.
    ///
    /// # Errors
    /// If the subject fails to answer; closures never do.
    pub fn run(mut self, seed_name: impl AsRef<str>) -> Result<Report, SubjectFailed> {
        self.seed_name = seed_name.as_ref().to_owned();
        let mut verdicts = property::all(&self)?;
        for v in &mut verdicts {
            if v.outcome == Outcome::Fail && self.allowed.contains(&v.property) {
                v.outcome = Outcome::Allowed;
            }
        }
        Ok(Report {
            subject: self.subject.name.clone(),
            effort: self.effort,
            seed_name: self.seed_name.clone(),
            verdicts,
        })
    }
}
