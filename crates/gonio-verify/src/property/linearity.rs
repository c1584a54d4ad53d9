//! A reflection function may be a sum of reflection functions.

use super::{relative_difference, rng, with_colour};
use crate::check::Checker;
use crate::search::{typical, worst_pair};
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;

/// The worst relative difference of f and the sum of its declared components.
pub(super) fn check(c: &Checker) -> Verdict {
    if c.components.is_empty() {
        return Verdict::not_applicable(Property::Linearity, "the subject names no components");
    }
    let eval = c.subject.eval;
    let sum = |wi: Vec3<f64>, wo: Vec3<f64>| {
        let mut total = [0.0; 3];
        for component in c.components {
            let f = component(wi, wo);
            for k in 0..3 {
                total[k] += f[k];
            }
        }
        total
    };
    let region = c.subject.region();
    let scale = typical(eval, region, &mut rng(c, Property::Linearity, "typical"));
    let worst = worst_pair(
        &mut rng(c, Property::Linearity, "pairs"),
        region,
        c.settings.pairs,
        c.settings.nudge(),
        |wi, wo| relative_difference(eval(wi, wo), sum(wi, wo), scale),
    );
    let bound = c.settings.relative_bound;
    let evaluations = worst.evaluations * (1 + c.components.len() as u64);
    let mut v = Verdict::passing(Property::Linearity, worst.figure, bound, evaluations);
    let witness = with_colour(
        Witness::pair(worst.wi, worst.wo),
        "f",
        eval(worst.wi, worst.wo),
    );
    v.witness = Some(with_colour(
        witness,
        "sum of components",
        sum(worst.wi, worst.wo),
    ));
    v.detail = format!(
        "worst relative difference of f and the sum of its {} components: {:.3e}",
        c.components.len(),
        worst.figure
    );
    v.judge(worst.figure > bound, true)
}
