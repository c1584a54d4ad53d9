//! One module a property, or a group of properties that the same evaluations answer.

mod density;
mod energy;
mod furnace;
mod isotropy;
mod linearity;
mod reciprocity;
mod signs;
mod weight;

use crate::check::Checker;
use crate::verdict::{Property, Verdict};
use gonio_radiometry::sequence::Rng;

/// Every property, in the order of [`Property::ALL`].
pub(crate) fn all(c: &Checker) -> Vec<Verdict> {
    let [finite, non_negative, horizon] = signs::check(c);
    let [integral, density] = density::check(c);
    let furnaces = furnace::measure(c);
    vec![
        finite,
        non_negative,
        horizon,
        reciprocity::check(c),
        energy::check(c, &furnaces),
        isotropy::check(c),
        linearity::check(c),
        integral,
        density,
        weight::check(c, &furnaces),
    ]
}

/// The random numbers of a property: a function of the seed's name, the property and `part` alone.
fn rng(c: &Checker, property: Property, part: &str) -> Rng {
    Rng::from_name(&format!("{}/{}/{part}", c.seed_name, property.name()))
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
