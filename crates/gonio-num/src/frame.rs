//! [`Frame`], the local coordinates in which reflection functions are written.

use crate::{Real, Vec3};

/// A right-handed orthonormal frame: (s, t) span the tangent plane and n is the normal, local +z.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame<R> {
    /// Tangent, local +x.
    pub s: Vec3<R>,
    /// Bitangent, local +y.
    pub t: Vec3<R>,
    /// Normal, local +z.
    pub n: Vec3<R>,
}

impl<R: Real> Frame<R> {
    /// A frame around the unit normal `n`, continuous but for n.z = 0.
    ///
    /// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited", listing 3.
    #[inline(always)]
    pub fn from_normal(n: Vec3<R>) -> Self {
        let sign = R::one().copysign(n.z);
        let a = -(sign + n.z).recip();
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(R::one() + sign * n.x * n.x * a, sign * b, -(sign * n.x)),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// A frame whose s lies in the plane of the unit normal `n` and of `tangent` (Gram–Schmidt). Where `tangent` is
    /// zero or along n (its part across n is below 1e-6 of it), or its square overflows or vanishes in this type,
    /// [`Frame::from_normal`].
    #[inline(always)]
    pub fn from_normal_tangent(n: Vec3<R>, tangent: Vec3<R>) -> Self {
        let across = tangent - n * n.dot(tangent);
        let length2 = across.length_squared();
        let bad = length2.le(tangent.length_squared() * R::lit(1e-12));
        let s = across * length2.max(R::lit(1e-37)).sqrt().recip();
        // Next to n the difference above has lost its digits; a second pass restores the right angle (Kahan and Parlett:
        // "twice is enough").
        let s = s - n * n.dot(s);
        let s = s * s.length_squared().max(R::lit(1e-37)).sqrt().recip();
        let fallback = Self::from_normal(n);
        let s = Vec3::select(bad, fallback.s, s);
        Self {
            s,
            t: n.cross(s),
            n,
        }
    }

    /// World to local coordinates.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3<R>) -> Vec3<R> {
        Vec3::new(self.s.dot(v), self.t.dot(v), self.n.dot(v))
    }

    /// Local to world coordinates.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3<R>) -> Vec3<R> {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}
