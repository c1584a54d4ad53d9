//! A reflection function may be a sum of reflection functions.

use super::{differences, rng, with_colour};
use crate::check::Checker;
use crate::reflection::SubjectFailed;
use crate::search::{typical, worst_pair};
use crate::subject::Pair;
use crate::verdict::{Property, Verdict, Witness};

/// The worst relative difference of f and the sum of its declared components.
pub(super) fn check(c: &Checker) -> Result<Verdict, SubjectFailed> {
    if c.components.is_empty() {
        let why = "the subject names no components";
        return Ok(Verdict::not_applicable(Property::Linearity, why));
    }
    let eval = |pairs: &[Pair]| c.subject.eval(pairs);
    let sum = |pairs: &[Pair]| -> Vec<[f64; 3]> {
        let of_one = |(wi, wo): &Pair| {
            let mut total = [0.0; 3];
            for component in c.components {
                let f = component(*wi, *wo);
                for k in 0..3 {
                    total[k] += f[k];
                }
            }
            total
        };
        pairs.iter().map(of_one).collect()
    };
    let region = c.subject.region();
    let scale = typical(eval, region, &mut rng(c, Property::Linearity, "typical"))?;
    let worst = worst_pair(
        &mut rng(c, Property::Linearity, "pairs"),
        region,
        c.settings.pairs,
        c.settings.nudge(),
        |pairs: &[Pair]| differences(&eval(pairs)?, &sum(pairs), scale),
    )?;
    let bound = c.settings.relative_bound;
    let evaluations = worst.evaluations * (1 + c.components.len() as u64);
    let mut v = Verdict::passing(Property::Linearity, worst.figure, bound, evaluations);
    let pair = [(worst.wi, worst.wo)];
    let witness = with_colour(Witness::pair(worst.wi, worst.wo), "f", eval(&pair)?[0]);
    v.witness = Some(with_colour(witness, "sum of components", sum(&pair)[0]));
    v.detail = format!(
        "worst relative difference of f and the sum of its {} components: {:.3e}",
        c.components.len(),
        worst.figure
    );
    Ok(v.judge(worst.figure > bound, true))
}
