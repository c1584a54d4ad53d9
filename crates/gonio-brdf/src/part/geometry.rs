//! Directions of the local frame: horizon, half vector, mirror images.

use gonio_num::{Real, Vec3};

/// Whether both directions are above the horizon.
#[inline(always)]
pub fn above<R: Real>(wi: Vec3<R>, wo: Vec3<R>) -> R::Mask {
    wi.z.gt(R::zero()) & wo.z.gt(R::zero())
}

/// The half vector of two directions and the angle that it makes with either.
#[derive(Debug, Clone, Copy)]
pub struct Half<R> {
    /// ωi + ωr, or anything along it.
    pub sum: Vec3<R>,
    /// |sum|².
    pub length2: R,
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
        Self {
            sum,
            length2,
            cos: (length2.max(R::lit(1e-30)).sqrt() * R::lit(0.5)).min(R::one()),
        }
    }

    /// Of a unit half vector.
    #[inline(always)]
    pub fn of(h: Vec3<R>, cos: R) -> Self {
        Self {
            sum: h,
            length2: R::one(),
            cos,
        }
    }

    /// h = (ωi + ωr) / |ωi + ωr|, unit.
    #[inline(always)]
    pub fn h(&self) -> Vec3<R> {
        let length2 = self.length2.max(R::lit(1e-30));
        // Opposite and both grazing to 1e-15: any half vector is as good as another.
        let lost = self.length2.lt(R::lit(1e-30));
        let up = Vec3::new(R::zero(), R::zero(), R::one());
        Vec3::select(lost, up, self.sum * length2.sqrt().recip())
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

/// `wo` mirrored about the half vector `h`; −z, which is no direction to the light, where `h` is turned away from `wo`.
#[inline(always)]
pub fn mirrored_about<R: Real>(wo: Vec3<R>, h: Vec3<R>) -> Vec3<R> {
    let down = Vec3::new(R::zero(), R::zero(), -R::one());
    Vec3::select(wo.dot(h).gt(R::zero()), wo.reflect(h), down)
}

/// `wo` refracted at a facet with normal `h` on its side, from a medium of index n_o into one of index n_i on the other side;
/// Snell's law. A vector of length 1 also beyond the critical angle, where it has no meaning: it then lies in the facet's plane.
///
/// - `cos`: wo·h, in [0, 1]
/// - `ratio`: n_o/n_i
#[inline(always)]
pub fn refracted_about<R: Real>(wo: Vec3<R>, h: Vec3<R>, cos: R, ratio: R) -> Vec3<R> {
    let sin2 = (R::one() - cos * cos).max(R::zero()) * ratio * ratio;
    let cos_t = (R::one() - sin2).safe_sqrt();
    let t = h * (ratio * cos - cos_t) - wo * ratio;
    Vec3::select(sin2.lt(R::one()), t, t.normalize())
}

/// `v` on the other side of the surface where the mask is true.
#[inline(always)]
pub fn flipped_where<R: Real>(mask: R::Mask, v: Vec3<R>) -> Vec3<R> {
    Vec3::new(v.x, v.y, R::select(mask, -v.z, v.z))
}

/// `v` turned about the normal by the angle with the given cosine and sine.
#[inline(always)]
pub fn turned<R: Real>(v: Vec3<R>, cos: R, sin: R) -> Vec3<R> {
    Vec3::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y, v.z)
}

/// Cosine and sine of the azimuth of `v`; (1, 0) on the normal.
#[inline(always)]
pub fn azimuth<R: Real>(v: Vec3<R>) -> [R; 2] {
    let tiny = R::lit(1e-30);
    let length2 = v.x * v.x + v.y * v.y;
    let over = length2.max(tiny).sqrt().recip();
    let lost = length2.lt(tiny);
    [
        R::select(lost, R::one(), v.x * over),
        R::select(lost, R::zero(), v.y * over),
    ]
}

/// √(x² + y²), the sine of θ of a unit vector.
#[inline(always)]
pub fn sin_theta<R: Real>(v: Vec3<R>) -> R {
    (v.x * v.x + v.y * v.y).safe_sqrt()
}
