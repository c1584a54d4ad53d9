//! f(ωi→ωr) = f(ωr→ωi).

use super::{relative_difference, rng, with_colour};
use crate::check::Checker;
use crate::search::{typical, worst_pair};
use crate::verdict::{Property, Verdict, Witness};

/// The worst relative difference of f(wi, wo) and f(wo, wi).
///
/// No chance enters a failure: the difference at the witness is above the bound whatever the random numbers were, and
/// the bound is far above what rounding makes of the same formula with its arguments exchanged.
pub(super) fn check(c: &Checker) -> Verdict {
    let eval = c.subject.eval;
    let scale = typical(eval, &mut rng(c, Property::Reciprocity, "typical"));
    let worst = worst_pair(
        &mut rng(c, Property::Reciprocity, "pairs"),
        c.settings.pairs,
        c.settings.nudge(),
        |wi, wo| relative_difference(eval(wi, wo), eval(wo, wi), scale),
    );
    let bound = c.settings.relative_bound;
    let mut v = Verdict::passing(
        Property::Reciprocity,
        worst.figure,
        bound,
        2 * worst.evaluations,
    );
    let (a, b) = (eval(worst.wi, worst.wo), eval(worst.wo, worst.wi));
    let witness = Witness::pair(worst.wi, worst.wo);
    let witness = with_colour(witness, "f(wi, wo)", a);
    v.witness = Some(with_colour(witness, "f(wo, wi)", b));
    v.detail = format!(
        "worst relative difference of f(wi, wo) and f(wo, wi): {:.3e}",
        worst.figure
    );
    v.judge(worst.figure > bound, c.expect.reciprocal)
}
