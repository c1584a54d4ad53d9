//! The kernel for processors with AVX2: the same results as [`Portable`](super::kernel::Portable), several times faster.
//!
//! Unsafe code, under these invariants:
//! 1. An [`Avx2`] exists only where [`Avx2::detect`] found every instruction set that the functions here are compiled
//!    for; so whoever holds one may run them.
//! 2. Vector loads read arrays of eight `f32` inside structures of alignment 32 or more, at multiples of 32 bytes.
//! 3. Prefetches change nothing that the program sees, and their addresses lie within what a reference leads to.
//!
//! The tests compare both kernels bit by bit.
#![allow(unsafe_code)]

use super::kernel::{BEYOND, Eight, Kernel};
use super::mesh_tree::MeshTree;
use super::nearest::Nearest;
use super::sphere_tree::{SphereBlock, SphereRay};
use super::tree::{Node, WIDTH};
use super::triangle::{TriangleBlock, TriangleRay};
use super::walk::BoxRay;
use super::{Geometry, Hit, Ray};
use gonio_num::Vectors;
use std::arch::x86_64::*;

/// Proof that this processor has AVX2.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Avx2(());

impl Avx2 {
    /// The proof, where there is one.
    pub(crate) fn detect() -> Option<Self> {
        let all = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("lzcnt")
            && is_x86_feature_detected!("popcnt");
        all.then_some(Self(()))
    }
}

/// [`Geometry::intersect`] with this kernel.
#[inline]
pub(super) fn intersect(kernel: Avx2, geometry: &Geometry, ray: &Ray) -> Option<Hit> {
    #[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
    fn run(kernel: Avx2, geometry: &Geometry, ray: &Ray) -> Option<Hit> {
        geometry.search::<Avx2, false>(kernel, ray).hit()
    }
    // SAFETY: invariant 1.
    unsafe { run(kernel, geometry, ray) }
}

/// [`Geometry::occluded`] with this kernel.
#[inline]
pub(super) fn occluded(kernel: Avx2, geometry: &Geometry, ray: &Ray) -> bool {
    #[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
    fn run(kernel: Avx2, geometry: &Geometry, ray: &Ray) -> bool {
        geometry.search::<Avx2, true>(kernel, ray).hit().is_some()
    }
    // SAFETY: invariant 1.
    unsafe { run(kernel, geometry, ray) }
}

/// [`Geometry::search_many`] with this kernel.
pub(super) fn search_many<const ANY: bool>(
    kernel: Avx2,
    geometry: &Geometry,
    rays: [&Vectors; 2],
    nearest: &mut [Nearest],
) {
    #[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
    fn run<const ANY: bool>(
        kernel: Avx2,
        geometry: &Geometry,
        rays: [&Vectors; 2],
        nearest: &mut [Nearest],
    ) {
        geometry.search_many::<Avx2, ANY>(kernel, rays, nearest);
    }
    // SAFETY: invariant 1.
    unsafe { run::<ANY>(kernel, geometry, rays, nearest) }
}

/// A [`BoxRay`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct Boxes {
    inverse: [__m256; 3],
    near: [__m256; 3],
    far: [__m256; 3],
    near_row: [usize; 3],
}

/// A [`TriangleRay`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct Triangles {
    axes: [usize; 3],
    origin: [__m256; 3],
    shear: [__m256; 3],
}

/// A [`SphereRay`] in registers.
#[derive(Clone, Copy)]
pub(crate) struct Spheres {
    origin: [__m256; 3],
    direction: [__m256; 3],
    inverse: __m256,
    step: __m256,
    pad: __m256,
}

/// Eight numbers from an aligned array.
#[inline(always)]
fn load(_: Avx2, row: &[f32; WIDTH]) -> __m256 {
    debug_assert_eq!(row.as_ptr() as usize % 32, 0);
    // SAFETY: invariants 1 and 2.
    unsafe { _mm256_load_ps(row.as_ptr()) }
}

#[inline(always)]
fn splat3(_: Avx2, a: [f32; 3]) -> [__m256; 3] {
    // SAFETY: invariant 1.
    unsafe {
        [
            _mm256_set1_ps(a[0]),
            _mm256_set1_ps(a[1]),
            _mm256_set1_ps(a[2]),
        ]
    }
}

// Plain functions, not closures: closures don't reliably end up in code compiled for AVX2.

/// t at eight planes: (plane − origin) · inverse.
#[inline(always)]
fn slab(kernel: Avx2, planes: &[f32; WIDTH], origin: __m256, inverse: __m256) -> __m256 {
    // SAFETY: invariant 1.
    unsafe { _mm256_mul_ps(_mm256_sub_ps(load(kernel, planes), origin), inverse) }
}

/// The edge function px · qy − py · qx.
#[inline(always)]
fn edge(_: Avx2, px: __m256, py: __m256, qx: __m256, qy: __m256) -> __m256 {
    // SAFETY: invariant 1.
    unsafe { _mm256_sub_ps(_mm256_mul_ps(px, qy), _mm256_mul_ps(py, qx)) }
}

/// x x' + y y' + z z', in that order.
#[inline(always)]
fn dot(_: Avx2, a: [__m256; 3], b: [__m256; 3]) -> __m256 {
    // SAFETY: invariant 1.
    unsafe {
        let xy = _mm256_add_ps(_mm256_mul_ps(a[0], b[0]), _mm256_mul_ps(a[1], b[1]));
        _mm256_add_ps(xy, _mm256_mul_ps(a[2], b[2]))
    }
}

impl Kernel for Avx2 {
    type Boxes = Boxes;
    type Triangles = Triangles;
    type Spheres = Spheres;

    #[inline(always)]
    fn prepare_boxes(self, ray: &BoxRay) -> Boxes {
        Boxes {
            inverse: splat3(self, ray.inverse),
            near: splat3(self, ray.near),
            far: splat3(self, ray.far),
            near_row: ray.near_row,
        }
    }

    #[inline(always)]
    fn prepare_triangles(self, ray: &TriangleRay) -> Triangles {
        Triangles {
            axes: ray.axes,
            origin: splat3(self, ray.origin),
            shear: splat3(self, ray.shear),
        }
    }

    #[inline(always)]
    fn prepare_spheres(self, ray: &SphereRay) -> Spheres {
        let [inverse, step, pad] = splat3(self, [ray.inverse, ray.step, ray.pad]);
        Spheres {
            origin: splat3(self, ray.origin),
            direction: splat3(self, ray.direction),
            inverse,
            step,
            pad,
        }
    }

    #[inline(always)]
    fn boxes(self, node: &Node, ray: &Boxes, t_max: f32) -> (u32, Eight) {
        // SAFETY: invariants 1 and 2; `Eight` is aligned to 32.
        unsafe {
            let [rx, ry, rz] = ray.near_row;
            let nx = slab(self, &node.planes[rx], ray.near[0], ray.inverse[0]);
            let ny = slab(self, &node.planes[ry], ray.near[1], ray.inverse[1]);
            let nz = slab(self, &node.planes[rz], ray.near[2], ray.inverse[2]);
            let fx = slab(self, &node.planes[rx ^ 1], ray.far[0], ray.inverse[0]);
            let fy = slab(self, &node.planes[ry ^ 1], ray.far[1], ray.inverse[1]);
            let fz = slab(self, &node.planes[rz ^ 1], ray.far[2], ray.inverse[2]);
            // NaN is only ever the first operand, and so never the result.
            let enter = _mm256_max_ps(
                nz,
                _mm256_max_ps(ny, _mm256_max_ps(nx, _mm256_setzero_ps())),
            );
            let leave = _mm256_min_ps(
                fz,
                _mm256_min_ps(fy, _mm256_min_ps(fx, _mm256_set1_ps(t_max))),
            );
            let mask = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(enter, leave));
            let mut out = Eight([0.0; WIDTH]);
            _mm256_store_ps(out.0.as_mut_ptr(), enter);
            (mask as u32, out)
        }
    }

    #[inline(always)]
    fn triangles(self, block: &TriangleBlock, ray: &Triangles, t_max: f32) -> u32 {
        // SAFETY: invariants 1 and 2.
        unsafe {
            let zero = _mm256_setzero_ps();
            let mut x = [zero; 3];
            let mut y = [zero; 3];
            let mut t = [zero; 3];
            for k in 0..3 {
                let corner = &block.corners[k];
                let cx = load(self, &corner[ray.axes[0]]);
                let cy = load(self, &corner[ray.axes[1]]);
                let cz = load(self, &corner[ray.axes[2]]);
                let z = _mm256_sub_ps(cz, ray.origin[2]);
                x[k] = _mm256_sub_ps(
                    _mm256_sub_ps(cx, ray.origin[0]),
                    _mm256_mul_ps(ray.shear[0], z),
                );
                y[k] = _mm256_sub_ps(
                    _mm256_sub_ps(cy, ray.origin[1]),
                    _mm256_mul_ps(ray.shear[1], z),
                );
                t[k] = _mm256_mul_ps(z, ray.shear[2]);
            }
            let a = edge(self, x[2], y[2], x[1], y[1]);
            let b = edge(self, x[0], y[0], x[2], y[2]);
            let c = edge(self, x[1], y[1], x[0], y[0]);
            let low = _mm256_min_ps(_mm256_min_ps(a, b), c);
            let high = _mm256_max_ps(_mm256_max_ps(a, b), c);
            // Vacant lanes hold NaN in all three, which fails both.
            let inside = _mm256_or_ps(
                _mm256_cmp_ps::<_CMP_GE_OQ>(low, zero),
                _mm256_cmp_ps::<_CMP_LE_OQ>(high, zero),
            );
            let first = _mm256_min_ps(_mm256_min_ps(t[0], t[1]), t[2]);
            let last = _mm256_max_ps(_mm256_max_ps(t[0], t[1]), t[2]);
            let limit = _mm256_set1_ps(t_max * BEYOND);
            let within = _mm256_and_ps(
                _mm256_cmp_ps::<_CMP_GT_OQ>(last, zero),
                _mm256_cmp_ps::<_CMP_LE_OQ>(first, limit),
            );
            _mm256_movemask_ps(_mm256_and_ps(inside, within)) as u32
        }
    }

    #[inline(always)]
    fn spheres(self, block: &SphereBlock, ray: &Spheres, t_max: f32) -> u32 {
        // SAFETY: invariants 1 and 2.
        unsafe {
            let [dx, dy, dz] = ray.direction;
            let x = _mm256_sub_ps(load(self, &block.centre[0]), ray.origin[0]);
            let y = _mm256_sub_ps(load(self, &block.centre[1]), ray.origin[1]);
            let z = _mm256_sub_ps(load(self, &block.centre[2]), ray.origin[2]);
            let along = dot(self, [x, y, z], ray.direction);
            let t = _mm256_mul_ps(along, ray.inverse);
            let x = _mm256_sub_ps(x, _mm256_mul_ps(dx, t));
            let y = _mm256_sub_ps(y, _mm256_mul_ps(dy, t));
            let z = _mm256_sub_ps(z, _mm256_mul_ps(dz, t));
            let radius = _mm256_add_ps(load(self, &block.radius), ray.pad);
            let zero = _mm256_setzero_ps();
            let off = dot(self, [x, y, z], [x, y, z]);
            let left = _mm256_sub_ps(_mm256_mul_ps(radius, radius), off);
            let half = _mm256_mul_ps(_mm256_sqrt_ps(_mm256_max_ps(left, zero)), ray.step);
            let beside = _mm256_cmp_ps::<_CMP_LT_OQ>(left, zero);
            let beyond = _mm256_cmp_ps::<_CMP_GT_OQ>(_mm256_sub_ps(t, half), _mm256_set1_ps(t_max));
            let behind = _mm256_cmp_ps::<_CMP_LT_OQ>(_mm256_add_ps(t, half), zero);
            let missed = _mm256_or_ps(beside, _mm256_or_ps(beyond, behind));
            block.valid & !(_mm256_movemask_ps(missed) as u32)
        }
    }

    #[inline(always)]
    fn prefetch<T>(self, item: &T) {
        let start = std::ptr::from_ref(item).cast::<i8>();
        for line in 0..size_of::<T>().div_ceil(64) {
            // SAFETY: invariant 3.
            unsafe { _mm_prefetch::<_MM_HINT_T0>(start.wrapping_add(64 * line)) };
        }
    }

    #[inline(always)]
    fn search_mesh<const ANY: bool>(
        self,
        tree: &MeshTree,
        ray: &Ray,
        boxes: &BoxRay,
        instance: u32,
        nearest: &mut Nearest,
    ) -> bool {
        #[inline(never)]
        #[target_feature(enable = "avx2,bmi1,lzcnt,popcnt")]
        fn run<const ANY: bool>(
            kernel: Avx2,
            tree: &MeshTree,
            ray: &Ray,
            boxes: &BoxRay,
            instance: u32,
            nearest: &mut Nearest,
        ) -> bool {
            tree.search::<Avx2, ANY>(kernel, ray, boxes, instance, nearest)
        }
        // SAFETY: invariant 1.
        unsafe { run::<ANY>(self, tree, ray, boxes, instance, nearest) }
    }
}
