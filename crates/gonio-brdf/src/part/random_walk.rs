//! Light traced from facet to facet on Smith's surface: ground truth for interreflection.
//!
//! The surface is a random height field whose heights and slopes are independent; light walks through it as through a
//! medium of facets (Heitz, Hanika, d'Eon & Dachsbacher 2016, "Multiple-Scattering Microfacet BSDFs with the Smith Model"). Heights
//! are uniform in [−1, 1], which by the paper doesn't matter.

use super::albedo::directional_albedo;
use super::distribution::{Distribution, Shape};
use super::fresnel::Fresnel;
use super::masking::{Masking, cos_over_smith_g1};
use crate::Number;
use crate::model::components;
use gonio_num::{Real, Vec3};
use gonio_radiometry::sequence::Rng;
use std::f64::consts::{FRAC_1_SQRT_2, PI, TAU};

type V = Vec3<f64>;

/// Λ(w) for a direction of any height: −1 − Λ(−w) where it points down.
fn lambda(d: &Distribution<f64>, w: V) -> f64 {
    if w.z < 0.0 {
        return -1.0 - lambda(d, -w);
    }
    cos_over_smith_g1(d, w) / w.z.max(1e-9) - 1.0
}

/// The area of the facets that face `w`, projected along it, over that of the surface.
fn projected_area(d: &Distribution<f64>, w: V) -> f64 {
    if w.z < 0.0 {
        return cos_over_smith_g1(d, -w) + w.z;
    }
    cos_over_smith_g1(d, w)
}

/// Share of the heights below `h`.
fn share_below(h: f64) -> f64 {
    (0.5 * (h + 1.0)).clamp(0.0, 1.0)
}

/// xᵉ for x in [0, 1], with the same bits on every machine; 0 for x = 0 and e > 0.
fn power(x: f64, e: f64) -> f64 {
    Real::exp(e * Real::ln(x.max(1e-300)))
}

/// The height at which a ray from height `h` in direction `w` meets a facet; nothing if it leaves.
fn next_height(d: &Distribution<f64>, w: V, h: f64, u: f64) -> Option<f64> {
    let lambda = lambda(d, w);
    if w.z > 0.0 && u <= power(share_below(h), lambda) {
        return None;
    }
    if lambda.abs() < 1e-9 {
        return Some(h);
    }
    // 1 − u is the chance to go farther, (C(h)/C(h′))^Λ.
    let below = share_below(h) / power(1.0 - u, 1.0 / lambda);
    Some(2.0 * below.clamp(0.0, 1.0) - 1.0)
}

/// A facet's normal among those that `w`, of any height, sees: density D(m) max(w·m, 0) over the projected area.
///
/// For GGX and Beckmann of one slope scale.
fn visible_normal(d: &Distribution<f64>, w: V, random: &mut Rng) -> V {
    let [u, v] = [random.next_f64(), random.next_f64()];
    if d.shape() == Shape::Ggx {
        return d.sample_visible_ggx(w, u, v);
    }
    // Slopes p towards w and q across it: p ∝ N(p) max(w.z + p sinθ, 0), q ∝ N(q), both of variance α²/2.
    let deviation = d.alpha_x() * FRAC_1_SQRT_2;
    let sin = (w.x * w.x + w.y * w.y).sqrt();
    let (cos_phi, sin_phi) = if sin > 1e-12 {
        (w.x / sin, w.y / sin)
    } else {
        (1.0, 0.0)
    };
    let density = |p: f64| Real::exp(-0.5 * (p / deviation).powi(2)) / (deviation * TAU.sqrt());
    let below = |p: f64| 0.5 * (1.0 + libm::erf(p / deviation * FRAC_1_SQRT_2));
    let end = 8.0 * deviation;
    let first = if sin > 1e-12 {
        (-w.z / sin).max(-end)
    } else {
        -end
    };
    let mass = |p: f64| {
        w.z * (below(p) - below(first))
            + sin * deviation * deviation * (density(first) - density(p))
    };
    let wanted = u * mass(end);
    let (mut low, mut high) = (first.min(end), end);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if mass(middle) < wanted {
            low = middle;
        } else {
            high = middle;
        }
    }
    let p = 0.5 * (low + high);
    let radius = (-2.0 * Real::ln((1.0 - v).max(1e-300))).sqrt();
    let q = deviation * radius * Real::cos(TAU * random.next_f64());
    V::new(cos_phi * p - sin_phi * q, sin_phi * p + cos_phi * q, 1.0).normalize()
}

/// One step of a walk: at a facet of height `height`, coming along −`towards`.
#[derive(Debug, Clone, Copy)]
pub struct Step {
    /// How many facets the light has met, this one included.
    pub order: u32,
    /// Back along the light's path: the direction that sees the facet.
    pub towards: Vec3<f64>,
    /// The facet's height.
    pub height: f64,
    /// Product of the reflectances before it.
    pub throughput: [f64; 3],
}

impl Step {
    /// f·cosθi of light from `wi` that meets this facet last: an estimate of the walk's, to be averaged over walks.
    pub fn reflected(
        &self,
        d: &Distribution<f64>,
        fresnel: &Fresnel<f64, 3>,
        wi: Vec3<f64>,
    ) -> [f64; 3] {
        let sum = self.towards + wi;
        let h = sum.normalize();
        if wi.z <= 0.0 || h.z.is_nan() || h.z <= 0.0 {
            return [0.0; 3];
        }
        let phase = d.density(h) / (4.0 * projected_area(d, self.towards).max(1e-12));
        let leaves = power(share_below(self.height), lambda(d, wi));
        let f = fresnel.eval((0.5 * sum.length()).min(1.0));
        std::array::from_fn(|k| self.throughput[k] * f[k] * phase * leaves)
    }
}

/// Walks from the viewer's direction `wo` (above the surface) until the light leaves, at most 64 facets; `visit` sees every facet.
///
/// Returns the direction to the light and the weight f·cosθi/pdf, summed over all orders of scattering; nothing if the
/// light was still inside.
///
/// For GGX and Beckmann with one slope scale.
pub fn walk(
    d: &Distribution<f64>,
    fresnel: &Fresnel<f64, 3>,
    wo: Vec3<f64>,
    random: &mut Rng,
    mut visit: impl FnMut(&Step),
) -> Option<(Vec3<f64>, [f64; 3])> {
    let mut along = -wo;
    // From above all heights.
    let mut height = 1.0;
    let mut throughput = [1.0; 3];
    for order in 1..=64 {
        match next_height(d, along, height, random.next_f64()) {
            None => return Some((along, throughput)),
            Some(h) => height = h,
        }
        let towards = -along;
        visit(&Step {
            order,
            towards,
            height,
            throughput,
        });
        let m = visible_normal(d, towards, random);
        let cos = towards.dot(m).clamp(0.0, 1.0);
        let f = fresnel.eval(cos);
        for k in 0..3 {
            throughput[k] *= f[k];
        }
        along = towards.reflect(m);
    }
    None
}

/// Nodes along √μ of either direction.
const NODES: usize = 16;
/// Nodes along Δφ, from 0 to π.
const TURNS: usize = 9;
/// Walks from each node.
const WALKS: u32 = 2048;
/// √μ of the first node: at exactly 90° nothing is defined.
const FIRST: f64 = 0.05;

/// The lobe of light that leaves after two and more facets, traced and kept as a table over √μi, √μr and |φi − φr|.
///
/// It is made reciprocal by averaging both orders of the directions, and scaled so that a white surface loses nothing at the nodes: the
/// walk conserves energy, its samples only nearly.
#[derive(Debug, Clone)]
pub struct WalkTable {
    /// f in sr⁻¹ at ((i·NODES + o)·TURNS + turn).
    values: Vec<[f64; 3]>,
    /// The share of the reflected light that is in this lobe, at each node.
    shares: [f64; NODES],
}

fn node(i: usize) -> f64 {
    let x = FIRST + (1.0 - FIRST) * i as f64 / (NODES - 1) as f64;
    x * x
}

/// The lower node around μ, and the weight of the upper one.
fn place(mu: f64) -> (usize, f64) {
    let x = (mu.max(0.0).sqrt() - FIRST) / (1.0 - FIRST) * (NODES - 1) as f64;
    let x = x.clamp(0.0, (NODES - 1) as f64);
    let i = (x as usize).min(NODES - 2);
    (i, x - i as f64)
}

fn direction(mu: f64, phi: f64) -> V {
    let sin = (1.0 - mu * mu).max(0.0).sqrt();
    V::new(sin * Real::cos(phi), sin * Real::sin(phi), mu)
}

/// What is reflected by more than one facet at each pair of nodes, averaged over walks and over both orders of the directions.
fn traced(d: &Distribution<f64>, fresnel: &Fresnel<f64, 3>) -> Vec<[f64; 3]> {
    let mut raw = vec![[0.0; 3]; NODES * NODES * TURNS];
    for o in 0..NODES {
        let wo = direction(node(o), 0.0);
        // The same numbers for every node and reflectance: what differs is not their noise.
        let mut random = Rng::from_name("random walk");
        for _ in 0..WALKS {
            walk(d, fresnel, wo, &mut random, |step| {
                if step.order < 2 {
                    return;
                }
                for i in 0..NODES {
                    for turn in 0..TURNS {
                        let wi = direction(node(i), PI * turn as f64 / (TURNS - 1) as f64);
                        let f = step.reflected(d, fresnel, wi);
                        let cell = &mut raw[(i * NODES + o) * TURNS + turn];
                        for k in 0..3 {
                            cell[k] += f[k] / (f64::from(WALKS) * wi.z);
                        }
                    }
                }
            });
        }
    }
    let mut both = raw.clone();
    for i in 0..NODES {
        for o in 0..NODES {
            for turn in 0..TURNS {
                let (a, b) = (
                    (i * NODES + o) * TURNS + turn,
                    (o * NODES + i) * TURNS + turn,
                );
                both[a] = std::array::from_fn(|k| 0.5 * (raw[a][k] + raw[b][k]));
            }
        }
    }
    both
}

/// ∫ f cosθi dωi of the interpolated values at node `o`, for the component `k`, with the values at node i times `scale[i]`.
fn row_albedo(values: &[[f64; 3]], scale: &[f64; NODES], o: usize, k: usize) -> f64 {
    // The mean over Δφ of a function that is linear between nodes is the trapezoid rule.
    let mean: [f64; NODES] = std::array::from_fn(|i| {
        let row = &values[(i * NODES + o) * TURNS..][..TURNS];
        let ends = 0.5 * (row[0][k] + row[TURNS - 1][k]);
        let inside: f64 = row[1..TURNS - 1].iter().map(|f| f[k]).sum();
        scale[i] * (ends + inside) / (TURNS - 1) as f64
    });
    // 2π ∫ f μ dμ with μ = x².
    let steps = 256;
    let mut sum = 0.0;
    for s in 0..steps {
        let x = (f64::from(s) + 0.5) / f64::from(steps);
        let (i, t) = place(x * x);
        let f = mean[i] * (1.0 - t) + mean[i + 1] * t;
        sum += f * 2.0 * x * x * x;
    }
    TAU * sum / f64::from(steps)
}

impl WalkTable {
    /// Traces the lobe of a surface: some tenths of a second.
    ///
    /// - `d`: GGX or Beckmann of one slope scale
    pub fn trace(d: &Distribution<f64>, fresnel: &Fresnel<f64, 3>) -> Self {
        let loss = |mu: f64| (1.0 - directional_albedo(d, Masking::SmithCorrelated, mu)).max(0.0);
        let losses: [f64; NODES] = std::array::from_fn(|i| loss(node(i)));
        // Between two nodes the sum of both lobes must not exceed 1 either.
        let mut target = losses;
        for i in 0..NODES - 1 {
            let middle = 0.5 * (node(i).sqrt() + node(i + 1).sqrt());
            let over = 0.5 * (losses[i] + losses[i + 1]) - loss(middle * middle);
            for t in &mut target[i..=i + 1] {
                *t = (*t - 1.5 * over.max(0.0)).max(0.0);
            }
        }
        let below = loss(0.25 * FIRST * FIRST) - losses[0];
        target[0] = (target[0] + below.min(0.0)).max(0.0);

        let white = traced(d, &Fresnel::None);
        let mut scale = [1.0; NODES];
        // The symmetric scaling s(i) s(o) that gives each row its target (Sinkhorn's iteration, damped).
        for _ in 0..64 {
            let next: [f64; NODES] = std::array::from_fn(|o| {
                let now = row_albedo(&white, &scale, o, 0).max(1e-12);
                (scale[o] * target[o] / now).sqrt()
            });
            scale = next;
        }
        let mut values = match fresnel {
            Fresnel::None => white,
            _ => traced(d, fresnel),
        };
        for i in 0..NODES {
            for o in 0..NODES {
                for f in &mut values[(i * NODES + o) * TURNS..][..TURNS] {
                    *f = f.map(|f| f * scale[i] * scale[o]);
                }
            }
        }
        let shares = std::array::from_fn(|o| {
            let many: f64 = (0..3)
                .map(|k| row_albedo(&values, &[1.0; NODES], o, k))
                .sum();
            let once: f64 = fresnel
                .average()
                .iter()
                .map(|f| f * (1.0 - losses[o]))
                .sum();
            many / (many + once).max(1e-12)
        });
        Self { values, shares }
    }

    /// f in sr⁻¹ of directions above the horizon.
    pub(crate) fn eval<R: Number, const N: usize>(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let rgb = R::through([wi.x, wi.y, wi.z, wo.x, wo.y, wo.z], &|x| {
            self.value(V::new(x[0], x[1], x[2]), V::new(x[3], x[4], x[5]))
        });
        components(rgb)
    }

    /// Probability of drawing this lobe towards a viewer at cosine `mu`.
    pub(crate) fn probability<R: Number>(&self, mu: R) -> R {
        let [p] = R::through([mu], &|[mu]| {
            let (i, t) = place(mu);
            [self.shares[i] * (1.0 - t) + self.shares[i + 1] * t]
        });
        p
    }

    fn value(&self, wi: V, wo: V) -> [f64; 3] {
        let (i, s) = place(wi.z);
        let (o, t) = place(wo.z);
        let sines = ((wi.x * wi.x + wi.y * wi.y) * (wo.x * wo.x + wo.y * wo.y)).sqrt();
        let cos_phi = (wi.x * wo.x + wi.y * wo.y) / sines.max(1e-12);
        let phi = Real::acos(cos_phi) / PI * (TURNS - 1) as f64;
        let turn = (phi as usize).min(TURNS - 2);
        let r = phi - turn as f64;
        let mut sum = [0.0; 3];
        for corner in 0..8usize {
            let bit = |n: usize| corner >> n & 1;
            let weight = |t: f64, n: usize| if bit(n) == 1 { t } else { 1.0 - t };
            let w = weight(s, 0) * weight(t, 1) * weight(r, 2);
            let f = self.values[((i + bit(0)) * NODES + o + bit(1)) * TURNS + turn + bit(2)];
            for k in 0..3 {
                sum[k] += w * f[k];
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surfaces() -> [Distribution<f64>; 3] {
        [
            Distribution::isotropic(Shape::Ggx, 0.3),
            Distribution::isotropic(Shape::Ggx, 1.0),
            Distribution::isotropic(Shape::Beckmann, 0.7),
        ]
    }

    /// A facet drawn by visible normals: E[1/p] over a region of normals is its solid angle, from above and from below.
    #[test]
    fn visible_normals_have_their_density() {
        for d in surfaces() {
            for w in [direction(0.6, 0.4), direction(-0.3, 1.0)] {
                let mut random = Rng::from_name("visible_normals_have_their_density");
                let n = 200_000;
                let (mut sum, mut squares) = (0.0, 0.0);
                // Normals within a cone that the direction sees all of.
                let axis = direction(0.8, if w.z > 0.0 { 0.4 } else { 1.0 });
                let cos0 = 0.95;
                for _ in 0..n {
                    let m = visible_normal(&d, w, &mut random);
                    if m.dot(axis) > cos0 {
                        let p = d.density(m) * w.dot(m) / projected_area(&d, w);
                        sum += 1.0 / p;
                        squares += 1.0 / (p * p);
                    }
                }
                let (mean, cone) = (sum / f64::from(n), TAU * (1.0 - cos0));
                let error =
                    (squares / f64::from(n) - mean * mean).max(0.0).sqrt() / f64::from(n).sqrt();
                // Walter's fit of Beckmann's Λ is within 0.4 %.
                let fit = if d.shape() == Shape::Beckmann {
                    8e-3 * cone
                } else {
                    0.0
                };
                assert!(
                    (mean - cone).abs() < 5.0 * error + fit,
                    "{d:?} {w:?}: {mean} {cone} {error}"
                );
            }
        }
    }

    /// White facets: what leaves after one is E(μ), and all of it leaves in the end.
    #[test]
    fn walks_conserve_energy_and_begin_as_the_formula() {
        for d in surfaces() {
            for mu in [0.2, 0.7] {
                let wo = direction(mu, 0.3);
                let mut random = Rng::from_name("walks_conserve_energy_and_begin_as_the_formula");
                let n = 40_000;
                let (mut once, mut left) = (0, 0);
                for _ in 0..n {
                    let mut orders = 0;
                    let end = walk(&d, &Fresnel::None, wo, &mut random, |step| {
                        orders = step.order
                    });
                    if let Some((wi, weight)) = end {
                        assert!(wi.z > 0.0 && weight == [1.0; 3]);
                        left += 1;
                        once += u32::from(orders == 1);
                    }
                }
                assert!(f64::from(n - left) < 1e-3 * f64::from(n));
                let expected = directional_albedo(&d, Masking::SmithCorrelated, mu);
                let error = (expected * (1.0 - expected) / f64::from(n)).sqrt();
                let fit = if d.shape() == Shape::Beckmann {
                    4e-3
                } else {
                    0.0
                };
                let share = f64::from(once) / f64::from(n);
                assert!(
                    (share - expected).abs() < 5.0 * error + fit,
                    "{d:?} {mu}: {share} {expected}"
                );
            }
        }
    }

    /// The next facet's light, summed over the first facets only, is the formula's f cosθi.
    #[test]
    fn the_first_facet_is_the_formula() {
        use super::super::geometry::Half;
        use super::super::masking::visibility;
        let d = Distribution::isotropic(Shape::Ggx, 0.5);
        let (wi, wo) = (direction(0.5, 2.0), direction(0.8, 0.0));
        let mut random = Rng::from_name("the_first_facet_is_the_formula");
        let n = 100_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..n {
            let mut f = 0.0;
            walk(&d, &Fresnel::None, wo, &mut random, |step| {
                if step.order == 1 {
                    f = step.reflected(&d, &Fresnel::None, wi)[0];
                }
            });
            sum += f;
            squares += f * f;
        }
        let mean = sum / f64::from(n);
        let error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
        let half = Half::new(wi, wo);
        let expected =
            d.density_of(&half) * visibility(Masking::SmithCorrelated, &d, wi, wo, &half) * wi.z;
        assert!(
            (mean - expected).abs() < 5.0 * error,
            "{mean} {expected} {error}"
        );
    }

    #[test]
    fn a_white_table_gives_back_what_is_lost() {
        for d in surfaces() {
            let table = WalkTable::trace(&d, &Fresnel::None);
            for o in [0, 5, NODES - 1] {
                let given = row_albedo(&table.values, &[1.0; NODES], o, 0);
                let lost = 1.0 - directional_albedo(&d, Masking::SmithCorrelated, node(o));
                // What the nodes were lowered by, so that nothing is gained between them.
                assert!(
                    given < lost + 1e-6 && given > lost - 0.02,
                    "{d:?} {o}: {given} {lost}"
                );
            }
        }
    }
}
