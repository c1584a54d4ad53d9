//! f depends on φi − φr only.

use super::{relative_difference, rng, with_colour};
use crate::check::Checker;
use crate::directions::turned;
use crate::search::{typical, worst_pair};
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;
use std::f64::consts::TAU;

/// The worst relative difference of f under rotations of both directions about the normal. Four random angles: a
/// function with a rotational symmetry of its own (a weave, period 90°) would hide from round ones.
///
/// A failure involves no chance, as for reciprocity. As information, the symmetry in |φi − φr| is tried too.
pub(super) fn check(c: &Checker) -> Verdict {
    let eval = c.subject.eval;
    let mut random = rng(c, Property::Isotropy, "angles");
    let angles: [f64; 4] = std::array::from_fn(|_| TAU * random.next_f64());
    let region = c.subject.region();
    let scale = typical(eval, region, &mut random);
    let at = |wi: Vec3<f64>, wo: Vec3<f64>| {
        let f = eval(wi, wo);
        let mut worst = (0.0, angles[0]);
        for angle in angles {
            let d = relative_difference(f, eval(turned(wi, angle), turned(wo, angle)), scale);
            if d > worst.0 {
                worst = (d, angle);
            }
        }
        worst
    };
    let worst = worst_pair(
        &mut rng(c, Property::Isotropy, "pairs"),
        region,
        c.settings.pairs / 2,
        c.settings.nudge(),
        |wi, wo| at(wi, wo).0,
    );
    let bound = c.settings.relative_bound;
    let mut v = Verdict::passing(
        Property::Isotropy,
        worst.figure,
        bound,
        5 * worst.evaluations,
    );
    let angle = at(worst.wi, worst.wo).1;
    let turned_f = eval(turned(worst.wi, angle), turned(worst.wo, angle));
    let witness =
        Witness::pair(worst.wi, worst.wo).value("turned by (degrees)", angle.to_degrees());
    let witness = with_colour(witness, "f", eval(worst.wi, worst.wo));
    v.witness = Some(with_colour(witness, "f turned", turned_f));
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
        |wi, wo| relative_difference(eval(wi, wo), eval(flipped(wi), flipped(wo)), scale),
    );
    v.samples += 2 * handed.evaluations;
    if handed.figure > bound && v.note.is_none() {
        v.note = Some(format!(
            "f isn't the same for φi − φr and φr − φi: relative difference {:.3e}",
            handed.figure
        ));
    }
    v
}
