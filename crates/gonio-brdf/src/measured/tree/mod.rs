//! [`TensorTree`], values over squares of varying size, and how they are evaluated and drawn from.

mod rings;
mod slices;
mod square;
mod table;

pub(super) use square::square_to_direction;
pub(super) use table::TreeTable;

use super::grid::parameterization::horizontal;
use super::values::Values;
use gonio_num::Vec3;
use square::disc_to_square;

/// Levels that a tree may have: squares of 2⁻¹².
pub(super) const DEEPEST: u32 = 12;
/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;

/// One child of a branch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Child {
    /// The branch with this number.
    Branch(u32),
    /// The leaf with this number.
    Leaf(u32),
}

/// Values that are constant in hypercubes, each a half of its parent along every side (Ward et al. 2012).
///
/// The hemispheres are unit squares by the map of Shirley & Chiu: an area of the square is a projected solid angle over π. Of rank 4:
/// the incoming direction, named by the azimuth in which its light travels, then the outgoing one. Of rank 3, isotropic:
/// ½ − ½ sinθi, then the outgoing direction turned so that light travels to azimuth 0.
#[derive(Debug, Clone, PartialEq)]
pub struct TensorTree {
    rank: u32,
    channels: usize,
    depth: u32,
    /// 2ʳᵃⁿᵏ children of each branch, the first of them the root; bit k of a child's place is the upper half of coordinate k.
    children: Vec<u32>,
    leaves: Values,
}

/// A tree as it grows.
pub(super) struct Growing {
    rank: u32,
    channels: usize,
    children: Vec<u32>,
    leaves: Vec<f32>,
}

impl Growing {
    /// Nothing yet.
    pub fn new(rank: u32, channels: usize) -> Self {
        Self {
            rank,
            channels,
            children: Vec::new(),
            leaves: Vec::new(),
        }
    }

    /// A new branch, whose children are to be set.
    pub fn branch(&mut self) -> u32 {
        let n = 1 << self.rank;
        let number = (self.children.len() / n) as u32;
        self.children.resize(self.children.len() + n, LEAF);
        number
    }

    /// A new leaf with these numbers.
    pub fn leaf(&mut self, values: impl IntoIterator<Item = f32>) -> Child {
        let number = (self.leaves.len() / self.channels) as u32;
        self.leaves.extend(values);
        Child::Leaf(number)
    }

    /// Whether no branch was made after this one, nor a leaf set in it.
    pub fn is_last(&self, branch: u32) -> bool {
        ((branch as usize + 1) << self.rank) == self.children.len()
    }

    /// Takes back the branch that was made last.
    pub fn forget_last(&mut self) {
        let n = self.children.len().saturating_sub(1 << self.rank);
        self.children.truncate(n);
    }

    /// Sets a child of a branch.
    pub fn set(&mut self, branch: u32, place: usize, child: Child) {
        let at = ((branch as usize) << self.rank) + place;
        self.children[at] = match child {
            Child::Branch(b) => b,
            Child::Leaf(l) => l | LEAF,
        };
    }

    /// The tree of the branches with these leaves.
    pub fn with(self, leaves: Values) -> TensorTree {
        let mut tree = TensorTree {
            rank: self.rank,
            channels: self.channels,
            depth: 0,
            children: self.children,
            leaves,
        };
        tree.depth = tree.measure(0, 1);
        tree
    }

    /// The tree whose root is the branch 0, or a leaf that is alone.
    pub fn done(mut self) -> TensorTree {
        if self.children.is_empty() {
            let root = self.branch();
            for place in 0..1 << self.rank {
                self.set(root, place, Child::Leaf(0));
            }
        }
        let leaves = std::mem::take(&mut self.leaves);
        self.with(leaves.into())
    }
}

impl TensorTree {
    /// 3 (isotropic) or 4.
    pub fn rank(&self) -> usize {
        self.rank as usize
    }

    /// Numbers for each leaf.
    pub fn channels(&self) -> usize {
        self.channels
    }

    /// Levels: the smallest squares have sides of 2^−depth.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// The numbers, leaf by leaf.
    pub fn leaves(&self) -> &Values {
        &self.leaves
    }

    pub(super) fn with_leaves(&self, leaves: Values) -> Self {
        Self {
            leaves,
            ..self.clone()
        }
    }

    /// Number of branches.
    pub(super) fn branches(&self) -> usize {
        self.children.len() >> self.rank
    }

    pub(super) fn child(&self, branch: u32, place: usize) -> Child {
        let code = self.children[((branch as usize) << self.rank) + place];
        if code & LEAF != 0 {
            Child::Leaf(code & !LEAF)
        } else {
            Child::Branch(code)
        }
    }

    pub(super) fn leaf(&self, number: u32) -> &[f32] {
        let at = number as usize * self.channels;
        &self.leaves[at..at + self.channels]
    }

    fn measure(&self, branch: u32, level: u32) -> u32 {
        (0..1usize << self.rank)
            .map(|place| match self.child(branch, place) {
                Child::Leaf(_) => level,
                Child::Branch(b) => self.measure(b, level + 1),
            })
            .max()
            .unwrap_or(level)
    }

    /// The leaf that holds the point `x` of the unit cube.
    pub(super) fn find(&self, mut x: [f64; 4]) -> u32 {
        let mut branch = 0;
        loop {
            let mut place = 0;
            for (k, x) in x.iter_mut().enumerate().take(self.rank()) {
                *x *= 2.0;
                if *x >= 1.0 {
                    *x -= 1.0;
                    place |= 1 << k;
                }
            }
            match self.child(branch, place) {
                Child::Leaf(l) => return l,
                Child::Branch(b) => branch = b,
            }
        }
    }

    /// All channels, whatever side the directions are on.
    pub(super) fn lookup(&self, wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]) {
        let leaf = self.find(coordinates(self.rank, wi, wo));
        for (x, value) in out.iter_mut().zip(self.leaf(leaf)) {
            *x = f64::from(*value);
        }
    }
}

/// The place of a pair of directions in the unit cube; the last of rank 3 is 0.
#[inline(always)]
fn coordinates<R: crate::Number>(rank: u32, wi: Vec3<R>, wo: Vec3<R>) -> [R; 4] {
    if rank == 4 {
        let [a, b] = disc_to_square(-wi.x, -wi.y);
        let [c, d] = disc_to_square(wo.x, wo.y);
        return [a, b, c, d];
    }
    let s2 = wi.x * wi.x + wi.y * wi.y;
    let sin = s2.max(R::lit(1e-30)).sqrt();
    let at_normal = s2.lt(R::lit(1e-30));
    let cos_phi = R::select(at_normal, R::one(), -wi.x / sin);
    let sin_phi = R::select(at_normal, R::zero(), -wi.y / sin);
    // A viewer at the normal is taken to be just beside it: the middle of the square is the corner of four cells.
    let [x, y] = horizontal(wo);
    let beside = (wo.x * wo.x + wo.y * wo.y).lt(R::lit(1e-12));
    let scale = R::select(
        beside,
        R::lit(1e-6) / (x * x + y * y).max(R::lit(1e-30)).sqrt(),
        R::one(),
    );
    let (x, y) = (x * scale, y * scale);
    let [b, c] = disc_to_square(cos_phi * x + sin_phi * y, cos_phi * y - sin_phi * x);
    let half = R::lit(0.5);
    let a = (half - half * sin).clamp(R::zero(), R::lit(0.5 - 1.0 / 33_554_432.0));
    [a, b, c, R::zero()]
}
