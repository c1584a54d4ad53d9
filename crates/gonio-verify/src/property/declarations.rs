//! Whether what is declared is what is found.

use crate::check::Checker;
use crate::verdict::{Outcome, Property, Verdict};

/// How many of the declarations (reciprocity, energy, isotropy) are not what `found` says. A violation of what is declared to
/// hold fails its own verdict, and what is declared as lacking but found to hold is only too cautious: this one is information.
pub(super) fn check(c: &Checker, found: &[Verdict]) -> Verdict {
    let e = c.expect;
    let declared = [
        (Property::Reciprocity, e.reciprocal),
        (Property::EnergyConservation, e.energy_conserving),
        (Property::Isotropy, e.isotropic),
    ];
    let holds = |p: Property| {
        let verdict = found.iter().find(|v| v.property == p);
        verdict.is_some_and(|v| v.outcome == Outcome::Pass)
    };
    let names = |wrong: bool| {
        let those = declared
            .iter()
            .filter(|(p, d)| *d == wrong && holds(*p) != wrong);
        those.map(|(p, _)| p.name()).collect::<Vec<_>>()
    };
    let (cautious, violated) = (names(false), names(true));
    let count = cautious.len() + violated.len();
    let mut v = Verdict::passing(Property::Declarations, count as f64, 0.0, 0);
    let mut said = Vec::new();
    if !violated.is_empty() {
        said.push(format!("declared, but violated: {}", violated.join(", ")));
    }
    if !cautious.is_empty() {
        let names = cautious.join(", ");
        said.push(format!(
            "declared as lacking, but no violation was found: {names}"
        ));
    }
    v.detail = match said.is_empty() {
        true => "each of reciprocity, energy and isotropy is as declared".into(),
        false => said.join("; "),
    };
    if count > 0 {
        v.outcome = Outcome::Information;
    }
    v
}
