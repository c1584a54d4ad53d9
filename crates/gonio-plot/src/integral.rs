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
const TOLERANCE: f64 = 2e-4;
/// Doublings of the nodes at most.
const STEPS: u32 = 4;
/// The width down to which a lobe is resolved, radians: below that of the sharpest, α = 1e-4.
const FINEST: f64 = 1e-4;

/// a(ωo) = ∫ f(ωi→ωo) n(ωi)²/n(ωo)² |cosθi| dωi, over the hemisphere or, for what transmits, over the sphere.
///
/// The integral is split among the directions where a narrow lobe may stand, by weights 1/distance⁴ that add up to 1 and are 0 at all
/// others; each part is taken in polar coordinates around its own, with nodes at distances from it that grow geometrically.
pub(crate) fn albedo(f: &Function, wo: Vec3<f64>) -> Albedo {
    let mut last = quadrature(f, wo, 0);
    for step in 1..=STEPS {
        let mut next = quadrature(f, wo, step);
        let apart = |k: usize| (next.total[k] - last.total[k]).abs();
        next.error = apart(0).max(apart(1)).max(apart(2));
        last = next;
        if last.error < TOLERANCE {
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

fn quadrature(f: &Function, wo: Vec3<f64>, step: u32) -> Albedo {
    let centres = f.lobes(wo);
    let rings = GaussLegendre::new(12 << step);
    let spokes = 16_u32 << step;
    let mut pairs = Vec::new();
    let mut weights = Vec::new();
    for (own, &centre) in centres.iter().enumerate() {
        let (across, along) = around(centre);
        for k in 0..spokes {
            let (sin_b, cos_b) = Real::sin_cos(TAU * (f64::from(k) + 0.5) / f64::from(spokes));
            let outwards = across * cos_b + along * sin_b;
            let mut node = |alpha: f64, weight: f64| {
                let (sin, cos) = Real::sin_cos(alpha);
                let wi = centre * cos + outwards * sin;
                let area = weight * sin * TAU / f64::from(spokes);
                pairs.push([wi, wo]);
                weights.push(area * share(&centres, own, wi) * wi.z.abs());
            };
            // The nodes end at the horizon, where |cosθ| has a kink: z = centre.z cosα + outwards.z sinα = 0.
            let up = if centre.z < 0.0 { -1.0 } else { 1.0 };
            let horizon = Real::atan2(up * centre.z, -up * outwards.z);
            let stretch = Real::ln(1.0 + horizon / FINEST);
            for (s, weight) in rings.on(0.0, 1.0) {
                let from = FINEST * Real::exp(s * stretch);
                node(from - FINEST, weight * stretch * from);
            }
            if f.transmits() {
                for (alpha, weight) in rings.on(horizon, PI) {
                    node(alpha, weight);
                }
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

/// The share of the direction `w` that belongs to the centre `own`.
fn share(centres: &[Vec3<f64>], own: usize, w: Vec3<f64>) -> f64 {
    let inverse = |c: &Vec3<f64>| {
        let d = (*c - w).length_squared().max(1e-18);
        1.0 / (d * d)
    };
    let all: f64 = centres.iter().map(inverse).sum();
    inverse(&centres[own]) / all
}

/// Two unit vectors at right angles to `w` and to each other.
pub(crate) fn around(w: Vec3<f64>) -> (Vec3<f64>, Vec3<f64>) {
    let other = if w.z.abs() < 0.9 {
        Vec3::new(0.0, 0.0, 1.0)
    } else {
        Vec3::new(1.0, 0.0, 0.0)
    };
    let a = w.cross(other).normalize();
    (a, w.cross(a))
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
