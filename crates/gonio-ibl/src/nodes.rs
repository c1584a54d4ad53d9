//! [`LightTree`]: an environment as lights, in cells of a cube map that get coarser and coarser.
//!
//! The texels of the picture (or, of one that is no panorama, a fine grid over the sphere) are points with a solid angle. Each falls into
//! a cell of a cube map; a cell holds the mean radiance of its points, the solid angle of them all, and the direction about which
//! they lie, weighed by their light. Four cells make one of the next level. So flux is conserved exactly on every level, and a
//! cell with a sun in it lies where the sun is.

use crate::cube::{place, solid_angle, towards};
use crate::gather::Lights;
use crate::points::Points;
use gonio_env::{Environment, LatLongTexels};
use gonio_num::Vec3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Smallest edge of the finest cube: cells of 0.7°, small enough for the widest kernels at the smallest tolerance.
const COARSEST: usize = 128;
/// Largest edge of the finest cube.
const LARGEST: usize = 1024;

/// An environment's light, cell by cell.
#[derive(Debug)]
pub struct LightTree {
    /// The finest first; level k has an edge of `size >> k` cells, the last of one.
    pub(crate) levels: Vec<Level>,
    /// Mean radiance over the sphere.
    pub(crate) mean: [f64; 3],
}

/// The cells of one cube: face after face, row after row.
#[derive(Debug)]
pub(crate) struct Level {
    pub size: usize,
    pub cells: Lights,
}

/// Sums of a cell: solid angle, flux of each channel, Σ weight · direction.
type Sums = [f32; 7];

/// Share of the mean luminance that a black point still has in the place of its cell.
const DARK_SHARE: f64 = 1e-3;

impl LightTree {
    /// The tree that kernels no narrower than `width` \[radians] need.
    pub fn new(environment: &Environment, width: f64) -> Self {
        let mean = environment.mean_radiance();
        match environment.lat_long_texels() {
            Some(texels) => Self::of_panorama(&texels, mean, width),
            None => Self::of_any(environment, mean, width),
        }
    }

    fn of_panorama(texels: &LatLongTexels<'_>, mean: [f64; 3], width: f64) -> Self {
        let points = Points::of_tree(texels, width);
        let size = size_for(points.columns().div_ceil(4), width);
        let dark = DARK_SHARE * luminance(mean);
        let faces: Vec<Vec<Sums>> = (0..6)
            .into_par_iter()
            .map(|face| {
                let mut sums = vec![[0.0; 7]; size * size];
                for row in 0..points.rows() {
                    if !points.may_meet(row, towards(face, 0.0, 0.0)) {
                        continue;
                    }
                    points.each_in_row(row, |d, w, rgb| {
                        if meets(face, d) {
                            let (f, a, b) = place(d);
                            if f == face {
                                deposit(&mut sums, size, [a, b], d, w, rgb, dark);
                            }
                        }
                    });
                }
                sums
            })
            .collect();
        Self::build(size, faces, mean)
    }

    /// Of a uniform environment, or of a picture that is no panorama: points on a cube of their own.
    fn of_any(environment: &Environment, mean: [f64; 3], width: f64) -> Self {
        let across = match environment.picture_size() {
            // A picture of n² shows the sphere about as finely as a cube of edge n/2.
            Some([w, h]) => w.max(h).div_ceil(2).max(16),
            None => 64,
        };
        let size = size_for(across, width);
        let dark = DARK_SHARE * luminance(mean);
        let faces: Vec<Vec<Sums>> = (0..6)
            .into_par_iter()
            .map(|face| {
                let mut sums = vec![[0.0; 7]; size * size];
                let fine = 2 * size;
                let edge = |i: usize| 2.0 * i as f64 / fine as f64 - 1.0;
                for y in 0..fine {
                    for x in 0..fine {
                        let (a, b) = (0.5 * (edge(x) + edge(x + 1)), 0.5 * (edge(y) + edge(y + 1)));
                        let d = towards(face, a, b).normalize();
                        let w = solid_angle(edge(x), edge(x + 1), edge(y), edge(y + 1));
                        let rgb = environment.radiance(d.to_f32());
                        deposit(&mut sums, size, [a, b], d, w, rgb, dark);
                    }
                }
                sums
            })
            .collect();
        Self::build(size, faces, mean)
    }

    fn build(size: usize, faces: Vec<Vec<Sums>>, mean: [f64; 3]) -> Self {
        let mut sums: Vec<Sums> = faces.into_iter().flatten().collect();
        let mut size = size;
        let mut levels = Vec::new();
        loop {
            levels.push(Level {
                size,
                cells: cells(&sums),
            });
            if size == 1 {
                break;
            }
            sums = coarser(&sums, size);
            size /= 2;
        }
        Self { levels, mean }
    }

    /// Cells of the finest level along an edge.
    pub fn size(&self) -> usize {
        self.levels[0].size
    }
}

/// Edge of the finest cube, a power of two: as fine as the picture, but no finer than 0.4 of the lobe's width.
fn size_for(picture: usize, width: f64) -> usize {
    let needed = (0.5 * PI / (0.4 * width)).ceil() as usize;
    picture
        .min(needed)
        .next_power_of_two()
        .clamp(COARSEST, LARGEST)
}

pub(crate) fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Whether a direction may meet a face: exactly, but for ties. Cheaper than [`place`].
#[inline(always)]
fn meets(face: usize, d: Vec3<f64>) -> bool {
    let (along, p, q) = match face {
        0 => (d.x, d.y, d.z),
        1 => (-d.x, d.y, d.z),
        2 => (d.y, d.x, d.z),
        3 => (-d.y, d.x, d.z),
        4 => (d.z, d.x, d.y),
        _ => (-d.z, d.x, d.y),
    };
    along >= p.abs().max(q.abs())
}

/// Puts a point into its cell.
#[inline(always)]
fn deposit(
    sums: &mut [Sums],
    size: usize,
    place: [f64; 2],
    d: Vec3<f64>,
    w: f64,
    rgb: [f32; 3],
    dark: f64,
) {
    let at = |c: f64| (((c + 1.0) * 0.5 * size as f64) as usize).min(size - 1);
    let cell = &mut sums[at(place[1]) * size + at(place[0])];
    let weight = w * (luminance(rgb.map(f64::from)) + dark).max(1e-30);
    cell[0] += w as f32;
    cell[1] += (w * f64::from(rgb[0])) as f32;
    cell[2] += (w * f64::from(rgb[1])) as f32;
    cell[3] += (w * f64::from(rgb[2])) as f32;
    cell[4] += (weight * d.x) as f32;
    cell[5] += (weight * d.y) as f32;
    cell[6] += (weight * d.z) as f32;
}

/// Four cells to one.
fn coarser(fine: &[Sums], size: usize) -> Vec<Sums> {
    let half = size / 2;
    let mut coarse = vec![[0.0; 7]; 6 * half * half];
    for face in 0..6 {
        for y in 0..half {
            for x in 0..half {
                let cell = &mut coarse[(face * half + y) * half + x];
                for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                    let part = &fine[(face * size + 2 * y + dy) * size + 2 * x + dx];
                    for (c, p) in cell.iter_mut().zip(part) {
                        *c += p;
                    }
                }
            }
        }
    }
    coarse
}

/// Sums as means. A cell without points has no solid angle, and no weight.
fn cells(sums: &[Sums]) -> Lights {
    let mut lights = Lights::default();
    for s in sums {
        let w = f64::from(s[0]);
        let length = s[4..7]
            .iter()
            .map(|c| f64::from(*c) * f64::from(*c))
            .sum::<f64>()
            .sqrt();
        if w > 0.0 && length > 0.0 {
            let d = [s[4], s[5], s[6]].map(|c| (f64::from(c) / length) as f32);
            let rgb = [s[1], s[2], s[3]].map(|c| (f64::from(c) / w) as f32);
            lights.push(d, rgb, s[0]);
        } else {
            lights.push([0.0, 0.0, 1.0], [0.0; 3], 0.0);
        }
    }
    lights
}
