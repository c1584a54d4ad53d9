//! Edges of a brightness picture: places where it changes most, with the direction of the change.

/// One channel, row after row from the top left.
#[derive(Debug, Clone)]
pub(crate) struct Plane {
    pub width: usize,
    pub height: usize,
    pub values: Vec<f32>,
}

impl Plane {
    /// Value at a pixel coordinate (the first pixel's centre is ½), linear between centres, constant beyond the border.
    pub fn at(&self, x: f64, y: f64) -> f64 {
        let x = (x - 0.5).clamp(0.0, (self.width - 1) as f64);
        let y = (y - 0.5).clamp(0.0, (self.height - 1) as f64);
        let (i, j) = (x as usize, y as usize);
        let (s, t) = (x - i as f64, y - j as f64);
        let (i2, j2) = ((i + 1).min(self.width - 1), (j + 1).min(self.height - 1));
        let v = |i: usize, j: usize| f64::from(self.values[j * self.width + i]);
        (v(i, j) * (1.0 - s) + v(i2, j) * s) * (1.0 - t)
            + (v(i, j2) * (1.0 - s) + v(i2, j2) * s) * t
    }

    /// The plane averaged over squares of `k` × `k`; a rest at the right and below is left out.
    pub fn shrunk(&self, k: usize) -> Self {
        let (width, height) = (self.width / k, self.height / k);
        let mut values = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                let mut sum = 0.0;
                for row in self.values[y * k * self.width..].chunks(self.width).take(k) {
                    sum += row[x * k..(x + 1) * k].iter().sum::<f32>();
                }
                values.push(sum / (k * k) as f32);
            }
        }
        Self {
            width,
            height,
            values,
        }
    }

    /// Smoothed with [1 4 6 4 1]/16 along both axes: a standard deviation of 1 pixel.
    fn smooth(&self) -> Self {
        const KERNEL: [f32; 5] = [0.0625, 0.25, 0.375, 0.25, 0.0625];
        let (w, h) = (self.width, self.height);
        let near = |i: usize, d: usize, n: usize| (i + d).saturating_sub(2).min(n - 1);
        let mut across = vec![0.0; w * h];
        for y in 0..h {
            for x in 0..w {
                across[y * w + x] = (0..5)
                    .map(|d| KERNEL[d] * self.values[y * w + near(x, d, w)])
                    .sum();
            }
        }
        let mut values = vec![0.0; w * h];
        for y in 0..h {
            for x in 0..w {
                values[y * w + x] = (0..5)
                    .map(|d| KERNEL[d] * across[near(y, d, h) * w + x])
                    .sum();
            }
        }
        Self {
            width: w,
            height: h,
            values,
        }
    }
}

/// An edge.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge {
    /// Pixel coordinates, to a fraction of a pixel.
    pub at: [f64; 2],
    /// Unit gradient.
    pub direction: [f64; 2],
    /// Length of the gradient.
    pub strength: f64,
}

/// Smallest change a pixel, of the logarithm of brightness, that is an edge.
const WEAKEST: f32 = 0.015;

/// The `most` strongest edges: local maxima of the gradient along itself (Canny 1986), in descending strength.
pub(crate) fn find(plane: &Plane, most: usize) -> Vec<Edge> {
    let p = plane.smooth();
    let (w, h) = (p.width, p.height);
    if w < 5 || h < 5 {
        return Vec::new();
    }
    let mut length = vec![0.0_f32; w * h];
    let mut gradient = vec![[0.0_f32; 2]; w * h];
    for y in 1..h - 1 {
        for x in 1..w - 1 {
            let i = y * w + x;
            let g = [
                0.5 * (p.values[i + 1] - p.values[i - 1]),
                0.5 * (p.values[i + w] - p.values[i - w]),
            ];
            gradient[i] = g;
            length[i] = (g[0] * g[0] + g[1] * g[1]).sqrt();
        }
    }
    let mut edges = Vec::new();
    for y in 2..h - 2 {
        for x in 2..w - 2 {
            let i = y * w + x;
            let here = length[i];
            if here < WEAKEST {
                continue;
            }
            let d = [gradient[i][0] / here, gradient[i][1] / here];
            // Neighbours one step along the larger component of the gradient, interpolated between two pixels.
            let ahead = |sign: f32| {
                let (dx, dy) = (sign * d[0], sign * d[1]);
                let step = |v: f32| if v >= 0.0 { 1_isize } else { -1 };
                let pick =
                    |dx: isize, dy: isize| length[(i as isize + dx + dy * w as isize) as usize];
                if dx.abs() >= dy.abs() {
                    let t = dy.abs() / dx.abs();
                    (1.0 - t) * pick(step(dx), 0) + t * pick(step(dx), step(dy))
                } else {
                    let t = dx.abs() / dy.abs();
                    (1.0 - t) * pick(0, step(dy)) + t * pick(step(dx), step(dy))
                }
            };
            let (before, after) = (ahead(-1.0), ahead(1.0));
            if before >= here || after > here {
                continue;
            }
            // The top of the parabola through three lengths.
            let shift = 0.5 * (before - after) / (before - 2.0 * here + after);
            let step = f64::from(shift / d[0].abs().max(d[1].abs()));
            let d = d.map(f64::from);
            edges.push(Edge {
                at: [x as f64 + 0.5 + step * d[0], y as f64 + 0.5 + step * d[1]],
                direction: d,
                strength: f64::from(here),
            });
        }
    }
    // Stable: of equal edges the upper left one is first.
    edges.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    edges.truncate(most);
    edges
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Real;

    /// A disc with a blurred rim: the logistic function is steepest exactly at the rim. Its curvature shifts the maximum of the
    /// smoothed picture by σ²/2r = 0.017 pixel inwards, and the parabola through three samples of a bell of width 1.5 by less than
    /// 0.1.
    #[test]
    fn a_discs_rim_is_found_to_a_tenth_of_a_pixel() {
        let (cx, cy, r) = (50.3, 48.7, 30.0);
        let values = (0..100 * 100)
            .map(|i| {
                let (x, y) = (f64::from(i % 100) + 0.5, f64::from(i / 100) + 0.5);
                let d = (x - cx).hypot(y - cy) - r;
                (1.0 / (1.0 + Real::exp(d))) as f32
            })
            .collect();
        let plane = Plane {
            width: 100,
            height: 100,
            values,
        };
        let edges = find(&plane, 10_000);
        assert!(edges.len() > 150, "{}", edges.len());
        for e in &edges {
            let v = [e.at[0] - cx, e.at[1] - cy];
            let d = v[0].hypot(v[1]);
            assert!((d - r).abs() < 0.12, "{d}");
            // It is bright inside: the gradient points to the centre.
            assert!((v[0] * e.direction[0] + v[1] * e.direction[1]) / d < -0.99);
        }
    }

    #[test]
    fn a_flat_picture_has_none() {
        let plane = Plane {
            width: 20,
            height: 20,
            values: vec![0.3; 400],
        };
        assert!(find(&plane, 100).is_empty());
        assert!(find(&plane.shrunk(10), 100).is_empty());
    }
}
