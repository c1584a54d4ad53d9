//! The kernel for WebAssembly with vectors of 128 bits: the same results as [`Portable`](super::kernel::Portable).
//!
//! Eight numbers are two vectors of four. Unsafe code, under one invariant: vector loads read the four numbers of an array.
#![allow(unsafe_code)]

use super::Ray;
use super::kernel::{BEYOND, Eight, Kernel};
use super::mesh_tree::MeshTree;
use super::nearest::Nearest;
use super::sphere_tree::{SphereBlock, SphereRay};
use super::tree::{Node, WIDTH};
use super::triangle::{TriangleBlock, TriangleRay};
use super::walk::BoxRay;
use std::arch::wasm32::*;

/// Vectors of four, which a module either is compiled for or not.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Simd128;

/// The first or the second four of eight numbers.
#[inline(always)]
fn load(row: &[f32; WIDTH], half: usize) -> v128 {
    let four: &[f32; 4] = if half == 0 {
        row.first_chunk()
    } else {
        row.last_chunk()
    }
    .expect("invariant: eight are four and four");
    // SAFETY: the four numbers are there; a vector load needs no alignment.
    unsafe { v128_load(four.as_ptr().cast()) }
}

#[inline(always)]
fn splat3(a: [f32; 3]) -> [v128; 3] {
    [f32x4_splat(a[0]), f32x4_splat(a[1]), f32x4_splat(a[2])]
}

/// a < b ? a : b, which is b if one is NaN.
#[inline(always)]
fn min(a: v128, b: v128) -> v128 {
    f32x4_pmin(b, a)
}

/// a > b ? a : b, which is b if one is NaN.
#[inline(always)]
fn max(a: v128, b: v128) -> v128 {
    f32x4_pmax(b, a)
}

/// t at four planes: (plane − origin) · inverse.
#[inline(always)]
fn slab(planes: v128, origin: v128, inverse: v128) -> v128 {
    f32x4_mul(f32x4_sub(planes, origin), inverse)
}

/// The edge function px · qy − py · qx.
#[inline(always)]
fn edge(px: v128, py: v128, qx: v128, qy: v128) -> v128 {
    f32x4_sub(f32x4_mul(px, qy), f32x4_mul(py, qx))
}

/// x x' + y y' + z z', in that order.
#[inline(always)]
fn dot(a: [v128; 3], b: [v128; 3]) -> v128 {
    let xy = f32x4_add(f32x4_mul(a[0], b[0]), f32x4_mul(a[1], b[1]));
    f32x4_add(xy, f32x4_mul(a[2], b[2]))
}

/// A [`BoxRay`] in vectors.
#[derive(Clone, Copy)]
pub(crate) struct Boxes {
    inverse: [v128; 3],
    near: [v128; 3],
    far: [v128; 3],
    near_row: [usize; 3],
}

/// A [`TriangleRay`] in vectors.
#[derive(Clone, Copy)]
pub(crate) struct Triangles {
    axes: [usize; 3],
    origin: [v128; 3],
    shear: [v128; 3],
}

/// A [`SphereRay`] in vectors.
#[derive(Clone, Copy)]
pub(crate) struct Spheres {
    origin: [v128; 3],
    direction: [v128; 3],
    inverse: v128,
    step: v128,
    pad: v128,
}

impl Kernel for Simd128 {
    type Boxes = Boxes;
    type Triangles = Triangles;
    type Spheres = Spheres;

    #[inline(always)]
    fn prepare_boxes(self, ray: &BoxRay) -> Boxes {
        Boxes {
            inverse: splat3(ray.inverse),
            near: splat3(ray.near),
            far: splat3(ray.far),
            near_row: ray.near_row,
        }
    }

    #[inline(always)]
    fn prepare_triangles(self, ray: &TriangleRay) -> Triangles {
        Triangles {
            axes: ray.axes,
            origin: splat3(ray.origin),
            shear: splat3(ray.shear),
        }
    }

    #[inline(always)]
    fn prepare_spheres(self, ray: &SphereRay) -> Spheres {
        let [inverse, step, pad] = splat3([ray.inverse, ray.step, ray.pad]);
        Spheres {
            origin: splat3(ray.origin),
            direction: splat3(ray.direction),
            inverse,
            step,
            pad,
        }
    }

    #[inline(always)]
    fn boxes(self, node: &Node, ray: &Boxes, t_max: f32) -> (u32, Eight) {
        let mut mask = 0;
        let mut out = Eight([0.0; WIDTH]);
        for half in 0..2 {
            let mut enter = f32x4_splat(0.0);
            let mut leave = f32x4_splat(t_max);
            for axis in 0..3 {
                let row = ray.near_row[axis];
                let near = load(&node.planes[row], half);
                let far = load(&node.planes[row ^ 1], half);
                // NaN is only ever the first operand, and so never the result.
                enter = max(slab(near, ray.near[axis], ray.inverse[axis]), enter);
                leave = min(slab(far, ray.far[axis], ray.inverse[axis]), leave);
            }
            mask |= u32::from(i32x4_bitmask(f32x4_le(enter, leave))) << (4 * half);
            out.0[4 * half] = f32x4_extract_lane::<0>(enter);
            out.0[4 * half + 1] = f32x4_extract_lane::<1>(enter);
            out.0[4 * half + 2] = f32x4_extract_lane::<2>(enter);
            out.0[4 * half + 3] = f32x4_extract_lane::<3>(enter);
        }
        (mask, out)
    }

    #[inline(always)]
    fn triangles(self, block: &TriangleBlock, ray: &Triangles, t_max: f32) -> u32 {
        let zero = f32x4_splat(0.0);
        let limit = f32x4_splat(t_max * BEYOND);
        let mut mask = 0;
        for half in 0..2 {
            let mut x = [zero; 3];
            let mut y = [zero; 3];
            let mut t = [zero; 3];
            for k in 0..3 {
                let corner = &block.corners[k];
                let cx = load(&corner[ray.axes[0]], half);
                let cy = load(&corner[ray.axes[1]], half);
                let cz = load(&corner[ray.axes[2]], half);
                let z = f32x4_sub(cz, ray.origin[2]);
                x[k] = f32x4_sub(f32x4_sub(cx, ray.origin[0]), f32x4_mul(ray.shear[0], z));
                y[k] = f32x4_sub(f32x4_sub(cy, ray.origin[1]), f32x4_mul(ray.shear[1], z));
                t[k] = f32x4_mul(z, ray.shear[2]);
            }
            let a = edge(x[2], y[2], x[1], y[1]);
            let b = edge(x[0], y[0], x[2], y[2]);
            let c = edge(x[1], y[1], x[0], y[0]);
            let low = min(min(a, b), c);
            let high = max(max(a, b), c);
            // Vacant lanes hold NaN in all three, which fails both.
            let inside = v128_or(f32x4_ge(low, zero), f32x4_le(high, zero));
            let first = min(min(t[0], t[1]), t[2]);
            let last = max(max(t[0], t[1]), t[2]);
            let within = v128_and(f32x4_gt(last, zero), f32x4_le(first, limit));
            mask |= u32::from(i32x4_bitmask(v128_and(inside, within))) << (4 * half);
        }
        mask
    }

    #[inline(always)]
    fn spheres(self, block: &SphereBlock, ray: &Spheres, t_max: f32) -> u32 {
        let [dx, dy, dz] = ray.direction;
        let mut missed = 0;
        for half in 0..2 {
            let x = f32x4_sub(load(&block.centre[0], half), ray.origin[0]);
            let y = f32x4_sub(load(&block.centre[1], half), ray.origin[1]);
            let z = f32x4_sub(load(&block.centre[2], half), ray.origin[2]);
            let t = f32x4_mul(dot([x, y, z], ray.direction), ray.inverse);
            let x = f32x4_sub(x, f32x4_mul(dx, t));
            let y = f32x4_sub(y, f32x4_mul(dy, t));
            let z = f32x4_sub(z, f32x4_mul(dz, t));
            let radius = f32x4_add(load(&block.radius, half), ray.pad);
            let zero = f32x4_splat(0.0);
            let off = dot([x, y, z], [x, y, z]);
            let left = f32x4_sub(f32x4_mul(radius, radius), off);
            let half_chord = f32x4_mul(f32x4_sqrt(f32x4_pmax(zero, left)), ray.step);
            let beside = f32x4_lt(left, zero);
            let beyond = f32x4_gt(f32x4_sub(t, half_chord), f32x4_splat(t_max));
            let behind = f32x4_lt(f32x4_add(t, half_chord), zero);
            let all = v128_or(beside, v128_or(beyond, behind));
            missed |= u32::from(i32x4_bitmask(all)) << (4 * half);
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
