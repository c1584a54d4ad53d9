//! f(ωi→ωr) n(ωi)² = f(ωr→ωi) n(ωr)², n the index of refraction of the side that a direction is on.

use super::{differences, rng, with_colour};
use crate::check::Checker;
use crate::reflection::SubjectFailed;
use crate::search::{typical, worst_pair};
use crate::subject::Pair;
use crate::verdict::{Property, Verdict, Witness};

/// The worst relative difference of f(wi, wo) n(wi)² and f(wo, wi) n(wo)²; n is 1 for what only reflects.
///
/// No chance enters a failure: the difference at the witness is above the bound whatever the random numbers were, and
/// the bound is far above what rounding makes of the same formula with its arguments exchanged.
pub(super) fn check(c: &Checker) -> Result<Verdict, SubjectFailed> {
    let (subject, region) = (c.subject, c.subject.region());
    // Radiance in units of n² of the side it arrives from: what both orders of the directions must agree on.
    let eval = |pairs: &[Pair]| {
        let mut f = subject.eval(pairs)?;
        for (f, (wi, _)) in f.iter_mut().zip(pairs) {
            let n2 = subject.index_squared(*wi);
            *f = [0, 1, 2].map(|k| f[k] * n2[k]);
        }
        Ok(f)
    };
    let scale = typical(eval, region, &mut rng(c, Property::Reciprocity, "typical"))?;
    let worst = worst_pair(
        &mut rng(c, Property::Reciprocity, "pairs"),
        region,
        c.settings.pairs,
        c.settings.nudge(),
        |pairs: &[Pair]| {
            let exchanged: Vec<Pair> = pairs.iter().map(|(wi, wo)| (*wo, *wi)).collect();
            differences(&eval(pairs)?, &eval(&exchanged)?, scale)
        },
    )?;
    let bound = c.settings.relative_bound;
    let mut v = Verdict::passing(
        Property::Reciprocity,
        worst.figure,
        bound,
        2 * worst.evaluations,
    );
    let both = eval(&[(worst.wi, worst.wo), (worst.wo, worst.wi)])?;
    let (a, b) = (both[0], both[1]);
    let witness = Witness::pair(worst.wi, worst.wo);
    let names = if subject.only_reflects() {
        ["f(wi, wo)", "f(wo, wi)"]
    } else {
        ["f(wi, wo)·n(wi)²", "f(wo, wi)·n(wo)²"]
    };
    let witness = with_colour(witness, names[0], a);
    v.witness = Some(with_colour(witness, names[1], b));
    v.detail = format!(
        "worst relative difference of {} and {}: {:.3e}",
        names[0], names[1], worst.figure
    );
    Ok(v.judge(worst.figure > bound, c.expect.reciprocal))
}
