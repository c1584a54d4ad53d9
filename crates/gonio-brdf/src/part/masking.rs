//! Masking and shadowing of microfacets.

use super::distribution::{Distribution, Shape};
use super::geometry::Half;
use gonio_num::{Real, Vec3};

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

/// (1 + Λ(w))·w.z of Smith's masking, that is w.z/G₁(w); positive and finite also at grazing w.
///
/// With m² = (αx w.x)² + (αy w.y)²:
///
/// - GGX: (√(w.z² + m²) + w.z)/2, exact
/// - Beckmann, and Blinn–Phong through the same α: w.z + m (1 − 1.259a + 0.396a²)/(3.535 + 2.181a), Walter's rational fit with
///   a = w.z/m, for a < 1.6, else w.z; within 0.4 % of the exact G₁
///
/// Source: Walter et al. 2007 eqs 27, 34; Heitz 2014 eqs 72, 80.
#[inline(always)]
pub fn cos_over_smith_g1<R: Real>(d: &Distribution<R>, w: Vec3<R>) -> R {
    let m2 = (d.alpha_x * w.x).sq() + (d.alpha_y * w.y).sq();
    match d.shape {
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
    }
}

/// G₁(w)/w.z of Smith's masking, finite also at grazing w for α > 0.
#[inline(always)]
pub fn smith_g1_over_cos<R: Real>(d: &Distribution<R>, w: Vec3<R>) -> R {
    cos_over_smith_g1(d, w).max(R::lit(1e-20)).recip()
}

/// G(ωi, ωr)/(4 cosθi cosθr), for directions above the horizon. Symmetric to the last bit.
///
/// V-cavities: G = min(1, 2 h.z ωr.z/cosθ′, 2 h.z ωi.z/cosθ′).
#[inline(always)]
pub fn visibility<R: Real>(
    masking: Masking,
    d: &Distribution<R>,
    wi: Vec3<R>,
    wo: Vec3<R>,
    half: &Half<R>,
) -> R {
    // D is at most 4/(π αx αy) ≤ 1.3e8: the product with this stays within single precision.
    let tiny = R::lit(1e-29);
    let quarter = R::lit(0.25);
    match masking {
        Masking::VCavity => {
            let groove = R::lit(2.0) * half.h.z * wi.z.min(wo.z);
            let g = R::one().min(groove / half.cos.max(R::lit(1e-15)));
            quarter * g / (wi.z * wo.z).max(tiny)
        }
        Masking::Smith => {
            let (i, o) = (cos_over_smith_g1(d, wi), cos_over_smith_g1(d, wo));
            quarter / (i * o).max(tiny)
        }
        Masking::SmithCorrelated => {
            // (1 + Λi + Λr) cosθi cosθr; what is subtracted is at most half of the sum.
            let (i, o) = (cos_over_smith_g1(d, wi), cos_over_smith_g1(d, wo));
            quarter / ((i * wo.z + o * wi.z) - wi.z * wo.z).max(tiny)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::distribution::tests::hemisphere_sum;
    use super::*;
    use gonio_radiometry::warp::around_axis;

    /// The visible-area identity: ∫ D(h) G₁(w) max(w·h, 0) dh = w.z. Midpoint rule over the slopes' tangent.
    #[test]
    fn visible_area() {
        for (shape, tolerance) in [(Shape::Ggx, 1e-4), (Shape::Beckmann, 4e-3)] {
            for (alpha_x, alpha_y) in [(0.3, 0.3), (0.8, 0.2)] {
                let d: Distribution<f64> = Distribution {
                    shape,
                    alpha_x,
                    alpha_y,
                };
                for theta in [0.0f64, 0.5, 1.0, 1.4, 1.55] {
                    let w = around_axis(0.1, theta.sin(), theta.cos());
                    let sum = hemisphere_sum(2000, 256, |h| d.density(h) * w.dot(h).max(0.0));
                    // sum = w.z/G₁ by the identity.
                    let figure = sum * smith_g1_over_cos(&d, w);
                    assert!((figure - 1.0).abs() < tolerance, "{d:?} {theta}: {figure}");
                }
            }
        }
    }
}
