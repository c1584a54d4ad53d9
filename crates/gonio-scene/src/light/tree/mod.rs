//! [`LightTree`]: one of many lights, chosen by what they may send to a point.
//!
//! Conty Estévez & Kulla 2018, "Importance Sampling of Many Lights with Adaptive Tree Splitting": a hierarchy of lights, where each node
//! knows a bound on what the lights below it send to a point. From the root down one child is chosen in proportion to its bound, with one
//! number, whose rest chooses the next.
//!
//! Here a node has eight children, whose bounds are evaluated together: the way down is a third as long, and as many of the choices are
//! made among eight bounds instead of two, which are then those of smaller groups. Emissive meshes are there triangle by triangle.
//! The paper's splitting, several lights a point where the bounds say little, isn't done: a path takes one light a reflection.

mod bounds;
mod build;
mod cone;
mod many;
mod source;
#[cfg(test)]
pub(super) mod tests;

use super::emitter::Emitter;
use super::{Light, Receiver};
use crate::Geometry;
use bounds::{COLUMNS, LightBounds};
use gonio_num::Vec3;
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
pub(super) use many::{Choices, Points, Walks};
use source::Source;

/// Children of a node.
const WIDTH: usize = 8;
/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;
/// No such thing.
const NONE: u32 = u32::MAX;

/// Lights that have a place, ordered by where they are and which way they shine. Memory: 424 bytes for each node of up to eight children, and
/// 20 for each light or triangle.
#[derive(Debug)]
pub(super) struct LightTree {
    /// The root first.
    nodes: Vec<Node>,
    leaves: Vec<Leaf>,
    /// For each light its first place in `leaf_of`, or [`NONE`].
    first: Vec<u32>,
    /// For each light that isn't a mesh its leaf, for others that of each triangle, or [`NONE`].
    leaf_of: Vec<u32>,
}

#[derive(Debug)]
struct Node {
    /// The coordinates of [`LightBounds`], one a child.
    bounds: [[f32; WIDTH]; COLUMNS],
    /// A node, or a leaf with [`LEAF`]; of no meaning where the intensity is 0.
    children: [u32; WIDTH],
    /// The node above and which child of it this is; [`NONE`] for the root.
    parent: (u32, u32),
}

#[derive(Debug, Clone, Copy)]
struct Leaf {
    light: u32,
    /// Of a mesh, or `WHOLE`.
    primitive: u32,
    /// Whose child it is, and which.
    parent: (u32, u32),
}

/// A light that was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    pub light: u32,
    /// Of a mesh, or `WHOLE`.
    pub primitive: u32,
    pub probability: f64,
    /// Uniform in \[0, 1) again.
    pub rest: f64,
}

impl LightTree {
    /// The tree of the lights that have a place and shine; nothing if there are fewer than two leaves.
    ///
    /// - `powers`: of each light, weighted by luminance
    pub fn new(
        geometry: &Geometry,
        lights: &[Light],
        emitters: &[Option<Emitter>],
        powers: &[f64],
    ) -> Option<Self> {
        let mut sources = Vec::new();
        for (i, light) in lights.iter().enumerate() {
            if powers[i] > 0.0 && powers[i].is_finite() {
                let light = (i as u32, light, emitters[i].as_ref());
                Source::push(&mut sources, geometry, light, powers[i]);
            }
        }
        (sources.len() > 1).then(|| build::build(sources, lights.len()))
    }

    /// Whether a light is in it.
    pub fn holds(&self, light: u32) -> bool {
        self.first[light as usize] != NONE
    }

    /// Whether a light is in it triangle by triangle.
    pub fn has_parts(&self, light: u32) -> bool {
        let first = self.first[light as usize];
        let parts = self.leaf_of.get(first as usize..).unwrap_or_default();
        let leaf = parts.iter().find(|&&leaf| leaf != NONE);
        leaf.is_some_and(|&leaf| self.leaves[leaf as usize].primitive != super::WHOLE)
    }

    /// Chooses a leaf for a point. Nothing where no light may arrive. It is quick within a [`Kernel`] alone.
    #[inline(always)]
    pub fn choose(&self, at: &Receiver, u: f64) -> Option<Found> {
        self.choose_below(0, at, u, 1.0)
    }

    /// The rest of the way, from a node that is reached with this probability.
    #[inline(always)]
    fn choose_below(&self, node: usize, at: &Receiver, u: f64, probability: f64) -> Option<Found> {
        let (mut u, mut probability, mut node) = (u, probability, node);
        loop {
            let importance = self.nodes[node].importance(at);
            let total = total(&importance);
            if total <= 0.0 {
                return None;
            }
            let mut left = u * total;
            // The last that is possible, where roundings lead past the end.
            let mut chosen = WIDTH;
            for (i, &one) in importance.iter().enumerate() {
                let one = f64::from(one);
                if one > 0.0 {
                    chosen = i;
                    if left < one {
                        break;
                    }
                    left -= one;
                }
            }
            let one = f64::from(importance[chosen]);
            probability *= one / total;
            u = (left / one).clamp(0.0, BELOW_ONE);
            let child = self.nodes[node].children[chosen];
            if child & LEAF != 0 {
                let leaf = &self.leaves[(child & !LEAF) as usize];
                return Some(Found {
                    light: leaf.light,
                    primitive: leaf.primitive,
                    probability,
                    rest: u,
                });
            }
            node = child as usize;
        }
    }

    /// The probability with which [`LightTree::choose`] chooses this light at a point; of a mesh, this triangle of it.
    pub fn probability(&self, at: &Receiver, light: u32, primitive: u32) -> f64 {
        self.leaf(light, primitive).map_or(0.0, |leaf| {
            dispatch(Climb {
                tree: self,
                at,
                leaf,
            })
        })
    }

    fn leaf(&self, light: u32, primitive: u32) -> Option<&Leaf> {
        let first = *self.first.get(light as usize).filter(|&&f| f != NONE)?;
        let whole = primitive == super::WHOLE;
        let place = first + if whole { 0 } else { primitive };
        self.leaves.get(*self.leaf_of.get(place as usize)? as usize)
    }

    /// The probability that some leaf of a light is chosen.
    pub fn probability_of_light(&self, at: &Receiver, light: u32) -> f64 {
        let leaves = self.leaves.iter().filter(|l| l.light == light);
        leaves
            .map(|l| self.probability(at, light, l.primitive))
            .sum()
    }
}

/// The largest number below 1.
const BELOW_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

#[inline(always)]
fn total(importance: &[f32; WIDTH]) -> f64 {
    let mut total = 0.0;
    for &one in importance {
        total += f64::from(one);
    }
    total
}

impl Node {
    #[inline(always)]
    fn importance(&self, at: &Receiver) -> [f32; WIDTH] {
        let mut columns = [Lanes([0.0; WIDTH]); COLUMNS];
        for (lanes, column) in columns.iter_mut().zip(&self.bounds) {
            *lanes = Lanes(*column);
        }
        let bounds = LightBounds::from_columns(columns);
        let (p, n) = (at.p, at.normal);
        let p = Vec3::new(Lanes::splat(p.x), Lanes::splat(p.y), Lanes::splat(p.z));
        let n = Vec3::new(Lanes::splat(n.x), Lanes::splat(n.y), Lanes::splat(n.z));
        bounds.importance(p, n).0
    }
}

struct Climb<'a> {
    tree: &'a LightTree,
    at: &'a Receiver,
    leaf: &'a Leaf,
}

impl Kernel for Climb<'_> {
    type Output = f64;
    #[inline(always)]
    fn run<const L: usize>(self) -> f64 {
        let mut probability = 1.0;
        let (mut node, mut child) = self.leaf.parent;
        while node != NONE {
            let at = &self.tree.nodes[node as usize];
            let importance = at.importance(self.at);
            let one = f64::from(importance[child as usize]);
            if one <= 0.0 {
                return 0.0;
            }
            probability *= one / total(&importance);
            (node, child) = at.parent;
        }
        probability
    }
}
