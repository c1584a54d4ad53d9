//! weight = f·|cosθi| / pdf.

use super::furnace::{Furnace, viewers};
use super::rng;
use crate::check::Checker;
use crate::directions::{awkward, awkward_numbers, flipped, moved};
use crate::reflection::{SubjectFailed, SubjectSample};
use crate::statistics::sidak;
use crate::subject::{BATCH, Draw, Pair};
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;

/// The worst mismatch of a sample.
struct Worst {
    figure: f64,
    witness: Option<Witness>,
    samples: u64,
    compared: u64,
}

impl Worst {
    /// Draws, and compares each with `eval` and `pdf`.
    fn add(&mut self, c: &Checker, queries: &[Draw]) -> Result<(), SubjectFailed> {
        self.samples += queries.len() as u64;
        let drawn: Vec<(Draw, SubjectSample)> = queries
            .iter()
            .zip(c.subject.draw(queries)?)
            .filter_map(|(query, s)| Some((*query, s?)))
            .filter(|(_, s)| !s.delta && s.wi.is_finite() && s.pdf.is_finite())
            .collect();
        self.compared += drawn.len() as u64;
        let places: Vec<Place> = drawn.iter().map(|((wo, _), s)| (*s, s.wi, *wo)).collect();
        for (((wo, u), s), found) in drawn.iter().zip(mismatches(c, &places)?) {
            let Mismatch {
                mut figure,
                weight,
                density,
            } = found;
            if figure > self.figure.max(c.settings.weight_bound) {
                // On the edge of a table's cell the density of the draw may be that of the other side: such a mismatch
                // vanishes beside it.
                let beside = [0.4, 2.0, 3.6, 5.2]
                    .map(|around| (*s, moved(s.wi, c.settings.nudge(), around), *wo));
                for beside in mismatches(c, &beside)? {
                    figure = figure.min(beside.figure);
                }
            }
            // A mismatch of a vector that isn't unit is no matter of edges.
            figure = figure.max((s.wi.length() - 1.0).abs());
            if figure > self.figure {
                self.figure = figure;
                let mut w = Witness::pair(s.wi, *wo)
                    .drawn(*u)
                    .value("pdf of the sample", s.pdf)
                    .value("pdf(wi, wo)", density)
                    .value("length of wi", s.wi.length());
                w = super::with_colour(w, "weight", s.weight);
                w = super::with_colour(w, "f·|cosθi| / pdf", weight);
                self.witness = Some(w);
            }
        }
        Ok(())
    }
}

/// A draw, the direction wi to compare it at, and wo.
type Place = (SubjectSample, Vec3<f64>, Vec3<f64>);

/// The relative difference of a draw's density and weight from those of `eval` and `pdf`, which are the expected ones.
struct Mismatch {
    figure: f64,
    weight: [f64; 3],
    density: f64,
}

fn mismatches(c: &Checker, places: &[Place]) -> Result<Vec<Mismatch>, SubjectFailed> {
    let pairs: Vec<Pair> = places.iter().map(|(_, wi, wo)| (*wi, *wo)).collect();
    let values = c.subject.eval(&pairs)?;
    let densities = if c.subject.has_pdf() {
        c.subject.pdf(&pairs)?
    } else {
        places.iter().map(|(s, ..)| s.pdf).collect()
    };
    let all = places.iter().zip(values.iter().zip(densities));
    Ok(all
        .map(|((s, wi, _), (f, density))| {
            let weight = f.map(|f| f * wi.z.abs() / density);
            if density == 0.0 {
                return Mismatch {
                    figure: f64::INFINITY,
                    weight,
                    density,
                };
            }
            let mut figure = (s.pdf - density).abs() / s.pdf.abs().max(density.abs());
            for (given, expected) in s.weight.into_iter().zip(weight) {
                // Weights are of order 1: a thousandth of that is the smallest size that a difference is held against.
                let size = given.abs().max(expected.abs()) + 1e-3;
                // NaN is another property's business: it never wins.
                figure = figure.max((given - expected).abs() / size);
            }
            Mismatch {
                figure,
                weight,
                density,
            }
        })
        .collect())
}

/// Three things. At each draw the weight is f·|cosθi| / pdf and the returned density is pdf: no chance involved. Where f
/// reflects, pdf isn't 0 (else sampling never finds that light): by quadrature. And the mean weight is the albedo by
/// quadrature, within Bernstein's bound with the weight's true variance and range, so that rare large weights don't raise a
/// false alarm.
pub(super) fn check(c: &Checker, furnaces: &[Furnace]) -> Result<Verdict, SubjectFailed> {
    let property = Property::SampleWeight;
    if !c.subject.has_sample() {
        let why = "the subject can't be sampled";
        return Ok(Verdict::not_applicable(property, why));
    }
    let mut worst = Worst {
        figure: 0.0,
        witness: None,
        samples: 0,
        compared: 0,
    };
    let mut random = rng(c, property, "draws");
    let directions = viewers(c, 4 * c.settings.directions, 89.9);
    let each = c.settings.pairs / directions.len() as u64 + 1;
    let mut queries: Vec<Draw> = Vec::new();
    for wo in directions {
        for _ in 0..each {
            let u = [random.next_f64(), random.next_f64(), random.next_f64()];
            queries.push((wo, u));
        }
        if queries.len() >= BATCH {
            worst.add(c, &std::mem::take(&mut queries))?;
        }
    }
    let mut steep: Vec<_> = awkward().into_iter().filter(|w| w.z > 1e-3).collect();
    if !c.subject.only_reflects() {
        steep.extend(steep.clone().into_iter().map(flipped));
    }
    for wo in steep {
        queries.extend(awkward_numbers().into_iter().map(|u| (wo, u)));
    }
    worst.add(c, &queries)?;

    let bound = c.settings.weight_bound;
    let mut v = Verdict::passing(property, worst.figure, bound, worst.samples);
    let deltas: u64 = furnaces.iter().map(|f| f.delta_draws).sum();
    if !c.subject.has_pdf() && worst.compared == 0 && deltas == 0 {
        let why = "no direction is ever drawn, and there is no pdf";
        return Ok(Verdict::not_applicable(property, why));
    }
    v.witness = worst.witness;
    v.detail = match (worst.compared, deltas) {
        (0, 0) => "no direction is ever drawn".into(),
        (0, _) => "only Dirac deltas are drawn, whose weights the energy check sums".into(),
        (n, _) => format!(
            "worst relative difference of weight and f·|cosθi| / pdf in {n} draws: {:.3e}",
            worst.figure
        ),
    };
    let mut violated = worst.figure > bound;
    if c.subject.has_pdf() {
        let rate = c.settings.false_positive_rate;
        v.false_positive_rate = rate;
        v.samples += furnaces.iter().map(|f| f.evaluations).sum::<u64>();
        for found in [unreachable(c, furnaces), biased(c, furnaces, rate)] {
            if let Some((figure, bound, witness, detail)) = found
                && !violated
            {
                violated = true;
                (v.figure, v.bound, v.witness, v.detail) = (figure, bound, Some(witness), detail);
            }
        }
    }
    Ok(v.judge(violated, true))
}

type Found = Option<(f64, f64, Witness, String)>;

/// Light that sampling can't find.
fn unreachable(c: &Checker, furnaces: &[Furnace]) -> Found {
    let f = furnaces
        .iter()
        .max_by(|a, b| a.unreachable.total_cmp(&b.unreachable))?;
    let bound = c.settings.integral_bound;
    if f.unreachable - f.unreachable_error <= bound {
        return None;
    }
    let witness = match f.unreachable_at {
        Some(wi) => Witness::pair(wi, f.wo),
        None => Witness::at(f.wo),
    };
    Some((
        f.unreachable,
        bound,
        witness
            .value("albedo at directions of density 0", f.unreachable)
            .value("quadrature error", f.unreachable_error),
        format!(
            "{:.4} of albedo comes from directions whose pdf is 0: sampling never finds it",
            f.unreachable
        ),
    ))
}

/// A mean weight that isn't the albedo.
fn biased(c: &Checker, furnaces: &[Furnace], rate: f64) -> Found {
    let tail = sidak(rate, 3 * furnaces.len() as u64);
    let mut worst: Found = None;
    let mut most = c.settings.integral_bound;
    for f in furnaces {
        for k in 0..3 {
            let b = f.bias(k, tail);
            if b.excess > most {
                most = b.excess;
                worst = Some((
                    (b.mean - b.expected).abs(),
                    b.chance + b.quadrature_error + c.settings.integral_bound,
                    Witness::at(f.wo)
                        .value("mean weight", b.mean)
                        .value("albedo by quadrature", b.expected)
                        .value("explained by chance", b.chance)
                        .value("quadrature error", b.quadrature_error),
                    format!(
                        "the mean weight is {:.5}, the albedo {:.5}",
                        b.mean, b.expected
                    ),
                ));
            }
        }
    }
    worst
}
