//! Masking and shadowing of microfacets.

use super::distribution::{Distribution, Shape};
use super::geometry::Half;
use super::masking_table;
use super::special::beta;
use gonio_num::{Real, Vec3, Work};

/// How facets hide each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Masking {
    /// Symmetric V-shaped grooves: Torrance & Sparrow 1967, Cook & Torrance 1982 eq. 7.
    VCavity,
    /// Smith 1967, the two directions independent: G = G₁(ωi) G₁(ωr).
    Smith,
    /// Smith, correlated through the height: G = 1/(1 + Λ(ωi) + Λ(ωr)). Heitz 2014 eq. 99.
    SmithCorrelated,
}

impl Masking {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::VCavity, Self::Smith, Self::SmithCorrelated];

    /// The words for them in a description, in the order of [`Masking::ALL`].
    pub const NAMES: &'static [&'static str] = &["v-cavity", "smith", "smith-correlated"];

    /// The masking of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        let index = Self::NAMES.iter().position(|n| *n == name)?;
        Some(Self::ALL[index])
    }

    /// Its place in [`Masking::ALL`].
    pub const fn index(self) -> usize {
        match self {
            Self::VCavity => 0,
            Self::Smith => 1,
            Self::SmithCorrelated => 2,
        }
    }
}

/// (1 + Λ(w))·w.z of Smith's masking, that is w.z/G₁(w); positive and finite also at grazing w.
///
/// With m² = (αx w.x)² + (αy w.y)²:
///
/// - GGX: (√(w.z² + m²) + w.z)/2, exact
/// - Beckmann, and Blinn–Phong through the same α: w.z + m (1 − 1.259a + 0.396a²)/(3.535 + 2.181a), Walter's rational fit with
///   a = w.z/m, for a < 1.6, else w.z; within 0.4 % of the exact G₁
/// - the others: (w.z + ρm) times a table over w.z/(w.z + ρm), α and the tail, with ρ their [`Distribution::spread`]
///   ([`super::masking_table`])
///
/// Source: Walter et al. 2007 eqs 27, 34; Heitz 2014 eqs 72, 80.
#[inline(always)]
pub fn cos_over_smith_g1<R: Real>(d: &Distribution<R>, w: Vec3<R>) -> R {
    let m2 = (d.alpha_x() * w.x).sq() + (d.alpha_y() * w.y).sq();
    match d.shape() {
        Shape::Ggx => {
            let root = (w.z * w.z + m2).max(R::lit(1e-30)).sqrt();
            (root + w.z) * R::lit(0.5)
        }
        Shape::Beckmann | Shape::BlinnPhong => {
            let m = m2.max(R::lit(1e-30)).sqrt();
            let a = (w.z / m).clamp(R::zero(), R::lit(1.6));
            let top = R::one() - R::lit(1.259) * a + R::lit(0.396) * a * a;
            let fit = m * top / (R::lit(3.535) + R::lit(2.181) * a);
            w.z + R::select(a.lt(R::lit(1.6)), fit, R::zero())
        }
        Shape::Gaussian | Shape::Gtr | Shape::StudentT | Shape::ShiftedGamma | Shape::Abc => {
            let sum = w.z + d.spread() * m2.max(R::lit(1e-30)).sqrt();
            sum * masking_table::look_up(d, w.z / sum.max(R::lit(1e-15)))
        }
    }
}

/// G₁(w)/w.z of Smith's masking, finite also at grazing w for α > 0.
#[inline(always)]
pub fn smith_g1_over_cos<R: Real>(d: &Distribution<R>, w: Vec3<R>) -> R {
    cos_over_smith_g1(d, w).max(R::lit(1e-20)).recip()
}

/// D is at most 3e15 (`sgd` with p = 2 at the smallest slope scale): its product with 1/(4 · this) stays within single precision.
const TINY: f64 = 1e-23;

/// G(ωi, ωr)/(4 cosθi cosθr), for directions above the horizon. Symmetric to the last bit.
///
/// V-cavities: [`v_cavity`].
#[inline(always)]
pub fn visibility<R: Real>(
    masking: Masking,
    d: &Distribution<R>,
    wi: Vec3<R>,
    wo: Vec3<R>,
    half: &Half<R>,
) -> R {
    match masking {
        Masking::VCavity => v_cavity(wi, wo, half),
        Masking::Smith | Masking::SmithCorrelated => visibility_from_areas(masking, d, wi, wo),
    }
}

/// [`visibility`] of V-cavities: G = min(1, 2 h.z ωr.z/cosθ′, 2 h.z ωi.z/cosθ′).
#[inline(always)]
pub fn v_cavity<R: Real>(wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>) -> R {
    let groove = R::lit(2.0) * half.h().z * wi.z.min(wo.z);
    let g = R::one().min(groove / half.cos.max(R::lit(1e-15)));
    R::lit(0.25) * g / (wi.z * wo.z).max(R::lit(TINY))
}

/// [`visibility`] of Smith's maskings, which doesn't need the half vector.
#[inline(always)]
pub fn visibility_from_areas<R: Real>(
    masking: Masking,
    d: &Distribution<R>,
    wi: Vec3<R>,
    wo: Vec3<R>,
) -> R {
    let (i, o) = (cos_over_smith_g1(d, wi), cos_over_smith_g1(d, wo));
    let tiny = R::lit(TINY);
    let area = match masking {
        Masking::Smith | Masking::VCavity => i * o,
        // (1 + Λi + Λr) cosθi cosθr; what is subtracted is at most half of the sum.
        Masking::SmithCorrelated => (i * wo.z + o * wi.z) - wi.z * wo.z,
    };
    R::lit(0.25) / area.max(tiny)
}

/// G(ωi, ωr)/(4 |cosθi cosθr|) of Smith's maskings for directions on different sides of the surface, both given as if above it.
///
/// What is above a facet hides one direction and what is below it the other: with heights, G = B(1 + Λi, 1 + Λr), Euler's beta
/// function (Heitz et al. 2016, eq. 18), which is less than the product of both.
#[inline(always)]
pub fn visibility_across<R: Real>(
    masking: Masking,
    d: &Distribution<R>,
    wi: Vec3<R>,
    wo: Vec3<R>,
) -> R {
    match masking {
        Masking::Smith | Masking::VCavity => visibility_from_areas(masking, d, wi, wo),
        Masking::SmithCorrelated => R::out_of_line(Across { d, wi, wo }),
    }
}

struct Across<'a, R> {
    d: &'a Distribution<R>,
    wi: Vec3<R>,
    wo: Vec3<R>,
}

impl<R: Real> Work for Across<'_, R> {
    type Output = R;
    #[inline(always)]
    fn run(self) -> R {
        let Self { d, wi, wo } = self;
        let cosines = (wi.z.max(R::lit(1e-10)), wo.z.max(R::lit(1e-10)));
        // 1 + Λ; beyond 10⁴, at grazing angles, B is below 10⁻⁴ whatever it is.
        let most = R::lit(1e4);
        let i = (cos_over_smith_g1(d, wi) / cosines.0).clamp(R::one(), most);
        let o = (cos_over_smith_g1(d, wo) / cosines.1).clamp(R::one(), most);
        R::lit(0.25) * beta(i, o) / (cosines.0 * cosines.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::distribution::tests::{all, hemisphere_sum};
    use super::*;
    use gonio_radiometry::warp::around_axis;

    /// The visible-area identity: ∫ D(h) G₁(w) max(w·h, 0) dh = w.z. Midpoint rule over the slopes' tangent.
    #[test]
    fn visible_area() {
        for (alpha_x, alpha_y) in [(0.3, 0.3), (0.8, 0.2), (0.02, 0.02)] {
            for d in all(alpha_x, alpha_y) {
                // The centre of the shifted gamma is α² wide, too narrow for the midpoint rule.
                if d.shape() == Shape::ShiftedGamma && alpha_x < 0.1 {
                    continue;
                }
                let tolerance = match d.shape() {
                    Shape::Ggx => 3e-4,
                    // Walter's fit.
                    Shape::Beckmann => 4e-3,
                    // Borrowed from Beckmann's.
                    Shape::BlinnPhong => continue,
                    // The midpoint rule misses too much of a tail that ends at the horizon as cos^-0.8; the table's own tests have
                    // another.
                    Shape::StudentT if d.tail() < 2.0 => continue,
                    _ => 4e-3,
                };
                for theta in [0.0f64, 0.7, 1.4, 1.55] {
                    let w = around_axis(0.1, theta.sin(), theta.cos());
                    let sum = hemisphere_sum(1000, 96, |h| d.density(h) * w.dot(h).max(0.0));
                    // sum = w.z/G₁ by the identity.
                    let figure = sum * smith_g1_over_cos(&d, w);
                    assert!((figure - 1.0).abs() < tolerance, "{d:?} {theta}: {figure}");
                }
            }
        }
    }
}
