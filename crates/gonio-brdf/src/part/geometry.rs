//! Directions of the local frame: horizon, half vector, cosine-distributed directions.

use gonio_num::{Real, Vec3};

/// Whether both directions are above the horizon.
#[inline(always)]
pub fn above<R: Real>(wi: Vec3<R>, wo: Vec3<R>) -> R::Mask {
    wi.z.gt(R::zero()) & wo.z.gt(R::zero())
}

/// The half vector of two directions and the angle that it makes with either.
#[derive(Debug, Clone, Copy)]
pub struct Half<R> {
    /// (ωi + ωr) / |ωi + ωr|, unit.
    pub h: Vec3<R>,
    /// cosθ′ = ωi·h = ωr·h, in (0, 1].
    pub cos: R,
}

impl<R: Real> Half<R> {
    /// The half vector of two unit directions above the horizon.
    ///
    /// As ωi·h = |ωi + ωr| / 2, the cosine is computed from the length: symmetric in the two directions to the last bit, which
    /// makes reflection functions reciprocal to the last bit.
    #[inline(always)]
    pub fn new(wi: Vec3<R>, wo: Vec3<R>) -> Self {
        let sum = wi + wo;
        let length2 = sum.length_squared();
        let length = length2.max(R::lit(1e-30)).sqrt();
        // Opposite and both grazing to 1e-15: any half vector is as good as another.
        let lost = length2.lt(R::lit(1e-30));
        let up = Vec3::new(R::zero(), R::zero(), R::one());
        Self {
            h: Vec3::select(lost, up, sum * length.recip()),
            cos: (length * R::lit(0.5)).min(R::one()),
        }
    }
}

/// The cosine between `wi` and the mirror image of `wo` about the normal; symmetric in the two.
#[inline(always)]
pub fn mirror_cosine<R: Real>(wi: Vec3<R>, wo: Vec3<R>) -> R {
    wi.z * wo.z - (wi.x * wo.x + wi.y * wo.y)
}

/// `wo` mirrored about the normal.
#[inline(always)]
pub fn mirrored<R: Real>(wo: Vec3<R>) -> Vec3<R> {
    Vec3::new(-wo.x, -wo.y, wo.z)
}

/// A direction of the upper hemisphere with density cosθ/π, from a point in the unit square.
///
/// θ = asin √u₁, φ = 2π u₀ (Malley's method in polar form).
#[inline(always)]
pub fn cosine_hemisphere<R: Real>(u0: R, u1: R) -> Vec3<R> {
    polar((R::one() - u1).safe_sqrt(), u1.safe_sqrt(), u0)
}

/// Density of [`cosine_hemisphere`]: max(z, 0)/π.
#[inline(always)]
pub fn cosine_density<R: Real>(w: Vec3<R>) -> R {
    w.z.max(R::zero()) * R::lit(std::f64::consts::FRAC_1_PI)
}

/// The direction with the given cosine and sine of θ and φ = 2π·turn.
#[inline(always)]
pub fn polar<R: Real>(cos: R, sin: R, turn: R) -> Vec3<R> {
    let (s, c) = (turn * R::lit(std::f64::consts::TAU)).sin_cos();
    Vec3::new(sin * c, sin * s, cos)
}

/// `v` turned about the normal by the angle with the given cosine and sine.
#[inline(always)]
pub fn turned<R: Real>(v: Vec3<R>, cos: R, sin: R) -> Vec3<R> {
    Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

/// √(x² + y²), the sine of θ of a unit vector.
#[inline(always)]
pub fn sin_theta<R: Real>(v: Vec3<R>) -> R {
    (v.x * v.x + v.y * v.y).safe_sqrt()
}
