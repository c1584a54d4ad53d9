//! [`Shape`] and [`Instance`], and where a ray meets the shapes that aren't meshes.

use super::Aabb;
use crate::mesh::TriangleMesh;
use gonio_num::{Affine3, Vec3};
use std::sync::Arc;

/// A surface in its own coordinates.
#[derive(Debug, Clone)]
pub enum Shape {
    /// Triangles. Shapes of the same mesh share one tree.
    Mesh(Arc<TriangleMesh>),
    /// The unit sphere around the origin, outward normals. u = φ/2π and v = θ/π in the spherical coordinates around +z, so
    /// v is 0 at +z. Tangent along growing φ.
    Sphere,
    /// The square \[−1, 1\]² in the plane z = 0, normal +z, tangent +x; u = (x + 1)/2, v = (1 − y)/2.
    Rectangle,
    /// The unit disk in the plane z = 0, normal +z, tangent +x; u = (x + 1)/2, v = (1 − y)/2.
    Disk,
}

/// A shape placed in the world.
///
/// Any invertible map will do: a sphere becomes an ellipsoid. Under a map that mirrors (negative determinant) the outside
/// stays outside: as glTF 2.0 section 3.7.4 demands, the winding of triangles is then clockwise in the world.
#[derive(Debug, Clone)]
pub struct Instance {
    /// Index of the shape.
    pub shape: u32,
    /// From the shape's coordinates to the world's.
    pub to_world: Affine3<f32>,
    /// Index of the material.
    pub material: u32,
    /// Index of the area light that it is, if any.
    pub area_light: Option<u32>,
}

/// Where a ray meets the unit sphere first, t > 0.
///
/// t² d·d + 2 t o·d + o·o − 1 = 0, with the discriminant from the part of o across d, and the smaller root by
/// multiplication: nothing cancels (Haines et al. 2019, Ray Tracing Gems, chapter 7).
#[inline(always)]
pub(crate) fn cross_sphere(o: Vec3<f64>, d: Vec3<f64>, t_max: f32) -> Option<f32> {
    let a = d.dot(d);
    let b = -o.dot(d);
    let c = o.dot(o) - 1.0;
    let across = o + d * (b / a);
    let discriminant = 1.0 - across.dot(across);
    if discriminant < 0.0 {
        return None;
    }
    let root = (a * discriminant).sqrt();
    let q = if b < 0.0 { b - root } else { b + root };
    let (r0, r1) = (c / q, q / a);
    let (first, second) = if r0 < r1 { (r0, r1) } else { (r1, r0) };
    // Each is false for NaN, which a ray along a tangent that starts at its point leads to.
    let inside = |t: f64| t as f32 > 0.0 && (t as f32) < t_max;
    if inside(first) {
        Some(first as f32)
    } else if first <= 0.0 && inside(second) {
        Some(second as f32)
    } else {
        None
    }
}

/// Where a ray meets the plane z = 0: (t, x, y), t > 0.
#[inline(always)]
pub(crate) fn cross_plane(o: Vec3<f64>, d: Vec3<f64>) -> Option<(f32, f64, f64)> {
    let t = -o.z / d.z;
    let near = t as f32;
    (near > 0.0 && near < f32::INFINITY).then_some((near, o.x + t * d.x, o.y + t * d.y))
}

impl Shape {
    /// The box in the shape's own coordinates.
    pub(crate) fn bounds(&self) -> Aabb {
        let (one, flat) = (Vec3::new(1.0, 1.0, 1.0), Vec3::new(1.0, 1.0, 0.0));
        match self {
            Self::Mesh(mesh) => Aabb::around(
                mesh.indices
                    .iter()
                    .flatten()
                    .map(|&i| mesh.positions[i as usize]),
            ),
            Self::Sphere => Aabb::around([-one, one]),
            Self::Rectangle | Self::Disk => Aabb::around([-flat, flat]),
        }
    }

    /// The box in the world, tight for all but meshes.
    pub(crate) fn world_bounds(&self, own: &Aabb, m: &Affine3<f64>) -> Aabb {
        let columns: &[Vec3<f64>] = match self {
            Self::Sphere => &[m.x, m.y, m.z],
            Self::Disk => &[m.x, m.y],
            Self::Mesh(_) | Self::Rectangle => return own.transformed(m),
        };
        // The largest coordinate of M·ω over all unit ω is the length of the row of M.
        let mut square = Vec3::splat(0.0);
        for c in columns {
            square += c.mul_elementwise(*c);
        }
        let half = Vec3::new(square.x.sqrt(), square.y.sqrt(), square.z.sqrt());
        Aabb::around([(m.origin - half).to_f32(), (m.origin + half).to_f32()])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_far_sphere_is_met_to_the_last_bit() {
        // From 1e6 radii away the distance is 1e6 − 1, which single precision holds exactly.
        let t = cross_sphere(Vec3::new(0.0, 0.0, 1e6), Vec3::new(0.0, 0.0, -1.0), 1e30);
        assert_eq!(t, Some(999_999.0));
        let past = Vec3::new(1.0 + 1e-9, 0.0, 1e6);
        assert_eq!(cross_sphere(past, Vec3::new(0.0, 0.0, -1.0), 1e30), None);
        let graze = Vec3::new(1.0 - 1e-9, 0.0, 1e6);
        assert!(cross_sphere(graze, Vec3::new(0.0, 0.0, -1.0), 1e30).is_some());
    }

    #[test]
    fn from_inside_the_far_side_is_met() {
        let t = cross_sphere(Vec3::new(0.5, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), 1e30);
        assert_eq!(t, Some(0.25));
        let beyond = cross_sphere(Vec3::new(0.5, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0), 0.25);
        assert_eq!(beyond, None);
    }

    #[test]
    fn a_plane_parallel_to_the_ray_is_missed() {
        let d = Vec3::new(1.0, 0.0, 0.0);
        assert!(cross_plane(Vec3::new(0.0, 0.0, 1.0), d).is_none());
        assert!(cross_plane(Vec3::new(0.0, 0.0, 0.0), d).is_none());
    }
}
