//! [`Clearcoat`], the second specular lobe of Disney's principled model.

use super::fresnel::schlick;
use super::geometry::{Half, mirrored_about};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::around_axis;
use std::f64::consts::PI;

/// ¼ F D G/(4 cosθi cosθr), isotropic: F of index 1.5 by Schlick, G Smith's of GGX with α = 0.25, and the distribution GTR with γ = 1,
///
/// D(h) = (α² − 1)/(π ln α² (1 + (α² − 1) cos²θh)),
///
/// which is drawn as D cosθh. Source: Burley 2012, §5.6 and eqs 4, 5.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Clearcoat<R> {
    alpha2: R,
    /// −ln α².
    log: R,
}

/// F₀ of an index of 1.5.
const F0: f64 = 0.04;

impl<R: Real> Clearcoat<R> {
    /// Of `gloss` in [0, 1]: α from 0.1 to 0.001.
    pub fn new(gloss: R) -> Self {
        let alpha = gloss.lerp(R::lit(0.1), R::lit(0.001));
        let alpha2 = alpha * alpha;
        Self {
            alpha2,
            log: -alpha2.ln(),
        }
    }

    pub fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Clearcoat<S> {
        Clearcoat {
            alpha2: f(self.alpha2),
            log: f(self.log),
        }
    }

    /// D(h).
    #[inline(always)]
    fn distribution(&self, h: Vec3<R>) -> R {
        let sin2 = h.x * h.x + h.y * h.y;
        let spread = self.alpha2 * h.z * h.z + sin2;
        (R::one() - self.alpha2) / (R::lit(PI) * self.log * spread)
    }

    /// The lobe, for directions above the horizon.
    #[inline(always)]
    pub fn value(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>) -> R {
        let g = area(wi.z) * area(wo.z);
        let f = schlick(half.cos, R::lit(F0), R::one());
        R::lit(0.25) * f * self.distribution(half.h()) / g.max(R::lit(1e-20))
    }

    /// About what it reflects.
    #[inline(always)]
    pub fn albedo(&self, cos: R) -> R {
        R::lit(0.25) * schlick(cos, R::lit(F0), R::one())
    }

    /// Density of the directions of [`Clearcoat::sample`] in sr⁻¹.
    #[inline(always)]
    pub fn density(&self, half: &Half<R>) -> R {
        let d = self.distribution(half.h()) * half.h().z;
        R::lit(0.25) * d / half.cos.max(R::lit(1e-15))
    }

    /// A direction mirrored about a normal of density D(h) cosθh.
    #[inline(always)]
    pub fn sample(&self, wo: Vec3<R>, u: [R; 2]) -> Vec3<R> {
        // sin²θh = α² (α^(−2u) − 1)/(1 − α²).
        let grown = (self.log * u[1]).exp() - R::one();
        let sin2 = (self.alpha2 * grown / (R::one() - self.alpha2)).saturate();
        let h = around_axis(u[0], sin2.safe_sqrt(), (R::one() - sin2).safe_sqrt());
        mirrored_about(wo, h)
    }
}

/// 2 cosθ/G₁ of GGX with α = 0.25: cosθ + √(α² + (1 − α²) cos²θ).
#[inline(always)]
fn area<R: Real>(cos: R) -> R {
    let a2 = R::lit(0.0625);
    cos + (a2 + (R::one() - a2) * cos * cos).sqrt()
}
