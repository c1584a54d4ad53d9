//! [`FacetPair`], two directions on either side of a rough boundary and the facet that takes light from one to the other.

use super::fresnel::dielectric_cosines;
use super::geometry::{Half, flipped_where, refracted_about};
use super::masking::{visibility_across, visibility_from_areas};
use super::rough::RoughSurface;
use gonio_num::{Real, Vec3};

/// What evaluation and density share for one pair of directions, in the frame of (αx, αy).
///
/// With n the index of refraction of the side that a direction is on, the facet's normal h is ∝ n_i ωi + n_r ωr: by it light is
/// reflected (both on one side) or refracted. Source: Walter et al. 2007, eqs 13 and 16.
pub(crate) struct FacetPair<R: Real> {
    /// The directions wi and wo on the outer side.
    pub up: [Vec3<R>; 2],
    /// 1 for each that is in the body, else 0.
    pub inside: [R; 2],
    /// Index of refraction on the side of each.
    pub n: [R; 2],
    /// The facet's normal, on the outer side.
    pub h: Vec3<R>,
    /// 1/|n_i ωi + n_r ωr|², of a refracted pair.
    over_length2: R,
    /// ω·h of each.
    pub cos: [R; 2],
    /// D(h).
    pub d: R,
}

impl<R: Real> FacetPair<R> {
    /// Of two directions in the local frame; `ior` is the index of the inner side over that of the outer.
    #[inline(always)]
    pub fn new(surface: &RoughSurface<R>, ior: R, wi: Vec3<R>, wo: Vec3<R>) -> Self {
        let w = [surface.into_axes(wi), surface.into_axes(wo)];
        let one = R::one();
        let below = [w[0].z.lt(R::zero()), w[1].z.lt(R::zero())];
        let n = [R::select(below[0], ior, one), R::select(below[1], ior, one)];
        // Of a reflected pair the index is a common factor: products with it would be rounded, and of a small sum few digits be left.
        let weight = [
            R::select(below[0] & !below[1], ior, one),
            R::select(below[1] & !below[0], ior, one),
        ];
        // Symmetric in the directions to the last bit, which makes f reciprocal where their sum is small.
        let sum = w[0] * weight[0] + w[1] * weight[1];
        let length2 = sum.length_squared();
        // Opposite and both grazing, on one side: any half vector is as good as another.
        let lost = length2.lt(R::lit(1e-30));
        let length2 = length2.max(R::lit(1e-30));
        let over = length2.sqrt().recip();
        let h = sum * R::select(sum.z.lt(R::zero()), -over, over);
        let h = Vec3::select(lost, Vec3::new(R::zero(), R::zero(), one), h);
        Self {
            up: [flipped_where(below[0], w[0]), flipped_where(below[1], w[1])],
            inside: [R::from_mask(below[0]), R::from_mask(below[1])],
            n,
            h,
            over_length2: over * over,
            cos: [w[0].dot(h), w[1].dot(h)],
            d: surface.distribution.density_of(&Half::of(h, R::one())),
        }
    }

    /// Whether both lie on one side of the surface.
    #[inline(always)]
    pub fn reflects(&self) -> R::Mask {
        (self.inside[0] - self.inside[1]).abs().lt(R::lit(0.5))
    }

    /// Whether neither lies along the horizon.
    #[inline(always)]
    pub fn off_horizon(&self) -> R::Mask {
        self.up[0].z.gt(R::zero()) & self.up[1].z.gt(R::zero())
    }

    /// Whether both directions are off the horizon, and each sees the front of the facet from its side.
    #[inline(always)]
    pub fn valid(&self) -> R::Mask {
        let sign = R::lit(-2.0);
        let faces = [
            (self.cos[0] * (sign * self.inside[0] + R::one())).gt(R::zero()),
            (self.cos[1] * (sign * self.inside[1] + R::one())).gt(R::zero()),
        ];
        self.off_horizon() & faces[0] & faces[1]
    }

    /// The cosine that a reflected pair makes with its facet: the same for both orders of the directions.
    #[inline(always)]
    pub fn reflected_cosine(&self) -> R {
        ((self.cos[0].abs() + self.cos[1].abs()) * R::lit(0.5)).min(R::one())
    }

    /// Fresnel reflectance at the pair's facet, for a reflected or a refracted pair.
    #[inline(always)]
    pub fn fresnel(&self, ior: R) -> R {
        let in_body = [
            self.inside[0].gt(R::lit(0.5)),
            self.inside[1].gt(R::lit(0.5)),
        ];
        let reflects = self.reflects();
        // Of a reflected pair one cosine is known, and Snell's law gives that on the other side: outside cos²θ = η²cos² − (η² − 1), inside
        // (cos² + η² − 1)/η².
        let cos = self.reflected_cosine();
        let (n2, contrast) = (ior * ior, (ior - R::one()) * (ior + R::one()));
        let outside = n2 * cos * cos - contrast;
        let inside = (cos * cos + contrast) / n2;
        let far2 = R::select(in_body[1], outside, inside);
        let far = far2.max(R::lit(1e-20)).sqrt();
        // Of a refracted pair both are: the same for both orders of the directions.
        let [ci, co] = [self.cos[0].abs(), self.cos[1].abs()];
        let outer = R::select(in_body[0], co, ci);
        let inner = R::select(in_body[0], ci, co);
        let outer = R::select(reflects, R::select(in_body[1], far, cos), outer);
        let inner = R::select(reflects, R::select(in_body[1], cos, far), inner);
        let total = reflects & far2.le(R::zero());
        R::select(total, R::one(), dielectric_cosines(outer, inner, ior))
    }

    /// f of a reflected pair where F = 1: D G/(4 |cosθi cosθr|).
    #[inline(always)]
    pub fn reflection(&self, surface: &RoughSurface<R>) -> R {
        let [i, o] = self.up;
        self.d * visibility_from_areas(surface.masking, &surface.distribution, i, o)
    }

    /// f of a refracted pair where F = 0: D G |ωi·h| |ωr·h| n_r²/(|cosθi cosθr| (n_i ωi·h + n_r ωr·h)²) (eq. 21).
    #[inline(always)]
    pub fn refraction(&self, surface: &RoughSurface<R>) -> R {
        let [i, o] = self.up;
        let across = visibility_across(surface.masking, &surface.distribution, i, o);
        let n2 = self.n[1] * self.n[1];
        R::lit(4.0)
            * self.d
            * across
            * self.cos[0].abs()
            * self.cos[1].abs()
            * (n2 * self.over_length2)
    }

    /// Density in sr⁻¹ of wi, given wo, where facets are drawn by [`RoughSurface::sample_normal`]: as a pair that is reflected with the
    /// probability `p` and refracted with 1 − `p`.
    #[inline(always)]
    pub fn density(&self, surface: &RoughSurface<R>, p: R) -> R {
        let co = self.cos[1].abs();
        let half = Half::of(self.h, co);
        let over_cos = surface.normal_density_over_cos(&half, self.d, self.up[1]);
        let reflected = R::lit(0.25) * over_cos * p;
        let n2 = self.n[0] * self.n[0];
        let through = over_cos * co * (R::one() - p) * self.cos[0].abs() * (n2 * self.over_length2);
        R::select(self.reflects(), reflected, through)
    }
}

/// A facet that was drawn for a viewer.
pub(crate) struct DrawnFacet<R: Real> {
    /// The viewer's direction on the outer side, in the frame of (αx, αy).
    pub wo: Vec3<R>,
    /// Whether the viewer is in the body.
    pub inside: R::Mask,
    /// The facet's normal, on the outer side.
    pub h: Vec3<R>,
    /// Cosine between the two, [0, 1].
    pub cos: R,
    /// Whether the viewer sees its front.
    seen: R::Mask,
}

impl<R: Real> DrawnFacet<R> {
    /// Drawn by [`RoughSurface::sample_normal`].
    #[inline(always)]
    pub fn new(surface: &RoughSurface<R>, wo: Vec3<R>, u: [R; 2]) -> Self {
        let inside = wo.z.lt(R::zero());
        let o = flipped_where(inside, surface.into_axes(wo));
        let h = surface.sample_normal(o, u[0], u[1]);
        let cos = o.dot(h);
        Self {
            wo: o,
            inside,
            h,
            cos: cos.clamp(R::zero(), R::one()),
            seen: cos.gt(R::zero()),
        }
    }

    /// Where the facet sends light: reflected or refracted, as if the viewer stood on the outer side, in the frame of (αx, αy). A direction
    /// along the horizon where it would not leave on the right side.
    #[inline(always)]
    pub fn leaving(&self, ior: R, reflects: R::Mask) -> Vec3<R> {
        let up = self.wo.reflect(self.h);
        // Index of the own side over that of the opposite one.
        let ratio = R::select(self.inside, ior, ior.recip());
        let down = refracted_about(self.wo, self.h, self.cos, ratio);
        let facet = Vec3::select(reflects, up, down);
        let right = R::select(reflects, up.z, -down.z).gt(R::zero()) & self.seen;
        let along = Vec3::new(R::one(), R::zero(), R::zero());
        Vec3::select(right, facet, along)
    }
}
