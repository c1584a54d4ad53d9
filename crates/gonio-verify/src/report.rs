//! A report: the verdicts on one subject, as a table for people and as data for programs.

use crate::settings::Effort;
use crate::table::Table;
use crate::verdict::{Outcome, Property, Verdict};
use serde::Serialize;
use std::fmt;

/// The verdicts on one subject. `Display` prints [`Report::table`] without colours.
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

    /// The table for people, at most 80 columns wide but for a name without a comma: a line a property, and below it each violation with
    /// all that reproduces it. `colour`: with ANSI colours, for a terminal.
    pub fn table(&self, colour: bool) -> String {
        Table::of(self, colour)
    }

    /// The verdict on `property`.
    pub fn verdict(&self, property: Property) -> Option<&Verdict> {
        self.verdicts.iter().find(|v| v.property == property)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.table(false))
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
            "! lacks",
            "- n/a",
            "90,0→0,0",
            "✗ FAIL reciprocity",
            "θ 90.0000° φ 0.0000°",
            "f(wi, wo) = 2",
            "FAIL: 1 passed, 1 failed, 1 lacking as declared; 30 evaluations; seed \"seed\"",
        ] {
            assert!(text.contains(part), "{part}\n{text}");
        }
        assert!(text.lines().all(|l| l.chars().count() <= 80), "{text}");
        let coloured = report().table(true);
        assert!(coloured.contains("\x1b[1;31m✗ FAIL"), "{coloured}");
        assert!(!text.contains('\x1b'));
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
