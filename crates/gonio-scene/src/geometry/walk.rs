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
        let reach_pad = bounds.reach(origin) * (1.0 / (1 << 20) as f32);
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

/// A walk that can be left after any step.
pub(super) struct Walk {
    stack: Stack,
    current: u32,
}

impl Walk {
    /// At the root.
    #[inline(always)]
    pub(super) fn new() -> Self {
        Self {
            stack: Stack::new(),
            current: 0,
        }
    }

    /// At this node or leaf, with nothing else to visit.
    #[inline(always)]
    pub(super) fn start_at(&mut self, child: u32) {
        self.stack.clear();
        self.current = child;
    }

    /// Visits one node or leaf, and announces the next; returns whether that was the last.
    #[inline(always)]
    pub(super) fn step<K: Kernel, V: Visitor>(
        &mut self,
        kernel: K,
        tree: &WideTree,
        ray: &K::Boxes,
        visitor: &mut V,
    ) -> bool {
        if self.current & LEAF == 0 {
            let node = &tree.nodes[self.current as usize];
            // A vacant child's box lies inside out, so no ray meets it.
            let (mut hits, near) = kernel.boxes(node, ray, visitor.t_max());
            if hits != 0 {
                let i = hits.trailing_zeros() as usize % WIDTH;
                hits &= hits - 1;
                let mut current = node.children[i];
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
                    self.stack.push(entry);
                    others += 1;
                }
                if !V::ANY && others > 1 {
                    self.stack.sort_last(others);
                }
                self.current = current;
                return false;
            }
        } else {
            let (first, count) = leaf_items(self.current);
            if visitor.leaf(first, count) {
                return true;
            }
        }
        // The next entry that may still hold something nearer, or as near.
        loop {
            let Some(entry) = self.stack.pop() else {
                return true;
            };
            if V::ANY || entry.near <= visitor.t_max() {
                self.current = entry.child;
                return false;
            }
        }
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
    let prepared = kernel.prepare_boxes(ray);
    let mut walk = Walk::new();
    while !walk.step(kernel, tree, &prepared, visitor) {}
}

/// Where walks of many rays come from.
pub(crate) trait Rays {
    /// What each does at the leaves.
    type Visitor: Visitor;
    /// The next, if any is left.
    fn next(&mut self) -> Option<(BoxRay, Self::Visitor)>;
}

/// Trees of fewer bytes stay in the cache, and their rays are walked one after the other.
const LARGE: usize = 1 << 20;

/// Walks at a time: while one waits for the memory that it announced, the others go on.
const STREAMS: usize = 8;

/// How many rays walk through a tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// One after the other.
    Alone,
    /// A step of one after a step of another.
    InTurns,
}

impl Order {
    /// For a tree of so many bytes, those of what its owner stores included. Rays that go the same way find in the cache what the one
    /// before them used.
    #[inline(always)]
    pub(crate) fn of(coherent: bool, bytes: usize) -> Self {
        if coherent || bytes < LARGE {
            Self::Alone
        } else {
            Self::InTurns
        }
    }
}

/// [`walk`] for many rays.
#[inline(always)]
pub(crate) fn walk_many<K: Kernel, R: Rays>(
    kernel: K,
    tree: &WideTree,
    order: Order,
    rays: &mut R,
) {
    if tree.nodes.is_empty() {
        return;
    }
    match order {
        Order::Alone => {
            while let Some((ray, mut visitor)) = rays.next() {
                walk(kernel, tree, &ray, &mut visitor);
            }
        }
        Order::InTurns => walk_in_turns(kernel, tree, rays),
    }
}

#[inline(always)]
fn walk_in_turns<K: Kernel, R: Rays>(kernel: K, tree: &WideTree, rays: &mut R) {
    let mut walks = Vec::with_capacity(STREAMS);
    while walks.len() < STREAMS
        && let Some((ray, visitor)) = rays.next()
    {
        walks.push((Walk::new(), ray, visitor));
    }
    while !walks.is_empty() {
        let mut i = 0;
        while let Some((walk, ray, visitor)) = walks.get_mut(i) {
            if !walk.step(kernel, tree, &kernel.prepare_boxes(ray), visitor) {
                i += 1;
            } else if let Some((next, of_next)) = rays.next() {
                // Its stack is empty, or holds what no longer counts.
                walk.start_at(0);
                *ray = next;
                *visitor = of_next;
                i += 1;
            } else {
                walks.swap_remove(i);
            }
        }
    }
}
