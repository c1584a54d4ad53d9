//! What can be seen number by number: finite, non-negative, and 0 below the horizon.

use super::rng;
use crate::check::Checker;
use crate::directions::{
    Region, awkward, awkward_about, awkward_numbers, flipped as down, random_pair,
};
use crate::search::typical;
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

struct Sweep<'c, 'a> {
    c: &'c Checker<'a>,
    not_finite: Tally,
    negative: Tally,
    below: Tally,
    samples: u64,
    /// Typical size of f, for judging whether a negative value is only rounding.
    scale: f64,
}

impl Sweep<'_, '_> {
    fn number(&mut self, x: f64, unit: f64, witness: impl Fn() -> Witness) {
        if !x.is_finite() {
            self.not_finite.add(1.0, witness);
        } else if x < -self.c.settings.rounding() * unit {
            self.negative.add(-x, witness);
        }
    }

    fn pair(&mut self, wi: Vec3<f64>, wo: Vec3<f64>) {
        self.samples += 1;
        let below = self.c.subject.only_reflects() && (wi.z < 0.0 || wo.z < 0.0);
        let f = (self.c.subject.eval)(wi, wo);
        for x in f {
            self.number(x, self.scale, || Witness::pair(wi, wo).value("f", x));
            if below && x.is_finite() && x != 0.0 {
                self.below
                    .add(x.abs(), || Witness::pair(wi, wo).value("f", x));
            }
        }
        if let Some(pdf) = self.c.subject.pdf {
            let p = pdf(wi, wo);
            self.number(p, 1.0, || Witness::pair(wi, wo).value("pdf", p));
            if below && p.is_finite() && p != 0.0 {
                self.below
                    .add(p.abs(), || Witness::pair(wi, wo).value("pdf", p));
            }
        }
    }

    fn draw(&mut self, wo: Vec3<f64>, u: [f64; 3]) {
        self.samples += 1;
        let Some(s) = self.c.subject.draw(wo, u) else {
            return;
        };
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
pub(super) fn check(c: &Checker) -> [Verdict; 3] {
    let mut random = rng(c, Property::Finite, "pairs");
    let scale = typical(c.subject.eval, c.subject.region(), &mut random);
    let mut sweep = Sweep {
        c,
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
    }
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
    [finite, signs, horizon]
}
