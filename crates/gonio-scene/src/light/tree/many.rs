//! [`LightTree::choose`] for many points: those that are at one node together choose among its children on lanes.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::{BELOW_ONE, Found, LEAF, LightBounds, LightTree, Node, WIDTH};
use crate::light::Receiver;
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3, Vectors};

/// Points on their way down the tree, and room for an order to be made in. They are kept from one call to the next, so that nothing is
/// allocated.
#[derive(Debug, Clone, Default)]
pub(in crate::light) struct Walks {
    walks: Vec<Walk>,
    spare: Vec<Walk>,
    /// Nodes that points have reached, with the range of them.
    open: Vec<(u32, std::ops::Range<usize>)>,
}

/// A point on its way.
#[derive(Debug, Clone, Copy)]
struct Walk {
    point: u32,
    /// The child that it has chosen.
    child: u32,
    /// What is left of its number.
    u: f64,
    probability: f64,
}

/// Where the points are.
#[derive(Clone, Copy)]
pub(in crate::light) struct Points<'a> {
    pub p: &'a Vectors,
    /// As [`Receiver::normal`]; empty where there are none.
    pub normals: &'a Vectors,
}

/// Points at a node from which on lanes pay. Not in WebAssembly, where a page loads the code, and lanes are four.
const MANY: usize = if cfg!(target_family = "wasm") {
    usize::MAX
} else {
    3
};

impl Walks {
    pub fn clear(&mut self) {
        self.walks.clear();
    }

    /// Adds a point, with its number.
    #[inline(always)]
    pub fn push(&mut self, point: u32, u: f64) {
        self.walks.push(Walk {
            point,
            child: 0,
            u,
            probability: 1.0,
        });
    }
}

impl Points<'_> {
    #[inline(always)]
    fn receiver(&self, i: usize) -> Receiver {
        Receiver {
            p: self.p.get(i),
            error: 0.0,
            normal: if self.normals.is_empty() {
                Vec3::zero()
            } else {
                self.normals.get(i)
            },
        }
    }
}

impl LightTree {
    /// [`LightTree::choose`] for the points in `walks`, the same to the bit.
    ///
    /// - `found`: called with each point that finds a light
    #[inline(always)]
    pub fn choose_many<const L: usize>(
        &self,
        points: Points<'_>,
        walks: &mut Walks,
        found: &mut impl Choices,
    ) {
        let Walks { walks, spare, open } = walks;
        open.clear();
        open.push((0, 0..walks.len()));
        while let Some((node, range)) = open.pop() {
            let here = &mut walks[range.clone()];
            if here.len() < MANY {
                for walk in here {
                    let at = points.receiver(walk.point as usize);
                    let below = self.choose_below(node as usize, &at, walk.u, walk.probability);
                    if let Some(one) = below {
                        found.found(walk.point, &one);
                    }
                }
                continue;
            }
            let node = &self.nodes[node as usize];
            let mut at = 0;
            while at < here.len() {
                let end = here.len().min(at + L);
                node.choose_child::<L>(points, &mut here[at..end]);
                at = end;
            }
            // Those that have arrived are done, the others are put together by the child that they have chosen.
            let mut population = [0; WIDTH];
            for walk in &*here {
                let child = walk.child as usize;
                if child == WIDTH {
                    continue;
                }
                let below = node.children[child];
                if below & LEAF != 0 {
                    let leaf = &self.leaves[(below & !LEAF) as usize];
                    let one = Found {
                        light: leaf.light,
                        primitive: leaf.primitive,
                        probability: walk.probability,
                        rest: walk.u,
                    };
                    found.found(walk.point, &one);
                } else {
                    population[child] += 1;
                }
            }
            let mut starts = [0; WIDTH];
            let mut start = 0;
            for child in 0..WIDTH {
                starts[child] = start;
                start += population[child];
                if population[child] > 0 {
                    let place = range.start + starts[child];
                    open.push((node.children[child], place..place + population[child]));
                }
            }
            if start == 0 {
                continue;
            }
            spare.clear();
            spare.extend_from_slice(here);
            for walk in &*spare {
                let child = walk.child as usize;
                if child < WIDTH && node.children[child] & LEAF == 0 {
                    here[starts[child]] = *walk;
                    starts[child] += 1;
                }
            }
        }
    }
}

/// What is done with the lights that are chosen.
pub(in crate::light) trait Choices {
    fn found(&mut self, point: u32, found: &Found);
}

impl Node {
    /// Up to `L` points at this node choose a child each: [`WIDTH`] if no light may arrive.
    #[inline(always)]
    fn choose_child<const L: usize>(&self, points: Points<'_>, walks: &mut [Walk]) {
        let mut p = Vec3::splat(Lanes([0.0; L]));
        let mut n = p;
        let mut u = DoubleLanes([0.0; L]);
        for (lane, walk) in walks.iter().enumerate() {
            let at = points.receiver(walk.point as usize);
            (p.x.0[lane], p.y.0[lane], p.z.0[lane]) = (at.p.x, at.p.y, at.p.z);
            (n.x.0[lane], n.y.0[lane], n.z.0[lane]) = (at.normal.x, at.normal.y, at.normal.z);
            u.0[lane] = walk.u;
        }
        let zero = DoubleLanes([0.0; L]);
        let mut importance = [zero; WIDTH];
        let mut total = zero;
        for child in 0..WIDTH {
            if self.bounds[INTENSITY][child] == 0.0 {
                continue;
            }
            let mut columns = [Lanes([0.0; L]); super::COLUMNS];
            for (lanes, column) in columns.iter_mut().zip(&self.bounds) {
                *lanes = Lanes::splat(column[child]);
            }
            let one = LightBounds::from_columns(columns).importance(p, n);
            importance[child] = one.to_double();
            total = total + importance[child];
        }
        let mut left = u * total;
        let mut open = zero.lt(total);
        let mut chosen = Lanes::splat(WIDTH as f32);
        let mut of_chosen = DoubleLanes([1.0; L]);
        for child in 0..WIDTH {
            let one = importance[child];
            // The last that is possible, where roundings lead past the end.
            let possible = open & zero.lt(one);
            chosen = Lanes::select(possible, Lanes::splat(child as f32), chosen);
            of_chosen = DoubleLanes::select(possible, one, of_chosen);
            let here = possible & left.lt(one);
            left = DoubleLanes::select(possible & !here, left - one, left);
            open = open & !here;
        }
        let share = of_chosen / total;
        let rest = (left / of_chosen).clamp(zero, DoubleLanes::lit(BELOW_ONE));
        // Read again from memory: a lane that is chosen at run time is slow to reach in a register.
        let columns = [rest.0, share.0, chosen.to_double().0];
        let [rest, share, chosen] = &columns;
        let found = rest.iter().zip(share).zip(chosen);
        for (walk, ((&rest, &share), &chosen)) in walks.iter_mut().zip(found) {
            walk.child = chosen as u32;
            walk.u = rest;
            walk.probability *= share;
        }
    }
}

/// The row of [`Node::bounds`] that has the intensity.
const INTENSITY: usize = 10;
