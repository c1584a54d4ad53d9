//! [`Slices`], drawing from a tree of rank 4: for each square of viewers' directions the squares of incoming ones, as a tree of sums.

use super::square::{disc_to_square, square_to_direction};
use super::{Child, TensorTree};
use crate::{Index, Number};
use gonio_num::{Mask, Vec3};
use std::f64::consts::PI;

/// Numbers that the sums of all slices may take: 1 GiB.
const MOST_NUMBERS: usize = 1 << 28;

/// For each viewer's direction the luminance over the square of incoming directions.
#[derive(Debug, Clone)]
pub(super) struct Slices {
    /// Squares of viewers' directions: for each child of each branch its branch, or −1 − slice.
    viewers: Vec<f32>,
    depth: u32,
    /// For each slice (first branch in `sums` / 4096, its remainder, albedo, 0).
    slices: Vec<f32>,
    /// For each branch of each slice the sums of its 4 children, then their branches counted from the slice's first, or −1.
    sums: Vec<f32>,
}

/// A square of incoming directions in a slice: its lower corner, its side, and what the tree has there.
#[derive(Clone, Copy)]
struct Square {
    x: f64,
    y: f64,
    side: f64,
    child: Child,
}

impl Slices {
    /// Of a tree of rank 4; `light` is the luminance of a leaf.
    pub fn new(tree: &TensorTree, light: &impl Fn(u32) -> f64) -> Result<Self, (String, String)> {
        let mut this = Self {
            viewers: Vec::new(),
            depth: tree.depth,
            slices: Vec::new(),
            sums: Vec::new(),
        };
        let all = Square {
            x: 0.0,
            y: 0.0,
            side: 1.0,
            child: Child::Branch(0),
        };
        let code = this.divide(tree, light, &[all])?;
        if this.viewers.is_empty() {
            this.viewers.extend([code; 4]);
        }
        if this.slices.len() / 4 >= 1 << 24 {
            return Err((
                format!("{} slices", this.slices.len() / 4),
                "fewer than 16777216".into(),
            ));
        }
        Ok(this)
    }

    /// Makes what lies below one square of viewers' directions, for which `squares` is the slice; returns its code.
    fn divide(
        &mut self,
        tree: &TensorTree,
        light: &impl Fn(u32) -> f64,
        squares: &[Square],
    ) -> Result<f32, (String, String)> {
        let is_leaf = |s: &Square| matches!(s.child, Child::Leaf(_));
        if squares.iter().all(is_leaf) {
            return self.push(light, squares);
        }
        let branch = self.viewers.len() / 4;
        self.viewers.extend([0.0; 4]);
        for quarter in 0..4usize {
            let mut finer = Vec::with_capacity(squares.len());
            for s in squares {
                let Child::Branch(b) = s.child else {
                    finer.push(*s);
                    continue;
                };
                for place in 0..4usize {
                    let side = 0.5 * s.side;
                    finer.push(Square {
                        x: s.x + side * (place & 1) as f64,
                        y: s.y + side * (place >> 1) as f64,
                        side,
                        child: tree.child(b, quarter << 2 | place),
                    });
                }
            }
            let code = self.divide(tree, light, &finer)?;
            self.viewers[branch * 4 + quarter] = code;
        }
        Ok(branch as f32)
    }

    /// Appends a slice, all of whose squares are leaves.
    fn push(
        &mut self,
        light: &impl Fn(u32) -> f64,
        squares: &[Square],
    ) -> Result<f32, (String, String)> {
        if self.sums.len() + squares.len() * 3 > MOST_NUMBERS {
            return Err((
                format!("more than {MOST_NUMBERS} squares of all slices"),
                "a coarser tree".into(),
            ));
        }
        let number = self.slices.len() / 4;
        let first = self.sums.len() / 8;
        let total = self.sum(light, squares, [0.0, 0.0, 1.0], first);
        if self.sums.len() / 8 == first {
            // A single square: a branch of four equal ones.
            let quarter = 0.25 * total;
            self.sums.extend([quarter, quarter, quarter, quarter]);
            self.sums.extend([-1.0; 4]);
        }
        let albedo = f64::from(total) * PI;
        self.slices.extend([
            (first / 4096) as f32,
            (first % 4096) as f32,
            albedo as f32,
            0.0,
        ]);
        Ok(-1.0 - number as f32)
    }

    /// Luminance × area of `squares`, which fill the square [x, y, side]; branches are appended where there is more than one.
    fn sum(
        &mut self,
        light: &impl Fn(u32) -> f64,
        squares: &[Square],
        [x, y, side]: [f64; 3],
        first: usize,
    ) -> f32 {
        if let [only] = squares {
            let Child::Leaf(leaf) = only.child else {
                return 0.0;
            };
            return (light(leaf) * side * side) as f32;
        }
        let branch = self.sums.len() / 8;
        self.sums.extend([0.0; 8]);
        let half = 0.5 * side;
        for place in 0..4usize {
            let (px, py) = (
                x + half * (place & 1) as f64,
                y + half * (place >> 1) as f64,
            );
            let inside: Vec<Square> = squares
                .iter()
                .filter(|s| s.x >= px && s.x < px + half && s.y >= py && s.y < py + half)
                .copied()
                .collect();
            let next = self.sums.len() / 8;
            let sum = self.sum(light, &inside, [px, py, half], first);
            self.sums[branch * 8 + place] = sum;
            let code = if self.sums.len() / 8 > next {
                (next - first) as f32
            } else {
                -1.0
            };
            self.sums[branch * 8 + 4 + place] = code;
        }
        let at = branch * 8;
        self.sums[at..at + 4].iter().sum()
    }

    /// The slice of a viewer's direction: where its branches begin, and its albedo.
    #[inline(always)]
    fn slice<R: Number>(&self, wo: Vec3<R>) -> (R::Index, R) {
        let mut x = disc_to_square(wo.x, wo.y);
        let mut branch = R::Index::splat(0);
        let mut found = R::zero();
        let mut arrived = R::Mask::splat(false);
        for _ in 0..self.depth {
            let mut at = branch.times(4);
            for k in 0..2 {
                let twice = x[k] + x[k];
                let upper = twice.ge(R::one());
                at = R::select_index(upper, at.plus(R::Index::splat(1 << k)), at);
                x[k] = R::select(upper, twice - R::one(), twice);
            }
            let [code] = R::gather(&self.viewers, at);
            found = R::select(arrived, found, code);
            arrived = arrived | code.lt(R::zero());
            if !R::maybe_any(!arrived) {
                break;
            }
            branch = code.index((1 << 24) - 1);
        }
        let slice = (-R::one() - found).index((1 << 24) - 1);
        let [high, low, albedo, _] = R::gather(&self.slices, slice.times(4));
        let last = (1 << 24) - 1;
        (high.index(last).times(4096).plus(low.index(4095)), albedo)
    }

    /// The luminous albedo.
    #[inline(always)]
    pub fn albedo<R: Number>(&self, wo: Vec3<R>) -> R {
        self.slice(wo).1
    }

    /// Draws a direction with z ≥ 0, by going down the tree of sums with both numbers.
    #[inline(always)]
    pub fn sample<R: Number>(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let (first, _) = self.slice(wo);
        let (zero, one) = (R::zero(), R::one());
        let mut u = [u[0], u[1]];
        let mut branch = R::Index::splat(0);
        let (mut corner, mut side) = ([zero; 2], one);
        let mut arrived = R::Mask::splat(false);
        for _ in 0..self.depth {
            let at = first.plus(branch).times(8);
            let m = R::gather::<4>(&self.sums, at);
            let codes = R::gather::<4>(&self.sums, at.plus(R::Index::splat(4)));
            // First along x, then along y in the half that was chosen.
            let (left, right) = (m[0] + m[2], m[1] + m[3]);
            let p = left / (left + right).max(R::lit(1e-37));
            let (to_right, ux) = halve(u[0], p);
            let (low, high) = (
                R::select(to_right, m[1], m[0]),
                R::select(to_right, m[3], m[2]),
            );
            let p = low / (low + high).max(R::lit(1e-37));
            let (to_top, uy) = halve(u[1], p);
            let code = R::select(
                to_top,
                R::select(to_right, codes[3], codes[2]),
                R::select(to_right, codes[1], codes[0]),
            );
            let half = side * R::lit(0.5);
            let step = |mask: R::Mask, x: R| x + R::select(mask, half, zero);
            let next = [step(to_right, corner[0]), step(to_top, corner[1])];
            corner = [
                R::select(arrived, corner[0], next[0]),
                R::select(arrived, corner[1], next[1]),
            ];
            side = R::select(arrived, side, half);
            u = [R::select(arrived, u[0], ux), R::select(arrived, u[1], uy)];
            arrived = arrived | code.lt(zero);
            if !R::maybe_any(!arrived) {
                break;
            }
            branch = code.index((1 << 24) - 1);
        }
        let w = square_to_direction(corner[0] + u[0] * side, corner[1] + u[1] * side);
        // Named by where its light travels to.
        Vec3::new(-w.x, -w.y, w.z)
    }
}

/// Whether `u` in [0, 1) is in the upper part, the lower one having probability `p`, and where in its part.
#[inline(always)]
fn halve<R: Number>(u: R, p: R) -> (R::Mask, R) {
    let upper = p.le(u);
    let low = u / p.max(R::lit(1e-37));
    let high = (u - p) / (R::one() - p).max(R::lit(1e-37));
    (upper, R::select(upper, high, low).saturate())
}
