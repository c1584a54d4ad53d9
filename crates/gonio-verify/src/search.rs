//! The search for the worst pair of directions.

use crate::directions::{Region, at_height, azimuth, mirror, moved, random_pair};
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
fn robust(
    figure: &impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
    wi: Vec3<f64>,
    wo: Vec3<f64>,
    nudge: f64,
) -> f64 {
    let mut least = figure(wi, wo);
    let here = (wi.z, wo.z);
    for k in 0..3 {
        let around = 0.5 + 2.1 * f64::from(k);
        let (a, b) = (moved(wi, nudge, around), moved(wo, nudge, around + 1.0));
        for (wi, wo) in [(a, wo), (a, b)] {
            if wi.z * here.0 > 0.0 && wo.z * here.1 > 0.0 {
                // A figure that isn't a number is no evidence either: it is the business of another property.
                least = least.min(figure(wi, wo));
            }
        }
    }
    if least.is_nan() { 0.0 } else { least }
}

/// The largest robust `figure` over random pairs of the region, refined by a pattern search in the four coordinates
/// (z, φ) of both directions.
pub(crate) fn worst_pair(
    rng: &mut Rng,
    region: Region,
    pairs: u64,
    nudge: f64,
    figure: impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
) -> Worst {
    let up = Vec3::new(0.0, 0.0, 1.0);
    let mut evaluations = 0;
    let mut starts: Vec<(f64, Vec3<f64>, Vec3<f64>)> = vec![(0.0, up, up); STARTS];
    for _ in 0..pairs {
        let (wi, wo) = random_pair(rng, region);
        evaluations += 1;
        if figure(wi, wo) > starts[STARTS - 1].0 {
            let f = robust(&figure, wi, wo, nudge);
            evaluations += 7;
            let place = starts.iter().position(|s| f > s.0);
            if let Some(place) = place {
                starts.insert(place, (f, wi, wo));
                starts.truncate(STARTS);
            }
        }
    }
    let mut worst = starts[0];
    for start in starts.into_iter().filter(|s| s.0 > 0.0) {
        let (refined, spent) = refine(&figure, start, nudge);
        evaluations += spent;
        if refined.0 > worst.0 {
            worst = refined;
        }
    }
    let (figure, wi, wo) = worst;
    Worst {
        figure,
        wi,
        wo,
        evaluations,
    }
}

type Scored = (f64, Vec3<f64>, Vec3<f64>);

/// Hooke and Jeeves' exploratory moves: each coordinate one step up or down, keeping what is worse; else half the step.
fn refine(
    figure: &impl Fn(Vec3<f64>, Vec3<f64>) -> f64,
    start: Scored,
    nudge: f64,
) -> (Scored, u64) {
    let (mut best, wi, wo) = start;
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
                let (wi, wo) = pair(trial);
                let f = robust(figure, wi, wo, nudge);
                evaluations += 7;
                if f > best {
                    (best, x, kept, better) = (f, trial, (wi, wo), true);
                }
            }
        }
        if !better {
            step *= 0.5;
        }
    }
    ((best, kept.0, kept.1), evaluations)
}

/// A typical size of f: its mean over random pairs of the region and mirror pairs, over the channels. Only finite values
/// count.
pub(crate) fn typical(eval: &crate::subject::EvalFn, region: Region, rng: &mut Rng) -> f64 {
    const PAIRS: u32 = 512;
    let (mut sum, mut n) = (0.0, 0u32);
    for k in 0..PAIRS {
        let (mut wi, wo) = random_pair(rng, region);
        if k % 16 == 0 {
            wi = mirror(wo);
        }
        let f = eval(wi, wo);
        let mean = (f[0].abs() + f[1].abs() + f[2].abs()) / 3.0;
        if mean.is_finite() {
            // A few directions in a sharp lobe must not set the scale of all others.
            sum += mean.min(10.0);
            n += 1;
        }
    }
    sum / f64::from(n.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    #[test]
    fn the_refined_witness_is_the_summit() {
        // A bump of width 0.05 at z = 0.3, φ = 1 of wi: the summit is 1.
        let bump = |wi: Vec3<f64>, _: Vec3<f64>| {
            let d = ((wi.z - 0.3) / 0.05, (azimuth(wi) - 1.0) / 0.05);
            let e: f64 = Real::exp(-(d.0 * d.0 + d.1 * d.1));
            e
        };
        let mut rng = Rng::from_name("the_refined_witness_is_the_summit");
        let worst = worst_pair(&mut rng, Region::Above, 2000, 1e-7, bump);
        assert!(worst.figure > 0.999, "{worst:?}");
        assert!((worst.wi.z - 0.3).abs() < 2e-3);
    }

    #[test]
    fn a_point_on_an_edge_is_no_violation() {
        // Positive only within 1e-9 of a meridian.
        let edge = |wi: Vec3<f64>, _: Vec3<f64>| f64::from(azimuth(wi) < 1e-9);
        let w = Vec3::new(0.6, 0.0, 0.8);
        assert_eq!(edge(w, w), 1.0);
        assert_eq!(robust(&edge, w, w, 1e-7), 0.0);
        // A half plane is one.
        let half = |wi: Vec3<f64>, _: Vec3<f64>| f64::from(wi.x > 0.0);
        assert_eq!(robust(&half, w, w, 1e-7), 1.0);
    }
}
