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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::verdict::Witness;
    use gonio_num::Vec3;

    fn report() -> Report {
        let up = Vec3::new(0.0, 0.0, 1.0);
        let mut fails = Verdict::passing(Property::Reciprocity, 0.5, 1e-6, 10).judge(true, true);
        fails.witness = Some(Witness::pair(Vec3::new(1.0, 0.0, 0.0), up).value("f(wi, wo)", 2.0));
        Report {
            subject: "example".into(),
            effort: Effort::Quick,
            seed_name: "seed".into(),
            verdicts: vec![
                Verdict::passing(Property::Finite, 0.0, 0.0, 10).judge(false, true),
                fails,
                Verdict::passing(Property::Isotropy, 0.3, 1e-6, 10).judge(true, false),
                Verdict::not_applicable(Property::Linearity, "no components"),
            ],
        }
    }

    #[test]
    fn only_an_undeclared_violation_fails() {
        let mut r = report();
        assert!(!r.passed());
        assert_eq!(r.failures().count(), 1);
        r.verdicts.remove(1);
        assert!(r.passed());
        assert_eq!(
            r.verdict(Property::Isotropy).unwrap().outcome,
            Outcome::Declared
        );
        assert!(r.verdict(Property::Reciprocity).is_none());
    }

    #[test]
    fn the_table_names_each_outcome_and_the_witness() {
        let text = report().to_string();
        for part in [
            "✓ pass",
            "✗ FAIL",
            "! declared",
            "- n/a",
            "worst for reciprocity:",
            "θ 90.0000° φ 0.0000°",
            "f(wi, wo) = 2",
            "FAIL: 1 passed, 1 failed, 1 declared, 1 not applicable",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        let column = |line: &str| line.find("(bound");
        let lines: Vec<&str> = text.lines().filter(|l| l.contains("(bound")).collect();
        assert_eq!(lines.len(), 4);
        // Counted in characters, the marks being longer in bytes.
        let at = |l: &str| column(l).map(|b| l[..b].chars().count());
        assert!(lines.iter().all(|l| at(l) == at(lines[0])), "{text}");
    }

    #[test]
    fn json_has_names_and_null_for_what_was_not_measured() {
        let json: serde_json::Value = serde_json::to_value(report()).unwrap();
        assert_eq!(json["effort"], "quick");
        let verdicts = &json["verdicts"];
        assert_eq!(verdicts[1]["property"], "reciprocity");
        assert_eq!(verdicts[1]["outcome"], "fail");
        assert_eq!(verdicts[1]["witness"]["wo"]["theta_deg"], 0.0);
        assert_eq!(verdicts[3]["outcome"], "not_applicable");
        assert!(verdicts[3]["figure"].is_null());
    }
}
