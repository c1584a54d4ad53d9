//! The sphere cut into cells that follow a density: fine where it is high, with about as many pilot samples in each.

use crate::cubature::Rect;
use crate::directions::azimuth;
use gonio_num::{Real, Vec3};
use std::f64::consts::TAU;

/// The coordinates (z, φ) of a direction, accurate near the poles.
///
/// There z itself has lost the polar angle: 1 − z = θ²/2. It is taken from x and y instead, which also makes it as
/// accurate for a direction that was rounded to `f32`.
pub(crate) fn coordinates(w: Vec3<f64>) -> [f64; 2] {
    let s2 = w.x * w.x + w.y * w.y;
    let z = if s2 < 0.5 {
        let down = s2 / (1.0 + (1.0 - s2).sqrt());
        if w.z < 0.0 { down - 1.0 } else { 1.0 - down }
    } else {
        w.z.clamp(-1.0, 1.0)
    };
    [z, azimuth(w)]
}

/// A direction drawn to see where the mass lies: its coordinates and the density of whatever is to be integrated.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pilot {
    pub at: [f64; 2],
    pub density: f64,
}

/// When a cell is small enough.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rules {
    /// A cell with more pilot samples is split at their median.
    pub max_points: usize,
    /// A cell is halved while its solid angle times the largest density of its pilot samples is above this: what it would
    /// hold if it were as dense everywhere. So a cell never hides a summit in its corner, between the nodes of a quadrature.
    pub max_mass: f64,
    /// A larger cell is halved, in sr.
    pub max_solid_angle: f64,
    /// A cell around a seed direction is halved until it is narrower, in radians.
    pub seed_width: f64,
}

enum Node {
    Leaf(usize),
    Split {
        axis: usize,
        at: f64,
        children: [usize; 2],
    },
}

/// A k-d tree over (z, φ).
pub(crate) struct Partition {
    nodes: Vec<Node>,
    /// The cells; together they cover the hemisphere above, or the sphere.
    pub cells: Vec<Rect>,
    whole_sphere: bool,
}

impl Partition {
    /// Cuts the upper hemisphere, or the sphere, with a cut along the horizon.
    pub(crate) fn new(
        mut points: Vec<Pilot>,
        seeds: &[Vec3<f64>],
        rules: &Rules,
        whole_sphere: bool,
    ) -> Self {
        let mut p = Self {
            nodes: Vec::new(),
            cells: Vec::new(),
            whole_sphere,
        };
        let seeds: Vec<[f64; 2]> = seeds.iter().map(|s| coordinates(*s)).collect();
        let upper = Rect {
            low: [0.0, 0.0],
            high: [1.0, TAU],
        };
        if whole_sphere {
            p.nodes.push(Node::Leaf(0));
            points.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
            let above = points.partition_point(|p| p.at[0] < 0.0);
            let lower = Rect {
                low: [-1.0, 0.0],
                high: [0.0, TAU],
            };
            let (down, up) = points.split_at_mut(above);
            let children = [
                p.build(lower, down, &seeds, rules),
                p.build(upper, up, &seeds, rules),
            ];
            p.nodes[0] = Node::Split {
                axis: 0,
                at: 0.0,
                children,
            };
        } else {
            points.retain(|p| p.at[0] >= 0.0);
            p.build(upper, &mut points, &seeds, rules);
        }
        p
    }

    fn build(
        &mut self,
        rect: Rect,
        points: &mut [Pilot],
        seeds: &[[f64; 2]],
        rules: &Rules,
    ) -> usize {
        let node = self.nodes.len();
        self.nodes.push(Node::Leaf(self.cells.len()));
        let widths = widths(&rect);
        let longer = usize::from(widths[1] > widths[0]);
        let holds = |s: &[f64; 2]| (0..2).all(|k| s[k] >= rect.low[k] && s[k] <= rect.high[k]);
        let highest = points.iter().map(|p| p.density).fold(0.0, f64::max);
        let crowded = points.len() > rules.max_points;
        let dense = rect.area() * highest > rules.max_mass;
        let cut = if crowded || dense {
            let uneven = [0, 1].map(|axis| unevenness(points, &rect, axis));
            // Even along both, as far as so few points tell (Kolmogorov's 5 % point): keep the cells round.
            let even = 1.36 / (points.len() as f64).sqrt();
            let first = if uneven[0].max(uneven[1]) < even {
                longer
            } else {
                usize::from(uneven[1] > uneven[0])
            };
            if crowded {
                median(points, &rect, first).or_else(|| median(points, &rect, 1 - first))
            } else {
                halving(&rect, first)
            }
        } else if rect.area() > rules.max_solid_angle
            || (widths[longer] > rules.seed_width && seeds.iter().any(holds))
        {
            halving(&rect, longer)
        } else {
            None
        };
        let Some((axis, at)) = cut else {
            self.cells.push(rect);
            return node;
        };
        let halves = rect.split(axis, at);
        let mut below = 0;
        for i in 0..points.len() {
            if points[i].at[axis] < at {
                points.swap(i, below);
                below += 1;
            }
        }
        let (a, b) = points.split_at_mut(below);
        let children = [
            self.build(halves[0], a, seeds, rules),
            self.build(halves[1], b, seeds, rules),
        ];
        self.nodes[node] = Node::Split { axis, at, children };
        node
    }

    /// The cell that holds `w`; `None` below the horizon of a hemisphere.
    pub(crate) fn find(&self, w: Vec3<f64>) -> Option<usize> {
        let x = coordinates(w);
        if !self.whole_sphere && x[0] < 0.0 {
            return None;
        }
        let mut node = 0;
        loop {
            match self.nodes[node] {
                Node::Leaf(cell) => return Some(cell),
                Node::Split { axis, at, children } => {
                    node = children[usize::from(x[axis] >= at)];
                }
            }
        }
    }
}

/// The cell's largest extents along θ and φ, in radians on the sphere.
fn widths(r: &Rect) -> [f64; 2] {
    let theta = |z: f64| -> f64 { Real::acos(z) };
    let widest = if r.low[0] * r.high[0] <= 0.0 {
        0.0
    } else {
        r.low[0].abs().min(r.high[0].abs())
    };
    let sin = (1.0 - widest * widest).max(0.0).sqrt();
    [
        theta(r.low[0]) - theta(r.high[0]),
        sin * (r.high[1] - r.low[1]),
    ]
}

/// How far the points are from even along `axis` of the cell: Kolmogorov's distance from the uniform distribution.
///
/// A lobe near grazing is hundreds of times longer in θ than in φ. Cuts along the axis where it varies resolve it, where
/// round cells would each hold its whole width.
fn unevenness(points: &mut [Pilot], rect: &Rect, axis: usize) -> f64 {
    points.sort_unstable_by(|a, b| a.at[axis].total_cmp(&b.at[axis]));
    let (low, n) = (rect.low[axis], points.len() as f64);
    let width = rect.high[axis] - low;
    let mut distance: f64 = 0.0;
    for (i, p) in points.iter().enumerate() {
        let x = (p.at[axis] - low) / width;
        distance = distance.max(x - i as f64 / n).max((i + 1) as f64 / n - x);
    }
    distance
}

/// The cut through the middle; none where `f64` has hardly a number between.
fn halving(rect: &Rect, axis: usize) -> Option<(usize, f64)> {
    let width = rect.high[axis] - rect.low[axis];
    (width > 1e-14).then(|| (axis, rect.centre()[axis]))
}

/// A cut along `axis` that halves the points; none where they coincide.
fn median(points: &mut [Pilot], rect: &Rect, axis: usize) -> Option<(usize, f64)> {
    let middle = points.len() / 2;
    let (_, at, _) =
        points.select_nth_unstable_by(middle, |a, b| a.at[axis].total_cmp(&b.at[axis]));
    let at = at.at[axis];
    // A sliver would hold nothing but rounding.
    let margin = 1e-6 * (rect.high[axis] - rect.low[axis]);
    (at > rect.low[axis] + margin && at < rect.high[axis] - margin).then_some((axis, at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::directions::{moved, spherical, uniform};
    use gonio_radiometry::sequence::Rng;

    const RULES: Rules = Rules {
        max_points: 16,
        max_mass: f64::INFINITY,
        max_solid_angle: 0.2,
        seed_width: 0.01,
    };

    fn pilot(at: [f64; 2]) -> Pilot {
        Pilot { at, density: 1.0 }
    }

    #[test]
    fn a_dense_point_shrinks_its_cell() {
        let rules = Rules {
            max_mass: 0.01,
            ..RULES
        };
        let summit = Pilot {
            at: [0.5, 1.0],
            density: 1e6,
        };
        let p = Partition::new(vec![summit], &[], &rules, false);
        let cell = p.cells[p.find(crate::directions::at_height(0.5, 1.0)).unwrap()];
        assert!(cell.area() <= 1e-8 && cell.area() > 1e-9);
    }

    #[test]
    fn cells_cover_the_sphere_once() {
        let mut rng = Rng::from_name("cells_cover_the_sphere_once");
        let lobe = spherical(1.0, 0.05);
        let points = (0..4000)
            .map(|_| {
                pilot(coordinates(moved(
                    lobe,
                    0.01 * rng.next_f64(),
                    TAU * rng.next_f64(),
                )))
            })
            .collect();
        let p = Partition::new(points, &[spherical(0.3, 2.0)], &RULES, true);
        let area: f64 = p.cells.iter().map(Rect::area).sum();
        assert!((area - 2.0 * TAU).abs() < 1e-12);
        assert!(p.cells.len() > 250);
        for k in 0..10_000 {
            let mut w = uniform(&mut rng);
            if k % 2 == 0 {
                w.z = -w.z;
            }
            let x = coordinates(w);
            let cell = p.cells[p.find(w).unwrap()];
            assert!((0..2).all(|k| cell.low[k] <= x[k] && x[k] <= cell.high[k]));
        }
        let seeded = p.cells[p.find(spherical(0.3, 2.0)).unwrap()];
        assert!(widths(&seeded).iter().all(|w| *w <= 0.01));
    }

    #[test]
    fn coincident_points_end_the_splitting() {
        let p = Partition::new(vec![pilot([0.5, 1.0]); 1000], &[], &RULES, true);
        assert!(p.cells.len() < 1000);
    }

    #[test]
    fn below_the_horizon_is_in_no_cell_of_a_hemisphere() {
        let p = Partition::new(vec![], &[], &RULES, false);
        assert_eq!(p.find(Vec3::new(0.0, 0.6, -0.8)), None);
        assert!(p.find(Vec3::new(0.0, 0.6, 0.8)).is_some());
    }

    #[test]
    fn coordinates_near_the_pole_keep_their_digits() {
        let w = spherical(1e-7, 1.0).to_f32().to_f64();
        // 1 − z = θ²/2 = 5e-15, of which f64 next to 1 resolves 1.1e-16.
        assert!(((1.0 - coordinates(w)[0]) / 5e-15 - 1.0).abs() < 0.03);
    }
}
