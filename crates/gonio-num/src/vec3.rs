//! [`Vec3`], points and directions.

use crate::Real;
use std::ops::{Add, AddAssign, Div, Index, Mul, Neg, Sub};

/// A vector, point or direction in three dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[repr(C)]
pub struct Vec3<R> {
    /// First coordinate.
    pub x: R,
    /// Second coordinate.
    pub y: R,
    /// Third coordinate.
    pub z: R,
}

impl<R> Vec3<R> {
    /// The vector (x, y, z).
    #[inline(always)]
    pub const fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
}

impl<R: Real> Vec3<R> {
    /// (0, 0, 0).
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(R::zero())
    }
    /// (a, a, a).
    #[inline(always)]
    pub fn splat(a: R) -> Self {
        Self::new(a, a, a)
    }
    /// The coordinates as an array.
    #[inline(always)]
    pub fn to_array(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, o: Self) -> R {
        self.x * o.x + self.y * o.y + self.z * o.z
    }
    /// Vector product, right-handed.
    #[inline(always)]
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }
    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }
    /// Length.
    #[inline(always)]
    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }
    /// The vector scaled to length 1; not finite for a zero vector.
    #[inline(always)]
    pub fn normalize(self) -> Self {
        self * self.length().recip()
    }
    /// The mirror image of `self` about the unit vector `axis`, both leaving the same point: 2 (self·axis) axis − self.
    #[inline(always)]
    pub fn reflect(self, axis: Self) -> Self {
        axis * (R::lit(2.0) * self.dot(axis)) - self
    }
    /// Coordinate by coordinate product.
    #[inline(always)]
    pub fn mul_elementwise(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }
    /// Coordinate by coordinate minimum.
    #[inline(always)]
    pub fn min(self, o: Self) -> Self {
        Self::new(self.x.min(o.x), self.y.min(o.y), self.z.min(o.z))
    }
    /// Coordinate by coordinate maximum.
    #[inline(always)]
    pub fn max(self, o: Self) -> Self {
        Self::new(self.x.max(o.x), self.y.max(o.y), self.z.max(o.z))
    }
    /// `a` where the mask is true, `b` elsewhere.
    #[inline(always)]
    pub fn select(mask: R::Mask, a: Self, b: Self) -> Self {
        Self::new(
            R::select(mask, a.x, b.x),
            R::select(mask, a.y, b.y),
            R::select(mask, a.z, b.z),
        )
    }
    /// The constant vector `v`, rounded to this type.
    #[inline(always)]
    pub fn lit(v: Vec3<f64>) -> Self {
        Self::new(R::lit(v.x), R::lit(v.y), R::lit(v.z))
    }
}

impl Vec3<f32> {
    /// The same vector in double precision, exactly.
    #[inline(always)]
    pub fn to_f64(self) -> Vec3<f64> {
        Vec3::new(self.x.into(), self.y.into(), self.z.into())
    }
    /// Whether no coordinate is NaN or infinite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl Vec3<f64> {
    /// The same vector rounded to single precision.
    #[inline(always)]
    pub fn to_f32(self) -> Vec3<f32> {
        Vec3::new(self.x as f32, self.y as f32, self.z as f32)
    }
    /// Whether no coordinate is NaN or infinite.
    #[inline(always)]
    pub fn is_finite(self) -> bool {
        self.x.is_finite() && self.y.is_finite() && self.z.is_finite()
    }
}

impl<R> From<[R; 3]> for Vec3<R> {
    #[inline(always)]
    fn from([x, y, z]: [R; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<R> Index<usize> for Vec3<R> {
    type Output = R;
    /// Coordinate `i` of x, y, z.
    ///
    /// # Panics
    /// If i > 2.
    #[inline(always)]
    fn index(&self, i: usize) -> &R {
        match i {
            0 => &self.x,
            1 => &self.y,
            2 => &self.z,
            _ => panic!("a Vec3 has coordinates 0, 1 and 2, not {i}"),
        }
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl<R: Real> AddAssign for Vec3<R> {
    #[inline(always)]
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, a: R) -> Self {
        Self::new(self.x * a, self.y * a, self.z * a)
    }
}

impl<R: Real> Div<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, a: R) -> Self {
        Self::new(self.x / a, self.y / a, self.z / a)
    }
}

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}
