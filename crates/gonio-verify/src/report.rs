//! A report: the verdicts on one subject, as a table for people and as data for programs.

use crate::settings::Effort;
use crate::verdict::{Outcome, Property, Verdict};
use serde::Serialize;
use std::fmt;

/// The verdicts on one subject. `Display` prints a table with the witnesses of all violations below it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// The subject's name.
    pub subject: String,
    /// How hard it was looked at.
    pub effort: Effort,
    /// The name that the random numbers were derived from: the same name gives the same report.
    pub seed_name: String,
    /// One verdict a property, in the order of [`Property::ALL`].
    pub verdicts: Vec<Verdict>,
}

impl Report {
    /// Whether nothing failed.
    pub fn passed(&self) -> bool {
        self.failures().next().is_none()
    }

    /// The verdicts that failed.
    pub fn failures(&self) -> impl Iterator<Item = &Verdict> {
        self.verdicts.iter().filter(|v| v.outcome == Outcome::Fail)
    }

    /// The verdict on `property`.
    pub fn verdict(&self, property: Property) -> Option<&Verdict> {
        self.verdicts.iter().find(|v| v.property == property)
    }
}

fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Pass => "✓ pass",
        Outcome::Fail => "✗ FAIL",
        Outcome::Declared => "! declared",
        Outcome::NotApplicable => "- n/a",
    }
}

/// A number in at most nine characters: plain near 1, with an exponent elsewhere.
fn number(x: f64) -> String {
    if x.is_nan() {
        "-".into()
    } else if x == 0.0 {
        "0".into()
    } else if (1e-3..1e5).contains(&x.abs()) {
        format!("{x:.5}")
    } else {
        format!("{x:.2e}")
    }
}

fn violation(v: &Verdict) -> bool {
    matches!(v.outcome, Outcome::Fail | Outcome::Declared)
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}", self.subject)?;
        for v in &self.verdicts {
            let figure = match v.p_value {
                Some(p) => format!("p = {}", number(p)),
                None => number(v.figure),
            };
            writeln!(
                f,
                "  {:<10}  {:<14}  {:>12}  (bound {:>8})  {}",
                mark(v.outcome),
                v.property,
                figure,
                number(v.bound),
                v.detail
            )?;
        }
        for v in self.verdicts.iter().filter(|v| violation(v)) {
            let Some(w) = &v.witness else { continue };
            writeln!(f, "  worst for {}:", v.property)?;
            writeln!(f, "    wo  {}", w.wo)?;
            if let Some(wi) = &w.wi {
                writeln!(f, "    wi  {wi}")?;
            }
            if let Some(u) = w.u {
                writeln!(f, "    u   {u:?}")?;
            }
            for value in &w.values {
                writeln!(f, "    {} = {}", value.name, value.value)?;
            }
            if let Some(c) = v.confidence {
                let (low, high) = (number(c.low), number(c.high));
                if c.level < 1.0 {
                    writeln!(
                        f,
                        "    in [{low}, {high}] with confidence 1 − {:.1e}",
                        1.0 - c.level
                    )?;
                } else {
                    writeln!(f, "    in [{low}, {high}] by quadrature")?;
                }
            }
        }
        for v in &self.verdicts {
            if let Some(note) = &v.note {
                writeln!(f, "  note on {}: {note}", v.property)?;
            }
        }
        let count = |o| self.verdicts.iter().filter(|v| v.outcome == o).count();
        let samples: u64 = self.verdicts.iter().map(|v| v.samples).sum();
        write!(
            f,
            "  {}: {} passed, {} failed, {} declared, {} not applicable; {samples} evaluations; seed \"{}\"",
            if self.passed() { "PASS" } else { "FAIL" },
            count(Outcome::Pass),
            count(Outcome::Fail),
            count(Outcome::Declared),
            count(Outcome::NotApplicable),
            self.seed_name
        )
    }
}
