//! [`MeshTree`], the triangles of one mesh, ready for ray queries. Instances share it.

use super::kernel::Kernel;
use super::nearest::Nearest;
use super::tree::{Purpose, WideTree};
use super::triangle::{LANES, TriangleBlock, TriangleRay};
use super::walk::{BoxRay, Visitor, walk};
use super::{Aabb, Ray};
use crate::mesh::TriangleMesh;

/// A tree whose leaves are blocks of up to eight triangles, corners copied in.
///
/// Memory beside the mesh itself: 320 bytes a block and 256 a node, so 40 bytes a triangle in full blocks and 80 in blocks
/// half filled, nodes aside; [`MeshTree::bytes`] counts.
#[derive(Debug, Default)]
pub(crate) struct MeshTree {
    pub(crate) tree: WideTree,
    pub(crate) blocks: Vec<TriangleBlock>,
    /// Triangles left out because they have no area.
    pub(crate) degenerate: usize,
}

impl MeshTree {
    /// Builds the tree of a mesh that has been checked.
    pub(crate) fn build(mesh: &TriangleMesh) -> Self {
        let ids: Vec<u32> = (0..mesh.indices.len())
            .filter(|&i| !mesh.is_degenerate(i))
            .map(|i| i as u32)
            .collect();
        let boxes = ids.iter().map(|&i| Aabb::around(mesh.corners(i as usize)));
        let mut blocks = Vec::with_capacity(ids.len() / 4);
        let tree = WideTree::build(boxes, Purpose::Triangles, &mut |leaf| {
            let first = blocks.len();
            for part in leaf.chunks(LANES) {
                let mut block = TriangleBlock::vacant();
                for (lane, &k) in part.iter().enumerate() {
                    let id = ids[k as usize];
                    block.set(lane, mesh.corners(id as usize), id);
                }
                blocks.push(block);
            }
            (first as u32, (blocks.len() - first) as u32)
        });
        Self {
            tree,
            blocks,
            degenerate: mesh.indices.len() - ids.len(),
        }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.tree.bytes() + self.blocks.len() * size_of::<TriangleBlock>()
    }

    /// Looks for triangles along `ray`, given in the mesh's coordinates, with `boxes` prepared for a box around the mesh, or a
    /// larger one; `nearest` holds the best so far, of any instance.
    /// Returns whether the search is over: only if `ANY` and something was found.
    #[inline(always)]
    pub(crate) fn search<K: Kernel, const ANY: bool>(
        &self,
        kernel: K,
        ray: &Ray,
        boxes: &BoxRay,
        instance: u32,
        nearest: &mut Nearest,
    ) -> bool {
        let mut visitor = Triangles::<K, ANY>::new(kernel, self, ray, instance, nearest);
        walk(kernel, &self.tree, boxes, &mut visitor);
        ANY && visitor.found
    }
}

/// What a ray does at the leaves of a mesh.
pub(crate) struct Triangles<'a, K: Kernel, const ANY: bool> {
    kernel: K,
    blocks: &'a [TriangleBlock],
    exact: TriangleRay,
    instance: u32,
    nearest: &'a mut Nearest,
    found: bool,
}

impl<'a, K: Kernel, const ANY: bool> Triangles<'a, K, ANY> {
    #[inline(always)]
    pub(crate) fn new(
        kernel: K,
        tree: &'a MeshTree,
        ray: &Ray,
        instance: u32,
        nearest: &'a mut Nearest,
    ) -> Self {
        let exact = TriangleRay::new(ray.origin, ray.direction);
        Self::with(kernel, tree, exact, instance, nearest)
    }

    /// With the ray prepared.
    #[inline(always)]
    pub(crate) fn with(
        kernel: K,
        tree: &'a MeshTree,
        exact: TriangleRay,
        instance: u32,
        nearest: &'a mut Nearest,
    ) -> Self {
        Self {
            kernel,
            blocks: &tree.blocks,
            exact,
            instance,
            nearest,
            found: false,
        }
    }
}

impl<K: Kernel, const ANY: bool> Visitor for Triangles<'_, K, ANY> {
    const ANY: bool = ANY;

    #[inline(always)]
    fn t_max(&self) -> f32 {
        self.nearest.t
    }

    #[inline(always)]
    fn leaf(&mut self, first: u32, count: u32) -> bool {
        let (first, count) = (first as usize, count as usize);
        let ray = self.kernel.prepare_triangles(&self.exact);
        for block in &self.blocks[first..first + count] {
            let mut hits = self.kernel.triangles(block, &ray, self.nearest.t);
            while hits != 0 {
                let lane = hits.trailing_zeros() as usize % LANES;
                hits &= hits - 1;
                if let Some(c) = self.exact.cross(block, lane)
                    && self
                        .nearest
                        .offer(c.t, self.instance, block.id[lane], c.u, c.v)
                {
                    self.found = true;
                    if ANY {
                        return true;
                    }
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
