//! One module a property, or a group of properties that the same evaluations answer.

mod continuity;
mod declarations;
mod density;
mod energy;
mod furnace;
mod isotropy;
mod linearity;
mod reciprocity;
mod signs;
mod single;
mod weight;

use crate::check::Checker;
use crate::reflection::SubjectFailed;
use crate::subject::{BATCH, Draw};
use crate::verdict::{Property, Verdict};
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;
use rayon::prelude::*;

/// A group of properties that share their evaluations.
type Group = fn(&Checker) -> Result<Vec<Verdict>, SubjectFailed>;

/// Each group is a task for a thread; the long ones are first, and divide themselves by direction.
const GROUPS: [Group; 8] = [
    furnaces,
    |c| Ok(density::check(c)?.into()),
    |c| Ok(vec![isotropy::check(c)?]),
    |c| Ok(vec![reciprocity::check(c)?]),
    |c| Ok(vec![single::check(c)?]),
    |c| Ok(signs::check(c)?.into()),
    |c| Ok(vec![continuity::check(c)?]),
    |c| Ok(vec![linearity::check(c)?]),
];

fn furnaces(c: &Checker) -> Result<Vec<Verdict>, SubjectFailed> {
    let furnaces = furnace::measure(c)?;
    let [energy, loss] = energy::check(c, &furnaces);
    Ok(vec![energy, loss, weight::check(c, &furnaces)?])
}

/// How often [`Checker::step`] is called: once a group, and once for each direction of those that go direction by direction.
pub(crate) fn steps(c: &Checker) -> u64 {
    let both = if c.subject.has_pdf() && c.subject.has_sample() {
        density::directions(c).len()
    } else {
        0
    };
    (GROUPS.len() + furnace::steps(c) + both) as u64
}

/// Every property, in the order of [`Property::ALL`].
///
/// # Errors
/// If the subject fails to answer.
pub(crate) fn all(c: &Checker) -> Result<Vec<Verdict>, SubjectFailed> {
    let groups = GROUPS
        .par_iter()
        .map(|group| {
            let verdicts = group(c);
            c.step();
            verdicts
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut all: Vec<Verdict> = groups.into_iter().flatten().collect();
    all.push(declarations::check(c, &all));
    all.sort_by_key(|v| v.property);
    Ok(all)
}

/// The random numbers of a property: a function of the seed's name, the property and `part` alone.
fn rng(c: &Checker, property: Property, part: &str) -> Rng {
    Rng::from_name(&format!("{}/{}/{part}", c.seed_name, property.name()))
}

/// `count` times wo with three random numbers, in batches.
fn draws<'r>(rng: &'r mut Rng, wo: Vec3<f64>, count: u64) -> impl Iterator<Item = Vec<Draw>> + 'r {
    let batch = BATCH as u64;
    (0..count.div_ceil(batch)).map(move |k| {
        (0..batch.min(count - k * batch))
            .map(|_| (wo, [rng.next_f64(), rng.next_f64(), rng.next_f64()]))
            .collect()
    })
}

/// The largest difference of a and b over the channels, relative to the larger of both plus a thousandth of the
/// function's typical size: a disagreement below that is invisible beside the rest of the function.
fn relative_difference(a: [f64; 3], b: [f64; 3], typical: f64) -> f64 {
    let mut worst = 0.0;
    for k in 0..3 {
        let size = a[k].abs().max(b[k].abs()) + 1e-3 * typical;
        let d = if size > 0.0 {
            (a[k] - b[k]).abs() / size
        } else {
            0.0
        };
        if d.is_nan() {
            return f64::NAN;
        }
        worst = d.max(worst);
    }
    worst
}

/// [`relative_difference`] of each of `a` with its like in `b`.
fn differences(a: &[[f64; 3]], b: &[[f64; 3]], typical: f64) -> Result<Vec<f64>, SubjectFailed> {
    let both = a.iter().zip(b);
    Ok(both
        .map(|(a, b)| relative_difference(*a, *b, typical))
        .collect())
}

/// `name` and its three channels as named numbers of a witness; one number where the channels agree.
fn with_colour(
    witness: crate::verdict::Witness,
    name: &str,
    colour: [f64; 3],
) -> crate::verdict::Witness {
    if colour[0] == colour[1] && colour[1] == colour[2] {
        return witness.value(name, colour[0]);
    }
    witness
        .value(format!("{name} [0]"), colour[0])
        .value(format!("{name} [1]"), colour[1])
        .value(format!("{name} [2]"), colour[2])
}
