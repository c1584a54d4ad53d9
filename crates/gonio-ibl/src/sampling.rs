//! Filtered importance sampling: a kernel as samples of equal weight, each of which reads a copy of the picture as blurred as the
//! samples stand apart.
//!
//! The angles are those of equal shares of ∫ K dω, the azimuths turn by the golden angle: one set of samples for all axes, turned into
//! the frame of each. So it is deterministic, and its error is blur, not noise.
//!
//! Source: Křivánek & Colbert 2008, "Real-time Shading with Filtered Importance Sampling"; Colbert & Křivánek 2007, GPU Gems 3, ch. 20.

use crate::Kernel;
use crate::cube::{Cube, place};
use gonio_num::{Frame, Real, Vec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// A cube and its smaller copies.
#[derive(Debug)]
pub(crate) struct Pyramid {
    levels: Vec<Cube>,
}

/// A direction around +z and the level of the pyramid it reads.
struct Sample {
    d: Vec3<f32>,
    level: f32,
}

/// Steps of the running integral of a kernel.
const STEPS: usize = 8192;

/// Samples overlap: each reads a copy twice as wide as its share (GPU Gems 3, ch. 20, where the factor is found by trial).
const OVERLAP: f64 = 1.0;

impl Pyramid {
    pub fn new(cube: Cube) -> Self {
        let mut levels = vec![cube];
        while let Some(last) = levels.last()
            && last.size > 1
        {
            let half = last.size / 2;
            let mut next = Cube::filled(half, [0.0; 3]);
            for face in 0..6 {
                for y in 0..half {
                    for x in 0..half {
                        let mut sum = [0.0; 3];
                        for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                            let t = last.get(face, 2 * x + i, 2 * y + j);
                            for k in 0..3 {
                                sum[k] += 0.25 * t[k];
                            }
                        }
                        next.texels[(face * half + y) * half + x] = sum;
                    }
                }
            }
            levels.push(next);
        }
        Self { levels }
    }

    /// The mean around each axis.
    pub fn means(
        &self,
        kernel: &Kernel,
        axes: &[Vec<Vec3<f32>>],
        count: usize,
    ) -> Vec<Vec<[f32; 3]>> {
        let samples = self.samples(kernel, count);
        axes.par_iter()
            .map(|block| block.iter().map(|n| self.mean(*n, &samples)).collect())
            .collect()
    }

    fn samples(&self, kernel: &Kernel, count: usize) -> Vec<Sample> {
        // q = 2 s⁴: steps crowd at the axis. dω = π dq.
        let q = |i: f64| 2.0 * (i / STEPS as f64).powi(4);
        let mut running = vec![0.0];
        for i in 0..STEPS {
            let (a, b) = (q(i as f64), q(i as f64 + 1.0));
            let middle = kernel.value(q(i as f64 + 0.5));
            running.push(running[i] + PI * (b - a) * middle);
        }
        let whole = running[STEPS];
        let texel = 4.0 * PI / (6 * self.levels[0].size * self.levels[0].size) as f64;
        let golden = 0.5 * (5.0f64.sqrt() - 1.0);
        (0..count)
            .map(|k| {
                let share = (k as f64 + 0.5) / count as f64 * whole;
                let i = running.partition_point(|r| *r <= share).clamp(1, STEPS) - 1;
                let inside = (share - running[i]) / (running[i + 1] - running[i]).max(1e-300);
                let q = q(i as f64) + inside.clamp(0.0, 1.0) * (q(i as f64 + 1.0) - q(i as f64));
                let cos = 1.0 - 0.5 * q;
                let sin = (q * (1.0 - 0.25 * q)).max(0.0).sqrt();
                let phi = TAU * (k as f64 * golden).fract();
                let apart = whole / (count as f64 * kernel.value(q).max(1e-300));
                let level = 0.5 * (apart / texel).max(1e-300).log2_exact() + OVERLAP;
                Sample {
                    d: Vec3::new(sin * Real::cos(phi), sin * Real::sin(phi), cos).to_f32(),
                    level: level.clamp(0.0, (self.levels.len() - 1) as f64) as f32,
                }
            })
            .collect()
    }

    fn mean(&self, n: Vec3<f32>, samples: &[Sample]) -> [f32; 3] {
        let frame = Frame::from_normal(n);
        let mut sum = [0.0f64; 3];
        for s in samples {
            let rgb = self.read(frame.to_world(s.d), s.level);
            for k in 0..3 {
                sum[k] += f64::from(rgb[k]);
            }
        }
        sum.map(|c| (c / samples.len() as f64) as f32)
    }

    /// Trilinear: bilinear in two levels, and between them.
    fn read(&self, d: Vec3<f32>, level: f32) -> [f32; 3] {
        let (face, a, b) = place(d.to_f64());
        let low = (level as usize).min(self.levels.len() - 1);
        let high = (low + 1).min(self.levels.len() - 1);
        let t = level - low as f32;
        let (p, q) = (
            bilinear(&self.levels[low], face, a, b),
            bilinear(&self.levels[high], face, a, b),
        );
        [0, 1, 2].map(|k| p[k] * (1.0 - t) + q[k] * t)
    }
}

fn bilinear(cube: &Cube, face: usize, a: f64, b: f64) -> [f32; 3] {
    let n = cube.size;
    let at = |c: f64| {
        let x = (0.5 * (c + 1.0) * n as f64 - 0.5).clamp(0.0, (n - 1) as f64);
        let low = (x as usize).min(n - 1);
        (low, (low + 1).min(n - 1), (x - low as f64) as f32)
    };
    let ((x0, x1, s), (y0, y1, t)) = (at(a), at(b));
    let (p, q) = (cube.get(face, x0, y0), cube.get(face, x1, y0));
    let (u, v) = (cube.get(face, x0, y1), cube.get(face, x1, y1));
    [0, 1, 2].map(|k| (p[k] * (1.0 - s) + q[k] * s) * (1.0 - t) + (u[k] * (1.0 - s) + v[k] * s) * t)
}

/// Logarithm to the base 2 by our own functions.
trait Log2 {
    fn log2_exact(self) -> f64;
}

impl Log2 for f64 {
    fn log2_exact(self) -> f64 {
        Real::ln(self) * std::f64::consts::LOG2_E
    }
}
