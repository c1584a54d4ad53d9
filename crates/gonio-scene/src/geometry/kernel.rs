//! [`Kernel`], the two tests that ray queries spend their time in, and their portable form.
// WebAssembly with vectors has a form of its own, chosen when it is compiled.
#![cfg_attr(
    all(target_arch = "wasm32", target_feature = "simd128"),
    allow(dead_code)
)]

use super::Ray;
use super::mesh_tree::MeshTree;
use super::nearest::Nearest;
use super::sphere_tree::{SphereBlock, SphereRay};
use super::tree::{Node, WIDTH};
use super::triangle::{LANES, TriangleBlock, TriangleRay};
use super::walk::BoxRay;

/// Eight numbers, aligned for vector registers.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(32))]
pub(crate) struct Eight(pub(crate) [f32; WIDTH]);

/// The tests of eight boxes and of eight triangles against a ray.
///
/// Every kernel returns the same masks to the bit: each product and each sum is rounded by itself, in the order that
/// [`Portable`] writes, and min and max return their second operand if one is NaN.
pub(crate) trait Kernel: Copy {
    /// A ray as [`Kernel::boxes`] wants it.
    type Boxes;
    /// A ray as [`Kernel::triangles`] wants it.
    type Triangles;
    /// A ray as [`Kernel::spheres`] wants it.
    type Spheres;

    fn prepare_boxes(self, ray: &BoxRay) -> Self::Boxes;
    fn prepare_triangles(self, ray: &TriangleRay) -> Self::Triangles;
    fn prepare_spheres(self, ray: &SphereRay) -> Self::Spheres;
    /// A bit for each child whose box the ray may meet in \[0, t_max\], and where it enters each.
    fn boxes(self, node: &Node, ray: &Self::Boxes, t_max: f32) -> (u32, Eight);
    /// A bit for each triangle that the ray may meet in (0, t_max]: the edge functions don't disagree in sign, and the
    /// corners lie neither all behind the origin nor all beyond t_max.
    fn triangles(self, block: &TriangleBlock, ray: &Self::Triangles, t_max: f32) -> u32;
    /// A bit for each sphere that the ray may meet in (0, t_max\].
    fn spheres(self, block: &SphereBlock, ray: &Self::Spheres, t_max: f32) -> u32;
    /// Announces that `item` will be read.
    fn prefetch<T>(self, item: &T);
    /// [`MeshTree::search`], compiled for this kernel as a function of its own: its loop then has all registers to itself.
    fn search_mesh<const ANY: bool>(
        self,
        tree: &MeshTree,
        ray: &Ray,
        boxes: &BoxRay,
        instance: u32,
        nearest: &mut Nearest,
    ) -> bool;
}

/// The relative margin by which a corner may lie beyond t_max and yet be tested: more than the roundings of its t.
pub(crate) const BEYOND: f32 = 1.000001;

/// Plain arithmetic on arrays, right on every processor.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Portable;

#[inline(always)]
pub(super) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[inline(always)]
pub(super) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

impl Kernel for Portable {
    type Boxes = BoxRay;
    type Triangles = TriangleRay;
    type Spheres = SphereRay;

    #[inline(always)]
    fn prepare_boxes(self, ray: &BoxRay) -> BoxRay {
        *ray
    }

    #[inline(always)]
    fn prepare_triangles(self, ray: &TriangleRay) -> TriangleRay {
        *ray
    }

    #[inline(always)]
    fn prepare_spheres(self, ray: &SphereRay) -> SphereRay {
        *ray
    }

    #[inline(always)]
    fn boxes(self, node: &Node, ray: &BoxRay, t_max: f32) -> (u32, Eight) {
        let near: [&[f32; WIDTH]; 3] = [
            &node.planes[ray.near_row[0]],
            &node.planes[ray.near_row[1]],
            &node.planes[ray.near_row[2]],
        ];
        let far: [&[f32; WIDTH]; 3] = [
            &node.planes[ray.near_row[0] ^ 1],
            &node.planes[ray.near_row[1] ^ 1],
            &node.planes[ray.near_row[2] ^ 1],
        ];
        let mut enter = [0.0f32; WIDTH];
        let mut leave = [t_max; WIDTH];
        for axis in 0..3 {
            for i in 0..WIDTH {
                // NaN, from 0 · ∞ on a plane that the ray lies in, leaves the other axes to decide.
                enter[i] = max(
                    (near[axis][i] - ray.near[axis]) * ray.inverse[axis],
                    enter[i],
                );
                leave[i] = min((far[axis][i] - ray.far[axis]) * ray.inverse[axis], leave[i]);
            }
        }
        let mut mask = 0;
        for i in 0..WIDTH {
            mask |= u32::from(enter[i] <= leave[i]) << i;
        }
        (mask, Eight(enter))
    }

    #[inline(always)]
    fn triangles(self, block: &TriangleBlock, ray: &TriangleRay, t_max: f32) -> u32 {
        let mut x = [[0.0f32; LANES]; 3];
        let mut y = [[0.0f32; LANES]; 3];
        let mut t = [[0.0f32; LANES]; 3];
        for k in 0..3 {
            let corner = &block.corners[k];
            for i in 0..LANES {
                let z = corner[ray.axes[2]][i] - ray.origin[2];
                x[k][i] = (corner[ray.axes[0]][i] - ray.origin[0]) - ray.shear[0] * z;
                y[k][i] = (corner[ray.axes[1]][i] - ray.origin[1]) - ray.shear[1] * z;
                t[k][i] = z * ray.shear[2];
            }
        }
        let limit = t_max * BEYOND;
        let mut mask = 0;
        for i in 0..LANES {
            let a = x[2][i] * y[1][i] - y[2][i] * x[1][i];
            let b = x[0][i] * y[2][i] - y[0][i] * x[2][i];
            let c = x[1][i] * y[0][i] - y[1][i] * x[0][i];
            let inside = (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
            let first = min(min(t[0][i], t[1][i]), t[2][i]);
            let last = max(max(t[0][i], t[1][i]), t[2][i]);
            let within = last > 0.0 && first <= limit;
            mask |= u32::from(inside && within) << i;
        }
        mask
    }

    #[inline(always)]
    fn spheres(self, block: &SphereBlock, ray: &SphereRay, t_max: f32) -> u32 {
        let ([ox, oy, oz], [dx, dy, dz]) = (ray.origin, ray.direction);
        let mut missed = 0;
        for i in 0..WIDTH {
            let (x, y, z) = (
                block.centre[0][i] - ox,
                block.centre[1][i] - oy,
                block.centre[2][i] - oz,
            );
            // t where the line is nearest to the centre, and the way from there.
            let t = (x * dx + y * dy + z * dz) * ray.inverse;
            let (x, y, z) = (x - dx * t, y - dy * t, z - dz * t);
            let radius = block.radius[i] + ray.pad;
            let left = radius * radius - (x * x + y * y + z * z);
            // Half of what the ray's line has in the sphere.
            let half = max(left, 0.0).sqrt() * ray.step;
            let missing = left < 0.0 || t - half > t_max || t + half < 0.0;
            missed |= u32::from(missing) << i;
        }
        block.valid & !missed
    }

    #[inline(always)]
    fn prefetch<T>(self, _: &T) {}

    #[inline(never)]
    fn search_mesh<const ANY: bool>(
        self,
        tree: &MeshTree,
        ray: &Ray,
        boxes: &BoxRay,
        instance: u32,
        nearest: &mut Nearest,
    ) -> bool {
        tree.search::<Self, ANY>(self, ray, boxes, instance, nearest)
    }
}
