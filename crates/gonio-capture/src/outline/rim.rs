//! Edges along the normals of an outline that is nearly right, and the curve through them that is the rim.

use super::edges::Plane;
use crate::ball::Ball;
use crate::solve::Normal;
use gonio_num::Real;
use gonio_radiometry::sequence::Rng;
use std::f64::consts::TAU;

/// Normals along which edges are sought.
const NORMALS: usize = 720;
/// Contrast, in the logarithm of luminance, of an edge.
const CONTRAST: f64 = 0.025;
/// Curves that are tried.
const TRIALS: usize = 4000;
/// A curve farther out prevails if it has at least this share of the normals that the best has.
const NEARLY_AS_GOOD: f64 = 0.8;

/// One normal of the outline.
struct Line {
    /// Its angle around the ball.
    t: f64,
    start: [f64; 2],
    out: [f64; 2],
    /// Distances along it of its edges, outwards; ascending.
    edges: Vec<f64>,
}

impl Line {
    fn point(&self, s: f64) -> [f64; 2] {
        [
            self.start[0] + s * self.out[0],
            self.start[1] + s * self.out[1],
        ]
    }

    /// The edge nearest to `s`, within `reach`.
    fn near(&self, s: f64, reach: f64) -> Option<f64> {
        let nearest = |best: Option<f64>, e: &f64| match best {
            Some(b) if (b - s).abs() <= (e - s).abs() => Some(b),
            _ => Some(*e),
        };
        self.edges
            .iter()
            .fold(None, nearest)
            .filter(|e| (e - s).abs() <= reach)
    }
}

/// Width \[pixels] of the smoothing: a large ball's rim is rarely sharp to the pixel.
fn scale(ball: &Ball) -> f64 {
    (ball.radius() / 900.0).clamp(0.7, 3.0)
}

/// Edges within `reach` pixels of the outline, on the normals that are in the picture that far.
fn lines(plane: &Plane, ball: &Ball, reach: f64) -> Vec<Line> {
    let sigma = scale(ball);
    let step = 0.5 * sigma;
    let (width, height) = (plane.width as f64, plane.height as f64);
    // The derivative of a Gaussian, so normalised that a slope is per pixel.
    const HALF: usize = 6;
    let mut kernel = [0.0; HALF + 1];
    let mut sum = 0.0;
    for (j, w) in kernel.iter_mut().enumerate() {
        let x = j as f64 * step;
        *w = x * Real::exp(-0.5 * (x / sigma).sq());
        sum += 2.0 * *w * x;
    }
    let count = (reach / step).ceil() as usize;
    let centre = ball.centre();
    let mut found = Vec::with_capacity(NORMALS);
    for k in 0..NORMALS {
        let t = TAU * k as f64 / NORMALS as f64;
        let start = ball.outline(t);
        let (dx, dy) = (start[0] - centre[0], start[1] - centre[1]);
        let length = dx.hypot(dy);
        let out = [dx / length, dy / length];
        let far = [start[0] + reach * out[0], start[1] + reach * out[1]];
        let inside =
            |p: [f64; 2]| p[0] > 1.0 && p[1] > 1.0 && p[0] < width - 1.0 && p[1] < height - 1.0;
        if !inside(start) {
            continue;
        }
        // A rim that touches the picture's border is sought up to it.
        let last = if inside(far) {
            count
        } else {
            (0..=count)
                .rfind(|i| {
                    let s = (*i + HALF) as f64 * step;
                    inside([start[0] + s * out[0], start[1] + s * out[1]])
                })
                .unwrap_or(0)
        };
        let mut line = Line {
            t,
            start,
            out,
            edges: Vec::new(),
        };
        let value = |i: isize| {
            let p = line.point(i as f64 * step);
            // The mean over a short piece of the outline: less noise.
            let across = |q: f64| plane.at(p[0] - q * sigma * out[1], p[1] + q * sigma * out[0]);
            Real::ln([-2.0, -1.0, 0.0, 1.0, 2.0].map(across).iter().sum::<f64>() / 5.0)
        };
        let first = -(count as isize);
        let profile: Vec<f64> = (first - HALF as isize..=last as isize + HALF as isize)
            .map(value)
            .collect();
        let slope: Vec<f64> = (HALF..profile.len() - HALF)
            .map(|i| {
                let s: f64 = (1..=HALF)
                    .map(|j| kernel[j] * (profile[i + j] - profile[i - j]))
                    .sum();
                (s / sum).abs()
            })
            .collect();
        for i in 1..slope.len().saturating_sub(1) {
            let (a, b, c) = (slope[i - 1], slope[i], slope[i + 1]);
            // A step of contrast C smoothed by σ has the slope C / (σ √(2π)).
            if b >= a && b > c && b * sigma * 2.507 > CONTRAST {
                let shift = 0.5 * (a - c) / (a - 2.0 * b + c);
                line.edges
                    .push((i as isize + first) as f64 * step + shift * step);
            }
        }
        found.push(line);
    }
    found
}

/// The edges of the rim near a first guess of the outline: of the curves δ(t) = a + b cos t + c sin t, by which the outline moves if
/// its radius and centre change a little, the outermost that has nearly as many edges as the best.
pub(super) fn outermost(plane: &Plane, ball: &Ball, reach: f64) -> Vec<[f64; 2]> {
    let reach = reach.max(0.03 * ball.radius());
    let lines = lines(plane, ball, reach);
    let near = 1.2 * scale(ball);
    let edges: Vec<(f64, f64)> = lines
        .iter()
        .flat_map(|l| l.edges.iter().map(|s| (l.t, *s)))
        .collect();
    if edges.len() < 16 {
        return Vec::new();
    }
    let row = |t: f64| {
        let (s, c) = Real::sin_cos(t);
        [1.0, c, s]
    };
    let rows: Vec<[f64; 3]> = lines.iter().map(|l| row(l.t)).collect();
    let at = |p: &[f64; 3], r: &[f64; 3]| p[0] * r[0] + p[1] * r[1] + p[2] * r[2];
    let support = |p: &[f64; 3]| {
        lines
            .iter()
            .zip(&rows)
            .filter(|(l, r)| l.near(at(p, r), near).is_some())
            .count()
    };
    let mut rng = Rng::from_name("curves along a rim");
    let mut tried: Vec<([f64; 3], usize)> = Vec::new();
    let mut most = 0;
    for _ in 0..TRIALS {
        let mut normal = Normal::<3>::new();
        for _ in 0..3 {
            let (t, s) = edges[(rng.next_f64() * edges.len() as f64) as usize];
            normal.add(row(t), s, 1.0);
        }
        let Some(p) = normal.solve() else { continue };
        if p[0].abs() + p[1].hypot(p[2]) > 1.5 * reach {
            continue;
        }
        let n = support(&p);
        most = most.max(n);
        tried.push((p, n));
    }
    let good = tried
        .iter()
        .filter(|(_, n)| *n as f64 >= NEARLY_AS_GOOD * most as f64)
        .max_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let Some((mut p, _)) = good.copied() else {
        return Vec::new();
    };
    // The outermost is so because its three edges err outwards: follow all that are near.
    for _ in 0..5 {
        let mut normal = Normal::<3>::new();
        for (l, r) in lines.iter().zip(&rows) {
            if let Some(s) = l.near(at(&p, r), 2.0 * near) {
                normal.add(*r, s, 1.0);
            }
        }
        let Some(next) = normal.solve() else { break };
        p = next;
    }
    lines
        .iter()
        .zip(&rows)
        .filter_map(|(l, r)| l.near(at(&p, r), near).map(|s| l.point(s)))
        .collect()
}

/// On each normal the edge nearest to the outline, if one is near.
pub(super) fn nearest(plane: &Plane, ball: &Ball) -> Vec<[f64; 2]> {
    let reach = 3.0 * scale(ball);
    lines(plane, ball, reach + 2.0)
        .iter()
        .filter_map(|l| l.near(0.0, reach).map(|s| l.point(s)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Projection;

    /// A disc of radius 200 with a darker ring inside it: the outer of the two steps, the fainter one, is the rim.
    #[test]
    fn the_outermost_edge_is_the_rim() {
        let values = (0..500 * 500)
            .map(|i| {
                let (x, y) = (f64::from(i % 500) + 0.5, f64::from(i / 500) + 0.5);
                let d = (x - 251.0).hypot(y - 249.0);
                let step = |r: f64| 1.0 / (1.0 + Real::exp(2.0 * (d - r)));
                (1.0 - 0.1 * step(200.0) - 0.6 * step(196.0)) as f32
            })
            .collect();
        let plane = Plane {
            width: 500,
            height: 500,
            values,
        };
        let guess = Ball::new(Projection::Orthographic, [250.0, 250.0], 196.5);
        let found = outermost(&plane, &guess, 3.0);
        assert!(found.len() > 600, "{}", found.len());
        for p in found {
            let d = (p[0] - 251.0).hypot(p[1] - 249.0);
            // A maximum of a smoothed slope, 0.35 pixel apart, moved by the slope of the strong step four pixels inside.
            assert!((d - 200.0).abs() < 0.3, "{d}");
        }
    }
}
