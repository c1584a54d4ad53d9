//! [`Surfaces`], what is known of many surface points, as structures of arrays.

use super::surface::{offset_origin, ray_to};
use super::{Geometry, Hit, Ray, SurfacePoint};
use gonio_num::{Vec3, Vectors, vectors::whole_steps};

/// Points of surfaces as [`SurfacePoint`] has them, without texture coordinates and colours.
#[derive(Debug, Clone, Default)]
pub struct Surfaces {
    /// [`SurfacePoint::p`].
    pub p: Vectors,
    /// [`SurfacePoint::error`].
    pub error: Vec<f32>,
    /// [`SurfacePoint::ng`].
    pub ng: Vectors,
    /// [`SurfacePoint::ns`].
    pub ns: Vectors,
    /// [`SurfacePoint::tangent`].
    pub tangent: Vectors,
}

impl Surfaces {
    /// Makes it `count` points.
    pub fn resize(&mut self, count: usize) {
        for v in [&mut self.p, &mut self.ng, &mut self.ns, &mut self.tangent] {
            v.resize(count);
        }
        self.error.resize(whole_steps(count), 0.0);
    }

    /// Puts a point at `i`.
    #[inline]
    pub fn set(&mut self, i: usize, point: &SurfacePoint) {
        self.p.set(i, point.p);
        self.ng.set(i, point.ng);
        self.ns.set(i, point.ns);
        self.tangent.set(i, point.tangent);
        self.error[i] = point.error;
    }

    /// [`SurfacePoint::offset_origin`] of point `i`.
    #[inline(always)]
    pub fn offset_origin(&self, i: usize, direction: Vec3<f32>) -> Vec3<f32> {
        offset_origin(self.p.get(i), self.ng.get(i), self.error[i], direction)
    }

    /// [`SurfacePoint::spawn_ray`] from point `i`.
    #[inline(always)]
    pub fn spawn_ray(&self, i: usize, direction: Vec3<f32>) -> Ray {
        Ray::new(self.offset_origin(i, direction), direction)
    }

    /// [`SurfacePoint::spawn_ray_to`] from point `i`.
    #[inline(always)]
    pub fn spawn_ray_to(&self, i: usize, target: Vec3<f32>) -> Ray {
        ray_to(self.offset_origin(i, target - self.p.get(i)), target)
    }
}

impl Geometry {
    /// [`Geometry::surface`] of many hits, the same to the bit.
    ///
    /// - `rays`: origins and directions
    /// - `order`: indices of rays; the point of ray `order[i]` is put at `i`
    /// - `hits`: one a ray
    ///
    /// # Panics
    /// If an index is out of range, or a hit isn't one of this geometry.
    pub fn surfaces(
        &self,
        rays: [&Vectors; 2],
        order: &[u32],
        hits: &[Hit],
        surfaces: &mut Surfaces,
    ) {
        surfaces.resize(order.len());
        for (i, &k) in order.iter().enumerate() {
            let k = k as usize;
            let ray = Ray::new(rays[0].get(k), rays[1].get(k));
            let point = self.surface(&ray, &hits[k]);
            surfaces.set(i, &point);
        }
    }
}
