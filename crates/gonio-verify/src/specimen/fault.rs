//! A right function with some of its operations replaced, and what a check makes of it.

use super::{Pointwise, Specimen};
use crate::{Outcome, Property, Report, SubjectFailed, SubjectSample, Verdict};
use gonio_num::Vec3;

type V = Vec3<f64>;
type EvalOf<R> = Box<dyn Fn(&R, V, V) -> [f64; 3] + Send + Sync>;
type PdfOf<R> = Box<dyn Fn(&R, V, V) -> f64 + Send + Sync>;
type SampleOf<R> = Box<dyn Fn(&R, V, [f64; 3]) -> Option<SubjectSample> + Send + Sync>;

/// `inner` with some operations replaced.
pub struct Broken<R> {
    inner: R,
    eval: Option<EvalOf<R>>,
    pdf: Option<PdfOf<R>>,
    sample: Option<SampleOf<R>>,
}

impl<R: Pointwise> Broken<R> {
    /// Nothing replaced.
    pub fn new(inner: R) -> Self {
        Self {
            inner,
            eval: None,
            pdf: None,
            sample: None,
        }
    }

    /// Another value.
    pub fn eval(mut self, f: impl Fn(&R, V, V) -> [f64; 3] + Send + Sync + 'static) -> Self {
        self.eval = Some(Box::new(f));
        self
    }

    /// Another density.
    pub fn pdf(mut self, f: impl Fn(&R, V, V) -> f64 + Send + Sync + 'static) -> Self {
        self.pdf = Some(Box::new(f));
        self
    }

    /// Another way to draw.
    pub fn sample(
        mut self,
        f: impl Fn(&R, V, [f64; 3]) -> Option<SubjectSample> + Send + Sync + 'static,
    ) -> Self {
        self.sample = Some(Box::new(f));
        self
    }
}

impl<R: Pointwise> Pointwise for Broken<R> {
    fn eval(&self, wi: V, wo: V) -> [f64; 3] {
        match &self.eval {
            Some(f) => f(&self.inner, wi, wo),
            None => self.inner.eval(wi, wo),
        }
    }

    fn pdf(&self, wi: V, wo: V) -> f64 {
        match &self.pdf {
            Some(f) => f(&self.inner, wi, wo),
            None => self.inner.pdf(wi, wo),
        }
    }

    /// By the replacement; else as `inner` draws, and if the value or the density was replaced with their weight.
    fn sample(&self, wo: V, u: [f64; 3]) -> Option<SubjectSample> {
        match &self.sample {
            Some(f) => f(&self.inner, wo, u),
            None if self.eval.is_none() && self.pdf.is_none() => self.inner.sample(wo, u),
            None => {
                let s = self.inner.sample(wo, u)?;
                super::consistent(self, s.wi, wo)
            }
        }
    }
}

/// What a check made of a specimen.
pub struct Caught {
    /// The report.
    pub report: Report,
    fault: Option<Property>,
}

impl Caught {
    /// Checks `specimen` with quick effort.
    ///
    /// # Errors
    /// Never: it always answers.
    pub fn of(specimen: &Specimen) -> Result<Self, SubjectFailed> {
        Ok(Self {
            report: specimen.quick()?,
            fault: specimen.fault,
        })
    }

    /// Whether the instrument is right: what is right passes, and a fault is caught by the property that it belongs to.
    pub fn as_it_should_be(&self) -> bool {
        match self.fault {
            None => self.report.passed(),
            Some(_) => self.verdict().is_some_and(|v| v.outcome == Outcome::Fail),
        }
    }

    /// The verdict of the property that the fault belongs to.
    pub fn verdict(&self) -> Option<&Verdict> {
        self.report.verdict(self.fault?)
    }

    /// The other properties that failed, too.
    pub fn others(&self) -> Vec<Property> {
        let failures = self.report.failures().map(|v| v.property);
        failures.filter(|p| Some(*p) != self.fault).collect()
    }
}
