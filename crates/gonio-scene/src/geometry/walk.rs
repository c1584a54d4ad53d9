//! The walk of a ray through a [`WideTree`], nearest boxes first.

use super::Aabb;
use super::kernel::Kernel;
use super::stack::{Entry, Stack};
use super::tree::{LEAF, WIDTH, WideTree, leaf_items};
use gonio_num::Vec3;

/// A ray, prepared for boxes.
///
/// The box test must never miss a box that holds a triangle which the triangle test would report. Both round, in units of the
/// distance from the origin to the corners: at most 10 roundings of 2⁻²⁴ together (three in the slab test, seven in shearing
/// a corner and in the edge function). So all planes are moved outwards by 2⁻²⁰ = 16 · 2⁻²⁴ of the largest such distance.
/// That costs nothing a box, since the origin is moved instead, once for the near sides and once for the far sides (Woop,
/// Benthin and Wald 2013, section 3.3; Ize 2013, "Robust BVH Ray Traversal").
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoxRay {
    /// 1 / direction; ±∞ for a component that is 0 or nearly so.
    pub(crate) inverse: [f32; 3],
    /// The origin as the planes on the near side see it.
    pub(crate) near: [f32; 3],
    /// The origin as the planes on the far side see it.
    pub(crate) far: [f32; 3],
    /// Row of [`Node::planes`](super::tree::Node::planes) that is on the near side, for each axis.
    pub(crate) near_row: [usize; 3],
}

impl BoxRay {
    #[inline(always)]
    pub(crate) fn new(origin: Vec3<f32>, direction: Vec3<f32>, bounds: &Aabb) -> Self {
        let (o, d) = (origin.to_array(), direction.to_array());
        let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
        let mut reach = 0.0f32;
        for axis in 0..3 {
            let r = (low[axis] - o[axis])
                .abs()
                .max((high[axis] - o[axis]).abs());
            reach = reach.max(r);
        }
        let reach_pad = reach * (1.0 / (1 << 20) as f32);
        let mut ray = Self {
            inverse: [0.0; 3],
            near: [0.0; 3],
            far: [0.0; 3],
            near_row: [0; 3],
        };
        for axis in 0..3 {
            let inverse = 1.0 / d[axis];
            let backwards = inverse < 0.0;
            // The second term is at least one unit in the last place of the origin, so that the sum does move it.
            let pad = reach_pad + o[axis].abs() * f32::EPSILON;
            let pad = if backwards { -pad } else { pad };
            ray.inverse[axis] = inverse;
            ray.near[axis] = o[axis] + pad;
            ray.far[axis] = o[axis] - pad;
            ray.near_row[axis] = 2 * axis + usize::from(backwards);
        }
        ray
    }
}

/// What a walk does at the leaves.
pub(crate) trait Visitor {
    /// Whether any hit will do: then children aren't sorted.
    const ANY: bool;
    /// Boxes that begin beyond it are skipped.
    fn t_max(&self) -> f32;
    /// Tests `count` items from `first` on; true ends the walk.
    fn leaf(&mut self, first: u32, count: u32) -> bool;
    /// Announces that the items from `first` on will be tested.
    fn prefetch(&self, first: u32);
}

/// Announces that a child will be visited: by then its memory has arrived.
#[inline(always)]
fn announce<K: Kernel, V: Visitor>(kernel: K, tree: &WideTree, visitor: &V, child: u32) {
    if child & LEAF != 0 {
        visitor.prefetch(leaf_items(child).0);
    } else if let Some(node) = tree.nodes.get(child as usize) {
        kernel.prefetch(node);
    }
}

/// Walks the leaves that the ray may hit, roughly by distance.
#[inline(always)]
pub(crate) fn walk<K: Kernel, V: Visitor>(
    kernel: K,
    tree: &WideTree,
    ray: &BoxRay,
    visitor: &mut V,
) {
    if tree.nodes.is_empty() {
        return;
    }
    let mut stack = Stack::new();
    let prepared = kernel.prepare_boxes(ray);
    let mut current = 0u32;
    loop {
        if current & LEAF == 0 {
            let node = &tree.nodes[current as usize];
            // A vacant child's box lies inside out, so no ray meets it.
            let (mut hits, near) = kernel.boxes(node, &prepared, visitor.t_max());
            if hits != 0 {
                let i = hits.trailing_zeros() as usize % WIDTH;
                hits &= hits - 1;
                current = node.children[i];
                if hits == 0 {
                    continue;
                }
                announce(kernel, tree, visitor, current);
                let mut nearest = near.0[i];
                let mut others = 0;
                while hits != 0 {
                    let j = hits.trailing_zeros() as usize % WIDTH;
                    hits &= hits - 1;
                    let mut entry = Entry {
                        near: near.0[j],
                        child: node.children[j],
                    };
                    announce(kernel, tree, visitor, entry.child);
                    if !V::ANY && entry.near < nearest {
                        std::mem::swap(&mut entry.near, &mut nearest);
                        std::mem::swap(&mut entry.child, &mut current);
                    }
                    stack.push(entry);
                    others += 1;
                }
                if !V::ANY && others > 1 {
                    stack.sort_last(others);
                }
                continue;
            }
        } else {
            let (first, count) = leaf_items(current);
            if visitor.leaf(first, count) {
                return;
            }
        }
        // The next entry that may still hold something nearer, or as near.
        loop {
            let Some(entry) = stack.pop() else { return };
            if V::ANY || entry.near <= visitor.t_max() {
                current = entry.child;
                break;
            }
        }
    }
}
