//! Evidence about reflection functions: closures in, verdicts out.
//!
//! A [`Subject`] is anybody's reflection function: `eval`, and if it has them `pdf` and `sample`, as closures, or as a
//! [`Reflection`] that answers in batches. An [`Expectation`] is what it declares of itself. [`check`] returns a [`Report`] with one [`Verdict`] a [`Property`]:
//! the figure, the bound it is held to, how sure that is, and the worst place found.
//!
//! Two rules lead the design. A false alarm costs a verifier its readers, so a statistical verdict fails a right subject
//! with a designed probability (1e-6 unless set otherwise), and every other bound stands above what rounding and
//! quadrature can make. And a check that can't fail is a defect: each has known-broken subjects in this crate's tests
//! that it must catch.
//!
//! [`statistics`] has the tests themselves, for anyone.

mod check;
mod cubature;
mod directions;
mod partition;
mod property;
mod reflection;
mod report;
mod search;
mod settings;
pub mod specimen;
pub mod statistics;
mod subject;
mod sweep;
mod table;
mod verdict;

pub use check::{Checker, Progress, check};
pub use reflection::{EvalFn, PdfFn, Reflection, SampleFn, SubjectFailed, SubjectSample};
pub use report::Report;
pub use settings::{Effort, Precision, Settings};
pub use subject::{Expectation, Subject};
pub use sweep::{Axis, Point, Range, Setting, SweepReport, Worst, points};
pub use verdict::{Direction, Interval, Outcome, Property, Value, Verdict, Witness};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
