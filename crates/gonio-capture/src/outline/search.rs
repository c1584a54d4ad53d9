//! The circle that most of its own circumference is an edge of: RANSAC (Fischler & Bolles 1981) over three edges.

use super::edges::Edge;
use gonio_radiometry::sequence::Rng;
use std::f64::consts::{PI, TAU};

/// A circle \[pixels].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Circle {
    pub centre: [f64; 2],
    pub radius: f64,
}

/// Triples that are tried. If a fraction p of the edges is the ball's, p³ of the triples are good: at p = 3 % more than five in
/// this number.
const TRIALS: usize = 250_000;
/// Sectors of the circumference, each of which has an edge or not.
const SECTORS: usize = 180;
/// Distance \[pixels] of an edge from the circle, and cosine of its gradient to the radius, at which it still belongs to it.
const NEAR: f64 = 1.25;
const RADIAL: f64 = 0.94;
/// Share of the circumference that has to be in the picture.
const INSIDE: f64 = 0.6;

/// The best circle, and how much of it is an edge beyond what chance gives: (c − p)/(1 − p) for a share c of its sectors and
/// a share p of the sectors of circles a little larger and smaller. The same edges give the same circle.
pub(crate) fn find(edges: &[Edge], size: [usize; 2]) -> Option<(Circle, f64)> {
    if edges.len() < 16 {
        return None;
    }
    let [w, h] = size.map(|n| n as f64);
    let (smallest, largest) = (0.05 * w.max(h), 0.75 * w.max(h));
    let mut rng = Rng::from_name("circles of edges");
    let mut pick = || edges[(rng.next_f64() * edges.len() as f64) as usize];
    let mut best: Option<(Circle, f64)> = None;
    for _ in 0..TRIALS {
        let three = [pick(), pick(), pick()];
        let Some(circle) = through(three.map(|e| e.at)) else {
            continue;
        };
        let [x, y] = circle.centre;
        let plausible = (smallest..largest).contains(&circle.radius)
            && (0.0..w).contains(&x)
            && (0.0..h).contains(&y)
            && three.iter().all(|e| circle.holds(e));
        if !plausible {
            continue;
        }
        let score = circle.coverage(edges, size);
        if best.is_none_or(|(_, s)| score > s) {
            best = Some((circle, score));
        }
    }
    let (mut circle, mut score) = best?;
    // The best triple is only as exact as its three edges: follow all that belong to the circle.
    for _ in 0..10 {
        let Some(next) = circle.refitted(edges) else {
            break;
        };
        let better = next.coverage(edges, size);
        if better < score {
            break;
        }
        (circle, score) = (next, better);
    }
    Some((circle, circle.beyond_chance(edges, size, score)))
}

impl Circle {
    fn holds(&self, e: &Edge) -> bool {
        self.off(e, RADIAL).is_some_and(|d| d.abs() < NEAR)
    }

    /// Distance of an edge from the circle, if its gradient is radial.
    fn off(&self, e: &Edge, radial: f64) -> Option<f64> {
        let v = [e.at[0] - self.centre[0], e.at[1] - self.centre[1]];
        let d2 = v[0] * v[0] + v[1] * v[1];
        let along = v[0] * e.direction[0] + v[1] * e.direction[1];
        (along * along > radial * radial * d2).then(|| d2.sqrt() - self.radius)
    }

    /// Share of the sectors in the picture that have an edge; 0 if too little of the circle is in the picture.
    fn coverage(&self, edges: &[Edge], size: [usize; 2]) -> f64 {
        let mut hit = [false; SECTORS];
        for e in edges {
            let far = (e.at[0] - self.centre[0])
                .abs()
                .max((e.at[1] - self.centre[1]).abs());
            if far > self.radius + NEAR || far < 0.7 * self.radius - NEAR || !self.holds(e) {
                continue;
            }
            let t = (e.at[1] - self.centre[1]).atan2(e.at[0] - self.centre[0]);
            hit[(((t + PI) / TAU * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
        }
        let visible: Vec<bool> = (0..SECTORS)
            .map(|k| {
                let t = (k as f64 + 0.5) / SECTORS as f64 * TAU - PI;
                let p = [
                    self.centre[0] + self.radius * gonio_num::Real::cos(t),
                    self.centre[1] + self.radius * gonio_num::Real::sin(t),
                ];
                (0..2).all(|a| p[a] > 2.0 && p[a] < size[a] as f64 - 2.0)
            })
            .collect();
        let seen = visible.iter().filter(|v| **v).count();
        if (seen as f64) < INSIDE * SECTORS as f64 {
            return 0.0;
        }
        let found = hit.iter().zip(&visible).filter(|(h, v)| **h && **v).count();
        found as f64 / seen as f64
    }

    /// Least squares over the edges of the circle: |p|² = 2 c · p + (r² − |c|²) is linear in c and the bracket (Kåsa 1976).
    fn refitted(&self, edges: &[Edge]) -> Option<Self> {
        let mut normal = crate::solve::Normal::<3>::new();
        for e in edges.iter().filter(|e| self.holds(e)) {
            let (x, y) = (e.at[0] - self.centre[0], e.at[1] - self.centre[1]);
            normal.add([2.0 * x, 2.0 * y, 1.0], x * x + y * y, 1.0);
        }
        let [x, y, k] = normal.solve()?;
        Some(Self {
            centre: [self.centre[0] + x, self.centre[1] + y],
            radius: (k + x * x + y * y).max(0.0).sqrt(),
        })
    }

    fn beyond_chance(&self, edges: &[Edge], size: [usize; 2], coverage: f64) -> f64 {
        let others = [0.8, 0.85, 0.9, 1.06, 1.1].map(|k| {
            Self {
                radius: k * self.radius,
                ..*self
            }
            .coverage(edges, size)
        });
        let chance = others.iter().sum::<f64>() / others.len() as f64;
        (coverage - chance) / (1.0 - chance).max(0.05)
    }
}

/// The circle through three points; `None` if they are nearly in line.
fn through([a, b, c]: [[f64; 2]; 3]) -> Option<Circle> {
    let (bx, by) = (b[0] - a[0], b[1] - a[1]);
    let (cx, cy) = (c[0] - a[0], c[1] - a[1]);
    let det = 2.0 * (bx * cy - by * cx);
    if det.abs() < 1.0 {
        return None;
    }
    let (b2, c2) = (bx * bx + by * by, cx * cx + cy * cy);
    let x = (cy * b2 - by * c2) / det;
    let y = (bx * c2 - cx * b2) / det;
    Some(Circle {
        centre: [a[0] + x, a[1] + y],
        radius: x.hypot(y),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    fn clutter(rng: &mut Rng, n: usize) -> Vec<Edge> {
        (0..n)
            .map(|_| {
                let (s, c) = Real::sin_cos(TAU * rng.next_f64());
                Edge {
                    at: [400.0 * rng.next_f64(), 300.0 * rng.next_f64()],
                    direction: [c, s],
                    strength: 1.0,
                }
            })
            .collect()
    }

    #[test]
    fn a_circle_is_found_among_clutter() {
        let mut rng = Rng::from_name("circle among clutter");
        let mut edges = clutter(&mut rng, 4000);
        for k in 0..400 {
            let (s, c) = Real::sin_cos(f64::from(k));
            let r = 100.0 + 0.3 * (rng.next_f64() - 0.5);
            edges.push(Edge {
                at: [210.0 + r * c, 140.0 + r * s],
                direction: [c, s],
                strength: 1.0,
            });
        }
        let (circle, score) = find(&edges, [400, 300]).unwrap();
        // 400 edges of 0.3/√12 = 0.09: the mean is known to 0.01. Clutter within ± 1.25 pixels pulls at random: some 20 edges of
        // 0.7 among 400, 0.7 √20 / 400 = 0.008.
        assert!((circle.centre[0] - 210.0).abs() < 0.1 && (circle.centre[1] - 140.0).abs() < 0.1);
        assert!((circle.radius - 100.0).abs() < 0.1, "{circle:?}");
        assert!(score > 0.9, "{score}");
        assert_eq!(find(&edges, [400, 300]).unwrap().0, circle);
    }

    #[test]
    fn clutter_alone_has_no_circle() {
        let mut rng = Rng::from_name("clutter alone");
        let found = find(&clutter(&mut rng, 6000), [400, 300]);
        assert!(found.is_none_or(|(_, score)| score < 0.3), "{found:?}");
        assert!(find(&[], [400, 300]).is_none());
    }

    #[test]
    fn three_points_make_a_circle() {
        let c = through([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]]).unwrap();
        assert!(c.centre[0].abs() < 1e-15 && c.centre[1].abs() < 1e-15);
        assert!((c.radius - 1.0).abs() < 1e-15);
        assert!(through([[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).is_none());
    }
}
