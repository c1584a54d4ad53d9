//! [`Aabb`], boxes along the axes.

use gonio_num::{Affine3, Vec3};

/// A box along the axes: the points p with min ≤ p ≤ max in each coordinate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// The lowest coordinates.
    pub min: Vec3<f32>,
    /// The highest coordinates.
    pub max: Vec3<f32>,
}

impl Default for Aabb {
    fn default() -> Self {
        Self::empty()
    }
}

impl Aabb {
    /// The box of nothing: min = +∞, max = −∞. The neutral element of [`Aabb::union`].
    pub const fn empty() -> Self {
        let (a, b) = (f32::INFINITY, f32::NEG_INFINITY);
        Self {
            min: Vec3::new(a, a, a),
            max: Vec3::new(b, b, b),
        }
    }

    /// The smallest box around some points; empty without any.
    pub fn around(points: impl IntoIterator<Item = Vec3<f32>>) -> Self {
        points
            .into_iter()
            .fold(Self::empty(), |b, p| b.including(p))
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        self.min.x > self.max.x || self.min.y > self.max.y || self.min.z > self.max.z
    }

    /// The smallest box around this one and a point.
    pub fn including(&self, p: Vec3<f32>) -> Self {
        Self {
            min: self.min.min(p),
            max: self.max.max(p),
        }
    }

    /// The largest distance along an axis from a point to a corner.
    #[inline(always)]
    pub(crate) fn reach(&self, from: Vec3<f32>) -> f32 {
        let (low, high, o) = (self.min.to_array(), self.max.to_array(), from.to_array());
        let mut reach = 0.0f32;
        for axis in 0..3 {
            let r = (low[axis] - o[axis])
                .abs()
                .max((high[axis] - o[axis]).abs());
            reach = reach.max(r);
        }
        reach
    }

    /// The smallest box around both.
    pub fn union(&self, o: &Self) -> Self {
        Self {
            min: self.min.min(o.min),
            max: self.max.max(o.max),
        }
    }

    /// The middle; not finite if empty.
    pub fn centre(&self) -> Vec3<f32> {
        (self.min + self.max) * 0.5
    }

    /// The vector from min to max.
    pub fn diagonal(&self) -> Vec3<f32> {
        self.max - self.min
    }

    /// Radius of the sphere around the centre that holds the box; 0 if empty.
    pub fn radius(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        self.diagonal().length() * 0.5
    }

    /// Area of the six sides; 0 if empty.
    pub fn area(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let d = self.diagonal();
        2.0 * (d.x * d.y + d.y * d.z + d.z * d.x)
    }

    /// The eight corners.
    pub fn corners(&self) -> [Vec3<f32>; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, a: f32, b: f32| if i & bit == 0 { a } else { b };
            Vec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            )
        })
    }

    /// The largest magnitude of a coordinate; 0 if empty.
    pub(crate) fn magnitude(&self) -> f32 {
        if self.is_empty() {
            return 0.0;
        }
        let m = |a: f32, b: f32| a.abs().max(b.abs());
        m(self.min.x, self.max.x)
            .max(m(self.min.y, self.max.y))
            .max(m(self.min.z, self.max.z))
    }

    /// The box moved outwards by `pad` on each side.
    pub(crate) fn padded(&self, pad: f32) -> Self {
        let v = Vec3::splat(pad);
        Self {
            min: self.min - v,
            max: self.max + v,
        }
    }

    /// A box around the image of this one.
    pub(crate) fn transformed(&self, m: &Affine3<f64>) -> Self {
        if self.is_empty() {
            return *self;
        }
        Self::around(
            self.corners()
                .map(|p| m.transform_point(p.to_f64()).to_f32()),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_neutral() {
        let e = Aabb::empty();
        assert!(e.is_empty() && e.area() == 0.0 && e.radius() == 0.0);
        let b = Aabb::around([Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 4.0, 3.0)]);
        assert_eq!(e.union(&b), b);
        assert!(!b.is_empty());
        assert_eq!(b.centre(), Vec3::new(0.0, 3.0, 3.0));
        assert_eq!(b.area(), 8.0);
        assert_eq!(b.magnitude(), 4.0);
    }

    #[test]
    fn a_turned_box_holds_its_corners() {
        let b = Aabb::around([Vec3::new(-1.0, -2.0, -3.0), Vec3::new(1.0, 2.0, 3.0)]);
        let m = Affine3::rotation(Vec3::new(0.0, 0.0, 1.0), std::f64::consts::FRAC_PI_2);
        let t = b.transformed(&m);
        assert!((t.max.x - 2.0).abs() < 1e-6 && (t.max.y - 1.0).abs() < 1e-6);
    }
}
