//! Many checks over a space of parameters, judged together: a fault may stand between the ends of a parameter, or at one choice of
//! several.

use crate::report::Report;
use crate::settings::Effort;
use crate::table::Table;
use crate::verdict::{Outcome, Property, Verdict};
use serde::Serialize;

/// A parameter that is swept.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Axis {
    /// Its name.
    pub name: String,
    /// What it may be.
    pub range: Range,
    /// Whether it has no effect unless set: at most one of these is set at a time, since they tend to exclude each other.
    pub optional: bool,
}

/// The values of an [`Axis`].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Range {
    /// Numbers from `low` to `high`, as many at once as there are `components` (3 for a colour).
    Numbers {
        /// The smallest.
        low: f64,
        /// The largest.
        high: f64,
        /// How many at once, 1 or more.
        components: usize,
    },
    /// One of some words.
    Words(Vec<String>),
}

/// The value of one axis at a point.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Setting {
    /// As many numbers as the axis has components.
    Numbers(Vec<f64>),
    /// A word.
    Word(String),
}

/// A value for each axis; `None` where it is left at its default.
pub type Point = Vec<Option<Setting>>;

/// Where in the unit interval each dimension of point `k` is: multiples of the square roots of the primes, modulo 1. Each of these
/// numbers is badly approximated by fractions, so every dimension by itself is filled evenly, and together they have no
/// common period.
///
/// Source: Richtmyer 1951, "The evaluation of definite integrals, and a quasi-Monte-Carlo method based on the properties of
/// algebraic numbers".
fn even(dimensions: usize, k: usize) -> Vec<f64> {
    let prime = |n: &u32| {
        (2..*n)
            .take_while(|d| d * d <= *n)
            .all(|d| !n.is_multiple_of(d))
    };
    let primes = (2u32..).filter(prime).take(dimensions);
    primes
        .map(|p| (0.5 + f64::from(p).sqrt() * (k + 1) as f64).fract())
        .collect()
}

impl Axis {
    fn dimensions(&self) -> usize {
        match self.range {
            Range::Numbers { components, .. } => components.max(1),
            Range::Words(_) => 1,
        }
    }

    /// The value at the place `u` of the unit interval in each of its dimensions.
    fn at(&self, u: &[f64]) -> Setting {
        match &self.range {
            Range::Numbers { low, high, .. } => {
                Setting::Numbers(u.iter().map(|u| within(*low, *high, *u)).collect())
            }
            Range::Words(words) => {
                let k = (u[0] * words.len() as f64) as usize;
                Setting::Word(words[k.min(words.len() - 1)].clone())
            }
        }
    }

    /// Its first or last value.
    fn end(&self, last: bool) -> Setting {
        self.at(&vec![f64::from(last); self.dimensions()])
    }
}

/// The number at `u` between the ends, in four digits, so that what is printed is what was checked. Over more than three orders of
/// magnitude equal steps of `u` are equal ratios: an exponent up to 10⁵ is not always above 10⁴.
fn within(low: f64, high: f64, u: f64) -> f64 {
    if u <= 0.0 || u >= 1.0 {
        return if u <= 0.0 { low } else { high };
    }
    let range = high - low;
    let x = if range > 1000.0 * low.abs().max(1.0) {
        low + gonio_num::Real::powf(1.0 + range, u) - 1.0
    } else {
        low + range * u
    };
    format!("{x:.3e}")
        .parse::<f64>()
        .unwrap_or(x)
        .clamp(low, high)
}

/// At most `count` points of the space: the defaults; each axis at each of its ends or words with the others at their defaults; the
/// corners of a space of up to four axes; and for the rest, at least half, a sequence that fills the interior and the choices
/// evenly.
pub fn points(axes: &[Axis], count: usize) -> Vec<Point> {
    let nothing: Point = vec![None; axes.len()];
    let mut ends = vec![nothing.clone()];
    for (i, axis) in axes.iter().enumerate() {
        let settings: Vec<Setting> = match &axis.range {
            Range::Numbers { .. } => vec![axis.end(false), axis.end(true)],
            Range::Words(words) => words.iter().cloned().map(Setting::Word).collect(),
        };
        for setting in settings {
            let mut point = nothing.clone();
            point[i] = Some(setting);
            ends.push(point);
        }
    }
    let plain: Vec<usize> = (0..axes.len()).filter(|i| !axes[*i].optional).collect();
    if (2..=4).contains(&plain.len()) {
        for corner in 0..1usize << plain.len() {
            let mut point = nothing.clone();
            for (bit, i) in plain.iter().enumerate() {
                point[*i] = Some(axes[*i].end(corner >> bit & 1 == 1));
            }
            ends.push(point);
        }
    }
    ends.truncate((count / 2).max(1));
    let optional: Vec<usize> = (0..axes.len()).filter(|i| axes[*i].optional).collect();
    // One dimension more chooses which of the optional ones is set; half of the time none is.
    let dimensions = axes.iter().map(Axis::dimensions).sum::<usize>() + 1;
    let inside = (0..count.saturating_sub(ends.len())).map(|k| {
        let u = even(dimensions, k);
        let chosen = (2.0 * u[dimensions - 1] * optional.len() as f64) as usize;
        let chosen = optional.get(chosen).copied();
        let mut at = 0;
        axes.iter()
            .enumerate()
            .map(|(i, axis)| {
                let own = &u[at..at + axis.dimensions()];
                at += axis.dimensions();
                (!axis.optional || chosen == Some(i)).then(|| axis.at(own))
            })
            .collect()
    });
    let inside: Vec<Point> = inside.collect();
    ends.extend(inside);
    ends
}

/// The worst verdict on a property over all points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Worst {
    /// The point, as a description that can be checked by itself.
    pub at: String,
    /// At how many points the property applied.
    pub points: usize,
    /// At how many of them it failed.
    pub failed: usize,
    /// The verdict there.
    pub verdict: Verdict,
}

/// What a sweep found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepReport {
    /// What was swept.
    pub subject: String,
    /// The parameters that were swept.
    pub axes: Vec<Axis>,
    /// How many points were checked.
    pub points: usize,
    /// How many combinations of values aren't allowed together, and were left out.
    pub skipped: usize,
    /// The points at which a property failed.
    pub failed: Vec<String>,
    /// The worst of each property, in the order of [`Property::ALL`].
    pub worst: Vec<Worst>,
}

impl SweepReport {
    /// Of no points yet.
    pub fn new(subject: impl Into<String>, axes: Vec<Axis>) -> Self {
        Self {
            subject: subject.into(),
            axes,
            points: 0,
            skipped: 0,
            failed: Vec::new(),
            worst: Vec::new(),
        }
    }

    /// Counts the report on the point `at`.
    pub fn add(&mut self, at: &str, report: &Report) {
        self.points += 1;
        if !report.passed() {
            self.failed.push(at.to_owned());
        }
        for v in &report.verdicts {
            let place = self
                .worst
                .iter()
                .position(|w| w.verdict.property == v.property);
            let new = Worst {
                at: at.to_owned(),
                points: 0,
                failed: 0,
                verdict: v.clone(),
            };
            let place = place.unwrap_or_else(|| {
                self.worst.push(new.clone());
                self.worst.len() - 1
            });
            let worst = &mut self.worst[place];
            if badness(v) > badness(&worst.verdict) {
                (worst.at, worst.verdict) = (new.at, new.verdict);
            }
            worst.points += usize::from(v.outcome != Outcome::NotApplicable);
            worst.failed += usize::from(v.outcome == Outcome::Fail);
        }
        self.worst.sort_by_key(|w| w.verdict.property);
    }

    /// Whether nothing failed anywhere.
    pub fn passed(&self) -> bool {
        self.failed.is_empty()
    }

    /// The worst of `property`.
    pub fn worst(&self, property: Property) -> Option<&Worst> {
        self.worst.iter().find(|w| w.verdict.property == property)
    }

    /// The worst verdicts as one report, each with the point in its detail.
    pub fn report(&self, effort: Effort) -> Report {
        let verdict = |w: &Worst| {
            let mut v = w.verdict.clone();
            if v.outcome != Outcome::NotApplicable {
                let fails = match w.failed {
                    0 => String::new(),
                    n => format!("fails at {n}; "),
                };
                v.detail += &format!(
                    "; of {} points, {fails}this one is the worst: {}",
                    w.points, w.at
                );
            }
            v
        };
        Report {
            subject: self.subject.clone(),
            effort,
            seed_name: self.subject.clone(),
            verdicts: self.worst.iter().map(verdict).collect(),
        }
    }

    /// A table as [`Report::table`], with the point under each property.
    pub fn table(&self, colour: bool) -> String {
        Table::of_sweep(self, colour)
    }
}

/// How bad a verdict is: first by its outcome, then by its figure, which for a p-value is worse when it is small.
fn badness(v: &Verdict) -> (u8, f64) {
    let rank = match v.outcome {
        Outcome::Fail => 3,
        Outcome::Declared | Outcome::Allowed => 2,
        Outcome::Pass | Outcome::Information => 1,
        Outcome::NotApplicable => 0,
    };
    let figure = v.p_value.map_or(v.figure, |p| -p);
    (rank, if figure.is_nan() { f64::MIN } else { figure })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Expectation, Settings, Subject};
    use gonio_num::Vec3;

    fn number(name: &str, low: f64, high: f64) -> Axis {
        Axis {
            name: name.into(),
            range: Range::Numbers {
                low,
                high,
                components: 1,
            },
            optional: false,
        }
    }

    #[test]
    fn points_are_at_the_ends_and_fill_the_inside() {
        let axes = [
            number("x", -1.0, 1.0),
            Axis {
                name: "form".into(),
                range: Range::Words(vec!["a".into(), "b".into(), "c".into()]),
                optional: false,
            },
            number("n", 0.0, 1e5),
        ];
        let all = points(&axes, 200);
        assert_eq!(all.len(), 200);
        assert_eq!(all[0], [None, None, None]);
        let x = |k: usize| match &all[k][0] {
            Some(Setting::Numbers(x)) => Some(x[0]),
            _ => None,
        };
        let ends: Vec<f64> = (0..all.len()).filter_map(x).collect();
        assert!(ends.contains(&-1.0) && ends.contains(&1.0));
        // Evenly: each tenth of the range has about a tenth of the points inside.
        for tenth in 0..10 {
            let low = 0.2 * f64::from(tenth) - 1.0;
            let inside = ends.iter().filter(|x| (low..low + 0.2).contains(*x));
            assert!((14..=30).contains(&inside.count()), "{tenth}");
        }
        for word in ["a", "b", "c"] {
            let word = Some(Setting::Word(word.into()));
            assert!(all.iter().filter(|p| p[1] == word).count() > 50);
        }
        // Half of a range of five decades is below 317.
        let small = all
            .iter()
            .filter(|p| matches!(&p[2], Some(Setting::Numbers(n)) if n[0] < 317.0));
        assert!(small.count() > 80);
        assert_eq!(points(&axes, 1).len(), 1);
        assert_eq!(points(&[], 4).len(), 4);
    }

    #[test]
    fn at_most_one_of_the_optional_is_set() {
        let mut axes = [
            number("a", 0.0, 1.0),
            number("b", 0.0, 1.0),
            number("c", 0.0, 1.0),
        ];
        axes[1].optional = true;
        axes[2].optional = true;
        let all = points(&axes, 400);
        let set = |p: &Point| [p[1].is_some(), p[2].is_some()];
        assert!(all.iter().all(|p| set(p) != [true, true]));
        for which in [[true, false], [false, true], [false, false]] {
            assert!(
                all.iter().filter(|p| set(p) == which).count() > 60,
                "{which:?}"
            );
        }
    }

    /// A fault between metal and dielectric, absent at both ends: F0 is mixed in a term that isn't linear.
    #[test]
    fn a_fault_between_the_ends_is_found() {
        let axes = vec![number("metalness", 0.0, 1.0)];
        let sweep = |gain: f64| {
            let mut found = SweepReport::new("half metal", axes.clone());
            for point in points(&axes, 16) {
                let m = match &point[0] {
                    Some(Setting::Numbers(m)) => m[0],
                    _ => 0.0,
                };
                let albedo = 1.0 + gain * m * (1.0 - m);
                let eval = |wi: Vec3<f64>, wo: Vec3<f64>| match wi.z > 0.0 && wo.z > 0.0 {
                    true => [albedo / std::f64::consts::PI; 3],
                    false => [0.0; 3],
                };
                let subject = Subject::new("half metal", &eval);
                let report = crate::Checker::new(&subject, &Expectation::PHYSICAL, Effort::Quick)
                    .settings(Settings::glance(16))
                    .run(format!("metalness {m}"))
                    .unwrap();
                found.add(&format!("metalness={m}"), &report);
            }
            found
        };
        let found = sweep(0.1);
        assert!(!found.passed());
        // The ends and the default pass.
        assert!(found.failed.len() < found.points, "{:?}", found.failed);
        assert!(!found.failed.contains(&"metalness=0".to_owned()));
        let energy = found.worst(Property::EnergyConservation).unwrap();
        assert!(energy.at.starts_with("metalness=0.4") || energy.at.starts_with("metalness=0.5"));
        assert!((energy.verdict.figure - 1.025).abs() < 1e-3, "{energy:?}");
        assert!(!found.report(Effort::Quick).passed());
        let text = found.table(false);
        assert!(text.contains("metalness=0."), "{text}");
        assert!(text.lines().all(|l| l.chars().count() <= 80), "{text}");
        assert!(sweep(0.0).passed());
    }
}
