//! [`SphereTree`], the spheres of a scene of many, ready for ray queries.
//!
//! In two steps, as triangles are. The first takes eight bounding spheres at once in single precision and rejects those that a ray surely
//! misses; the second solves for the few that remain, in double precision and in the coordinates of each, so that ellipsoids are spheres too.

use super::kernel::Kernel;
use super::nearest::Nearest;
use super::placed::Placed;
use super::shape::cross_sphere;
use super::tree::{Purpose, WIDTH, WideTree};
use super::walk::{BoxRay, Visitor};
use super::{Aabb, Ray};
use gonio_num::{Affine3, Real, Vec3};

/// Eight bounding spheres side by side. 192 bytes, three cache lines.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct SphereBlock {
    /// `centre[axis][lane]`, rounded.
    pub(crate) centre: [[f32; WIDTH]; 3],
    /// Rounded upwards.
    pub(crate) radius: [f32; WIDTH],
    /// The instance in each lane.
    pub(crate) instance: [u32; WIDTH],
    /// A bit for each lane that has one.
    pub(crate) valid: u32,
}

/// A tree whose leaves are blocks of up to eight spheres, in the coordinates of the world.
#[derive(Debug, Default)]
pub(crate) struct SphereTree {
    pub(crate) tree: WideTree,
    pub(crate) blocks: Vec<SphereBlock>,
}

impl SphereTree {
    /// Of these instances, each a sphere.
    pub(crate) fn build(placed: &[Placed], instances: &[u32]) -> Self {
        let of = |i: u32| &placed[i as usize];
        let boxes = instances.iter().map(|&i| of(i).bounds);
        let mut blocks = Vec::with_capacity(instances.len() / 4);
        let tree = WideTree::build(boxes, Purpose::Triangles, &mut |leaf| {
            let first = blocks.len();
            for part in leaf.chunks(WIDTH) {
                let mut block = SphereBlock {
                    centre: [[0.0; WIDTH]; 3],
                    radius: [0.0; WIDTH],
                    instance: [0; WIDTH],
                    valid: (1 << part.len()) - 1,
                };
                for (lane, &k) in part.iter().enumerate() {
                    let instance = instances[k as usize];
                    let m = &of(instance).to_world;
                    for (axis, centre) in m.origin.to_f32().to_array().into_iter().enumerate() {
                        block.centre[axis][lane] = centre;
                    }
                    block.radius[lane] = (largest_radius(m) * (1.0 + 1e-6)) as f32;
                    block.instance[lane] = instance;
                }
                blocks.push(block);
            }
            (first as u32, (blocks.len() - first) as u32)
        });
        Self { tree, blocks }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.tree.bytes() + self.blocks.len() * size_of::<SphereBlock>()
    }
}

/// A bound on the radius of the image of the unit sphere: the square root of the norm of MᵀM by rows (Gershgorin), which is exact for
/// columns across each other.
fn largest_radius(m: &Affine3<f64>) -> f64 {
    let columns = [m.x, m.y, m.z];
    let row = |a: Vec3<f64>| columns.iter().map(|b| a.dot(*b).abs()).sum::<f64>();
    columns.into_iter().map(row).fold(0.0, f64::max).sqrt()
}

/// A ray, prepared for bounding spheres.
///
/// With u = 2⁻²⁴ and R the largest distance along an axis from the origin o to a corner of the scene's box: the centre of a sphere, relative to
/// o, is right to u(|o| + R) + uR an axis; the point of the ray's line nearest to it, computed from that, to less than e = 16 u √3 R. `pad` p is 64 u R
/// and 8 u |o|, so that the distance between both is never on the wrong side of the padded radius, nor t on that of the sphere's ends: with the distance
/// ρ and half of the chord c² = r² − ρ², the padded (r + p)² − (ρ + e)² is at least c² + 2r(p − e) + p² − e² > (c + e)², as c ≤ r and p > 2e.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SphereRay {
    pub(crate) origin: [f32; 3],
    pub(crate) direction: [f32; 3],
    /// 1/(d·d), or NaN where that is far from 1: no comparison then rejects.
    pub(crate) inverse: f32,
    /// 1/|d|.
    pub(crate) step: f32,
    pub(crate) pad: f32,
}

impl SphereRay {
    #[inline(always)]
    pub(crate) fn new(ray: &Ray, bounds: &Aabb) -> Self {
        let (o, d) = (ray.origin, ray.direction);
        let (reach, size) = (bounds.reach(o), o.x.abs().max(o.y.abs()).max(o.z.abs()));
        let square = d.dot(d);
        let inverse = if (1e-30..1e30).contains(&square) {
            1.0 / square
        } else {
            f32::NAN
        };
        Self {
            origin: o.to_array(),
            direction: d.to_array(),
            inverse,
            step: Real::sqrt(inverse),
            pad: reach * (1.0 / (1 << 18) as f32) + size * (1.0 / (1 << 21) as f32),
        }
    }
}

/// What a ray does at the leaves.
pub(crate) struct Spheres<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    blocks: &'a [SphereBlock],
    placed: &'a [Placed],
    ray: Ray,
    rough: SphereRay,
    nearest: &'a mut Nearest,
}

impl<'a, K: Kernel, const ANY: bool> Spheres<'a, K, ANY> {
    /// `bounds` holds all spheres.
    #[inline(always)]
    pub(crate) fn new(
        kernel: K,
        tree: &'a SphereTree,
        placed: &'a [Placed],
        ray: &Ray,
        bounds: &Aabb,
        nearest: &'a mut Nearest,
    ) -> (BoxRay, Self) {
        let visitor = Self {
            kernel,
            blocks: &tree.blocks,
            placed,
            ray: *ray,
            rough: SphereRay::new(ray, bounds),
            nearest,
        };
        (BoxRay::new(ray.origin, ray.direction, bounds), visitor)
    }
}

impl<K: Kernel, const ANY: bool> Visitor for Spheres<'_, K, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.nearest.t
    }

    #[inline(always)]
    fn leaf(&mut self, first: u32, count: u32) -> bool {
        let (first, count) = (first as usize, count as usize);
        let rough = self.kernel.prepare_spheres(&self.rough);
        for block in &self.blocks[first..first + count] {
            let mut hits = self.kernel.spheres(block, &rough, self.nearest.t);
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize % WIDTH;
                hits &= hits - 1;
                let instance = block.instance[lane];
                let (o, d) = self.placed[instance as usize].ray_to_object(&self.ray);
                let met = cross_sphere(o, d);
                if met.found && self.nearest.offer(met.t as f32, instance, 0, 0.0, 0.0) && ANY {
                    return true;
                }
            }
        }
        false
    }

    #[inline(always)]
    fn prefetch(&self, first: u32) {
        if let Some(block) = self.blocks.get(first as usize) {
            self.kernel.prefetch(block);
        }
    }
}
