//! The two ray queries, and the choice of instructions for them.

use super::beam::{self, Asked};
use super::coherence::are_coherent;
use super::kernel::Kernel;
use super::mesh_tree::{MeshTree, Triangles};
use super::nearest::Nearest;
use super::placed::{Kind, Placed};
use super::shape::{cross_flat, cross_sphere};
use super::sphere_tree::Spheres;
use super::walk::{BoxRay, Order, Rays, Visitor, walk, walk_many};
use super::{Geometry, Hit, Ray};
use gonio_num::Vectors;

/// The kernel of what the program was compiled for.
#[cfg(not(all(target_arch = "wasm32", target_feature = "simd128")))]
const HERE: super::kernel::Portable = super::kernel::Portable;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
const HERE: super::simd128::Simd128 = super::simd128::Simd128;

/// Whether coherent rays go through meshes as beams: not in WebAssembly, where a page loads the code.
const BEAMS: bool = !cfg!(target_family = "wasm");

/// Which kernel this processor gets.
#[derive(Debug, Clone, Copy)]
pub(super) enum Choice {
    Portable,
    #[cfg(target_arch = "x86_64")]
    Avx2(super::avx2::Avx2),
}

impl Choice {
    pub(super) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(kernel) = super::avx2::Avx2::detect() {
            return Self::Avx2(kernel);
        }
        Self::Portable
    }
}

impl Geometry {
    /// The nearest surface along a ray, if any. A ray that isn't valid ([`Ray::is_valid`]) hits nothing.
    #[inline]
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        match self.choice {
            Choice::Portable => self.intersect_portable(ray),
            #[cfg(target_arch = "x86_64")]
            Choice::Avx2(kernel) => super::avx2::intersect(kernel, self, ray),
        }
    }

    /// Whether anything lies along a ray. It ends at the first thing found, so it is quicker than
    /// [`Geometry::intersect`], and says the same.
    #[inline]
    pub fn occluded(&self, ray: &Ray) -> bool {
        match self.choice {
            Choice::Portable => self.occluded_portable(ray),
            #[cfg(target_arch = "x86_64")]
            Choice::Avx2(kernel) => super::avx2::occluded(kernel, self, ray),
        }
    }

    #[inline(never)]
    pub(super) fn intersect_portable(&self, ray: &Ray) -> Option<Hit> {
        self.search::<_, false>(HERE, ray).hit()
    }

    #[inline(never)]
    pub(super) fn occluded_portable(&self, ray: &Ray) -> bool {
        self.search::<_, true>(HERE, ray).hit().is_some()
    }

    /// Both queries, for any kernel.
    #[inline(always)]
    pub(super) fn search<K: Kernel, const ANY: bool>(&self, kernel: K, ray: &Ray) -> Nearest {
        let mut nearest = Nearest::none(ray.t_max);
        if !ray.is_valid() {
            return nearest;
        }
        let boxes = BoxRay::new(ray.origin, ray.direction, &self.bounds);
        let mut visitor = Instances::<K, ANY> {
            kernel,
            geometry: self,
            ray: *ray,
            boxes,
            nearest: &mut nearest,
        };
        if self.order.len() == 1 {
            // A mesh's own tree begins with the box around it.
            visitor.leaf(0, 1);
        } else {
            walk(kernel, &self.top, &boxes, &mut visitor);
        }
        if !(self.spheres.blocks.is_empty() || ANY && nearest.found()) {
            let (tree, bounds) = (&self.spheres, &self.spheres.tree.bounds);
            let (boxes, mut visitor) =
                Spheres::<K, ANY>::new(kernel, tree, &self.placed, ray, bounds, &mut nearest);
            walk(kernel, &tree.tree, &boxes, &mut visitor);
        }
        nearest
    }

    /// Both queries for many rays, each with the best hit so far: of everything but the shapes that [`Simple`](super::simple::Simple) has every
    /// ray tested with.
    #[inline(always)]
    pub(super) fn search_many<K: Kernel, const ANY: bool>(
        &self,
        kernel: K,
        rays: [&Vectors; 2],
        nearest: &mut [Nearest],
    ) {
        let size = self.bounds.max - self.bounds.min;
        let coherent = are_coherent(rays, size.length());
        if !self.simple.few {
            let mut rays = InstanceRays::<K, ANY> {
                kernel,
                geometry: self,
                open: Open::new(rays, nearest),
            };
            let order = Order::of(coherent, self.top.bytes());
            walk_many(kernel, &self.top, order, &mut rays);
        }
        for &(instance, tree) in &self.simple.meshes {
            let tree = &self.trees[tree as usize];
            if coherent && BEAMS {
                let placed = &self.placed[instance as usize];
                let asked = Asked {
                    tree,
                    instance,
                    placed,
                    bounds: if placed.identity {
                        &self.bounds
                    } else {
                        &tree.tree.bounds
                    },
                };
                beam::search::<K, ANY>(kernel, &asked, rays, nearest);
                continue;
            }
            let mut rays = MeshRays::<K, ANY> {
                kernel,
                geometry: self,
                tree,
                instance,
                open: Open::new(rays, nearest),
            };
            let order = Order::of(coherent, tree.bytes());
            walk_many(kernel, &tree.tree, order, &mut rays);
        }
        if !self.spheres.blocks.is_empty() {
            let mut rays = SphereRays::<K, ANY> {
                kernel,
                geometry: self,
                open: Open::new(rays, nearest),
            };
            let order = Order::of(coherent, self.spheres.bytes());
            walk_many(kernel, &self.spheres.tree, order, &mut rays);
        }
    }

    /// Whether [`Geometry::search_many`] looks at anything.
    pub(super) fn has_trees(&self) -> bool {
        !(self.simple.few && self.simple.meshes.is_empty() && self.spheres.blocks.is_empty())
    }

    /// [`Geometry::search_many`] with the kernel of this processor.
    pub(super) fn ask_many<const ANY: bool>(&self, rays: [&Vectors; 2], nearest: &mut [Nearest]) {
        match self.choice {
            Choice::Portable => self.search_many::<_, ANY>(HERE, rays, nearest),
            #[cfg(target_arch = "x86_64")]
            Choice::Avx2(kernel) => super::avx2::search_many::<ANY>(kernel, self, rays, nearest),
        }
    }
}

/// The rays that still ask something, with the best hit of each.
struct Open<'a> {
    rays: [&'a Vectors; 2],
    nearest: std::slice::IterMut<'a, Nearest>,
    at: usize,
}

impl<'a> Open<'a> {
    #[inline(always)]
    fn new(rays: [&'a Vectors; 2], nearest: &'a mut [Nearest]) -> Self {
        Self {
            rays,
            nearest: nearest.iter_mut(),
            at: 0,
        }
    }

    /// The next that is valid, and of which any hit isn't enough.
    #[inline(always)]
    fn next<const ANY: bool>(&mut self) -> Option<(Ray, &'a mut Nearest)> {
        loop {
            let nearest = self.nearest.next()?;
            let ray = Ray {
                origin: self.rays[0].get(self.at),
                direction: self.rays[1].get(self.at),
                t_max: nearest.t,
            };
            self.at += 1;
            if ray.is_valid() && !(ANY && nearest.found()) {
                return Some((ray, nearest));
            }
        }
    }
}

struct InstanceRays<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    geometry: &'a Geometry,
    open: Open<'a>,
}

impl<'a, K: Kernel, const ANY: bool> Rays for InstanceRays<'a, K, ANY> {
    type Visitor = Instances<'a, K, ANY>;

    #[inline(always)]
    fn next(&mut self) -> Option<(BoxRay, Self::Visitor)> {
        let (ray, nearest) = self.open.next::<ANY>()?;
        let boxes = BoxRay::new(ray.origin, ray.direction, &self.geometry.bounds);
        let visitor = Instances {
            kernel: self.kernel,
            geometry: self.geometry,
            ray,
            boxes,
            nearest,
        };
        Some((boxes, visitor))
    }
}

struct SphereRays<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    geometry: &'a Geometry,
    open: Open<'a>,
}

impl<'a, K: Kernel, const ANY: bool> Rays for SphereRays<'a, K, ANY> {
    type Visitor = Spheres<'a, K, ANY>;

    #[inline(always)]
    fn next(&mut self) -> Option<(BoxRay, Self::Visitor)> {
        let (ray, nearest) = self.open.next::<ANY>()?;
        let Geometry {
            spheres, placed, ..
        } = self.geometry;
        Some(Spheres::new(
            self.kernel,
            spheres,
            placed,
            &ray,
            &spheres.tree.bounds,
            nearest,
        ))
    }
}

struct MeshRays<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    geometry: &'a Geometry,
    tree: &'a MeshTree,
    instance: u32,
    open: Open<'a>,
}

impl<'a, K: Kernel, const ANY: bool> Rays for MeshRays<'a, K, ANY> {
    type Visitor = Triangles<'a, K, ANY>;

    #[inline(always)]
    fn next(&mut self) -> Option<(BoxRay, Self::Visitor)> {
        loop {
            let (ray, nearest) = self.open.next::<ANY>()?;
            let placed = &self.geometry.placed[self.instance as usize];
            let (ray, bounds) = if placed.identity {
                (ray, &self.geometry.bounds)
            } else {
                (placed.ray_to_mesh(&ray), &self.tree.tree.bounds)
            };
            // Overflow or underflow on the way there: nothing can be seen.
            if ray.is_valid() {
                let boxes = BoxRay::new(ray.origin, ray.direction, bounds);
                let (kernel, instance) = (self.kernel, self.instance);
                let visitor = Triangles::new(kernel, self.tree, &ray, instance, nearest);
                return Some((boxes, visitor));
            }
        }
    }
}

struct Instances<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    geometry: &'a Geometry,
    ray: Ray,
    boxes: BoxRay,
    nearest: &'a mut Nearest,
}

impl<K: Kernel, const ANY: bool> Instances<'_, K, ANY> {
    /// Whether a mesh offers anything nearer.
    #[inline(always)]
    fn mesh(&mut self, tree: u32, placed: &Placed, instance: u32) -> bool {
        let tree = &self.geometry.trees[tree as usize];
        let nearest = &mut *self.nearest;
        if placed.identity {
            let (kernel, boxes) = (self.kernel, &self.boxes);
            return kernel.search_mesh::<ANY>(tree, &self.ray, boxes, instance, nearest);
        }
        let ray = placed.ray_to_mesh(&self.ray);
        let boxes = BoxRay::new(ray.origin, ray.direction, &tree.tree.bounds);
        // Overflow or underflow on the way there: nothing can be seen.
        ray.is_valid()
            && self
                .kernel
                .search_mesh::<ANY>(tree, &ray, &boxes, instance, nearest)
    }
}

impl<K: Kernel, const ANY: bool> Visitor for Instances<'_, K, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.nearest.t
    }

    #[inline(always)]
    fn leaf(&mut self, first: u32, count: u32) -> bool {
        for k in first..first + count {
            let instance = self.geometry.order[k as usize];
            let placed = &self.geometry.placed[instance as usize];
            let found = match placed.kind {
                Kind::Mesh(tree) => self.mesh(tree, placed, instance),
                Kind::Sphere => {
                    let (o, d) = placed.ray_to_object(&self.ray);
                    let met = cross_sphere(o, d);
                    met.found && self.nearest.offer(met.t as f32, instance, 0, 0.0, 0.0)
                }
                Kind::Rectangle | Kind::Disk => {
                    let (o, d) = (self.ray.origin.to_f64(), self.ray.direction.to_f64());
                    let met = cross_flat(placed.kind == Kind::Disk, &placed.to_object, o, d);
                    let (x, y) = (met.x as f32, met.y as f32);
                    met.found && self.nearest.offer(met.t as f32, instance, 0, x, y)
                }
            };
            if ANY && found {
                return true;
            }
        }
        false
    }

    #[inline(always)]
    fn prefetch(&self, _: u32) {}
}
