//! f depends on φi − φr only.

use super::{differences, rng, with_colour};
use crate::check::Checker;
use crate::directions::turned;
use crate::reflection::SubjectFailed;
use crate::search::{typical, worst_pair};
use crate::subject::Pair;
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;
use std::f64::consts::TAU;

/// The worst relative difference of f under rotations of both directions about the normal. Four random angles: a
/// function with a rotational symmetry of its own (a weave, period 90°) would hide from round ones.
///
/// A failure involves no chance, as for reciprocity. As information, the symmetry in |φi − φr| is tried too.
pub(super) fn check(c: &Checker) -> Result<Verdict, SubjectFailed> {
    let eval = |pairs: &[Pair]| c.subject.eval(pairs);
    let mut random = rng(c, Property::Isotropy, "angles");
    let angles: [f64; 4] = std::array::from_fn(|_| TAU * random.next_f64());
    let region = c.subject.region();
    let scale = typical(eval, region, &mut random)?;
    let turn = |pairs: &[Pair], angle: f64| -> Vec<Pair> {
        let both = |(wi, wo): &Pair| (turned(*wi, angle), turned(*wo, angle));
        pairs.iter().map(both).collect()
    };
    // The worst over the angles, with the angle, for each pair.
    let at = |pairs: &[Pair]| -> Result<Vec<(f64, f64)>, SubjectFailed> {
        let f = eval(pairs)?;
        let mut worst = vec![(0.0, angles[0]); pairs.len()];
        for angle in angles {
            let changes = differences(&f, &eval(&turn(pairs, angle))?, scale)?;
            for (worst, d) in worst.iter_mut().zip(changes) {
                if d > worst.0 {
                    *worst = (d, angle);
                }
            }
        }
        Ok(worst)
    };
    let worst = worst_pair(
        &mut rng(c, Property::Isotropy, "pairs"),
        region,
        c.settings.pairs / 2,
        c.settings.nudge(),
        |pairs: &[Pair]| Ok(at(pairs)?.into_iter().map(|(d, _)| d).collect()),
    )?;
    let bound = c.settings.relative_bound;
    let mut v = Verdict::passing(
        Property::Isotropy,
        worst.figure,
        bound,
        5 * worst.evaluations,
    );
    let pair = [(worst.wi, worst.wo)];
    let angle = at(&pair)?[0].1;
    let (here, there) = (eval(&pair)?[0], eval(&turn(&pair, angle))?[0]);
    let witness =
        Witness::pair(worst.wi, worst.wo).value("turned by (degrees)", angle.to_degrees());
    let witness = with_colour(witness, "f", here);
    v.witness = Some(with_colour(witness, "f turned", there));
    v.detail = format!(
        "worst relative change when both directions turn about the normal: {:.3e}",
        worst.figure
    );
    let mut v = v.judge(worst.figure > bound, c.expect.isotropic);

    let flipped = |w: Vec3<f64>| Vec3::new(w.x, -w.y, w.z);
    let handed = worst_pair(
        &mut rng(c, Property::Isotropy, "bilateral"),
        region,
        c.settings.pairs / 4,
        c.settings.nudge(),
        |pairs: &[Pair]| {
            let other: Vec<Pair> = pairs
                .iter()
                .map(|(wi, wo)| (flipped(*wi), flipped(*wo)))
                .collect();
            differences(&eval(pairs)?, &eval(&other)?, scale)
        },
    )?;
    v.samples += 2 * handed.evaluations;
    if handed.figure > bound && v.note.is_none() {
        v.note = Some(format!(
            "f isn't the same for φi − φr and φr − φi: relative difference {:.3e}",
            handed.figure
        ));
    }
    Ok(v)
}
