//! Shapes, instances and ray queries.
//!
//! [`Geometry`] answers three questions: the nearest surface along a ray ([`Geometry::intersect`]), whether there is any
//! ([`Geometry::occluded`]), and what is known of a surface there ([`Geometry::surface`]). A tree over the instances stands
//! above one tree a mesh. The answers are the same to the bit on every processor: they depend neither on the tree nor on
//! the instruction set.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod batch;
mod beam;
mod bounds;
mod coherence;
mod kernel;
mod mesh_tree;
mod nearest;
mod placed;
mod query;
mod sample;
mod shape;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
mod simd128;
mod simple;
mod sphere_tree;
mod stack;
mod surface;
#[cfg(test)]
mod tests;
mod tree;
mod triangle;
mod walk;

pub use batch::Surfaces;
pub use bounds::Aabb;
pub use sample::AreaSample;
pub use shape::{Instance, Shape};
pub use surface::SurfacePoint;

use crate::mesh::TriangleMesh;
use crate::{Hit, Ray, SceneError};
use mesh_tree::MeshTree;
use placed::{Kind, Placed};
use rayon::prelude::*;
use sample::AreaTable;
use simple::Simple;
use sphere_tree::SphereTree;
use std::collections::HashMap;
use std::sync::{Arc, OnceLock};
use tree::{Purpose, WideTree};

/// All surfaces of a scene, ready for ray queries.
///
/// Memory beside the meshes themselves: for each mesh, however often it is placed, 320 bytes for each block of up to eight
/// triangles (40 a triangle if all were full) and 256 for each node of up to eight boxes; [`Geometry::tree_bytes`] counts.
#[derive(Debug)]
pub struct Geometry {
    shapes: Vec<Shape>,
    instances: Vec<Instance>,
    placed: Vec<Placed>,
    trees: Vec<MeshTree>,
    /// The spheres, where they are many.
    spheres: SphereTree,
    /// Over all other instances.
    top: WideTree,
    /// Instances in the order of the leaves of `top`.
    order: Vec<u32>,
    bounds: Aabb,
    areas: Vec<OnceLock<AreaTable>>,
    choice: query::Choice,
    simple: Simple,
}

impl Geometry {
    /// Checks everything and builds the trees, those of different meshes in parallel.
    ///
    /// # Errors
    /// [`SceneError::Mesh`] if a mesh breaks a rule of [`TriangleMesh::check`]; [`SceneError::Instance`] if an instance
    /// names a shape that doesn't exist, or its transform isn't finite or flattens space.
    pub fn build(shapes: Vec<Shape>, instances: Vec<Instance>) -> Result<Self, SceneError> {
        // One tree a mesh, though several shapes may hold it.
        let mut meshes: Vec<(usize, &Arc<TriangleMesh>)> = Vec::new();
        let mut known = HashMap::new();
        let mut tree_of = vec![0u32; shapes.len()];
        for (i, shape) in shapes.iter().enumerate() {
            if let Shape::Mesh(mesh) = shape {
                tree_of[i] = *known.entry(Arc::as_ptr(mesh)).or_insert_with(|| {
                    meshes.push((i, mesh));
                    meshes.len() as u32 - 1
                });
            }
        }
        let trees = meshes
            .par_iter()
            .map(|&(shape, mesh)| {
                mesh.check().map_err(|e| match e {
                    SceneError::Mesh {
                        place,
                        found,
                        expected,
                    } => SceneError::Mesh {
                        place: format!("shape {shape}, {place}"),
                        found,
                        expected,
                    },
                    other => other,
                })?;
                Ok(MeshTree::build(mesh))
            })
            .collect::<Result<Vec<_>, SceneError>>()?;
        drop(meshes);

        let boxes: Vec<Aabb> = shapes.iter().map(Shape::bounds).collect();
        let mut placed = Vec::with_capacity(instances.len());
        for (i, instance) in instances.iter().enumerate() {
            let s = instance.shape as usize;
            let shape = shapes.get(s).ok_or_else(|| SceneError::Instance {
                instance: i,
                message: format!("it has shape {s}, but there are {} shapes", shapes.len()),
            })?;
            let kind = match shape {
                Shape::Mesh(_) => Kind::Mesh(tree_of[s]),
                Shape::Sphere => Kind::Sphere,
                Shape::Rectangle => Kind::Rectangle,
                Shape::Disk => Kind::Disk,
            };
            placed.push(Placed::new(i, instance, shape, &boxes[s], kind)?);
        }

        let (simple, spheres) = Simple::of(&placed);
        let spheres = SphereTree::build(&placed, &spheres);
        // A mesh without triangles has no box, and no place in the tree.
        let has_place = |p: &Placed| {
            let elsewhere = p.kind == Kind::Sphere && !spheres.blocks.is_empty();
            !(p.bounds.is_empty() || elsewhere)
        };
        let visible: Vec<u32> = (0..placed.len() as u32)
            .filter(|&i| has_place(&placed[i as usize]))
            .collect();
        let mut order = Vec::with_capacity(visible.len());
        let top = WideTree::build(
            visible.iter().map(|&i| placed[i as usize].bounds),
            Purpose::Instances,
            &mut |leaf| {
                let first = order.len() as u32;
                order.extend(leaf.iter().map(|&k| visible[k as usize]));
                (first, leaf.len() as u32)
            },
        );
        let bounds = top.bounds.union(&spheres.tree.bounds);
        let areas = instances.iter().map(|_| OnceLock::new()).collect();
        Ok(Self {
            shapes,
            instances,
            placed,
            trees,
            spheres,
            top,
            order,
            bounds,
            areas,
            choice: query::Choice::detect(),
            simple,
        })
    }

    /// The box around everything; empty if there is nothing.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The shapes, as given.
    pub fn shapes(&self) -> &[Shape] {
        &self.shapes
    }

    /// The instances, as given.
    pub fn instances(&self) -> &[Instance] {
        &self.instances
    }

    /// Triangles in all instances, each as often as it is placed, degenerate ones left out.
    pub fn triangle_count(&self) -> usize {
        self.count(|mesh, tree| mesh.indices.len() - tree.degenerate)
    }

    /// Triangles without area in all instances: nothing ever hits them.
    pub fn degenerate_count(&self) -> usize {
        self.count(|_, tree| tree.degenerate)
    }

    /// Bytes that the trees hold, beside the meshes themselves.
    pub fn tree_bytes(&self) -> usize {
        let meshes = self.trees.iter().map(MeshTree::bytes).sum::<usize>();
        self.top.bytes() + self.spheres.bytes() + meshes
    }

    fn count(&self, of: impl Fn(&TriangleMesh, &MeshTree) -> usize) -> usize {
        let each = |i: &Instance, p: &Placed| match (&self.shapes[i.shape as usize], p.kind) {
            (Shape::Mesh(mesh), Kind::Mesh(tree)) => of(mesh, &self.trees[tree as usize]),
            _ => 0,
        };
        self.instances
            .iter()
            .zip(&self.placed)
            .map(|(i, p)| each(i, p))
            .sum()
    }

    fn shape_of(&self, instance: u32) -> &Shape {
        &self.shapes[self.instances[instance as usize].shape as usize]
    }
}
