//! The same function in single precision.

use super::{relative_difference, rng, with_colour};
use crate::check::Checker;
use crate::directions::{awkward, awkward_about, awkward_numbers, moved};
use crate::reflection::SubjectFailed;
use crate::search::{typical, worst_pair};
use crate::subject::{Draw, Pair, Subject};
use crate::verdict::{Property, Verdict, Witness};
use gonio_num::Vec3;

/// How far a difference must reach, in radians: a few steps of `f32`, which resolves directions to 6e-8.
const NUDGE: f64 = 1e-6;

/// How far a direction is moved to see how much the function itself turns a rounding into: four steps of `f32` near 1, as many as
/// a half vector takes roundings.
const ROUNDINGS: f64 = 4.0 * (f32::EPSILON as f64 / 2.0);

/// The worst relative difference of f, and of the density, between the subject and itself in single precision, at directions that
/// `f32` holds exactly; infinite where a number in single precision isn't finite but that in double is, also at the corpus of
/// awkward directions and numbers.
///
/// No chance is involved in a failure. Where a function is steep any way of computing it makes much of a rounding: a lobe of slope α
/// changes by 10/α times a rounding in its tail, or 6e-3 at α = 1e-4. So of a difference that counts, what the function in double precision
/// changes by between directions [`ROUNDINGS`] apart is subtracted. Digits that are lost otherwise, as in 1 − cos²θ near the normal,
/// stay.
pub(super) fn check(c: &Checker) -> Result<Verdict, SubjectFailed> {
    let property = Property::SinglePrecision;
    let Some(single) = c.subject.single() else {
        let why = "the subject is given in one precision only";
        return Ok(Verdict::not_applicable(property, why));
    };
    let region = c.subject.region();
    let eval = |pairs: &[Pair]| c.subject.eval(pairs);
    let scale = typical(eval, region, &mut rng(c, property, "typical"))?;
    let both = Both {
        double: c.subject,
        single: &single,
        scale,
        bound: c.settings.single_bound,
    };
    let worst = worst_pair(
        &mut rng(c, property, "pairs"),
        region,
        c.settings.pairs / 2 + 1,
        NUDGE,
        |pairs: &[Pair]| both.differences(pairs),
    )?;
    let mut v = Verdict::passing(property, worst.figure, both.bound, 4 * worst.evaluations);
    let pair = rounded((worst.wi, worst.wo));
    v.detail = format!(
        "worst relative difference of f32 and f64: {:.3e}",
        worst.figure
    );
    v.witness = Some(both.witness(pair)?);
    if let Some((witness, count)) = both.broken(&mut v.samples)? {
        v.figure = f64::INFINITY;
        v.witness = Some(witness);
        v.detail = format!("{count} × NaN or infinity in f32 where f64 has a number");
    }
    let violated = v.figure > both.bound;
    Ok(v.judge(violated, true))
}

struct Both<'s, 'a> {
    double: &'s Subject<'a>,
    single: &'s Subject<'a>,
    scale: f64,
    bound: f64,
}

/// As `f32` holds it.
fn rounded((wi, wo): Pair) -> Pair {
    (wi.to_f32().to_f64(), wo.to_f32().to_f64())
}

/// A typical density: that of a uniform hemisphere.
const DENSITY: f64 = 0.5 / std::f64::consts::PI;

impl Both<'_, '_> {
    fn densities(&self, pairs: &[Pair]) -> Result<[Vec<f64>; 2], SubjectFailed> {
        if self.double.has_pdf() && self.single.has_pdf() {
            Ok([self.double.pdf(pairs)?, self.single.pdf(pairs)?])
        } else {
            Ok([vec![0.0; pairs.len()], vec![0.0; pairs.len()]])
        }
    }

    fn differences(&self, pairs: &[Pair]) -> Result<Vec<f64>, SubjectFailed> {
        let pairs: Vec<Pair> = pairs.iter().copied().map(rounded).collect();
        let (a, b) = (self.double.eval(&pairs)?, self.single.eval(&pairs)?);
        let [p, q] = self.densities(&pairs)?;
        let of_one = |i: usize| {
            let finite = |f: [f64; 3], p: f64| p.is_finite() && f.iter().all(|x| x.is_finite());
            match (finite(a[i], p[i]), finite(b[i], q[i])) {
                (true, true) => self.difference((a[i], p[i]), (b[i], q[i])),
                (true, false) => f64::INFINITY,
                // Another property's business.
                (false, _) => 0.0,
            }
        };
        let mut differences: Vec<f64> = (0..pairs.len()).map(of_one).collect();
        for (i, difference) in differences.iter_mut().enumerate() {
            if difference.is_finite() && *difference > self.bound {
                *difference = (*difference - self.steepness(pairs[i])?).max(0.0);
            }
        }
        Ok(differences)
    }

    /// The larger of the relative differences of two values of f and of the density.
    fn difference(&self, (a, p): ([f64; 3], f64), (b, q): ([f64; 3], f64)) -> f64 {
        relative_difference(a, b, self.scale).max(relative_difference([p; 3], [q; 3], DENSITY))
    }

    /// How much the function in double precision changes by between directions [`ROUNDINGS`] apart.
    fn steepness(&self, (wi, wo): Pair) -> Result<f64, SubjectFailed> {
        let mut places = vec![(wi, wo)];
        for quarter in 0..4 {
            let around = std::f64::consts::FRAC_PI_2 * f64::from(quarter);
            places.push((moved(wi, ROUNDINGS, around), wo));
            places.push((wi, moved(wo, ROUNDINGS, around)));
        }
        // Beyond the horizon is another function.
        places.retain(|p| p.0.z * wi.z > 0.0 && p.1.z * wo.z > 0.0);
        if places.is_empty() {
            return Ok(0.0);
        }
        let f = self.double.eval(&places)?;
        let p = match self.double.has_pdf() {
            true => self.double.pdf(&places)?,
            false => vec![0.0; places.len()],
        };
        let here = (f[0], p[0]);
        let changes = (1..places.len()).map(|k| self.difference(here, (f[k], p[k])));
        // What is no number excuses nothing.
        Ok(changes.filter(|x| x.is_finite()).fold(0.0, f64::max))
    }

    fn witness(&self, (wi, wo): Pair) -> Result<Witness, SubjectFailed> {
        let pair = [(wi, wo)];
        let [p, q] = self.densities(&pair)?;
        let witness = with_colour(
            Witness::pair(wi, wo),
            "f in f64",
            self.double.eval(&pair)?[0],
        );
        let witness = with_colour(witness, "f in f32", self.single.eval(&pair)?[0]);
        Ok(witness.value("pdf in f64", p[0]).value("pdf in f32", q[0]))
    }

    /// The first of the awkward places at which only single precision has no number, and how many there are.
    fn broken(&self, samples: &mut u64) -> Result<Option<(Witness, u64)>, SubjectFailed> {
        let mut pairs: Vec<Pair> = Vec::new();
        let mut draws: Vec<Draw> = Vec::new();
        for wo in awkward() {
            pairs.extend(awkward_about(wo).into_iter().map(|wi| rounded((wi, wo))));
            let here: Vec3<f64> = wo.to_f32().to_f64();
            draws.extend(awkward_numbers().into_iter().map(|u| (here, u)));
        }
        *samples += 4 * pairs.len() as u64;
        let mut found: Option<(Witness, u64)> = None;
        let mut met = |witness: Witness| match &mut found {
            Some((_, count)) => *count += 1,
            None => found = Some((witness, 1)),
        };
        for (pair, difference) in pairs.iter().zip(self.differences(&pairs)?) {
            if difference == f64::INFINITY {
                met(self.witness(*pair)?);
            }
        }
        if self.double.has_sample() && self.single.has_sample() {
            *samples += 2 * draws.len() as u64;
            let (a, b) = (self.double.draw(&draws)?, self.single.draw(&draws)?);
            for ((wo, u), (a, b)) in draws.iter().zip(a.iter().zip(&b)) {
                let numbers = |s: &crate::SubjectSample| {
                    let [x, y, z] = s.wi.to_array();
                    let [r, g, b] = s.weight;
                    [x, y, z, r, g, b, s.pdf].iter().all(|x| x.is_finite())
                };
                if a.as_ref().is_none_or(numbers) && !b.as_ref().is_none_or(numbers) {
                    let witness = Witness::at(*wo).drawn(*u);
                    met(match b {
                        Some(s) => with_colour(witness, "weight in f32", s.weight)
                            .value("pdf in f32", s.pdf),
                        None => witness,
                    });
                }
            }
        }
        Ok(found)
    }
}
