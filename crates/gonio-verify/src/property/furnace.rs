//! The white furnace: how much of uniform light a surface sends to a viewer, by quadrature and by its own sampling.

use super::{draws as draws_of, rng};
use crate::check::Checker;
use crate::cubature::integrate;
use crate::directions::{Region, at_height, flipped, mirror, refracted, spherical};
use crate::partition::{Partition, Pilot, Rules, coordinates};
use crate::reflection::SubjectFailed;
use crate::statistics::{Moments, bernstein_deviation};
use crate::subject::Pair;
use crate::verdict::Property;
use gonio_num::{Real, Vec3};
use rayon::prelude::*;

/// How much harder a suspicion is looked at before it becomes a verdict.
pub(super) const SECOND_LOOK: u64 = 8;

/// What uniform light of radiance 1 becomes towards `wo`: a(ωo) = ∫ f(ωi, ωo) |cosθi| dωi, the directional albedo (by
/// reciprocity the reflected fraction of a beam from ωo). Where light also passes through, it is uniform in units of the
/// squared index of refraction: a(ωo) = ∫ f(ωi, ωo) n(ωi)²/n(ωo)² |cosθi| dωi over the sphere.
pub(super) struct Furnace {
    pub wo: Vec3<f64>,
    /// The albedo of all but Dirac deltas by quadrature, each channel, with its error.
    pub quadrature: [f64; 3],
    pub error: [f64; 3],
    /// The part of the brightest channel at directions of density 0, with its error.
    pub unreachable: f64,
    pub unreachable_error: f64,
    /// Where the most of it was seen.
    pub unreachable_at: Option<Vec3<f64>>,
    /// ∫ (f cosθ n²/n²)² / pdf: the second moment of the weight, each channel.
    pub second_moment: [f64; 3],
    /// The largest f cosθ / pdf that the quadrature met.
    pub largest_weight: f64,
    /// Weights of draws that aren't deltas (0 for all others), and of those that are.
    pub continuous: [Moments; 3],
    pub delta: [Moments; 3],
    pub draws: u64,
    pub delta_draws: u64,
    pub evaluations: u64,
    /// Directions at which f wasn't finite; they count as 0.
    pub not_finite: u64,
}

/// Outgoing directions from the normal to grazing, denser towards grazing where energy goes wrong, spiralling in azimuth by
/// the golden angle so that an anisotropic function is seen from all sides.
pub(super) fn outgoing(count: u32, steepest_deg: f64) -> Vec<Vec3<f64>> {
    (0..count.max(1))
        .map(|k| {
            let t = f64::from(k) / f64::from(count.max(2) - 1);
            let theta = steepest_deg * t * (1.4 - 0.4 * t);
            spherical(theta.to_radians(), 0.3 + 2.399_963 * f64::from(k))
        })
        .collect()
}

/// [`outgoing`], and for a subject that transmits the same number below the horizon, with other azimuths.
pub(super) fn viewers(c: &Checker, count: u32, steepest_deg: f64) -> Vec<Vec3<f64>> {
    let mut all = outgoing(count, steepest_deg);
    if !c.subject.only_reflects() {
        let below = all
            .iter()
            .map(|w| flipped(crate::directions::turned(*w, 1.0)));
        all.extend(below.collect::<Vec<_>>());
    }
    all
}

/// Where a lobe towards `wo` may stand.
pub(super) fn lobes(c: &Checker, wo: Vec3<f64>) -> Vec<Vec3<f64>> {
    let mut all = vec![mirror(wo), wo];
    if let Region::Sphere { relative_ior } = c.subject.region() {
        all.extend([refracted(wo, relative_ior), -wo]);
    }
    all
}

/// Twice the usual number of directions, up to 89.5°.
pub(super) fn directions(c: &Checker) -> Vec<Vec3<f64>> {
    viewers(c, 2 * c.settings.directions, 89.5)
}

/// How often the angle of the brightest furnace is looked for between its neighbours.
const REFINEMENTS: usize = 2;

/// How often [`Checker::step`] is called by [`measure`].
pub(super) fn steps(c: &Checker) -> usize {
    directions(c).len() + REFINEMENTS
}

/// A furnace for each of the [`directions`], and for some beside the brightest of them: an albedo may exceed 1 between two.
pub(super) fn measure(c: &Checker) -> Result<Vec<Furnace>, SubjectFailed> {
    let mut all = towards(c, directions(c), 0)?;
    for _ in 0..REFINEMENTS {
        let more = towards(c, beside_the_brightest(&all), all.len())?;
        all.extend(more);
        c.step();
    }
    Ok(all)
}

/// A furnace for each of `wo`, of which the first is number `first` of all.
fn towards(c: &Checker, wo: Vec<Vec3<f64>>, first: usize) -> Result<Vec<Furnace>, SubjectFailed> {
    wo.into_par_iter()
        .enumerate()
        .map(|(k, wo)| {
            let mut furnace = at(c, wo, first + k, 1)?;
            if suspicious(c, &furnace) {
                let before = furnace.evaluations;
                furnace = at(c, wo, first + k, SECOND_LOOK)?;
                furnace.evaluations += before;
            }
            if first == 0 {
                c.step();
            }
            Ok(furnace)
        })
        .collect()
}

/// Directions in the azimuth of the brightest furnace, half-way to the next steeper and the next shallower one on its side.
fn beside_the_brightest(all: &[Furnace]) -> Vec<Vec3<f64>> {
    let albedo = |f: &Furnace| {
        (0..3)
            .map(|k| f.quadrature[k] + f.delta[k].mean())
            .fold(0.0, f64::max)
    };
    let brightest = all
        .iter()
        .max_by(|a, b| albedo(a).total_cmp(&albedo(b)))
        .expect("invariant: there is at least one direction");
    let wo = brightest.wo;
    let angle = |w: Vec3<f64>| Real::acos(w.z.abs().min(1.0));
    let here = angle(wo);
    let others = || {
        let same_side = all.iter().filter(|f| f.wo.z * wo.z > 0.0);
        same_side.map(|f| angle(f.wo))
    };
    let shallower = others().filter(|t| *t < here).max_by(f64::total_cmp);
    let steeper = others().filter(|t| *t > here).min_by(f64::total_cmp);
    let azimuth = crate::directions::azimuth(wo);
    shallower
        .into_iter()
        .chain(steeper)
        .map(|theta| {
            let w = spherical(0.5 * (theta + here), azimuth);
            if wo.z < 0.0 { flipped(w) } else { w }
        })
        .collect()
}

/// Whether a furnace is near to failing anything by what the quadrature says, or its error is large.
fn suspicious(c: &Checker, f: &Furnace) -> bool {
    let tail = c.settings.false_positive_rate.max(1e-3);
    let settings = &c.settings;
    (0..3).any(|k| {
        let total = f.quadrature[k] + f.delta[k].mean();
        total > 1.0 + 0.5 * settings.energy_bound
            || f.error[k] > 0.005
            || (c.subject.has_pdf()
                && f.draws > 0
                && f.bias(k, tail).excess > 0.25 * settings.integral_bound)
    }) || f.unreachable > 0.5 * settings.integral_bound
}

/// The difference of a mean weight from the quadrature's albedo.
pub(super) struct Bias {
    pub mean: f64,
    pub expected: f64,
    /// What chance explains, but for the probability asked for.
    pub chance: f64,
    pub quadrature_error: f64,
    /// What neither explains.
    pub excess: f64,
}

impl Furnace {
    /// The bias of channel `k`; chance exceeds its part with probability `tail`.
    pub(super) fn bias(&self, k: usize, tail: f64) -> Bias {
        let expected = self.quadrature[k] - self.unreachable;
        let mean = self.continuous[k].mean();
        let variance = (self.second_moment[k] - expected * expected)
            .max(0.0)
            .max(self.continuous[k].variance());
        // The quadrature's nodes may have missed the summit of the weight.
        let range = 1.5 * self.largest_weight;
        let chance = bernstein_deviation(variance, range, self.draws, tail);
        let quadrature_error = self.error[k] + self.unreachable_error;
        Bias {
            mean,
            expected,
            chance,
            quadrature_error,
            excess: (mean - expected).abs() - chance - quadrature_error,
        }
    }
}

/// Draws, and the quadrature over cells that follow them; `harder` multiplies cells and quadrature.
fn at(c: &Checker, wo: Vec3<f64>, index: usize, harder: u64) -> Result<Furnace, SubjectFailed> {
    let mut random = rng(c, Property::EnergyConservation, &index.to_string());
    let draws = if c.subject.has_sample() {
        c.settings.density_samples / 4
    } else {
        0
    };
    let (mut continuous, mut delta) = ([Moments::new(); 3], [Moments::new(); 3]);
    let mut delta_draws = 0;
    let pilot = c.settings.cells as usize * 16 * harder as usize;
    let mut points = Vec::with_capacity(pilot.min(draws as usize));
    let mut largest_weight: f64 = 0.0;
    for batch in draws_of(&mut random, wo, draws) {
        for s in c.subject.draw(&batch)? {
            let is_delta = s.is_some_and(|s| s.delta);
            delta_draws += u64::from(is_delta);
            let weight = s.map_or([0.0; 3], |s| c.subject.basic(s.weight, s.wi, wo));
            for k in 0..3 {
                // What isn't finite is another property's business and must not blind this one.
                let w = if weight[k].is_finite() {
                    weight[k]
                } else {
                    0.0
                };
                continuous[k].push(if is_delta { 0.0 } else { w });
                delta[k].push(if is_delta { w } else { 0.0 });
                if !is_delta {
                    largest_weight = largest_weight.max(w);
                }
            }
            if let Some(s) = s.filter(|s| !s.delta && s.wi.is_finite())
                && points.len() < pilot
            {
                let brightest = weight.iter().fold(1.0, |a: f64, w| a.max(*w));
                points.push(Pilot {
                    at: coordinates(s.wi),
                    density: s.pdf * brightest,
                });
            }
        }
    }

    let cells = (u64::from(c.settings.cells) * harder) as f64;
    let rules = Rules {
        max_points: (points.len() as f64 / cells).max(8.0) as usize,
        max_mass: 4.0 / cells,
        max_solid_angle: 0.1 / harder as f64,
        // Without samples, or with samples of something else, nothing but this shows where a sharp lobe stands.
        seed_width: 1e-3,
    };
    let mut seeds = lobes(c, wo);
    seeds.push(Vec3::new(0.0, 0.0, 1.0));
    let partition = Partition::new(points, &seeds, &rules, !c.subject.only_reflects());
    let mut unreachable_at = None;
    let mut most = 0.0;
    let mut not_finite = 0;
    let integral = integrate(
        |at: &[[f64; 2]]| {
            let pairs: Vec<Pair> = at
                .iter()
                .map(|[z, phi]| (at_height(*z, *phi), wo))
                .collect();
            let f = c.subject.eval(&pairs)?;
            let densities = c.subject.pdf(&pairs)?;
            let values = (0..pairs.len()).map(|i| {
                let wi = pairs[i].0;
                let f = c.subject.basic(f[i], wi, wo);
                let [r, g, b] = f.map(|f| f * at[i][0].abs());
                let brightest = r.max(g).max(b);
                not_finite += u64::from(!(r + g + b).is_finite());
                if !c.subject.has_pdf() {
                    return [r, g, b, 0.0, 0.0, 0.0, 0.0];
                }
                let p = densities[i];
                if p > 0.0 {
                    largest_weight = largest_weight.max(brightest / p);
                    return [r, g, b, 0.0, r * r / p, g * g / p, b * b / p];
                }
                if brightest > most {
                    (most, unreachable_at) = (brightest, Some(wi));
                }
                [r, g, b, brightest, 0.0, 0.0, 0.0]
            });
            Ok(values.collect())
        },
        &partition.cells,
        0.2 * c.settings.energy_bound,
        c.settings.quadrature_evaluations * harder,
    )?;
    let (v, e) = (integral.total.value, integral.total.error);
    Ok(Furnace {
        wo,
        quadrature: [v[0], v[1], v[2]],
        error: [e[0], e[1], e[2]],
        unreachable: v[3],
        unreachable_error: e[3],
        unreachable_at,
        second_moment: [v[4] + e[4], v[5] + e[5], v[6] + e[6]],
        largest_weight,
        continuous,
        delta,
        draws,
        delta_draws,
        evaluations: integral.evaluations + draws,
        not_finite,
    })
}
