//! [`WideTree`], a hierarchy of boxes with up to eight children a node.
//!
//! `obvhs` builds a binary tree (parallel locally-ordered clustering, Meister and Bittner 2018, improved by reinsertion,
//! Meister and Bittner 2018); it is collapsed here to eight children a node, opening the child of the largest area first.
//! This file is the only one that speaks `obvhs` and `glam`.

use super::Aabb;
use glam::Vec3A;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, SortPrecision};

/// Children a node.
pub(crate) const WIDTH: usize = 8;
/// Set in a child that is a leaf.
pub(crate) const LEAF: u32 = 1 << 31;
/// A leaf's largest number of items: its count less one is kept in three bits.
const MAX_ITEMS: u32 = 8;

/// A node: the boxes of its children by plane, so that all are tested at once. 256 bytes, four cache lines.
#[derive(Debug, Clone)]
#[repr(C, align(64))]
pub(crate) struct Node {
    /// `planes[2 · axis + side][child]`, side 0 the lower.
    pub(crate) planes: [[f32; WIDTH]; 6],
    /// Index of an inner node, or a leaf as [`leaf_items`] reads it.
    pub(crate) children: [u32; WIDTH],
    /// A bit for each child that exists; they come first.
    pub(crate) valid: u32,
}

impl Node {
    fn vacant() -> Self {
        let (low, high) = ([f32::INFINITY; WIDTH], [f32::NEG_INFINITY; WIDTH]);
        Self {
            planes: [low, high, low, high, low, high],
            children: [0; WIDTH],
            valid: 0,
        }
    }
}

/// First item and number of items of a leaf child.
#[inline(always)]
pub(crate) fn leaf_items(child: u32) -> (u32, u32) {
    ((child & !LEAF) >> 3, (child & 7) + 1)
}

/// A hierarchy of boxes over items that its owner stores.
#[derive(Debug, Default)]
pub(crate) struct WideTree {
    /// The root comes first, a child after its parent. Empty for a tree over nothing.
    pub(crate) nodes: Vec<Node>,
    /// Around everything.
    pub(crate) bounds: Aabb,
}

/// What the tree is for decides how many primitives a leaf gets.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Purpose {
    /// Up to eight triangles tested at once: cheap leaves.
    Triangles,
    /// Instances, each with a tree of its own below: dear leaves.
    Instances,
}

impl WideTree {
    /// Builds a tree over boxes, each finite and not empty. `store` takes the indices of a leaf's boxes, and returns the
    /// first of its items and their number, 1 to 8.
    pub(crate) fn build(
        boxes: impl ExactSizeIterator<Item = Aabb>,
        purpose: Purpose,
        store: &mut dyn FnMut(&[u32]) -> (u32, u32),
    ) -> Self {
        let count = boxes.len();
        if count == 0 {
            return Self::default();
        }
        // The leaves are made where the builder has them: no list of boxes stands beside it.
        let mut leaves = Vec::with_capacity(count);
        let mut bounds = Aabb::empty();
        for (i, item) in boxes.enumerate() {
            bounds = bounds.union(&item);
            leaves.push(Bvh2Node::new(spoken(&item), 1, i as u32));
        }
        let nodes = collapse(&binary(leaves, &bounds, purpose), store);
        Self { nodes, bounds }
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>()
    }
}

/// A box as `obvhs` has it.
fn spoken(b: &Aabb) -> obvhs::aabb::Aabb {
    obvhs::aabb::Aabb {
        min: Vec3A::from_array(b.min.to_array()),
        max: Vec3A::from_array(b.max.to_array()),
    }
}

/// Neighbours on each side that clustering looks at.
const SEARCH: usize = 14;
/// Rounds of clustering before that, in which only the next neighbours are looked at.
const SHORT_ROUNDS: usize = 3;
/// The share of the nodes that reinsertion tries, before and after leaves are joined.
const REINSERTED: [f32; 2] = [0.05, 0.1];

/// The binary tree over these leaves, the steps of `obvhs` for its medium quality one by one, so that the memory of each is given back before
/// the next begins.
fn binary(leaves: Vec<Bvh2Node>, bounds: &Aabb, purpose: Purpose) -> Bvh2 {
    // Eight triangles cost as much as one, so leaves are worth filling. Against the default cost of 3 this was measured to save 24 to 37 % of the
    // memory, and to be as fast or faster on every set of rays of the bench.
    let (most, cost) = match purpose {
        Purpose::Triangles => (MAX_ITEMS, 8.0),
        Purpose::Instances => (1, 3.0),
    };
    let count = leaves.len();
    let mut tree = Bvh2::default();
    tree.reset_for_reuse(count, Some((0..count as u32).collect()));
    let mut clusters = PlocBuilder::new();
    clusters.current_nodes = leaves;
    clusters.build_ploc_from_leaves::<SEARCH, false>(
        &mut tree,
        spoken(bounds),
        SortPrecision::U64,
        SHORT_ROUNDS,
    );
    drop(clusters);
    let mut optimizer = ReinsertionOptimizer::default();
    optimizer.run(&mut tree, REINSERTED[0], None);
    leaf_collapser::collapse(&mut tree, most, cost);
    optimizer.run(&mut tree, REINSERTED[1], None);
    tree
}

fn collapse(binary: &Bvh2, store: &mut dyn FnMut(&[u32]) -> (u32, u32)) -> Vec<Node> {
    let mut nodes = vec![Node::vacant()];
    // Pairs of a wide node to be filled and the binary node it stands for.
    let mut open = vec![(0usize, 0usize)];
    while let Some((wide, source)) = open.pop() {
        let mut group = vec![source];
        while group.len() < WIDTH {
            let largest = (0..group.len())
                .filter(|&i| !binary.nodes[group[i]].is_leaf())
                .max_by(|&i, &j| {
                    let area = |k: usize| binary.nodes[group[k]].aabb().half_area();
                    area(i).total_cmp(&area(j))
                });
            let Some(i) = largest else { break };
            let first = binary.nodes[group[i]].first_index as usize;
            group[i] = first;
            group.push(first + 1);
        }
        for (slot, &k) in group.iter().enumerate() {
            let node = &binary.nodes[k];
            let bounds = node.aabb();
            for axis in 0..3 {
                nodes[wide].planes[2 * axis][slot] = bounds.min[axis];
                nodes[wide].planes[2 * axis + 1][slot] = bounds.max[axis];
            }
            nodes[wide].valid |= 1 << slot;
            nodes[wide].children[slot] = if node.is_leaf() {
                let first = node.first_index as usize;
                let indices = &binary.primitive_indices[first..first + node.prim_count as usize];
                let (item, count) = store(indices);
                assert!(
                    (1..=MAX_ITEMS).contains(&count) && item < LEAF >> 3,
                    "invariant: a leaf's items fit its 31 bits"
                );
                LEAF | (item << 3) | (count - 1)
            } else {
                let child = nodes.len();
                assert!(
                    child < LEAF as usize,
                    "invariant: fewer nodes than triangles"
                );
                nodes.push(Node::vacant());
                open.push((child, k));
                child as u32
            };
        }
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Vec3;

    fn boxes(n: usize, spacing: f32) -> Vec<Aabb> {
        (0..n)
            .map(|i| {
                let p = Vec3::new(i as f32 * spacing, 0.0, 0.0);
                Aabb::around([p, p + Vec3::new(0.5, 1.0, 1.0)])
            })
            .collect()
    }

    #[test]
    fn each_box_is_in_one_leaf_inside_its_ancestors() {
        for (n, spacing) in [(1, 1.0), (2, 1.0), (9, 1.0), (500, 1.0), (500, 0.0)] {
            let all = boxes(n, spacing);
            let mut leaves: Vec<Vec<u32>> = vec![];
            let tree = WideTree::build(all.iter().copied(), Purpose::Triangles, &mut |ids| {
                leaves.push(ids.to_vec());
                (leaves.len() as u32 - 1, 1)
            });
            let mut seen = vec![0; n];
            let mut open = vec![(0u32, Aabb::empty())];
            open[0].1 = tree.bounds;
            while let Some((i, outer)) = open.pop() {
                let node = &tree.nodes[i as usize];
                let count = node.valid.count_ones() as usize;
                assert_eq!(node.valid, (1 << count) - 1);
                for k in 0..count {
                    let p = &node.planes;
                    let b = Aabb {
                        min: Vec3::new(p[0][k], p[2][k], p[4][k]),
                        max: Vec3::new(p[1][k], p[3][k], p[5][k]),
                    };
                    assert_eq!(outer.union(&b), outer);
                    let child = node.children[k];
                    if child & LEAF == 0 {
                        assert!(child > i);
                        open.push((child, b));
                    } else {
                        let (first, items) = leaf_items(child);
                        assert_eq!(items, 1);
                        for &id in &leaves[first as usize] {
                            seen[id as usize] += 1;
                            assert_eq!(b.union(&all[id as usize]), b);
                        }
                    }
                }
            }
            assert!(seen.iter().all(|&s| s == 1));
        }
    }

    #[test]
    fn a_tree_over_nothing_is_empty() {
        let tree = WideTree::build([].into_iter(), Purpose::Instances, &mut |_| unreachable!());
        assert!(tree.nodes.is_empty() && tree.bounds.is_empty());
    }
}
