//! The directional albedo of a function, by quadrature.

use crate::Function;
use gonio_num::{Real, Vec3};
use gonio_radiometry::quadrature::GaussLegendre;
use std::f64::consts::{PI, TAU};

/// What uniform light of radiance 1 becomes towards a viewer: by reciprocity the fraction of a beam from there that leaves again.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Albedo {
    /// From the viewer's side, Dirac deltas included.
    pub reflected: [f64; 3],
    /// From both sides.
    pub total: [f64; 3],
    /// How far the last two steps of the quadrature are apart.
    pub error: f64,
    /// Values that were not finite, taken as 0.
    pub gaps: usize,
}

/// The quadrature ends at this difference between two steps: less than a curve's width in a chart of albedos.
const TOLERANCE: f64 = 5e-4;
/// Nodes in each piece along each angle, step by step.
const NODES: [usize; 4] = [3, 5, 8, 12];
/// The narrowest pieces, radians: along θ half as wide as the sharpest lobes (α = 1e-4), along φ by as much narrower as such a lobe is across the
/// plane of incidence for a viewer at 89.5°.
const FINEST: [f64; 2] = [5e-5, 1e-6];
/// How much wider the next piece is.
const GROWTH: f64 = 2.5;

/// a(ωo) = ∫ f(ωi→ωo) n(ωi)²/n(ωo)² |cosθi| dωi, over the hemisphere or, for what transmits, over the sphere.
///
/// Gauss–Legendre rules in θi and φi over pieces that grow geometrically from the angles at which a narrow lobe may stand. As a lobe's axes lie
/// along the two angles, so do the pieces, however grazing light stretches it.
pub(crate) fn albedo(f: &Function, wo: Vec3<f64>) -> Albedo {
    let mut last = quadrature(f, wo, NODES[0]);
    for nodes in &NODES[1..] {
        let mut next = quadrature(f, wo, *nodes);
        let apart = |k: usize| (next.total[k] - last.total[k]).abs();
        next.error = apart(0).max(apart(1)).max(apart(2));
        last = next;
        if last.error < TOLERANCE || last.gaps > 0 {
            break;
        }
    }
    let from = f.index_squared(wo);
    for spike in f.draws(wo) {
        let to = f.index_squared(spike.wi);
        for k in 0..3 {
            let share = spike.weight[k] * spike.probability * to[k] / from[k];
            last.total[k] += share;
            if (spike.wi.z > 0.0) == (wo.z > 0.0) {
                last.reflected[k] += share;
            }
        }
    }
    last
}

fn quadrature(f: &Function, wo: Vec3<f64>, nodes: usize) -> Albedo {
    let rule = GaussLegendre::new(nodes);
    let lobes = f.lobes(wo);
    let theta = |w: &Vec3<f64>| Real::atan2((w.x * w.x + w.y * w.y).sqrt(), w.z);
    let phi = Real::atan2(wo.y, wo.x);
    let azimuths = nodes_of(
        &rule,
        phi,
        phi + TAU,
        &[phi, phi + PI, phi + TAU],
        FINEST[1],
    );
    let mut pairs = Vec::new();
    let mut weights = Vec::new();
    for above in [true, false] {
        if !above && !f.transmits() {
            continue;
        }
        let (from, to) = if above {
            (0.0, 0.5 * PI)
        } else {
            (0.5 * PI, PI)
        };
        let here = lobes.iter().filter(|w| (w.z > 0.0) == above);
        let centres: Vec<f64> = here.map(theta).collect();
        for (theta, w_theta) in nodes_of(&rule, from, to, &centres, FINEST[0]) {
            let (sin, cos) = Real::sin_cos(theta);
            for &(phi, w_phi) in &azimuths {
                let (sin_phi, cos_phi) = Real::sin_cos(phi);
                pairs.push([Vec3::new(sin * cos_phi, sin * sin_phi, cos), wo]);
                weights.push(w_theta * w_phi * sin * cos.abs());
            }
        }
    }
    let mut sum = Albedo::default();
    let from = f.index_squared(wo);
    for ((value, [wi, _]), weight) in f.eval(&pairs).iter().zip(&pairs).zip(weights) {
        let to = f.index_squared(*wi);
        for k in 0..3 {
            let part = value[k] * weight * to[k] / from[k];
            if !part.is_finite() {
                sum.gaps += 1;
                continue;
            }
            sum.total[k] += part;
            if (wi.z > 0.0) == (wo.z > 0.0) {
                sum.reflected[k] += part;
            }
        }
    }
    sum
}

/// Nodes and weights from `low` to `high`, on pieces that are `finest` at each of the centres and grow from there.
fn nodes_of(
    rule: &GaussLegendre,
    low: f64,
    high: f64,
    centres: &[f64],
    finest: f64,
) -> Vec<(f64, f64)> {
    let mut edges = vec![low, high];
    edges.extend(centres);
    edges.retain(|t| (low..=high).contains(t));
    edges.sort_by(f64::total_cmp);
    edges.dedup_by(|b, a| *b - *a < finest);
    let mut all = edges.clone();
    for pair in edges.windows(2) {
        // From both ends to the middle; from an end of the range that is no centre nothing grows.
        let half = 0.5 * (pair[1] - pair[0]);
        let centre = |t: f64| centres.iter().any(|c| (c - t).abs() < finest);
        let reach = |other: f64| if centre(other) { half } else { 2.0 * half };
        let mut offset = finest;
        while offset < 2.0 * half / GROWTH {
            if centre(pair[0]) && offset < reach(pair[1]) {
                all.push(pair[0] + offset);
            }
            if centre(pair[1]) && offset < reach(pair[0]) {
                all.push(pair[1] - offset);
            }
            offset *= GROWTH;
        }
    }
    all.sort_by(f64::total_cmp);
    all.windows(2).flat_map(|w| rule.on(w[0], w[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn direction(degrees: f64) -> Vec3<f64> {
        let (sin, cos) = Real::sin_cos(degrees.to_radians());
        Vec3::new(sin, 0.0, cos)
    }

    #[test]
    fn a_lambertian_surface_reflects_its_albedo() {
        let f = Function::new("", |_, _| [0.3 / PI, 0.6 / PI, 0.9 / PI]);
        for degrees in [0.0, 40.0, 89.0] {
            let a = albedo(&f, direction(degrees));
            for (k, expected) in [0.3, 0.6, 0.9].into_iter().enumerate() {
                assert!((a.total[k] - expected).abs() < TOLERANCE, "{degrees} {a:?}");
            }
            assert!(a.error < TOLERANCE && a.gaps == 0, "{degrees} {a:?}");
        }
    }

    /// A Phong lobe (p + 2)/2π cosᵖ around the mirror direction of a viewer at the normal: ∫ cosᵖ⁺¹θ dω = 2π/(p + 2), so its albedo is 1.
    #[test]
    fn narrow_lobes_have_the_albedo_of_their_closed_form() {
        for power in [1.0, 100.0, 1e4, 1e6] {
            let f = Function::new("", move |wi, _| {
                [(power + 2.0) / TAU * Real::powf(wi.z.max(0.0), power); 3]
            });
            let a = albedo(&f, direction(0.0));
            assert!((a.total[0] - 1.0).abs() < TOLERANCE, "{power}: {a:?}");
        }
    }

    #[test]
    fn light_that_passes_counts_in_units_of_the_squared_index() {
        // Evenly into both sides, 0.25 each, after the radiance's factor n².
        let n = 1.5;
        let f = Function::new("", move |wi, _| {
            [if wi.z > 0.0 { 0.25 } else { 0.25 / (n * n) } / PI; 3]
        })
        .transmitting([n; 3]);
        let a = albedo(&f, direction(30.0));
        assert!((a.reflected[0] - 0.25).abs() < TOLERANCE && (a.total[0] - 0.5).abs() < TOLERANCE);
    }
}
