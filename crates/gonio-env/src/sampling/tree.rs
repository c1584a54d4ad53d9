//! Sampling through a quad-tree over the cells, as a whole (Clarberg et al. 2005, "Wavelet importance sampling") or weighed by the
//! cosine with a normal.
//!
//! From the root down, u is warped by the masses of the four children: the halves above and below, then left and right. Near the root
//! each child may be weighed, in addition, by the largest cosine that it can have with a normal. The density of a direction is then
//! that of the light times (probability of its node) / (mass of its node), at the depth where the weighing ends.

use super::nodes::Nodes;
use gonio_num::{Real, Vec3};
use std::f64::consts::{PI, TAU};

/// The masses of the cells, and of two by two of them, up to one.
#[derive(Debug)]
pub(super) struct Tree {
    /// From the cells (0) to the root.
    levels: Vec<Level>,
    /// The finest level that knows the cones of its nodes.
    finest_weighed: usize,
}

#[derive(Debug)]
struct Level {
    width: usize,
    height: usize,
    masses: Vec<f32>,
    /// Around each node: axis, cosine and sine of the half-angle. Empty below the weighed levels.
    cones: Vec<(Vec3<f32>, f32, f32)>,
}

/// Nodes that the finest weighed level may have across. Its nodes are about 3° wide, over which a cosine hardly changes.
const WEIGHED_ACROSS: usize = 128;

impl Tree {
    pub fn new(nodes: &Nodes) -> Self {
        let (width, height) = (nodes.width, nodes.height + 1);
        let masses = (0..width * height)
            .map(|k| nodes.cell_mass(k / width, k % width) as f32)
            .collect();
        let mut levels = vec![Level {
            width,
            height,
            masses,
            cones: Vec::new(),
        }];
        while let Some(fine) = levels.last()
            && fine.masses.len() > 1
        {
            let coarse = fine.halved();
            levels.push(coarse);
        }
        let finest_weighed = levels
            .iter()
            .position(|l| l.width <= WEIGHED_ACROSS)
            .unwrap_or(levels.len() - 1);
        for (depth, level) in levels.iter_mut().enumerate().skip(finest_weighed) {
            level.cones = (0..level.masses.len())
                .map(|k| cone(nodes, depth, k % level.width, k / level.width))
                .collect();
        }
        Self {
            levels,
            finest_weighed,
        }
    }

    /// A unit direction distributed by the density; with a normal, by the density times the bound of the cosine. Nothing where only
    /// nodes below the horizon are left.
    #[inline]
    pub fn sample(
        &self,
        nodes: &Nodes,
        u: [f32; 2],
        normal: Option<Vec3<f32>>,
    ) -> Option<Vec3<f32>> {
        let [mut x, mut y] = [0, 0];
        let mut u = u.map(f64::from);
        for depth in (0..self.levels.len() - 1).rev() {
            let (nodes, weights) =
                self.children(depth, x, y, normal.filter(|_| depth >= self.finest_weighed));
            let upper = weights[0] + weights[1];
            let whole = upper + weights[2] + weights[3];
            if whole <= 0.0 {
                return None;
            }
            let lower = choose(&mut u[1], upper, whole);
            let pair = [weights[2 * lower], weights[2 * lower + 1]];
            let right = choose(&mut u[0], pair[0], pair[0] + pair[1]);
            [x, y] = nodes[2 * lower + right];
        }
        Some(nodes.sample_cell(y, x, u))
    }

    /// How much more likely a direction is with the normal than without: probability of its weighed node over the node's share of
    /// the light.
    #[inline]
    pub fn factor(&self, (band, column): (usize, usize), normal: Vec3<f32>) -> f32 {
        let top = self.levels.len() - 1;
        let mut probability = 1.0;
        let mut share = 1.0;
        for depth in (self.finest_weighed..top).rev() {
            let (x, y) = (column >> (depth + 1), band >> (depth + 1));
            let (nodes, weights) = self.children(depth, x, y, Some(normal));
            let whole: f64 = weights.iter().sum();
            if whole <= 0.0 {
                return 0.0;
            }
            let wanted = [column >> depth, band >> depth];
            let mut plain = 0.0;
            for (node, weight) in nodes.iter().zip(weights) {
                let level = &self.levels[depth];
                if node[0] < level.width && node[1] < level.height {
                    plain += f64::from(level.masses[node[1] * level.width + node[0]]);
                }
                if *node == wanted {
                    probability *= weight / whole;
                }
            }
            let level = &self.levels[depth];
            share *= f64::from(level.masses[wanted[1] * level.width + wanted[0]]) / plain;
        }
        if share > 0.0 {
            (probability / share) as f32
        } else {
            0.0
        }
    }

    /// The four children of node (x, y) of the level above `depth`, upper left first, and their weights: 0 beyond the edge.
    #[inline(always)]
    fn children(
        &self,
        depth: usize,
        x: usize,
        y: usize,
        normal: Option<Vec3<f32>>,
    ) -> ([[usize; 2]; 4], [f64; 4]) {
        let level = &self.levels[depth];
        let mut nodes = [[0; 2]; 4];
        let mut weights = [0.0; 4];
        for (k, (node, weight)) in nodes.iter_mut().zip(&mut weights).enumerate() {
            *node = [2 * x + (k & 1), 2 * y + (k >> 1)];
            if node[0] < level.width && node[1] < level.height {
                let at = node[1] * level.width + node[0];
                *weight = f64::from(level.masses[at]);
                if let Some(n) = normal {
                    *weight *= f64::from(largest_cosine(level.cones[at], n));
                }
            }
        }
        (nodes, weights)
    }
}

/// 0 with the probability `first` / `whole`, else 1; `u` becomes the place in what was chosen.
#[inline(always)]
fn choose(u: &mut f64, first: f64, whole: f64) -> usize {
    let share = first / whole;
    if *u < share {
        *u /= share;
        0
    } else {
        // A half without weight is never chosen, whatever u was rounded to.
        if first >= whole {
            *u = 1.0;
            return 0;
        }
        *u = (*u - share) / (1.0 - share);
        1
    }
}

impl Level {
    fn halved(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let at = |x: usize, y: usize| {
            if x < self.width && y < self.height {
                f64::from(self.masses[y * self.width + x])
            } else {
                0.0
            }
        };
        let masses = (0..width * height)
            .map(|k| {
                let (x, y) = (2 * (k % width), 2 * (k / width));
                (at(x, y) + at(x + 1, y) + at(x, y + 1) + at(x + 1, y + 1)) as f32
            })
            .collect();
        Self {
            width,
            height,
            masses,
            cones: Vec::new(),
        }
    }
}

/// A cone around node (x, y) of level `depth`.
fn cone(nodes: &Nodes, depth: usize, x: usize, y: usize) -> (Vec3<f32>, f32, f32) {
    let side = 1 << depth;
    let rows = [y * side, ((y + 1) * side).min(nodes.height + 1)];
    let columns = [x * side, ((x + 1) * side).min(nodes.width)];
    let (low, high) = (nodes.band_ends(rows[0])[0], nodes.band_ends(rows[1] - 1)[1]);
    let step = TAU / nodes.width as f64;
    let middle = 0.5 * (low + high);
    let phi = step * (0.5 + 0.5 * (columns[0] + columns[1]) as f64) - PI;
    let widest = if low <= 0.5 * PI && high >= 0.5 * PI {
        1.0
    } else {
        Real::sin(low).max(Real::sin(high))
    };
    // No point is farther from the centre, and a little for roundings.
    let reach = 0.5 * (high - low) + 0.5 * step * (columns[1] - columns[0]) as f64 * widest + 1e-4;
    let ((sin, cos), (sin_phi, cos_phi)) = (Real::sin_cos(middle), Real::sin_cos(phi));
    let axis = Vec3::new(sin * sin_phi, cos, -sin * cos_phi);
    let (sin, cos) = Real::sin_cos(reach.min(PI));
    (axis.to_f32(), cos as f32, sin as f32)
}

/// The largest max(0, cosine) with the normal within a cone.
#[inline(always)]
fn largest_cosine((axis, cos, sin): (Vec3<f32>, f32, f32), n: Vec3<f32>) -> f32 {
    let along = axis.dot(n);
    if along >= cos {
        return 1.0;
    }
    (along * cos + ((1.0 - along) * (1.0 + along)).max(0.0).sqrt() * sin).max(0.0)
}
