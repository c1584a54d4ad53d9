//! weight = f·|cosθi| / pdf.

use super::furnace::{Furnace, viewers};
use super::rng;
use crate::check::Checker;
use crate::directions::{awkward, awkward_numbers, flipped, moved};
use crate::statistics::sidak;
use crate::subject::SubjectSample;
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
    /// Compares one sample with `eval` and `pdf`.
    fn add(&mut self, c: &Checker, wo: Vec3<f64>, u: [f64; 3], s: &SubjectSample) {
        if s.delta || !s.wi.is_finite() || !s.pdf.is_finite() {
            return;
        }
        self.compared += 1;
        let (mut figure, expected, density) = mismatch(c, wo, s, s.wi);
        if figure > self.figure.max(c.settings.weight_bound) {
            // On the edge of a table's cell the density of the draw may be that of the other side: such a mismatch
            // vanishes beside it.
            for around in [0.4, 2.0, 3.6, 5.2] {
                let beside = moved(s.wi, c.settings.nudge(), around);
                figure = figure.min(mismatch(c, wo, s, beside).0);
            }
        }
        // A mismatch of a vector that isn't unit is no matter of edges.
        figure = figure.max((s.wi.length() - 1.0).abs());
        if figure > self.figure {
            self.figure = figure;
            let mut w = Witness::pair(s.wi, wo)
                .drawn(u)
                .value("pdf of the sample", s.pdf)
                .value("pdf(wi, wo)", density)
                .value("length of wi", s.wi.length());
            w = super::with_colour(w, "weight", s.weight);
            w = super::with_colour(w, "f·|cosθi| / pdf", expected);
            self.witness = Some(w);
        }
    }
}

/// The relative difference of a draw's density and weight from those of `eval` and `pdf` at `wi`; the expected weight and
/// density.
fn mismatch(c: &Checker, wo: Vec3<f64>, s: &SubjectSample, wi: Vec3<f64>) -> (f64, [f64; 3], f64) {
    let density = c.subject.pdf.map_or(s.pdf, |pdf| pdf(wi, wo));
    let f = (c.subject.eval)(wi, wo);
    let expected = f.map(|f| f * wi.z.abs() / density);
    if density == 0.0 {
        return (f64::INFINITY, expected, density);
    }
    let mut figure = (s.pdf - density).abs() / s.pdf.abs().max(density.abs());
    for (given, expected) in s.weight.into_iter().zip(expected) {
        // Weights are of order 1: a thousandth of that is the smallest size that a difference is held against.
        let size = given.abs().max(expected.abs()) + 1e-3;
        // NaN is another property's business: it never wins.
        figure = figure.max((given - expected).abs() / size);
    }
    (figure, expected, density)
}

/// Three things. At each draw the weight is f·|cosθi| / pdf and the returned density is pdf: no chance involved. Where f
/// reflects, pdf isn't 0 (else sampling never finds that light): by quadrature. And the mean weight is the albedo by
/// quadrature, within Bernstein's bound with the weight's true variance and range, so that rare large weights don't raise a
/// false alarm.
pub(super) fn check(c: &Checker, furnaces: &[Furnace]) -> Verdict {
    let property = Property::SampleWeight;
    if c.subject.sample.is_none() {
        return Verdict::not_applicable(property, "the subject can't be sampled");
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
    for wo in directions {
        for _ in 0..each {
            let u = [random.next_f64(), random.next_f64(), random.next_f64()];
            worst.samples += 1;
            if let Some(s) = c.subject.draw(wo, u) {
                worst.add(c, wo, u, &s);
            }
        }
    }
    let mut steep: Vec<_> = awkward().into_iter().filter(|w| w.z > 1e-3).collect();
    if !c.subject.only_reflects() {
        steep.extend(steep.clone().into_iter().map(flipped));
    }
    for wo in steep {
        for u in awkward_numbers() {
            worst.samples += 1;
            if let Some(s) = c.subject.draw(wo, u) {
                worst.add(c, wo, u, &s);
            }
        }
    }

    let bound = c.settings.weight_bound;
    let mut v = Verdict::passing(property, worst.figure, bound, worst.samples);
    let deltas: u64 = furnaces.iter().map(|f| f.delta_draws).sum();
    if c.subject.pdf.is_none() && worst.compared == 0 && deltas == 0 {
        return Verdict::not_applicable(
            property,
            "no direction is ever drawn, and there is no pdf",
        );
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
    if c.subject.pdf.is_some() {
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
    v.judge(violated, true)
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
