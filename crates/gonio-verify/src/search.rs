//! The search for the worst pair of directions.

use crate::directions::{Region, at_height, azimuth, mirror, moved, random_pair};
use crate::reflection::SubjectFailed;
use crate::subject::{BATCH, Pair};
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;

/// How many of the worst random pairs are refined.
const STARTS: usize = 4;
/// Step halvings of the pattern search: from 0.2 down to 0.2·2⁻²⁰.
const HALVINGS: u32 = 20;

/// The worst pair that was found.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Worst {
    pub figure: f64,
    pub wi: Vec3<f64>,
    pub wo: Vec3<f64>,
    pub evaluations: u64,
}

/// The smallest figure at the pair and at six pairs `nudge` radians beside it.
///
/// A reflection function with edges (a table's cells, a cartoon's bands) differs from itself across an edge when an
/// argument is rounded. Such a difference lives on a set of measure zero and vanishes beside it; a true violation
/// doesn't.
fn robust(figure: &impl Figure, (wi, wo): Pair, nudge: f64) -> Result<f64, SubjectFailed> {
    let mut places = vec![(wi, wo)];
    let here = (wi.z, wo.z);
    for k in 0..3 {
        let around = 0.5 + 2.1 * f64::from(k);
        let (a, b) = (moved(wi, nudge, around), moved(wo, nudge, around + 1.0));
        for (wi, wo) in [(a, wo), (a, b)] {
            if wi.z * here.0 > 0.0 && wo.z * here.1 > 0.0 {
                places.push((wi, wo));
            }
        }
    }
    let figures = figure.at(&places)?;
    // A figure that isn't a number is no evidence either: it is the business of another property.
    let least = figures[1..].iter().fold(figures[0], |a: f64, f| a.min(*f));
    Ok(if least.is_nan() { 0.0 } else { least })
}

/// What is wrong at each of some pairs of directions (wi, wo).
pub(crate) trait Figure {
    fn at(&self, pairs: &[Pair]) -> Result<Vec<f64>, SubjectFailed>;
}

impl<F: Fn(&[Pair]) -> Result<Vec<f64>, SubjectFailed>> Figure for F {
    fn at(&self, pairs: &[Pair]) -> Result<Vec<f64>, SubjectFailed> {
        self(pairs)
    }
}

/// The largest robust `figure` over random pairs of the region, refined by a pattern search in the four coordinates
/// (z, φ) of both directions.
pub(crate) fn worst_pair(
    rng: &mut Rng,
    region: Region,
    pairs: u64,
    nudge: f64,
    figure: impl Figure,
) -> Result<Worst, SubjectFailed> {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let mut evaluations = 0;
    let mut starts: Vec<Scored> = vec![(0.0, (up, up)); STARTS];
    let mut left = pairs;
    while left > 0 {
        let now = left.min(BATCH as u64);
        left -= now;
        let batch: Vec<Pair> = (0..now).map(|_| random_pair(rng, region)).collect();
        evaluations += now;
        for (pair, first) in batch.iter().zip(figure.at(&batch)?) {
            if first > starts[STARTS - 1].0 {
                let f = robust(&figure, *pair, nudge)?;
                evaluations += 7;
                let place = starts.iter().position(|s| f > s.0);
                if let Some(place) = place {
                    starts.insert(place, (f, *pair));
                    starts.truncate(STARTS);
                }
            }
        }
    }
    let mut worst = starts[0];
    for start in starts.into_iter().filter(|s| s.0 > 0.0) {
        let (refined, spent) = refine(&figure, start, nudge)?;
        evaluations += spent;
        if refined.0 > worst.0 {
            worst = refined;
        }
    }
    let (figure, (wi, wo)) = worst;
    Ok(Worst {
        figure,
        wi,
        wo,
        evaluations,
    })
}

type Scored = (f64, Pair);

/// Hooke and Jeeves' exploratory moves: each coordinate one step up or down, keeping what is worse; else half the step.
fn refine(figure: &impl Figure, start: Scored, nudge: f64) -> Result<(Scored, u64), SubjectFailed> {
    let (mut best, (wi, wo)) = start;
    let mut x = [wi.z, azimuth(wi), wo.z, azimuth(wo)];
    let pair = |x: [f64; 4]| (at_height(x[0], x[1]), at_height(x[2], x[3]));
    // The starting point as the search's own coordinates round it.
    let mut kept = (wi, wo);
    let (mut step, mut evaluations) = (0.2, 0);
    for _ in 0..HALVINGS {
        let mut better = false;
        for axis in 0..4 {
            for sign in [-1.0, 1.0] {
                let mut trial = x;
                trial[axis] += sign * step;
                // A height stays on its side of the surface.
                if axis % 2 == 0 && !(trial[axis] * x[axis] > 0.0 && trial[axis].abs() <= 1.0) {
                    continue;
                }
                let place = pair(trial);
                let f = robust(figure, place, nudge)?;
                evaluations += 7;
                if f > best {
                    (best, x, kept, better) = (f, trial, place, true);
                }
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    Ok(((best, kept), evaluations))
}

/// A typical size of the values `f` at random pairs of the region and mirror pairs: their mean over the channels. Only
/// finite values count.
pub(crate) fn typical(
    eval: impl Fn(&[Pair]) -> Result<Vec<[f64; 3]>, SubjectFailed>,
    region: Region,
    rng: &mut Rng,
) -> Result<f64, SubjectFailed> {
    const PAIRS: u32 = 512;
    let pairs: Vec<Pair> = (0..PAIRS)
        .map(|k| {
            let (wi, wo) = random_pair(rng, region);
            (if k % 16 == 0 { mirror(wo) } else { wi }, wo)
        })
        .collect();
    let (mut sum, mut n) = (0.0, 0u32);
    for f in eval(&pairs)? {
        let mean = (f[0].abs() + f[1].abs() + f[2].abs()) / 3.0;
        if mean.is_finite() {
            // A few directions in a sharp lobe must not set the scale of all others.
            sum += mean.min(10.0);
            n += 1;
        }
    }
    Ok(sum / f64::from(n.max(1)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    fn of_one(
        figure: impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
    ) -> impl Fn(&[Pair]) -> Result<Vec<f64>, SubjectFailed> {
        move |pairs| Ok(pairs.iter().map(|(wi, wo)| figure(*wi, *wo)).collect())
    }

    #[test]
    fn the_refined_witness_is_the_summit() {
        // A bump of width 0.05 at z = 0.3, φ = 1 of wi: the summit is 1.
        let bump = |wi: Vec3<f64>, _: Vec3<f64>| {
            let d = ((wi.z - 0.3) / 0.05, (azimuth(wi) - 1.0) / 0.05);
            let e: f64 = Real::exp(-(d.0 * d.0 + d.1 * d.1));
            e
        };
        let bump = of_one(bump);
        let mut rng = Rng::from_name("the_refined_witness_is_the_summit");
        let worst = worst_pair(&mut rng, Region::Above, 2000, 1e-7, bump).unwrap();
        assert!(worst.figure > 0.999, "{worst:?}");
        assert!((worst.wi.z - 0.3).abs() < 2e-3);
    }

    #[test]
    fn a_point_on_an_edge_is_no_violation() {
        // Positive only within 1e-9 of a meridian.
        let edge = |wi: Vec3<f64>, _: Vec3<f64>| f64::from(azimuth(wi) < 1e-9);
        let w = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(edge(w, w), 1.0);
        assert_eq!(robust(&of_one(edge), (w, w), 1e-7), Ok(0.0));
        // A half plane is one.
        let half = |wi: Vec3<f64>, _: Vec3<f64>| f64::from(wi.x > 0.0);
        assert_eq!(robust(&of_one(half), (w, w), 1e-7), Ok(1.0));
    }
}
