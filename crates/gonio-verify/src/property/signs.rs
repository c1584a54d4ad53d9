//! What can be seen number by number: finite, non-negative, and 0 below the horizon.

use super::rng;
use crate::check::Checker;
use crate::directions::{
    Region, awkward, awkward_about, awkward_numbers, flipped as down, random_pair,
};
use crate::reflection::{SubjectFailed, SubjectSample};
use crate::search::typical;
use crate::subject::{BATCH, Draw, Pair};
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;

/// The worst offence of one kind, and how often it was met.
struct Tally {
    worst: f64,
    count: u64,
    witness: Option<Witness>,
}

impl Tally {
    fn new() -> Self {
        Self {
            worst: 0.0,
            count: 0,
            witness: None,
        }
    }

    fn add(&mut self, size: f64, witness: impl FnOnce() -> Witness) {
        self.count += 1;
        if self.witness.is_none() || size > self.worst {
            self.worst = size;
            self.witness = Some(witness());
        }
    }
}

/// One question.
enum Query {
    Pair(Pair),
    Draw(Draw),
}

struct Sweep<'c, 'a> {
    c: &'c Checker<'a>,
    queries: Vec<Query>,
    not_finite: Tally,
    negative: Tally,
    below: Tally,
    samples: u64,
    /// Typical size of f, for judging whether a negative value is only rounding.
    scale: f64,
}

impl Sweep<'_, '_> {
    fn pair(&mut self, wi: Vec3<f64>, wo: Vec3<f64>) {
        self.queries.push(Query::Pair((wi, wo)));
    }

    fn draw(&mut self, wo: Vec3<f64>, u: [f64; 3]) {
        if self.c.subject.has_sample() {
            self.queries.push(Query::Draw((wo, u)));
        } else {
            self.samples += 1;
        }
    }

    /// Asks what has been collected, if that is a batch; whatever is left, at the `end`.
    fn ask(&mut self, end: bool) -> Result<(), SubjectFailed> {
        if !end && self.queries.len() < BATCH {
            return Ok(());
        }
        let queries = std::mem::take(&mut self.queries);
        self.samples += queries.len() as u64;
        let (mut pairs, mut draws) = (Vec::new(), Vec::new());
        for query in &queries {
            match query {
                Query::Pair(pair) => pairs.push(*pair),
                Query::Draw(draw) => draws.push(*draw),
            }
        }
        let mut values = self.c.subject.eval(&pairs)?.into_iter();
        let mut densities = self.c.subject.pdf(&pairs)?.into_iter();
        let mut drawn = self.c.subject.draw(&draws)?.into_iter();
        for query in queries {
            match query {
                Query::Pair(pair) => {
                    let answer = values.next().zip(densities.next());
                    let (f, p) = answer.expect("invariant: an answer a pair");
                    self.looked_at(pair, f, p);
                }
                Query::Draw((wo, u)) => {
                    if let Some(s) = drawn.next().flatten() {
                        self.drawn(wo, u, &s);
                    }
                }
            }
        }
        Ok(())
    }

    fn number(&mut self, x: f64, unit: f64, witness: impl Fn() -> Witness) {
        if !x.is_finite() {
            self.not_finite.add(1.0, witness);
        } else if x < -self.c.settings.rounding() * unit {
            self.negative.add(-x, witness);
        }
    }

    fn looked_at(&mut self, (wi, wo): Pair, f: [f64; 3], p: f64) {
        let below = self.c.subject.only_reflects() && (wi.z < 0.0 || wo.z < 0.0);
        for x in f {
            self.number(x, self.scale, || Witness::pair(wi, wo).value("f", x));
            if below && x.is_finite() && x != 0.0 {
                self.below
                    .add(x.abs(), || Witness::pair(wi, wo).value("f", x));
            }
        }
        self.number(p, 1.0, || Witness::pair(wi, wo).value("pdf", p));
        if below && p.is_finite() && p != 0.0 {
            self.below
                .add(p.abs(), || Witness::pair(wi, wo).value("pdf", p));
        }
    }

    fn drawn(&mut self, wo: Vec3<f64>, u: [f64; 3], s: &SubjectSample) {
        let witness = || Witness::pair(s.wi, wo).drawn(u);
        for x in s.wi.to_array() {
            // A coordinate may have either sign.
            self.number(x.abs(), 1.0, || witness().value("coordinate of wi", x));
        }
        self.number(s.pdf, 1.0, || witness().value("pdf of the sample", s.pdf));
        for x in s.weight {
            self.number(x, 1.0, || witness().value("weight", x));
        }
        if self.c.subject.only_reflects() && (s.wi.z < 0.0 || wo.z < 0.0) {
            let size = s.weight.iter().fold(0.0, |a: f64, w| a.max(w.abs()));
            self.below.add(size, || {
                witness()
                    .value("weight", size)
                    .value("pdf of the sample", s.pdf)
            });
        }
    }
}

/// Sweeps random pairs, pairs with one or both directions below the horizon, the corpus of awkward directions, and the
/// corpus of awkward random numbers. No chance is involved in a failure: each is a value that was returned.
pub(super) fn check(c: &Checker) -> Result<[Verdict; 3], SubjectFailed> {
    let mut random = rng(c, Property::Finite, "pairs");
    let eval = |pairs: &[Pair]| c.subject.eval(pairs);
    let scale = typical(eval, c.subject.region(), &mut random)?;
    let mut sweep = Sweep {
        c,
        queries: Vec::with_capacity(BATCH),
        not_finite: Tally::new(),
        negative: Tally::new(),
        below: Tally::new(),
        samples: 0,
        scale,
    };
    for wo in awkward() {
        for wi in awkward_about(wo) {
            sweep.pair(wi, wo);
            sweep.pair(down(wi), wo);
            sweep.pair(wi, down(wo));
            sweep.pair(down(wi), down(wo));
        }
        for u in awkward_numbers() {
            sweep.draw(wo, u);
            sweep.draw(down(wo), u);
        }
        sweep.ask(false)?;
    }
    for k in 0..c.settings.pairs {
        let (wi, wo) = random_pair(&mut random, Region::Above);
        sweep.pair(wi, wo);
        let u = [random.next_f64(), random.next_f64(), random.next_f64()];
        sweep.draw(wo, u);
        match k % 4 {
            0 => sweep.pair(down(wi), wo),
            1 => sweep.pair(wi, down(wo)),
            2 => sweep.draw(down(wo), u),
            _ => sweep.pair(down(wi), down(wo)),
        }
        sweep.ask(false)?;
    }
    sweep.ask(true)?;
    let Sweep {
        not_finite,
        negative,
        below,
        samples,
        scale,
        ..
    } = sweep;

    let verdict = |property, figure, bound, tally: Tally, what: &str| {
        let mut v = Verdict::passing(property, figure, bound, samples);
        v.detail = match tally.count {
            0 => format!("no {what} in {samples} evaluations"),
            n => format!("{n} × {what} in {samples} evaluations"),
        };
        v.witness = tally.witness;
        v.judge(tally.count > 0, true)
    };
    let figure = not_finite.count as f64;
    let finite = verdict(Property::Finite, figure, 0.0, not_finite, "NaN or infinity");
    let (figure, bound) = (negative.worst, c.settings.rounding() * scale);
    let signs = verdict(
        Property::NonNegative,
        figure,
        bound,
        negative,
        "negative value",
    );
    let horizon = if c.subject.only_reflects() {
        let figure = below.worst;
        verdict(
            Property::Horizon,
            figure,
            0.0,
            below,
            "f, pdf or sample below the horizon",
        )
    } else {
        Verdict::not_applicable(Property::Horizon, "the subject also transmits")
    };
    Ok([finite, signs, horizon])
}
