//! [`Ray`] and [`Hit`], the question and the answer of a ray query.

use gonio_num::Vec3;

/// The points origin + t · direction for t in (0, t_max).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts \[m\].
    pub origin: Vec3<f32>,
    /// Where it goes; unit length, so that t is a distance. Other lengths are answered too: t counts in them.
    pub direction: Vec3<f32>,
    /// Where it ends, itself excluded; may be infinite.
    pub t_max: f32,
}

impl Ray {
    /// The endless ray.
    #[inline]
    pub fn new(origin: Vec3<f32>, direction: Vec3<f32>) -> Self {
        Self {
            origin,
            direction,
            t_max: f32::INFINITY,
        }
    }

    /// The point origin + t · direction.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3<f32> {
        self.origin + self.direction * t
    }

    /// Whether the ray asks anything: origin and direction are finite, the direction isn't zero and t_max > 0. Other rays
    /// hit nothing.
    #[inline(always)]
    pub fn is_valid(&self) -> bool {
        let d = self.direction;
        self.origin.is_finite()
            && d.is_finite()
            && (d.x != 0.0 || d.y != 0.0 || d.z != 0.0)
            && self.t_max > 0.0
    }
}

/// The nearest surface along a ray.
///
/// Of surfaces at exactly the same t the one with the lowest (instance, primitive) answers, so that a hit doesn't depend on
/// how the search was organised.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction, in (0, t_max).
    pub t: f32,
    /// Index of the instance.
    pub instance: u32,
    /// Index of the triangle in its mesh; 0 for the other shapes.
    pub primitive: u32,
    /// Triangle: barycentric weight of the second vertex, in \[0, 1\]. Rectangle and disk: x in object space. Sphere: 0.
    pub u: f32,
    /// Triangle: barycentric weight of the third vertex, in \[0, 1\]. Rectangle and disk: y in object space. Sphere: 0.
    pub v: f32,
}
