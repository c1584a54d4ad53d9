//! A depth buffer: triangles and lines in space, drawn with what is nearer in front.

use crate::canvas::Colour;
use gonio_num::{Real, Vec3};

/// Samples of a pixel along each side.
const SAMPLES: usize = 2;

/// A picture in the making.
pub(crate) struct Depth {
    size: [usize; 2],
    /// Distance towards the viewer, and colour, linear; row by row from the top, `SAMPLES`² for each pixel.
    samples: Vec<(f32, [f32; 3])>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    towards: Vec3<f64>,
    /// Pixels in a unit of length.
    scale: f64,
    centre: [f64; 2],
}

/// A corner of a triangle.
#[derive(Clone, Copy)]
pub(crate) struct Corner {
    pub at: Vec3<f64>,
    pub normal: Vec3<f64>,
}

impl Depth {
    /// A white picture of `size` pixels, seen from far away at these angles in degrees; the origin is at `centre`, in pixels.
    pub fn new(
        size: [usize; 2],
        azimuth: f64,
        elevation: f64,
        scale: f64,
        centre: [f64; 2],
    ) -> Self {
        let (sin_a, cos_a) = Real::sin_cos(azimuth.to_radians());
        let (sin_e, cos_e) = Real::sin_cos(elevation.to_radians());
        let n = SAMPLES as f64;
        Self {
            size,
            samples: vec![(f32::NEG_INFINITY, [1.0; 3]); size[0] * size[1] * SAMPLES * SAMPLES],
            right: Vec3::new(-sin_a, cos_a, 0.0),
            up: Vec3::new(-sin_e * cos_a, -sin_e * sin_a, cos_e),
            towards: Vec3::new(cos_e * cos_a, cos_e * sin_a, sin_e),
            scale: scale * n,
            centre: centre.map(|x| x * n),
        }
    }

    /// Where a point is seen, in pixels of the picture.
    pub fn place(&self, p: Vec3<f64>) -> [f64; 2] {
        let [x, y, _] = self.project(p);
        [x / SAMPLES as f64, y / SAMPLES as f64]
    }

    fn project(&self, p: Vec3<f64>) -> [f64; 3] {
        [
            self.centre[0] + self.scale * p.dot(self.right),
            self.centre[1] - self.scale * p.dot(self.up),
            p.dot(self.towards),
        ]
    }

    /// A triangle, shaded between its corners' normals; either side is lit.
    pub fn triangle(&mut self, corners: [Corner; 3], colour: [f32; 3]) {
        let [a, b, c] = corners.map(|c| self.project(c.at));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        if area.abs() < 1e-12 {
            return;
        }
        let [width, height] = self.size.map(|n| n * SAMPLES);
        let bounds = |k: usize, most: usize| {
            let low = a[k].min(b[k]).min(c[k]).floor().max(0.0) as usize;
            let high = a[k].max(b[k]).max(c[k]).ceil().max(0.0) as usize;
            low..high.min(most)
        };
        for y in bounds(1, height) {
            for x in bounds(0, width) {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                let side = |p: [f64; 3], q: [f64; 3]| {
                    ((q[0] - p[0]) * (py - p[1]) - (q[1] - p[1]) * (px - p[0])) / area
                };
                let (wa, wb, wc) = (side(b, c), side(c, a), side(a, b));
                // A little outside, too: a needle thinner than a sample is still seen.
                if wa < -1e-9 || wb < -1e-9 || wc < -1e-9 {
                    continue;
                }
                let depth = (wa * a[2] + wb * b[2] + wc * c[2]) as f32;
                let sample = &mut self.samples[y * width + x];
                if depth > sample.0 {
                    let n =
                        corners[0].normal * wa + corners[1].normal * wb + corners[2].normal * wc;
                    *sample = (depth, shaded(colour, n, self.right, self.up, self.towards));
                }
            }
        }
    }

    /// A line of some pixels' width, in front of what is as near.
    pub fn line(&mut self, points: &[Vec3<f64>], colour: Colour, width: f64) {
        let [_, r, g, b] = colour.to_be_bytes();
        let linear = [r, g, b].map(gonio_image::srgb::decode8);
        let [columns, rows] = self.size.map(|n| n * SAMPLES);
        let radius = 0.5 * width * SAMPLES as f64;
        for pair in points.windows(2) {
            let (a, b) = (self.project(pair[0]), self.project(pair[1]));
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let length = (dx * dx + dy * dy).sqrt();
            let steps = (2.0 * length).ceil().max(1.0) as usize;
            for k in 0..=steps {
                let t = k as f64 / steps as f64;
                let [x, y, z] = [0, 1, 2].map(|i| a[i] + t * (b[i] - a[i]));
                let reach = radius.ceil() as i64;
                for dy in -reach..=reach {
                    for dx in -reach..=reach {
                        let (sx, sy) = (x.floor() as i64 + dx, y.floor() as i64 + dy);
                        let (ox, oy) = (sx as f64 + 0.5 - x, sy as f64 + 0.5 - y);
                        let inside = sx >= 0 && sy >= 0 && sx < columns as i64 && sy < rows as i64;
                        if !inside || ox * ox + oy * oy > radius * radius {
                            continue;
                        }
                        let sample = &mut self.samples[sy as usize * columns + sx as usize];
                        if z as f32 + 2e-3 > sample.0 {
                            *sample = (z as f32, linear);
                        }
                    }
                }
            }
        }
    }

    /// The picture's codes.
    pub fn finish(&self) -> Vec<u8> {
        let [width, height] = self.size;
        let mut rgb = Vec::with_capacity(width * height * 3);
        for y in 0..height {
            for x in 0..width {
                let mut sum = [0.0_f32; 3];
                for k in 0..SAMPLES * SAMPLES {
                    let (sx, sy) = (x * SAMPLES + k % SAMPLES, y * SAMPLES + k / SAMPLES);
                    let (_, colour) = self.samples[sy * width * SAMPLES + sx];
                    for c in 0..3 {
                        sum[c] += colour[c];
                    }
                }
                let mean = sum.map(|s| s / (SAMPLES * SAMPLES) as f32);
                rgb.extend(mean.map(gonio_image::srgb::encode8));
            }
        }
        rgb
    }
}

/// A matt surface under a light from the upper left and some from everywhere.
fn shaded(
    colour: [f32; 3],
    normal: Vec3<f64>,
    right: Vec3<f64>,
    up: Vec3<f64>,
    towards: Vec3<f64>,
) -> [f32; 3] {
    let n = normal / normal.length().max(1e-12);
    let n = if n.dot(towards) < 0.0 { -n } else { n };
    let light = (towards * 0.75 + up * 0.55 - right * 0.45).normalize();
    let diffuse = 0.42 + 0.58 * n.dot(light).max(0.0);
    let half = (light + towards).normalize();
    let gloss = 0.16 * Real::powf(n.dot(half).max(0.0), 40.0);
    colour.map(|c| (c * diffuse as f32 + gloss as f32).min(1.0))
}
