//! The white furnace: how much of uniform light a surface sends to a viewer, by quadrature and by its own sampling.

use super::rng;
use crate::check::Checker;
use crate::cubature::integrate;
use crate::directions::{at_height, mirror, spherical};
use crate::partition::{Partition, Rules, coordinates};
use crate::statistics::Moments;
use crate::verdict::Property;
use gonio_num::Vec3;

/// What uniform light of radiance 1 becomes towards `wo`: a(ωo) = ∫ f(ωi, ωo) |cosθi| dωi, the directional albedo (by
/// reciprocity the reflected fraction of a beam from ωo).
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
    /// ∫ (f cosθ)² / pdf: the second moment of the weight, each channel.
    pub second_moment: [f64; 3],
    /// The largest f cosθ / pdf that the quadrature met.
    pub largest_weight: f64,
    /// Weights of draws that aren't deltas (0 for all others), and of those that are.
    pub continuous: [Moments; 3],
    pub delta: [Moments; 3],
    pub draws: u64,
    pub delta_draws: u64,
    pub evaluations: u64,
}

/// Outgoing directions from the normal to grazing, denser towards grazing where energy goes wrong, spiralling in azimuth by
/// the golden angle so that an anisotropic function is seen from all sides.
pub(super) fn outgoing(count: u32, steepest_deg: f64) -> Vec<Vec3<f64>> {
    (0..count)
        .map(|k| {
            let t = f64::from(k) / f64::from(count.max(2) - 1);
            let theta = steepest_deg * t * (1.4 - 0.4 * t);
            spherical(theta.to_radians(), 0.3 + 2.399_963 * f64::from(k))
        })
        .collect()
}

/// A furnace for each of twice the usual number of directions, up to 89.5°.
pub(super) fn measure(c: &Checker) -> Vec<Furnace> {
    outgoing(2 * c.settings.directions, 89.5)
        .into_iter()
        .enumerate()
        .map(|(k, wo)| at(c, wo, k))
        .collect()
}

fn at(c: &Checker, wo: Vec3<f64>, index: usize) -> Furnace {
    let mut random = rng(c, Property::EnergyConservation, &index.to_string());
    let draws = if c.subject.sample.is_some() {
        c.settings.density_samples / 2
    } else {
        0
    };
    let (mut continuous, mut delta) = ([Moments::new(); 3], [Moments::new(); 3]);
    let mut delta_draws = 0;
    let pilot = (draws / 4) as usize;
    let mut points = Vec::with_capacity(pilot);
    let mut largest_weight: f64 = 0.0;
    for _ in 0..draws {
        let u = [random.next_f64(), random.next_f64(), random.next_f64()];
        let s = c.subject.draw(wo, u);
        let is_delta = s.is_some_and(|s| s.delta);
        delta_draws += u64::from(is_delta);
        let weight = s.map_or([0.0; 3], |s| s.weight);
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
            points.push(coordinates(s.wi));
        }
    }

    let rules = Rules {
        max_points: (points.len() / c.settings.cells.max(1) as usize).max(8),
        max_solid_angle: 0.1,
        // Without samples nothing else shows where a sharp lobe stands.
        seed_width: if draws > 0 { 0.01 } else { 1e-3 },
    };
    let seeds = [mirror(wo), wo, Vec3::new(0.0, 0.0, 1.0)];
    let partition = Partition::new(points, &seeds, &rules, !c.settings.reflection_only);
    let mut unreachable_at = None;
    let mut most = 0.0;
    let integral = integrate(
        |[z, phi]| {
            let wi = at_height(z, phi);
            let f = (c.subject.eval)(wi, wo);
            let [r, g, b] = f.map(|f| f * z.abs());
            let brightest = r.max(g).max(b);
            let Some(pdf) = c.subject.pdf else {
                return [r, g, b, 0.0, 0.0, 0.0, 0.0];
            };
            let p = pdf(wi, wo);
            if p > 0.0 {
                largest_weight = largest_weight.max(brightest / p);
                return [r, g, b, 0.0, r * r / p, g * g / p, b * b / p];
            }
            if brightest > most {
                (most, unreachable_at) = (brightest, Some(wi));
            }
            [r, g, b, brightest, 0.0, 0.0, 0.0]
        },
        &partition.cells,
        1e-5,
        c.settings.quadrature_evaluations,
    );
    let (v, e) = (integral.total.value, integral.total.error);
    Furnace {
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
    }
}
