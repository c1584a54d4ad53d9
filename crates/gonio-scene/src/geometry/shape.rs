//! [`Shape`] and [`Instance`], and where a ray meets the shapes that aren't meshes.

use super::Aabb;
use crate::double::Double;
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
pub(crate) fn cross_sphere<D: Double>(o: Vec3<D>, d: Vec3<D>) -> Met<D> {
    let a = d.dot(d);
    let b = -o.dot(d);
    let c = o.dot(o) - D::one();
    let across = o + d * (b / a);
    let discriminant = D::one() - across.dot(across);
    let root = (a * discriminant).safe_sqrt();
    let q = D::select(b.lt(D::zero()), b - root, b + root);
    let (r0, r1) = (c / q, q / a);
    let swapped = r0.lt(r1);
    let first = D::select(swapped, r0, r1);
    let second = rounded(D::select(swapped, r1, r0));
    let behind = first.le(D::zero());
    let first = rounded(first);
    // Each is false for NaN, which a ray along a tangent that starts at its point leads to.
    let (near, far) = (ahead(first), ahead(second) & behind);
    Met {
        t: D::select(near, first, second),
        x: D::zero(),
        y: D::zero(),
        found: (near | far) & !discriminant.lt(D::zero()),
    }
}

/// A point where a ray may meet a shape.
pub(crate) struct Met<D: Double> {
    /// Rounded to single precision, which rays count in.
    pub(crate) t: D,
    /// The place on a flat shape.
    pub(crate) x: D,
    pub(crate) y: D,
    /// Whether there is one, t > 0.
    pub(crate) found: D::Mask,
}

/// Rounded to single precision.
#[inline(always)]
fn rounded<D: Double>(t: D) -> D {
    D::of(t.single())
}

/// Whether t lies in (0, ∞).
#[inline(always)]
fn ahead<D: Double>(t: D) -> D::Mask {
    D::zero().lt(t) & t.le(D::lit(f64::from(f32::MAX)))
}

/// Where a ray meets the plane z = 0 of the coordinates into which `m` maps those of the ray, t > 0.
///
/// First t, by the third coordinate alone, then the place of that point: fewer products than with the whole ray in those coordinates.
#[inline(always)]
pub(crate) fn cross_plane<D: Double>(m: &Affine3<D>, o: Vec3<D>, d: Vec3<D>) -> Met<D> {
    let height = m.x.z * o.x + m.y.z * o.y + m.z.z * o.z + m.origin.z;
    let rise = m.x.z * d.x + m.y.z * d.y + m.z.z * d.z;
    let t = -height / rise;
    let p = o + d * t;
    let met = rounded(t);
    Met {
        t: met,
        x: m.x.x * p.x + m.y.x * p.y + m.z.x * p.z + m.origin.x,
        y: m.x.y * p.x + m.y.y * p.y + m.z.y * p.z + m.origin.y,
        found: ahead(met),
    }
}

/// Where a ray meets the square \[−1, 1\]² or the unit disk of that plane.
#[inline(always)]
pub(crate) fn cross_flat<D: Double>(disk: bool, m: &Affine3<D>, o: Vec3<D>, d: Vec3<D>) -> Met<D> {
    let mut met = cross_plane(m, o, d);
    let (x, y, one) = (met.x, met.y, D::one());
    let inside = if disk {
        (x * x + y * y).le(one)
    } else {
        x.abs().le(one) & y.abs().le(one)
    };
    met.found = met.found & inside;
    met
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

    fn sphere(o: Vec3<f64>, d: Vec3<f64>) -> Option<f32> {
        let met = cross_sphere(o, d);
        met.found.then_some(met.t as f32)
    }

    #[test]
    fn a_far_sphere_is_met_to_the_last_bit() {
        // From 1e6 radii away the distance is 1e6 − 1, which single precision holds exactly.
        let t = sphere(Vec3::new(0.0, 0.0, 1e6), Vec3::new(0.0, 0.0, -1.0));
        assert_eq!(t, Some(999_999.0));
        let past = Vec3::new(1.0 + 1e-9, 0.0, 1e6);
        assert_eq!(sphere(past, Vec3::new(0.0, 0.0, -1.0)), None);
        let graze = Vec3::new(1.0 - 1e-9, 0.0, 1e6);
        assert!(sphere(graze, Vec3::new(0.0, 0.0, -1.0)).is_some());
    }

    #[test]
    fn from_inside_the_far_side_is_met() {
        let t = sphere(Vec3::new(0.5, 0.0, 0.0), Vec3::new(2.0, 0.0, 0.0));
        assert_eq!(t, Some(0.25));
    }

    #[test]
    fn a_plane_parallel_to_the_ray_is_missed() {
        let d = Vec3::new(1.0, 0.0, 0.0);
        let m = Affine3::<f64>::identity();
        assert!(!cross_plane(&m, Vec3::new(0.0, 0.0, 1.0), d).found);
        assert!(!cross_plane(&m, Vec3::new(0.0, 0.0, 0.0), d).found);
    }
}
