//! [`SurfacePoint`], what is known of a surface where a ray met it, and rays that leave it.

use super::placed::{Kind, Placed};
use super::{Geometry, Hit, Ray, Shape};
use crate::mesh::TriangleMesh;
use gonio_num::lanes::Lanes;
use gonio_num::{Affine3, Frame, Real, Vec3};
use std::f64::consts::{PI, TAU};

/// A point of a surface, in world coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint {
    /// Position \[m\], on the surface itself: not origin + t · direction, but the shape's own equation.
    pub p: Vec3<f32>,
    /// Bound on the distance between p and the true surface, with room for the roundings of a ray that starts there \[m\].
    pub error: f32,
    /// Geometric normal, unit, outwards (triangles: by winding), **not** turned to the ray.
    pub ng: Vec3<f32>,
    /// Shading normal, unit, on the side of `ng`.
    pub ns: Vec3<f32>,
    /// Tangent, unit, across `ns`: given, or along growing u, or else arbitrary.
    pub tangent: Vec3<f32>,
    /// ±1: the bitangent is `bitangent_sign · ns × tangent`, along falling v (upwards in the image, as glTF has it).
    pub bitangent_sign: f32,
    /// First texture coordinates, v downwards; (0, 0) if there are none.
    pub uv: [f32; 2],
    /// Second texture coordinates; (0, 0) if there are none.
    pub uv1: [f32; 2],
    /// Linear RGBA vertex colour; white if there is none.
    pub colour: [f32; 4],
    /// Distance along the ray, as in the hit.
    pub t: f32,
    /// Index of the instance.
    pub instance: u32,
    /// Index of the triangle in its mesh; 0 for the other shapes.
    pub primitive: u32,
}

/// The share of the way to a target that a shadow ray leaves out at its end, so that it doesn't meet the target's surface.
const SHORT: f32 = 1e-4;

impl SurfacePoint {
    /// The bitangent, unit: `bitangent_sign · ns × tangent`.
    pub fn bitangent(&self) -> Vec3<f32> {
        self.ns.cross(self.tangent) * self.bitangent_sign
    }

    /// p, moved off the surface to the side that `direction` leads to.
    ///
    /// The way is twice [`SurfacePoint::error`] along the geometric normal, which leads past the true surface and the
    /// rounding of the new origin (Wächter and Binder 2019, Ray Tracing Gems, chapter 6, has the problem).
    #[inline]
    pub fn offset_origin(&self, direction: Vec3<f32>) -> Vec3<f32> {
        offset_origin(self.p, self.ng, self.error, direction)
    }

    /// The endless ray that leaves in `direction` (unit), and doesn't meet the surface it leaves.
    #[inline]
    pub fn spawn_ray(&self, direction: Vec3<f32>) -> Ray {
        Ray::new(self.offset_origin(direction), direction)
    }

    /// The ray that leaves towards `target` and stops just short of it: by 10⁻⁴ of the way, and by the rounding of the
    /// target where that is more. If the target is p itself the ray hits nothing.
    #[inline]
    pub fn spawn_ray_to(&self, target: Vec3<f32>) -> Ray {
        ray_to(self.offset_origin(target - self.p), target)
    }
}

/// [`SurfacePoint::offset_origin`].
#[inline(always)]
pub(super) fn offset_origin(
    p: Vec3<f32>,
    ng: Vec3<f32>,
    error: f32,
    direction: Vec3<f32>,
) -> Vec3<f32> {
    let side = if direction.dot(ng) < 0.0 { -2.0 } else { 2.0 };
    p + ng * (side * error)
}

/// [`SurfacePoint::spawn_ray_to`], from the origin off the surface.
#[inline(always)]
pub(super) fn ray_to(origin: Vec3<f32>, target: Vec3<f32>) -> Ray {
    let way = target - origin;
    let distance = way.length();
    let largest = target.x.abs().max(target.y.abs()).max(target.z.abs());
    let short = (distance * SHORT).max(largest * (16.0 * f32::EPSILON));
    let open = distance > short;
    let unit = if open { 1.0 / distance } else { 1.0 };
    Ray {
        origin,
        direction: way * unit,
        t_max: if open { distance - short } else { 0.0 },
    }
}

/// What a shape knows of a point in its own coordinates; normals and tangents of any length.
pub(super) struct Local {
    pub(super) p: Vec3<f64>,
    pub(super) ng: Vec3<f64>,
    /// Zero: `ng`.
    ns: Vec3<f64>,
    /// Zero: arbitrary.
    tangent: Vec3<f64>,
    bitangent_sign: f32,
    pub(super) uv: [f32; 2],
    uv1: [f32; 2],
    colour: [f32; 4],
}

/// The directions at a point of a surface, as [`SurfacePoint`] has them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Axes {
    ng: Vec3<f32>,
    ns: Vec3<f32>,
    tangent: Vec3<f32>,
    bitangent_sign: f32,
}

impl Axes {
    /// The geometric and the shading normal and the tangent, in every lane.
    #[inline(always)]
    pub(super) fn over<const L: usize>(&self) -> (Vec3<Lanes<L>>, Vec3<Lanes<L>>, Vec3<Lanes<L>>) {
        (
            Vec3::broadcast(self.ng),
            Vec3::broadcast(self.ns),
            Vec3::broadcast(self.tangent),
        )
    }
}

impl Local {
    fn plain(p: Vec3<f64>, ng: Vec3<f64>, tangent: Vec3<f64>, uv: [f64; 2]) -> Self {
        Self {
            p,
            ng,
            ns: Vec3::zero(),
            tangent,
            bitangent_sign: 1.0,
            uv: uv.map(|x| x as f32),
            uv1: [0.0; 2],
            colour: [1.0; 4],
        }
    }

    pub(super) fn sphere(p: Vec3<f64>) -> Self {
        let n = p.normalize();
        // Texture coordinates are single precision, so angles of single precision will do.
        let across = (n.x * n.x + n.y * n.y).sqrt() as f32;
        let phi = f64::from(Real::atan2(n.y as f32, n.x as f32));
        let u = if phi < 0.0 {
            phi / TAU + 1.0
        } else {
            phi / TAU
        };
        let v = f64::from(Real::atan2(across, n.z as f32)) / PI;
        Self::plain(n, n, Vec3::new(-n.y, n.x, 0.0), [u, v])
    }

    pub(super) fn flat(x: f64, y: f64) -> Self {
        Self::plain(
            Vec3::new(x, y, 0.0),
            Vec3::new(0.0, 0.0, 1.0),
            Vec3::new(1.0, 0.0, 0.0),
            [0.5 * (x + 1.0), 0.5 * (1.0 - y)],
        )
    }

    pub(super) fn triangle(mesh: &TriangleMesh, triangle: usize, u: f32, v: f32) -> Self {
        let corners = mesh.indices[triangle].map(|i| i as usize);
        let (u, v) = (f64::from(u), f64::from(v));
        let placed = mesh.corners(triangle).map(Vec3::to_f64);
        let (weights, p, ng) = on_triangle(placed, u, v);
        let mut local = Self::plain(p, ng, Vec3::zero(), [0.0; 2]);
        let mix = |list: &[[f32; 2]]| {
            if list.is_empty() {
                [0.0; 2]
            } else {
                mixed(corners, weights, |i| list[i]).map(|x| x as f32)
            }
        };
        local.uv = mix(&mesh.uvs);
        local.uv1 = mix(&mesh.uvs1);
        if !mesh.colours.is_empty() {
            local.colour = mixed(corners, weights, |i| mesh.colours[i]).map(|x| x as f32);
        }
        if !mesh.normals.is_empty() {
            // A corner without a normal counts with the triangle's own.
            let unit = local.ng.normalize();
            for (&i, &w) in corners.iter().zip(&weights) {
                local.ns += normal_part(mesh.normals[i].to_f64(), w, unit);
            }
        }
        if !mesh.tangents.is_empty() {
            let [x, y, z, w] = mixed(corners, weights, |i| mesh.tangents[i]);
            local.tangent = Vec3::new(x, y, z);
            local.bitangent_sign = if w < 0.0 { -1.0 } else { 1.0 };
        } else if !mesh.uvs.is_empty() {
            let [uv0, uv1, uv2] = corners.map(|i| mesh.uvs[i].map(f64::from));
            let (ab, ac) = (placed[1] - placed[0], placed[2] - placed[0]);
            let (du1, dv1) = (uv1[0] - uv0[0], uv1[1] - uv0[1]);
            let (du2, dv2) = (uv2[0] - uv0[0], uv2[1] - uv0[1]);
            // ∂p/∂u · det; the determinant is the signed area of the triangle in the image.
            let det = du1 * dv2 - du2 * dv1;
            if det != 0.0 {
                local.tangent = (ab * dv2 - ac * dv1) * det.signum();
                // With v downwards a triangle that isn't mirrored in the image has a negative determinant.
                local.bitangent_sign = if det < 0.0 { 1.0 } else { -1.0 };
            }
        }
        local
    }
}

/// The values of three vertices, weighted.
fn mixed<const N: usize>(
    corners: [usize; 3],
    weights: [f64; 3],
    at: impl Fn(usize) -> [f32; N],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for (&i, &w) in corners.iter().zip(&weights) {
        for (s, x) in sum.iter_mut().zip(at(i)) {
            *s += w * f64::from(x);
        }
    }
    sum
}

impl Placed {
    /// A shape's point in the world.
    #[inline]
    pub(super) fn to_surface(&self, local: &Local, hit: &Hit) -> SurfacePoint {
        let p = self.to_world.transform_point(local.p);
        let axes = match &self.flat {
            Some(axes) => *axes,
            None => self.axes(local),
        };
        SurfacePoint {
            p: p.to_f32(),
            error: self.error_at(p) as f32 + f32::MIN_POSITIVE,
            ng: axes.ng,
            ns: axes.ns,
            tangent: axes.tangent,
            bitangent_sign: axes.bitangent_sign,
            uv: local.uv,
            uv1: local.uv1,
            colour: local.colour,
            t: hit.t,
            instance: hit.instance,
            primitive: hit.primitive,
        }
    }

    /// The directions at a shape's point, in the world.
    pub(super) fn axes(&self, local: &Local) -> Axes {
        let turned = axes(&self.to_world, local.ng, local.ns, local.tangent);
        let sign = local.bitangent_sign * self.handedness;
        Axes {
            ng: turned.ng.to_f32(),
            ns: turned.ns.to_f32(),
            tangent: turned.tangent.to_f32(),
            bitangent_sign: if turned.flipped { -sign } else { sign },
        }
    }
}

/// [`Axes`] before they are rounded.
pub(super) struct WorldAxes<R: Real> {
    pub(super) ng: Vec3<R>,
    pub(super) ns: Vec3<R>,
    pub(super) tangent: Vec3<R>,
    /// Whether the shading normal pointed to the other side.
    pub(super) flipped: R::Mask,
}

/// The directions at a shape's point, in the world.
///
/// - `ng`, `ns`, `tangent`: in the shape's coordinates, of any length; `ns` zero: `ng`, `tangent` zero: any
#[inline(always)]
pub(super) fn axes<R: Real>(
    m: &Affine3<R>,
    ng: Vec3<R>,
    ns: Vec3<R>,
    tangent: Vec3<R>,
) -> WorldAxes<R> {
    let ng = m.transform_normal(ng).normalize();
    let bent = m.transform_normal(ns);
    let length = bent.length();
    // Normals that cancel: the surface's own.
    let least = R::lit(1e-12) * ns.length().max(R::lit(1e-300));
    let sound = length.gt(least) & length.le(R::lit(f64::MAX));
    let length = R::select(sound, length, R::one());
    let ns = Vec3::select(sound, bent / length, ng);
    let flipped = ns.dot(ng).lt(R::zero());
    let ns = Vec3::select(flipped, -ns, ns);
    WorldAxes {
        ng,
        ns,
        tangent: Frame::from_normal_tangent(ns, m.transform_vector(tangent)).s,
        flipped,
    }
}

/// The point of a triangle and its normal by winding, of any length.
///
/// - `u`, `v`: barycentric weights of the second and third corner
#[inline(always)]
pub(super) fn on_triangle<R: Real>(
    corners: [Vec3<R>; 3],
    u: R,
    v: R,
) -> ([R; 3], Vec3<R>, Vec3<R>) {
    let weights = [(R::one() - u - v).max(R::zero()), u, v];
    let [a, b, c] = corners;
    let p = a * weights[0] + b * weights[1] + c * weights[2];
    (weights, p, (b - a).cross(c - a))
}

/// A corner's part in the normal: unit, times its weight; `unit` where the corner has none.
#[inline(always)]
pub(super) fn normal_part<R: Real>(n: Vec3<R>, weight: R, unit: Vec3<R>) -> Vec3<R> {
    let length = n.length();
    let given = length.gt(R::zero());
    let n = Vec3::select(given, n / R::select(given, length, R::one()), unit);
    n * weight
}

impl Geometry {
    /// What is known of the surface at a hit.
    ///
    /// # Panics
    /// If the hit isn't one of this geometry.
    pub fn surface(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        let placed = &self.placed[hit.instance as usize];
        let local = match (placed.kind, self.shape_of(hit.instance)) {
            (Kind::Mesh(_), Shape::Mesh(mesh)) => {
                Local::triangle(mesh, hit.primitive as usize, hit.u, hit.v)
            }
            (Kind::Sphere, _) => {
                let (o, d) = placed.ray_to_object(ray);
                Local::sphere(o + d * f64::from(hit.t))
            }
            _ => Local::flat(hit.u.into(), hit.v.into()),
        };
        placed.to_surface(&local, hit)
    }
}
