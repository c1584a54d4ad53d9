//! The two ray queries, and the choice of instructions for them.

use super::kernel::{Kernel, Portable};
use super::nearest::Nearest;
use super::placed::{Kind, Placed};
use super::shape::{cross_flat, cross_sphere};
use super::walk::{BoxRay, Visitor, walk};
use super::{Geometry, Hit, Ray};

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
        self.search::<Portable, false>(Portable, ray).hit()
    }

    #[inline(never)]
    pub(super) fn occluded_portable(&self, ray: &Ray) -> bool {
        self.search::<Portable, true>(Portable, ray).hit().is_some()
    }

    /// Both queries, for any kernel.
    #[inline(always)]
    pub(super) fn search<K: Kernel, const ANY: bool>(&self, kernel: K, ray: &Ray) -> Nearest {
        let nearest = Nearest::none(ray.t_max);
        if !ray.is_valid() {
            return nearest;
        }
        let boxes = BoxRay::new(ray.origin, ray.direction, &self.top.bounds);
        let mut visitor = Instances::<K, ANY> {
            kernel,
            geometry: self,
            ray,
            boxes: &boxes,
            nearest,
        };
        if self.order.len() == 1 {
            // A mesh's own tree begins with the box around it.
            visitor.leaf(0, 1);
        } else {
            walk(kernel, &self.top, &boxes, &mut visitor);
        }
        visitor.nearest
    }
}

impl Geometry {
    /// What the meshes alone offer that is nearer than `nearest`.
    #[inline(always)]
    pub(super) fn search_meshes<K: Kernel, const ANY: bool>(
        &self,
        kernel: K,
        ray: &Ray,
        nearest: Nearest,
    ) -> Nearest {
        if !ray.is_valid() {
            return nearest;
        }
        let boxes = BoxRay::new(ray.origin, ray.direction, &self.top.bounds);
        let mut visitor = Instances::<K, ANY> {
            kernel,
            geometry: self,
            ray,
            boxes: &boxes,
            nearest,
        };
        for &(instance, tree) in &self.simple.meshes {
            let found = visitor.mesh(tree, &self.placed[instance as usize], instance);
            if ANY && found {
                break;
            }
        }
        visitor.nearest
    }

    #[inline]
    pub(super) fn nearest_of_meshes(&self, ray: &Ray, nearest: Nearest) -> Nearest {
        match self.choice {
            Choice::Portable => self.search_meshes::<Portable, false>(Portable, ray, nearest),
            #[cfg(target_arch = "x86_64")]
            Choice::Avx2(kernel) => super::avx2::search_meshes::<false>(kernel, self, ray, nearest),
        }
    }

    #[inline]
    pub(super) fn occluded_by_meshes(&self, ray: &Ray) -> bool {
        let nothing = Nearest::none(ray.t_max);
        let found = match self.choice {
            Choice::Portable => self.search_meshes::<Portable, true>(Portable, ray, nothing),
            #[cfg(target_arch = "x86_64")]
            Choice::Avx2(kernel) => super::avx2::search_meshes::<true>(kernel, self, ray, nothing),
        };
        found.hit().is_some()
    }
}

struct Instances<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    geometry: &'a Geometry,
    ray: &'a Ray,
    boxes: &'a BoxRay,
    nearest: Nearest,
}

impl<K: Kernel, const ANY: bool> Instances<'_, K, ANY> {
    /// Whether a mesh offers anything nearer.
    #[inline(always)]
    fn mesh(&mut self, tree: u32, placed: &Placed, instance: u32) -> bool {
        let tree = &self.geometry.trees[tree as usize];
        let nearest = &mut self.nearest;
        if placed.identity {
            let (kernel, boxes) = (self.kernel, self.boxes);
            return kernel.search_mesh::<ANY>(tree, self.ray, boxes, instance, nearest);
        }
        let ray = placed.ray_to_mesh(self.ray);
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
                    let (o, d) = placed.ray_to_object(self.ray);
                    let met = cross_sphere(o, d);
                    met.found && self.nearest.offer(met.t as f32, instance, 0, 0.0, 0.0)
                }
                Kind::Rectangle | Kind::Disk => {
                    let (o, d) = placed.ray_to_object(self.ray);
                    let met = cross_flat(placed.kind == Kind::Disk, o, d);
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
