//! Cube maps of means: level by level, in the axes of a [`Target`].

use crate::cube::{Cube, centre, towards};
use crate::sampling::Pyramid;
use crate::target::three_direction;
use crate::{Filter, IblError, Kernel, LightTree, Target, reference};
use gonio_brdf::ModelSpec;
use gonio_env::Environment;
use gonio_image::Image;
use gonio_num::Vec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_2, PI};

/// What a chain of levels is made with: a kernel for each roughness.
#[derive(Debug, Clone, PartialEq)]
pub enum Family {
    /// GGX.
    Ggx,
    /// Charlie.
    Charlie,
    /// cosⁿ with n = (1/α² − 1)/2, whose lobe is as wide as that of facets of slope scale α = roughness².
    Phong,
    /// A model of the registry, whose parameter `roughness` each level sets.
    Model(ModelSpec),
}

impl Family {
    /// `ggx`, `charlie`, `phong`, or the description of a model.
    ///
    /// # Errors
    /// An unknown model, or one without the parameter `roughness`.
    pub fn parse(text: &str) -> Result<Self, IblError> {
        match text {
            "ggx" => Ok(Self::Ggx),
            "charlie" => Ok(Self::Charlie),
            "phong" => Ok(Self::Phong),
            _ => {
                let spec = ModelSpec::parse(text)?;
                let known = spec.parameters()?;
                if known.iter().any(|p| p.name == "roughness") {
                    return Ok(Self::Model(spec));
                }
                Err(IblError::Model {
                    model: text.to_owned(),
                    reason: "no parameter `roughness` for the levels to set".to_owned(),
                })
            }
        }
    }

    /// The kernel of a perceptual roughness in (0, 1].
    ///
    /// # Errors
    /// As the kernels'.
    pub fn kernel(&self, roughness: f64) -> Result<Kernel, IblError> {
        match self {
            Self::Ggx => Kernel::ggx(roughness),
            Self::Charlie => Kernel::charlie(roughness),
            Self::Phong => {
                let a2 = (roughness * roughness).powi(2).max(1e-5);
                Kernel::cosine(0.5 * (1.0 / a2 - 1.0))
            }
            Self::Model(spec) => {
                let mut spec = spec.clone();
                spec.set_text("roughness", &roughness.to_string())?;
                Kernel::model(&spec)
            }
        }
    }
}

/// How a mean is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Quadrature over the cells of a [`LightTree`] ([`Filter`]), of this tolerance.
    Tree(f64),
    /// Filtered importance sampling with so many samples.
    Sampling(usize),
    /// Every texel of the picture.
    Exact,
}

/// How far a map is from the exact means, over some of its texels.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MapError {
    /// Texels compared.
    pub texels: usize,
    /// Mean of |found − exact|/exact over texels and channels.
    pub mean: f64,
    /// The largest of them.
    pub largest: f64,
    /// Mean of (found − exact)/exact.
    pub bias: f64,
}

/// An environment ready for maps of kernels no narrower than a width.
#[derive(Debug)]
pub struct Maps<'a> {
    environment: &'a Environment,
    tree: LightTree,
    pyramid: Option<Pyramid>,
}

/// Edge of a block of texels that share a list of lights.
const BLOCK: usize = 8;

impl<'a> Maps<'a> {
    /// For kernels no narrower than `width` \[rad] ([`Kernel::width`]), by `method`.
    pub fn new(environment: &'a Environment, width: f64, method: Method) -> Self {
        let tree = LightTree::new(environment, width);
        let pyramid = match method {
            Method::Sampling(_) => Some(Pyramid::new(mirror(
                environment,
                tree.size(),
                Target::Custom,
            ))),
            _ => None,
        };
        Self {
            environment,
            tree,
            pyramid,
        }
    }

    /// The map of a kernel: `size`² texels a face, in the target's axes.
    pub fn cube(&self, kernel: &Kernel, size: usize, target: Target, method: Method) -> Cube {
        let blocks = blocks(size, |face, x, y| target.to_world(centre(face, size, x, y)));
        let axes: Vec<Vec<Vec3<f32>>> = blocks
            .iter()
            .map(|b| b.iter().map(|(_, d)| d.to_f32()).collect())
            .collect();
        let means = self.means(kernel, &axes, method);
        let mut cube = Cube::filled(size, [0.0; 3]);
        for (block, values) in blocks.iter().zip(means) {
            for ((at, _), value) in block.iter().zip(values) {
                cube.texels[*at] = value;
            }
        }
        cube
    }

    /// The means around axes, in blocks of neighbours.
    pub fn means(
        &self,
        kernel: &Kernel,
        axes: &[Vec<Vec3<f32>>],
        method: Method,
    ) -> Vec<Vec<[f32; 3]>> {
        match (method, &self.pyramid) {
            (Method::Sampling(samples), Some(pyramid)) => pyramid.means(kernel, axes, samples),
            (Method::Exact, _) => axes
                .iter()
                .flat_map(|block| block.chunks(4096))
                .map(|some| reference(self.environment, &self.tree, kernel, some))
                .collect(),
            (Method::Tree(tolerance), _) => Filter::new(&self.tree, kernel, tolerance).apply(axes),
            (Method::Sampling(_), None) => {
                Filter::new(&self.tree, kernel, crate::DEFAULT_TOLERANCE).apply(axes)
            }
        }
    }

    /// Compares `count` texels of a map, spread evenly, with exact quadrature.
    pub fn compare(&self, kernel: &Kernel, cube: &Cube, target: Target, count: usize) -> MapError {
        let n = cube.texels.len();
        let count = count.min(n);
        // An odd stride, so that faces are met at different places.
        let picked: Vec<usize> = (0..count)
            .map(|i| (i * n + n / 2) / count)
            .map(|i| i.min(n - 1))
            .collect();
        let axes: Vec<Vec3<f32>> = picked
            .iter()
            .map(|i| {
                let (face, rest) = (i / (cube.size * cube.size), i % (cube.size * cube.size));
                let d = centre(face, cube.size, rest % cube.size, rest / cube.size);
                target.to_world(d).to_f32()
            })
            .collect();
        let exact = reference(self.environment, &self.tree, kernel, &axes);
        let (mut mean, mut bias, mut largest, mut terms) = (0.0, 0.0, 0.0f64, 0);
        for (i, truth) in picked.iter().zip(&exact) {
            for k in 0..3 {
                let (a, b) = (f64::from(cube.texels[*i][k]), f64::from(truth[k]));
                let e = if b > 0.0 { (a - b) / b } else { a };
                mean += e.abs();
                bias += e;
                largest = largest.max(e.abs());
                terms += 1;
            }
        }
        let terms = f64::from(terms.max(1));
        MapError {
            texels: count,
            mean: mean / terms,
            largest,
            bias: bias / terms,
        }
    }

    /// The atlas of three.js, `CubeUV`: tiles of `size`, size/2 … 16 texels, then six of 16, as a picture whose top is v = 1.
    ///
    /// `levels` holds, level after level, the kernel, or nothing for the picture itself.
    pub fn three_atlas(&self, size: usize, levels: &[Option<Kernel>], method: Method) -> Image {
        let width = 3 * size.max(16 * 7);
        let height = 4 * size;
        let mut atlas = Image::new(width, height);
        for (k, kernel) in levels.iter().enumerate() {
            let tile = (size >> k).max(16);
            let extra = (k + 4).saturating_sub(size.ilog2() as usize);
            let (left, bottom) = (3 * 16 * extra, 4 * (size - tile));
            let blocks = blocks(tile, |face, x, y| three_direction(face, tile, x, y));
            let means: Vec<Vec<[f32; 3]>> = match kernel {
                Some(kernel) => {
                    let axes: Vec<Vec<Vec3<f32>>> = blocks
                        .iter()
                        .map(|b| b.iter().map(|(_, d)| d.to_f32()).collect())
                        .collect();
                    self.means(kernel, &axes, method)
                }
                None => blocks
                    .par_iter()
                    .map(|b| {
                        b.iter()
                            .map(|(_, d)| self.environment.radiance(d.to_f32()))
                            .collect()
                    })
                    .collect(),
            };
            for (block, values) in blocks.iter().zip(means) {
                for ((at, _), value) in block.iter().zip(values) {
                    let (face, rest) = (at / (tile * tile), at % (tile * tile));
                    let x = left + (face % 3) * tile + rest % tile;
                    let up = bottom + (face / 3) * tile + rest / tile;
                    atlas.set(x, height - 1 - up, value);
                }
            }
        }
        atlas
    }
}

/// A texel's place in the cube and where it looks.
type Texel = (usize, Vec3<f64>);

/// The texels of a cube in square blocks.
fn blocks(size: usize, direction: impl Fn(usize, usize, usize) -> Vec3<f64>) -> Vec<Vec<Texel>> {
    let edge = BLOCK.min(size);
    let mut blocks = Vec::new();
    for face in 0..6 {
        for by in (0..size).step_by(edge) {
            for bx in (0..size).step_by(edge) {
                let mut block = Vec::with_capacity(edge * edge);
                for y in by..(by + edge).min(size) {
                    for x in bx..(bx + edge).min(size) {
                        block.push(((face * size + y) * size + x, direction(face, x, y)));
                    }
                }
                blocks.push(block);
            }
        }
    }
    blocks
}

/// The environment as a cube, each texel the mean over its solid angle: level 0, of a mirror.
pub fn mirror(environment: &Environment, size: usize, target: Target) -> Cube {
    // Taps no farther apart than texels of the picture.
    let step = match environment.picture_size() {
        Some([w, h]) => PI / w.div_ceil(2).max(h) as f64,
        None => PI,
    };
    let taps = ((FRAC_PI_2 / size as f64 / step).ceil() as usize).clamp(2, 64);
    let fine = taps * size;
    let texels = (0..6 * size)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (face, y) = (row / size, row % size);
            (0..size).map(move |x| {
                let mut sum = [0.0; 4];
                for j in 0..taps {
                    for i in 0..taps {
                        let at = |k: usize| (2 * k + 1) as f64 / fine as f64 - 1.0;
                        let (a, b) = (at(x * taps + i), at(y * taps + j));
                        // dω/(da db) = (1 + a² + b²)^(−3/2).
                        let r2 = 1.0 / (1.0 + a * a + b * b);
                        let w = r2 * r2.sqrt();
                        let d = target.to_world(towards(face, a, b)).normalize();
                        let rgb = environment.radiance(d.to_f32());
                        for k in 0..3 {
                            sum[k] += w * f64::from(rgb[k]);
                        }
                        sum[3] += w;
                    }
                }
                [0, 1, 2].map(|k| (sum[k] / sum[3]) as f32)
            })
        })
        .collect();
    Cube { size, texels }
}
