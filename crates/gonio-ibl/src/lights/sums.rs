//! Sums over rectangles of a panorama.

use super::DirectionalLight;
use gonio_env::{Environment, Layout};
use gonio_num::{Real, Vec3};
use std::f64::consts::{PI, TAU};

/// Columns of the grid that a picture of another layout is read on.
const OTHER_WIDTH: usize = 1024;

/// Columns x0 ≤ x < x1, rows y0 ≤ y < y1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Rectangle {
    pub x0: usize,
    pub x1: usize,
    pub y0: usize,
    pub y1: usize,
}

impl Rectangle {
    pub fn can_be_cut(&self) -> bool {
        self.x1 - self.x0 > 1 || self.y1 - self.y0 > 1
    }
}

/// Sums of a rectangle: solid angle, flux of three channels, luminous flux times direction, luminous flux.
const KINDS: usize = 8;

/// A panorama with its summed-area table (Crow 1984).
pub(super) struct Grid {
    width: usize,
    height: usize,
    /// (height + 1) × (width + 1).
    table: Vec<[f64; KINDS]>,
    axes: [Vec3<f64>; 3],
}

impl Grid {
    pub fn new(environment: &Environment) -> Self {
        let axis = [
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.0, 0.0, 1.0),
        ];
        match environment.lat_long_texels() {
            Some(t) => {
                let rgb = |x: usize, y: usize| {
                    let p = t.texels[y * t.width + x];
                    [0, 1, 2].map(|k| p[k] * t.scale[k])
                };
                let axes = axis.map(|a| t.to_world(a));
                Self::of(t.width, t.height, axes, rgb)
            }
            None => {
                let (w, h) = (OTHER_WIDTH, OTHER_WIDTH / 2);
                let rgb = |x: usize, y: usize| {
                    let uv = [(x as f64 + 0.5) / w as f64, (y as f64 + 0.5) / h as f64];
                    environment.radiance(Layout::LatLong.direction(uv).to_f32())
                };
                Self::of(w, h, axis, rgb)
            }
        }
    }

    fn of(
        width: usize,
        height: usize,
        axes: [Vec3<f64>; 3],
        rgb: impl Fn(usize, usize) -> [f32; 3],
    ) -> Self {
        let turns: Vec<(f64, f64)> = (0..width)
            .map(|x| Real::sin_cos(TAU * ((x as f64 + 0.5) / width as f64 - 0.5)))
            .collect();
        let stride = width + 1;
        let mut table = vec![[0.0; KINDS]; stride * (height + 1)];
        for y in 0..height {
            let (top, bottom) = (
                PI * y as f64 / height as f64,
                PI * (y + 1) as f64 / height as f64,
            );
            let (sin, cos) = Real::sin_cos(0.5 * (top + bottom));
            let w = TAU / width as f64 * (Real::cos(top) - Real::cos(bottom));
            let mut running = [0.0; KINDS];
            for x in 0..width {
                let p = rgb(x, y).map(|c| f64::from(c) * w);
                let e = crate::nodes::luminance(p);
                let d = [sin * turns[x].0, cos, -sin * turns[x].1];
                let all = [w, p[0], p[1], p[2], e * d[0], e * d[1], e * d[2], e];
                for k in 0..KINDS {
                    running[k] += all[k];
                    table[(y + 1) * stride + x + 1][k] = table[y * stride + x + 1][k] + running[k];
                }
            }
        }
        Self {
            width,
            height,
            table,
            axes,
        }
    }

    pub fn whole(&self) -> Rectangle {
        Rectangle {
            x0: 0,
            x1: self.width,
            y0: 0,
            y1: self.height,
        }
    }

    fn sums(&self, r: &Rectangle) -> [f64; KINDS] {
        let at = |x: usize, y: usize| &self.table[y * (self.width + 1) + x];
        let (a, b, c, d) = (
            at(r.x0, r.y0),
            at(r.x1, r.y0),
            at(r.x0, r.y1),
            at(r.x1, r.y1),
        );
        std::array::from_fn(|k| (d[k] - b[k]) - (c[k] - a[k]))
    }

    /// Luminous flux.
    pub fn flux(&self, r: &Rectangle) -> f64 {
        self.sums(r)[7].max(0.0)
    }

    /// Σ E |ω − ω̄|².
    pub fn variance(&self, r: &Rectangle) -> f64 {
        let s = self.sums(r);
        if s[7] <= 0.0 {
            return 0.0;
        }
        (s[7] - (s[4] * s[4] + s[5] * s[5] + s[6] * s[6]) / s[7]).max(0.0)
    }

    fn columns(r: &Rectangle, x: usize) -> (Rectangle, Rectangle) {
        (Rectangle { x1: x, ..*r }, Rectangle { x0: x, ..*r })
    }

    fn rows(r: &Rectangle, y: usize) -> (Rectangle, Rectangle) {
        (Rectangle { y1: y, ..*r }, Rectangle { y0: y, ..*r })
    }

    /// Across the longer side, which narrows towards the poles, into halves of flux as equal as texels allow.
    pub fn cut_at_median(&self, r: &Rectangle) -> (Rectangle, Rectangle) {
        let middle = PI * 0.5 * (r.y0 + r.y1) as f64 / self.height as f64;
        let across = TAU * (r.x1 - r.x0) as f64 / self.width as f64 * Real::sin(middle);
        let down = PI * (r.y1 - r.y0) as f64 / self.height as f64;
        let by_columns = (across >= down && r.x1 - r.x0 > 1) || r.y1 - r.y0 < 2;
        let (first, last) = if by_columns {
            (r.x0 + 1, r.x1 - 1)
        } else {
            (r.y0 + 1, r.y1 - 1)
        };
        let cut = |at: usize| {
            if by_columns {
                Self::columns(r, at)
            } else {
                Self::rows(r, at)
            }
        };
        let half = 0.5 * self.flux(r);
        // Flux up to a cut grows with it.
        let (mut low, mut high) = (first, last);
        while low < high {
            let at = low.midpoint(high);
            if self.flux(&cut(at).0) >= half {
                high = at;
            } else {
                low = at + 1;
            }
        }
        cut(low)
    }

    /// Where the variances of the halves add up to the least.
    pub fn cut_for_variance(&self, r: &Rectangle) -> (Rectangle, Rectangle) {
        let columns = (r.x0 + 1..r.x1).map(|x| Self::columns(r, x));
        let rows = (r.y0 + 1..r.y1).map(|y| Self::rows(r, y));
        let mut best: Option<(f64, (Rectangle, Rectangle))> = None;
        for halves in columns.chain(rows) {
            let sum = self.variance(&halves.0) + self.variance(&halves.1);
            if best.is_none_or(|(least, _)| sum < least) {
                best = Some((sum, halves));
            }
        }
        best.expect("invariant: only regions that can be cut are").1
    }

    /// The light that stands for a region; nothing if it is black.
    pub fn light(&self, r: &Rectangle) -> Option<DirectionalLight> {
        let s = self.sums(r);
        let [x, y, z] = self.axes;
        let d = x * s[4] + y * s[5] + z * s[6];
        if s[7] <= 0.0 {
            return None;
        }
        // Flux from all around has no direction: then the zenith is as good as any.
        let d = if d.length() > 1e-12 * s[7] {
            d.normalize()
        } else {
            Vec3::new(0.0, 1.0, 0.0)
        };
        Some(DirectionalLight {
            direction: [d.x, d.y, d.z],
            irradiance: [s[1], s[2], s[3]].map(|c| c.max(0.0)),
            solid_angle: s[0],
        })
    }
}
