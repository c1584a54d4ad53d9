//! [`Affine3`], the transforms between coordinate systems.

use crate::{Frame, Real, Vec3};

/// An affine map of three-dimensional space, p ↦ x·p.x + y·p.y + z·p.z + origin.
///
/// The four members are the columns of the 3 × 4 matrix: the images of the unit vectors and of the origin. Name a
/// transform after both sides, target first, as in `world_from_camera`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(C)]
pub struct Affine3<R> {
    /// Image of the vector (1, 0, 0).
    pub x: Vec3<R>,
    /// Image of the vector (0, 1, 0).
    pub y: Vec3<R>,
    /// Image of the vector (0, 0, 1).
    pub z: Vec3<R>,
    /// Image of the point (0, 0, 0).
    pub origin: Vec3<R>,
}

impl<R> Affine3<R> {
    /// The map with these columns.
    #[inline(always)]
    pub const fn from_columns(x: Vec3<R>, y: Vec3<R>, z: Vec3<R>, origin: Vec3<R>) -> Self {
        Self { x, y, z, origin }
    }
}

impl<R: Real> Affine3<R> {
    /// The map that leaves every point where it is.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::scale(Vec3::splat(R::one()))
    }

    /// p ↦ p + v.
    #[inline(always)]
    pub fn translation(v: Vec3<R>) -> Self {
        Self {
            origin: v,
            ..Self::identity()
        }
    }

    /// p ↦ (v.x p.x, v.y p.y, v.z p.z).
    #[inline(always)]
    pub fn scale(v: Vec3<R>) -> Self {
        let o = R::zero();
        Self::from_columns(
            Vec3::new(v.x, o, o),
            Vec3::new(o, v.y, o),
            Vec3::new(o, o, v.z),
            Vec3::zero(),
        )
    }

    /// The rotation by `angle` radians about the unit vector `axis` through the origin, right-handed: counter-clockwise
    /// for an onlooker whom the axis points at. Rodrigues' formula.
    #[inline(always)]
    pub fn rotation(axis: Vec3<R>, angle: R) -> Self {
        let (sin, cos) = angle.sin_cos();
        let (a, s) = (axis * (R::one() - cos), axis * sin);
        Self::from_columns(
            Vec3::new(a.x * axis.x + cos, a.x * axis.y + s.z, a.x * axis.z - s.y),
            Vec3::new(a.y * axis.x - s.z, a.y * axis.y + cos, a.y * axis.z + s.x),
            Vec3::new(a.z * axis.x + s.y, a.z * axis.y - s.x, a.z * axis.z + cos),
            Vec3::zero(),
        )
    }

    /// World from camera, for a camera at `eye` that looks at `target`: camera −z is the direction of view, +x points to
    /// the right of the picture, +y up in it, as near to `up` as can be.
    ///
    /// Where `up` is zero or along the direction of view (within 1e-6 rad), the picture's roll is [`Frame::from_normal`]'s.
    /// Not finite for `eye` = `target`.
    #[inline(always)]
    pub fn look_at(eye: Vec3<R>, target: Vec3<R>, up: Vec3<R>) -> Self {
        let back = (eye - target).normalize();
        let right = up.cross(back);
        let roll_known = right
            .length_squared()
            .gt(up.length_squared() * R::lit(1e-12));
        let right = Vec3::select(roll_known, right, Vec3::zero());
        let frame = Frame::from_normal_tangent(back, right);
        Self::from_columns(frame.s, frame.t, frame.n, eye)
    }

    /// The constant map `m`, rounded to this type.
    #[inline(always)]
    pub fn lit(m: Affine3<f64>) -> Self {
        Self::from_columns(
            Vec3::lit(m.x),
            Vec3::lit(m.y),
            Vec3::lit(m.z),
            Vec3::lit(m.origin),
        )
    }

    /// `self` first, then `outer`: p ↦ outer(self(p)).
    #[inline(always)]
    pub fn then(&self, outer: &Self) -> Self {
        Self::from_columns(
            outer.transform_vector(self.x),
            outer.transform_vector(self.y),
            outer.transform_vector(self.z),
            outer.transform_point(self.origin),
        )
    }

    /// The image of a point: rotated, scaled and moved.
    #[inline(always)]
    pub fn transform_point(&self, p: Vec3<R>) -> Vec3<R> {
        self.transform_vector(p) + self.origin
    }

    /// The image of a difference of points: rotated and scaled, not moved. Lengths change if the map scales.
    #[inline(always)]
    pub fn transform_vector(&self, v: Vec3<R>) -> Vec3<R> {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// The normal of the image of a surface whose normal is `n`: a positive multiple of the inverse transpose times `n`,
    /// **not** normalised. It stays on the image of the side it was on, under mirror images too.
    ///
    /// The cofactor matrix is used, so a map that flattens space onto a plane still has its normal.
    #[inline(always)]
    pub fn transform_normal(&self, n: Vec3<R>) -> Vec3<R> {
        // Scaled so that the products neither overflow nor vanish for very large or small maps.
        let scale = max_abs(self.x)
            .max(max_abs(self.y))
            .max(max_abs(self.z))
            .max(R::lit(1e-37))
            .recip();
        let (x, y, z) = (self.x * scale, self.y * scale, self.z * scale);
        let yz = y.cross(z);
        let cofactors = yz * n.x + z.cross(x) * n.y + x.cross(y) * n.z;
        let mirrored = x.dot(yz).lt(R::zero());
        Vec3::select(mirrored, -cofactors, cofactors)
    }

    /// The signed volume of the image of the unit cube; negative if the map mirrors.
    #[inline(always)]
    pub fn determinant(&self) -> R {
        self.x.dot(self.y.cross(self.z))
    }
}

impl<R: Real<Mask = bool>> Affine3<R> {
    /// The map that undoes this one; `None` if it is singular, that is if its columns, each scaled to a largest coordinate
    /// of 1, span a volume of no more than 8 units of rounding, or are not finite.
    pub fn inverse(&self) -> Option<Self> {
        // 4/3 is rounded to this type, so three times its excess misses 1 by the unit of rounding (Kahan).
        let epsilon = ((R::lit(4.0 / 3.0) - R::one()) * R::lit(3.0) - R::one()).abs();
        let (mx, my, mz) = (max_abs(self.x), max_abs(self.y), max_abs(self.z));
        let unit = Self::from_columns(self.x / mx, self.y / my, self.z / mz, self.origin);
        let yz = unit.y.cross(unit.z);
        let det = unit.x.dot(yz);
        // The comparison is false for a NaN, which zero and infinite columns lead to.
        if !det.abs().gt(R::lit(8.0) * epsilon) {
            return None;
        }
        let row_x = yz / det / mx;
        let row_y = unit.z.cross(unit.x) / det / my;
        let row_z = unit.x.cross(unit.y) / det / mz;
        let o = self.origin;
        Some(Self::from_columns(
            Vec3::new(row_x.x, row_y.x, row_z.x),
            Vec3::new(row_x.y, row_y.y, row_z.y),
            Vec3::new(row_x.z, row_y.z, row_z.z),
            -Vec3::new(row_x.dot(o), row_y.dot(o), row_z.dot(o)),
        ))
    }
}

impl Affine3<f32> {
    /// The same map in double precision, exactly.
    pub fn to_f64(self) -> Affine3<f64> {
        Affine3::from_columns(
            self.x.to_f64(),
            self.y.to_f64(),
            self.z.to_f64(),
            self.origin.to_f64(),
        )
    }
}

impl Affine3<f64> {
    /// The same map rounded to single precision.
    pub fn to_f32(self) -> Affine3<f32> {
        Affine3::lit(self)
    }
}

/// The largest of the coordinates' magnitudes.
#[inline(always)]
fn max_abs<R: Real>(v: Vec3<R>) -> R {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    type V = Vec3<f64>;

    fn close(a: V, b: V, tolerance: f64) -> bool {
        (a - b).length() <= tolerance * (1.0 + b.length())
    }

    fn vector(bound: f64) -> impl Strategy<Value = V> {
        [-bound..bound, -bound..bound, -bound..bound].prop_map(V::from)
    }

    #[test]
    fn rotation_is_right_handed() {
        let about_y = Affine3::<f64>::rotation(V::new(0.0, 1.0, 0.0), FRAC_PI_2);
        assert!(close(
            about_y.transform_vector(V::new(0.0, 0.0, 1.0)),
            V::new(1.0, 0.0, 0.0),
            1e-15
        ));
        let about_z = Affine3::<f64>::rotation(V::new(0.0, 0.0, 1.0), FRAC_PI_2);
        assert!(close(
            about_z.transform_vector(V::new(1.0, 0.0, 0.0)),
            V::new(0.0, 1.0, 0.0),
            1e-15
        ));
        let about_x = Affine3::<f64>::rotation(V::new(1.0, 0.0, 0.0), FRAC_PI_2);
        assert!(close(
            about_x.transform_vector(V::new(0.0, 1.0, 0.0)),
            V::new(0.0, 0.0, 1.0),
            1e-15
        ));
    }

    #[test]
    fn then_applies_self_first() {
        let move_x = Affine3::<f64>::translation(V::new(1.0, 0.0, 0.0));
        let double = Affine3::scale(V::splat(2.0));
        let p = move_x.then(&double).transform_point(V::zero());
        assert_eq!(p, V::new(2.0, 0.0, 0.0));
        let q = double.then(&move_x).transform_point(V::zero());
        assert_eq!(q, V::new(1.0, 0.0, 0.0));
    }

    #[test]
    fn look_at_sees_the_target_upright() {
        let (eye, target) = (V::new(1.0, 2.0, 5.0), V::new(1.0, 0.0, -1.0));
        let m = Affine3::look_at(eye, target, V::new(0.0, 1.0, 0.0));
        let seen = m.inverse().unwrap().transform_point(target);
        let distance = (target - eye).length();
        assert!(close(seen, V::new(0.0, 0.0, -distance), 1e-14));
        assert!(close(m.x, V::new(1.0, 0.0, 0.0), 1e-15));
        assert!(m.y.y > 0.0);
        assert!((m.determinant() - 1.0).abs() < 1e-14);
    }

    #[test]
    fn look_at_along_up_is_still_a_rotation() {
        for up in [V::new(0.0, 1.0, 0.0), V::new(0.0, -3.0, 0.0), V::zero()] {
            let m = Affine3::look_at(V::new(0.0, 4.0, 0.0), V::zero(), up);
            assert!((m.determinant() - 1.0).abs() < 1e-14, "{m:?}");
            assert!(close(m.z, V::new(0.0, 1.0, 0.0), 1e-15));
        }
    }

    #[test]
    fn singular_and_non_finite_maps_have_no_inverse() {
        let flat = Affine3::scale(V::new(1.0, 0.0, 1.0));
        assert_eq!(flat.inverse(), None);
        let columns = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0], [5.0, 7.0, 9.0]].map(V::from);
        let dependent = Affine3::from_columns(columns[0], columns[1], columns[2], V::zero());
        assert_eq!(dependent.inverse(), None);
        assert_eq!(dependent.to_f32().inverse(), None);
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(Affine3::scale(V::new(1.0, bad, 1.0)).inverse(), None);
        }
    }

    #[test]
    fn very_small_and_large_maps_are_inverted() {
        for s in [1e-25f32, 1e25] {
            let back = Affine3::scale(Vec3::splat(s)).inverse().unwrap();
            assert_eq!(back.x.x, 1.0 / s);
            let n = Affine3::scale(Vec3::splat(s)).transform_normal(Vec3::new(0.0, 0.6, 0.8));
            assert!((n.length() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn normals_follow_the_surface() {
        // The plane x + y = 1, stretched by 2 along x, is x/2 + y = 1.
        let n = Affine3::scale(V::new(2.0, 1.0, 1.0)).transform_normal(V::new(1.0, 1.0, 0.0));
        assert!(close(
            n.normalize(),
            V::new(0.5, 1.0, 0.0).normalize(),
            1e-15
        ));
        // A mirror image takes the outer side to the outer side.
        let mirrored = Affine3::scale(V::new(-1.0, 1.0, 1.0));
        assert_eq!(
            mirrored
                .transform_normal(V::new(1.0, 0.0, 0.0))
                .normalize()
                .x,
            -1.0
        );
        assert_eq!(
            mirrored
                .transform_normal(V::new(0.0, 1.0, 0.0))
                .normalize()
                .y,
            1.0
        );
        // Flattened onto z = 0, everything faces along z.
        let flat = Affine3::scale(V::new(1.0, 1.0, 0.0));
        assert_eq!(
            flat.transform_normal(V::new(0.1, 0.2, 0.9)).normalize(),
            V::new(0.0, 0.0, 1.0)
        );
    }

    proptest! {
        #[test]
        fn inverse_undoes(
            axis in vector(1.0), angle in -PI..PI, s in [0.1..10.0, 0.1..10.0, 0.1..10.0],
            t in vector(100.0), p in vector(100.0), v in vector(1.0), n in vector(1.0),
        ) {
            prop_assume!(axis.length() > 0.1);
            let m = Affine3::scale(V::from(s))
                .then(&Affine3::rotation(axis.normalize(), angle))
                .then(&Affine3::translation(t));
            let inverse = m.inverse().unwrap();
            prop_assert!(close(inverse.transform_point(m.transform_point(p)), p, 1e-12));
            prop_assert!(close(m.transform_point(inverse.transform_point(p)), p, 1e-12));
            prop_assert!((m.determinant() - s[0] * s[1] * s[2]).abs() < 1e-10);
            // What is tangent stays tangent, and the side is kept: (M⁻ᵀ n)·(M v) = c n·v with c > 0.
            let c = m.determinant().abs() / [m.x, m.y, m.z].iter().map(|a| max_abs(*a)).fold(0.0, f64::max).powi(3);
            // M/scale has determinant c and M v is scale times larger, hence the product.
            let scale = (m.determinant().abs() / c).cbrt();
            let lhs = m.transform_normal(n).dot(m.transform_vector(v)) / scale;
            prop_assert!((lhs - c * n.dot(v)).abs() < 1e-10, "{lhs} {}", c * n.dot(v));
        }

        #[test]
        fn rotations_keep_lengths(axis in vector(1.0), angle in -10.0..10.0, v in vector(1.0)) {
            prop_assume!(axis.length() > 0.1);
            let m = Affine3::rotation(axis.normalize(), angle);
            prop_assert!((m.transform_vector(v).length() - v.length()).abs() < 1e-14);
            prop_assert!((m.determinant() - 1.0).abs() < 1e-14);
            prop_assert!(close(m.transform_vector(axis), axis, 1e-14));
        }
    }
}
