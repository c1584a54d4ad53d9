//! [`Worth`]: what paths are worth, for Russian roulette that judges by efficiency.
//!
//! The efficiency of a picture is 1 / (V·C), V being the variance of a sample and C its cost, the rays that are followed. A path that arrives at a point with the
//! throughput T brings T·L for c more rays, L being what it will find there. If it goes on with the probability q alone, that adds T²·E[L²]·(1/q − 1) to V and
//! takes (1 − q)·c from C. V·C is least where
//!
//! q = T · √(E[L²] / c) / √(V / C)
//!
//! (Bolin and Meyer 1997, "An error metric for Monte Carlo ray tracing"; Veach 1997, §10.4; Rath et al. 2022, "EARS: Efficiency-aware Russian roulette and splitting").
//! E[L²] and c are learned for cells of space, V and C for tiles of the picture, from a small picture that is taken before with a fixed seed: they are functions of the
//! scene, the camera and the options, and independent of the picture's own samples, whose expectation stays what it is.

use super::path::{Path, Roulette, Walk};
use super::shares::Shares;
use super::vertex::{arrive, environment_radiance};
use super::{Integrator, RayCounts, product, sum};
use crate::RenderOptions;
use gonio_num::Vec3;
use gonio_radiometry::sequence::{SampleStream, SamplerKind};
use gonio_scene::{Camera, Ray, Scene};
use rayon::prelude::*;

/// Tiles along the picture's longer side.
const TILES: u32 = 32;
/// Samples of a tile, two at each of half as many places.
const SAMPLES: u32 = 32;
/// The seed of the small picture.
const SEED: u64 = 0x5eed_0f3a_71c2_9d84;
/// Cells along each axis.
const CELLS: usize = 16;
/// Reflections left that are told apart; more are as many.
const MOST_LEFT: usize = 8;
/// The mean of all cells counts as this many paths in each.
const PRIOR: f32 = 8.0;
/// How many times smaller than that of independent samples the standard error of a picture's samples is taken to be, since its points are even. Of 2, 4 and 8 this has the
/// best efficiency over the scenes that the book measures: with less, late light is lost sooner than rays are saved.
const EVENNESS: f32 = 4.0;
/// No path goes on with a lower probability: what the small picture didn't find must not be multiplied by any number.
const LEAST: f32 = 0.1;

/// What paths are worth, for the places where they may end.
#[derive(Debug)]
pub(crate) struct Worth {
    /// The corner of the cells, and cells per unit of length.
    low: Vec3<f32>,
    per_length: Vec3<f32>,
    /// √(E\[L²] / c) for each cell, and each number of reflections that are left within it.
    values: Vec<f32>,
    tiles: [u32; 2],
    /// √(C / V) of each tile.
    importance: Vec<f32>,
}

/// What roulette knows when it judges a path.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Judge<'a> {
    pub worth: &'a Worth,
    /// Of the path's pixel, [`Worth::importance`].
    pub importance: f32,
}

impl<'a> Judge<'a> {
    /// For paths of a pixel.
    pub fn of(worth: &'a Worth, options: &RenderOptions, pixel: [u32; 2]) -> Self {
        let importance = worth.importance(options, pixel);
        Self { worth, importance }
    }

    /// The probability that a path goes on.
    ///
    /// - `at`: where it has arrived
    /// - `left`: reflections that it may still make
    /// - `carried`: its throughput
    #[inline]
    pub fn survival(&self, at: Vec3<f32>, left: u32, carried: [f32; 3]) -> f32 {
        let value = self.worth.values[self.worth.place(at, left)];
        (mean(carried) * value * self.importance).clamp(LEAST, 1.0)
    }
}

fn mean([r, g, b]: [f32; 3]) -> f32 {
    (r + g + b) * (1.0 / 3.0)
}

/// What a path found beyond a point.
#[derive(Debug, Clone, Copy)]
struct Beyond {
    at: Vec3<f32>,
    left: u32,
    /// L².
    square: f32,
    rays: f32,
}

/// A path as it was at a point.
struct Passed {
    at: Vec3<f32>,
    left: u32,
    carried: f32,
    total: f32,
    rays: u64,
}

/// What the small picture has of a tile: means over its samples, of a sample.
#[derive(Debug, Default)]
struct Tile {
    light: f32,
    variance: f32,
    rays: f32,
}

impl Worth {
    /// Learns what paths are worth; nothing unless roulette shall judge by it and there is any light.
    pub fn learn(scene: &Scene, camera: &Camera, options: &RenderOptions) -> Option<Self> {
        let Integrator::Path(path) = &options.integrator else {
            return None;
        };
        if path.roulette != Roulette::Efficiency || path.max_bounces < 2 {
            return None;
        }
        let longer = options.width.max(options.height);
        let along = |side: u32| (u64::from(side) * u64::from(TILES)).div_ceil(u64::from(longer));
        let tiles = [options.width, options.height].map(|side| side.min(along(side) as u32));
        let places: Vec<[u32; 2]> = (0..tiles[0] * tiles[1])
            .map(|i| [i % tiles[0], i / tiles[0]])
            .collect();
        let pilot = Pilot {
            scene,
            camera,
            path,
            aspect: options.width as f32 / options.height as f32,
            tiles,
        };
        let all: Vec<(Tile, Vec<Beyond>)> =
            places.par_iter().map(|tile| pilot.take(*tile)).collect();
        let beyond: Vec<Beyond> = all.iter().flat_map(|(_, b)| b.iter().copied()).collect();
        let pixels: Vec<Tile> = all.into_iter().map(|(tile, _)| tile).collect();
        let importance = importance_of(&pixels, tiles)?;
        let (low, per_length) = cells_around(&beyond)?;
        let mut worth = Self {
            low,
            per_length,
            values: Vec::new(),
            tiles,
            importance,
        };
        worth.values = worth.values_of(&beyond);
        Some(worth)
    }

    /// How much light counts in a pixel, √(C / V).
    #[inline]
    pub fn importance(&self, options: &RenderOptions, [x, y]: [u32; 2]) -> f32 {
        let tile =
            |k: u32, side: u32, tiles: u32| u64::from(k) * u64::from(tiles) / u64::from(side);
        let (column, row) = (
            tile(x, options.width, self.tiles[0]),
            tile(y, options.height, self.tiles[1]),
        );
        self.importance[(row * u64::from(self.tiles[0]) + column) as usize]
    }

    fn cell(&self, at: Vec3<f32>) -> usize {
        let offset = (at - self.low).to_array();
        let scale = self.per_length.to_array();
        // A conversion to an integer saturates: what lies outside is in the nearest cell.
        let along = |k: usize| ((offset[k] * scale[k]) as usize).min(CELLS - 1);
        (along(2) * CELLS + along(1)) * CELLS + along(0)
    }

    fn place(&self, at: Vec3<f32>, left: u32) -> usize {
        self.cell(at) * MOST_LEFT + (left as usize).clamp(1, MOST_LEFT) - 1
    }

    /// What is found is the product of a mean over all cells, for the reflections that are left, and one over those, for the cell.
    fn values_of(&self, beyond: &[Beyond]) -> Vec<f32> {
        let mut by_left = [[0.0_f64; 3]; MOST_LEFT];
        for b in beyond {
            let of = &mut by_left[(b.left as usize).clamp(1, MOST_LEFT) - 1];
            for (sum, one) in of.iter_mut().zip([b.square, b.rays, 1.0]) {
                *sum += f64::from(one);
            }
        }
        let means = by_left.map(|[square, rays, count]| {
            let n = count.max(1.0);
            [(square / n) as f32, (rays / n) as f32]
        });
        let mut by_cell = vec![[PRIOR; 3]; CELLS * CELLS * CELLS];
        for b in beyond {
            let [square, rays] = means[(b.left as usize).clamp(1, MOST_LEFT) - 1];
            let of = &mut by_cell[self.cell(b.at)];
            let relative = |x: f32, mean: f32| if mean > 0.0 { x / mean } else { 1.0 };
            of[0] += relative(b.square, square);
            of[1] += relative(b.rays, rays);
            of[2] += 1.0;
        }
        let of_cell = |[square, rays, count]: [f32; 3]| [square / count, rays / count];
        by_cell
            .into_iter()
            .map(of_cell)
            .flat_map(|[square, rays]| {
                means.map(|[all_square, all_rays]| {
                    (square * all_square / (rays * all_rays).max(1.0)).sqrt()
                })
            })
            .collect()
    }
}

/// √(C / V) of each tile: the relative variance is that of the whole picture, as tiles are too noisy to tell theirs; the light is that of the tile and its
/// neighbours. Nothing where there is none.
fn importance_of(tiles: &[Tile], [width, height]: [u32; 2]) -> Option<Vec<f32>> {
    let count = tiles.len() as f32;
    let all = tiles.iter().map(|t| t.light).sum::<f32>() / count;
    let rays = tiles.iter().map(|t| t.rays).sum::<f32>() / count;
    let (width, height) = (width as usize, height as usize);
    let around = |i: usize, end: usize| i.saturating_sub(1)..(i + 2).min(end);
    let squares: Vec<f32> = (0..tiles.len())
        .map(|i| {
            let (mut light, mut n) = (0.0, 0.0);
            for row in around(i / width, height) {
                for column in around(i % width, width) {
                    light += tiles[row * width + column].light;
                    n += 1.0;
                }
            }
            // As squared errors are made relative where samples are divided.
            (light / n) * (light / n) + 0.01 * all * all
        })
        .collect();
    let mut relative: Vec<f32> = tiles
        .iter()
        .zip(&squares)
        .map(|(t, s)| t.variance / s)
        .collect();
    relative.sort_unstable_by(f32::total_cmp);
    // Without the largest: a firefly must not decide.
    let kept = &relative[..relative.len() - relative.len() / 20];
    let relative = kept.iter().sum::<f32>() / kept.len() as f32;
    let known = relative > 0.0 && rays > 0.0 && all > 0.0 && (rays / relative).is_finite();
    known.then(|| {
        let of = |square: &f32| EVENNESS * (rays / (relative * square)).sqrt();
        squares.iter().map(of).collect()
    })
}

/// The corner of the cells, and cells per unit of length: they hold all but the outermost hundredth at each side, since a floor may be as wide as it likes.
fn cells_around(beyond: &[Beyond]) -> Option<(Vec3<f32>, Vec3<f32>)> {
    if beyond.is_empty() {
        return None;
    }
    let ends = [0, 1, 2].map(|axis| {
        let mut along: Vec<f32> = beyond.iter().map(|b| b.at.to_array()[axis]).collect();
        along.sort_unstable_by(f32::total_cmp);
        let outer = along.len() / 100;
        [along[outer], along[along.len() - 1 - outer]]
    });
    let low = Vec3::from(ends.map(|[low, _]| low));
    let scale = ends.map(|[low, high]| CELLS as f32 / (high - low).max(f32::MIN_POSITIVE));
    Some((low, Vec3::from(scale)))
}

/// What the small picture is taken with.
struct Pilot<'a> {
    scene: &'a Scene,
    camera: &'a Camera,
    path: &'a Path,
    aspect: f32,
    tiles: [u32; 2],
}

impl Pilot<'_> {
    fn take(&self, tile: [u32; 2]) -> (Tile, Vec<Beyond>) {
        let sequence = tile[1] * self.tiles[0] + tile[0];
        let (mut found, mut beyond) = (Tile::default(), Vec::new());
        let mut other = 0.0;
        for k in 0..SAMPLES {
            let stream = |k| SampleStream::new(SamplerKind::Independent, SEED, sequence, k);
            // Two at one place: what differs between them is noise.
            let [u, v] = stream(k / 2 * 2).next_2d();
            let film = [
                (tile[0] as f32 + u) / self.tiles[0] as f32,
                (tile[1] as f32 + v) / self.tiles[1] as f32,
            ];
            let mut own = stream(k);
            own.next_2d();
            let ray = self.camera.ray(film, self.aspect, own.next_2d());
            let mut counts = RayCounts::default();
            let light = mean(self.radiance(&ray, &mut own, &mut counts, &mut beyond));
            let light = if light.is_finite() { light } else { 0.0 };
            if k % 2 == 1 {
                found.variance += (light - other) * (light - other) / SAMPLES as f32;
            }
            other = light;
            found.light += light / SAMPLES as f32;
            found.rays += counts.total() as f32 / SAMPLES as f32;
        }
        (found, beyond)
    }

    /// Follows a sample's paths, as [`Path::reflected`] does.
    fn radiance(
        &self,
        ray: &Ray,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        beyond: &mut Vec<Beyond>,
    ) -> [f32; 3] {
        let (scene, path) = (self.scene, self.path);
        let (mut interior, mut left) = (scene.interior_at(ray.origin), [1.0; 3]);
        let first = arrive(scene, ray, &mut interior, &mut left, 0, stream, counts);
        let Some(first) = first else {
            return environment_radiance(scene, ray.origin, ray.direction);
        };
        let mut shares = Shares::none();
        let mut walk = Walk::new(&interior, None);
        path.direct(scene, &first, 0, &mut walk, stream, counts, &mut shares);
        let mut total = sum(scene.emitted(&first.point, -ray.direction), walk.total);
        let paths = path.strategies(0, first.model.is_delta()).directions;
        for which in 0..paths {
            let mut walk = Walk::new(&interior, None);
            let mut part = stream.split(paths, which);
            let mut passed = Vec::new();
            let mut current =
                path.step(scene, &first, 0, &mut walk, &mut part, counts, &mut shares);
            for bounce in 1..path.max_bounces {
                let Some(vertex) = &current else {
                    break;
                };
                passed.push(Passed {
                    at: vertex.point.p,
                    left: path.max_bounces - bounce,
                    carried: mean(product(walk.throughput, walk.unscaling)),
                    total: mean(walk.total),
                    rays: counts.total(),
                });
                path.direct(scene, vertex, bounce, &mut walk, &part, counts, &mut shares);
                current = path.step(
                    scene,
                    vertex,
                    bounce,
                    &mut walk,
                    &mut part,
                    counts,
                    &mut shares,
                );
            }
            for before in passed {
                let light = (mean(walk.total) - before.total) / before.carried;
                let square = light * light;
                if square.is_finite() {
                    beyond.push(Beyond {
                        at: before.at,
                        left: before.left,
                        square,
                        rays: (counts.total() - before.rays) as f32,
                    });
                }
            }
            total = sum(total, walk.total);
        }
        product(left, total)
    }
}
