//! `sample` against `pdf`: the integral of the density, and the χ² test of the drawn directions.

use super::furnace::{SECOND_LOOK, lobes, viewers};
use super::{draws as draws_of, rng};
use crate::check::Checker;
use crate::cubature::integrate;
use crate::directions::at_height;
use crate::partition::{Partition, Pilot, Rules, coordinates};
use crate::reflection::SubjectFailed;
use crate::statistics::{
    TestResult, chi_square_test_with_slack, sidak, sidak_p_value, wilson_interval,
};
use crate::subject::Pair;
use crate::verdict::{Interval, Property, Verdict, Witness};
use gonio_num::Vec3;
use rayon::prelude::*;

/// Above this quadrature error a direction can't be judged.
const BLIND: f64 = 0.02;

/// What one direction gave.
struct Look {
    wo: Vec3<f64>,
    integral: f64,
    integral_error: f64,
    /// The fraction of draws that gave a direction of the density, with its interval.
    drawn: f64,
    drawn_range: (f64, f64),
    draws: u64,
    deltas: u64,
    chi_square: TestResult,
    /// The cell that disagrees the most: a direction in it, expected and observed counts.
    worst_cell: Option<(Vec3<f64>, f64, u64)>,
    samples: u64,
}

impl Look {
    /// How far the integral is from the drawn fraction beyond what the quadrature and chance explain.
    fn excess(&self) -> f64 {
        let (low, high) = self.drawn_range;
        let (i, e) = (self.integral, self.integral_error);
        (i - e - high).max(low - i - e).max(0.0)
    }

    fn blind(&self) -> bool {
        self.integral_error > BLIND
    }
}

/// The tests of one direction: `harder` multiplies pilot samples, cells and quadrature; the tested samples stay the same.
fn look(
    c: &Checker,
    wo: Vec3<f64>,
    index: usize,
    tail: f64,
    harder: u64,
) -> Result<Look, SubjectFailed> {
    let settings = &c.settings;
    let property = Property::SampleDensity;
    let mut random = rng(c, property, &format!("pilot {index}"));
    let cells = u64::from(settings.cells);
    let pilot = cells * 16 * harder;
    let mut points: Vec<Pilot> = Vec::new();
    for batch in draws_of(&mut random, wo, pilot) {
        let drawn = c.subject.draw(&batch)?.into_iter().flatten();
        points.extend(
            drawn
                .filter(|s| !s.delta && s.wi.is_finite())
                .map(|s| Pilot {
                    at: coordinates(s.wi),
                    density: s.pdf,
                }),
        );
    }
    let rules = Rules {
        max_points: (points.len() / (cells * harder.min(4)) as usize).max(8),
        max_mass: 4.0 / (cells * harder) as f64,
        max_solid_angle: 0.2 / harder as f64,
        seed_width: 0.05,
    };
    let partition = Partition::new(points, &lobes(c, wo), &rules, true);
    let integral = integrate(
        |at: &[[f64; 2]]| {
            let pairs: Vec<Pair> = at
                .iter()
                .map(|[z, phi]| (at_height(*z, *phi), wo))
                .collect();
            Ok(c.subject.pdf(&pairs)?.into_iter().map(|p| [p]).collect())
        },
        &partition.cells,
        // A fiftieth of the standard error of a fraction 1/2 of the draws: small beside chance, over all cells together.
        0.01 / (settings.density_samples.max(1) as f64).sqrt(),
        settings.quadrature_evaluations * harder,
    )?;

    let draws = settings.density_samples;
    let mut random = rng(c, property, &format!("samples {index}"));
    let mut observed = vec![0u64; partition.cells.len()];
    let (mut hits, mut deltas) = (0, 0);
    for batch in draws_of(&mut random, wo, draws) {
        for s in c.subject.draw(&batch)?.into_iter().flatten() {
            if s.delta {
                deltas += 1;
            } else if s.wi.is_finite()
                && let Some(cell) = partition.find(s.wi)
            {
                observed[cell] += 1;
                hits += 1;
            }
        }
    }

    let n = draws as f64;
    // The cells of the quadrature are finer than a test of this many draws can use. They stand in the order of the tree, so
    // neighbours in the list are neighbours on the sphere, and a run of them is a cell of the test.
    let enough = (n / (2.0 * cells as f64)).max(5.0);
    let (mut counts, mut expected, mut slack) = (vec![0u64], vec![0.0], vec![0.0]);
    let mut centres = vec![partition.cells[0].centre()];
    for (i, e) in integral.cells.iter().enumerate() {
        let mut last = expected.len() - 1;
        if expected[last] >= enough {
            counts.push(0);
            expected.push(0.0);
            slack.push(0.0);
            centres.push(partition.cells[i].centre());
            last += 1;
        }
        counts[last] += observed[i];
        expected[last] += n * e.value[0];
        slack[last] += n * e.error[0];
    }
    let worst_cell = (0..counts.len())
        .map(|i| {
            let beyond = ((counts[i] as f64 - expected[i]).abs() - slack[i]).max(0.0);
            (i, beyond * beyond / expected[i].max(1.0))
        })
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(i, _)| {
            let [z, phi] = centres[i];
            (at_height(z, phi), expected[i], counts[i])
        });
    // The last cell is "no direction, or a delta's".
    let (value, error) = (integral.total.value[0], integral.total.error[0]);
    expected.push(n * (1.0 - value).max(0.0));
    slack.push(n * error);
    counts.push(draws - hits);
    Ok(Look {
        wo,
        integral: value,
        integral_error: error,
        drawn: hits as f64 / n,
        drawn_range: wilson_interval(hits, draws, 0.5 * tail),
        draws,
        deltas,
        chi_square: chi_square_test_with_slack(&counts, &expected, &slack, 5.0),
        worst_cell,
        samples: pilot + draws + integral.evaluations,
    })
}

pub(super) fn directions(c: &Checker) -> Vec<Vec3<f64>> {
    viewers(c, c.settings.directions, 86.0)
}

/// The density integrates to the fraction of draws that give a direction, and the drawn directions fall into cells of the
/// sphere as the density says, at several outgoing directions with Šidák's correction.
///
/// The cells follow pilot samples drawn apart from the tested ones, so each holds about the same probability however sharp
/// the lobe is. Differences are shortened by the quadrature's error. A suspicion is looked at again with eight times the
/// pilot samples and quadrature, so that a feature the first partition overlooked isn't blamed on the subject.
pub(super) fn check(c: &Checker) -> Result<[Verdict; 2], SubjectFailed> {
    let properties = [Property::PdfIntegral, Property::SampleDensity];
    let not_applicable = |why: &str| Ok(properties.map(|p| Verdict::not_applicable(p, why)));
    if !c.subject.has_pdf() {
        return not_applicable("the subject gives no pdf");
    }
    if !c.subject.has_sample() {
        return not_applicable("the subject can't be sampled");
    }
    let rate = c.settings.false_positive_rate;
    let directions = directions(c);
    let each = sidak(rate, directions.len() as u64);
    let judged = |(index, wo): (usize, Vec3<f64>)| {
        let mut l = look(c, wo, index, each, 1)?;
        let suspicious = l.excess() > c.settings.integral_bound
            || l.chi_square.p_value < each.max(1e-3)
            || l.integral_error > 0.25 * BLIND;
        if suspicious {
            let before = l.samples;
            l = look(c, wo, index, each, SECOND_LOOK)?;
            l.samples += before;
        }
        c.step();
        Ok(l)
    };
    let looks = directions
        .into_par_iter()
        .enumerate()
        .map(judged)
        .collect::<Result<Vec<Look>, SubjectFailed>>()?;
    if looks.iter().all(|l| l.drawn == 0.0 && l.integral == 0.0) {
        let only_deltas = looks.iter().any(|l| l.deltas > 0);
        return not_applicable(if only_deltas {
            "only Dirac deltas are drawn: they have no density"
        } else {
            "no direction is ever drawn, and the pdf is 0"
        });
    }
    let blind = looks.iter().filter(|l| l.blind()).count();
    let judged: Vec<&Look> = looks.iter().filter(|l| !l.blind()).collect();
    if judged.is_empty() {
        return not_applicable(
            "inconclusive: the pdf couldn't be integrated to 2 % at any direction",
        );
    }
    let samples = looks.iter().map(|l| l.samples).sum();
    let note = (blind > 0).then(|| {
        format!("{blind} directions left out: the pdf couldn't be integrated to 2 % there")
    });
    let mut verdicts = [
        integral_verdict(c, &judged, samples),
        density_verdict(c, &judged, samples),
    ];
    for v in &mut verdicts {
        v.note = note.clone();
    }
    Ok(verdicts)
}

fn integral_verdict(c: &Checker, looks: &[&Look], samples: u64) -> Verdict {
    let worst = looks
        .iter()
        .max_by(|a, b| {
            let key = |l: &Look| (l.excess(), (l.integral - l.drawn).abs());
            key(a)
                .partial_cmp(&key(b))
                .unwrap_or(std::cmp::Ordering::Equal)
        })
        .expect("invariant: there is at least one direction");
    let bound = c.settings.integral_bound;
    let mut v = Verdict::passing(Property::PdfIntegral, worst.excess(), bound, samples);
    let rate = c.settings.false_positive_rate;
    v.false_positive_rate = rate;
    let (low, high) = worst.drawn_range;
    let (i, e) = (worst.integral, worst.integral_error);
    v.confidence = Some(Interval {
        low: worst.excess(),
        high: (i + e - low).max(high - i + e),
        level: 1.0 - rate,
    });
    v.witness = Some(
        Witness::at(worst.wo)
            .value("integral of pdf", i)
            .value("quadrature error", e)
            .value("fraction of draws with a density", worst.drawn)
            .value(
                "fraction of draws without a direction",
                1.0 - worst.drawn - worst.deltas as f64 / worst.draws as f64,
            ),
    );
    v.detail = format!(
        "∫ pdf = {i:.6} ± {e:.1e}, and {:.6} of {} draws have a density: apart by this much beyond chance",
        worst.drawn, worst.draws
    );
    v.judge(worst.excess() > bound, true)
}

fn density_verdict(c: &Checker, looks: &[&Look], samples: u64) -> Verdict {
    let worst = looks
        .iter()
        .min_by(|a, b| a.chi_square.p_value.total_cmp(&b.chi_square.p_value))
        .expect("invariant: there is at least one direction");
    let t = worst.chi_square;
    let p = sidak_p_value(t.p_value, looks.len() as u64);
    let rate = c.settings.false_positive_rate;
    let mut v = Verdict::passing(Property::SampleDensity, p, rate, samples);
    v.p_value = Some(p);
    v.false_positive_rate = rate;
    let mut witness = Witness::at(worst.wo);
    if let Some((wi, expected, observed)) = worst.worst_cell {
        witness = Witness::pair(wi, worst.wo)
            .value("expected draws in the cell around wi", expected)
            .value("observed draws", observed as f64);
    }
    v.witness = Some(
        witness
            .value("χ²", t.statistic)
            .value("degrees of freedom", t.degrees_of_freedom),
    );
    v.detail = format!(
        "χ² = {:.1} with {} degrees of freedom, the worst of {} directions",
        t.statistic,
        t.degrees_of_freedom,
        looks.len()
    );
    v.judge(p < rate, true)
}
