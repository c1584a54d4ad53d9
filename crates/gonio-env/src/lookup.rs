//! [`Map`], a checked picture of radiance and its bilinear interpolation.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use crate::info::Origin;
use crate::projection::disc_from_uv;
use crate::texels::{self, Defects, Remedy};
use crate::{EnvError, Layout, luminance};
use gonio_image::Image;
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};
use std::path::{Path, PathBuf};

/// A picture of radiance: at least one texel, every one finite and ≥ 0.
#[derive(Debug)]
pub(crate) struct Map {
    pub layout: Layout,
    pub width: usize,
    pub height: usize,
    /// Row-major from the top left. Outside a disc: the nearest texel of the disc, so that the rim doesn't darken.
    pub texels: Vec<[f32; 3]>,
    pub file: Option<PathBuf>,
    pub defects: Defects,
    /// The picture that this one was resampled from, if it was.
    pub origin: Option<Origin>,
}

/// The four texels around a point, and the weights of the right and of the lower pair.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bilinear {
    pub left: usize,
    pub right: usize,
    pub top: usize,
    pub bottom: usize,
    pub fu: f32,
    pub fv: f32,
}

impl Bilinear {
    /// Wraps around in u, clamps in v.
    #[inline(always)]
    pub fn wrapped(uv: [f32; 2], width: usize, height: usize) -> Self {
        let x = uv[0] * width as f32 - 0.5;
        let floor = x.floor();
        let left = if floor < 0.0 {
            width - 1
        } else {
            (floor as usize).min(width - 1)
        };
        let right = if left + 1 == width { 0 } else { left + 1 };
        let (top, bottom, fv) = Self::clamped_axis(uv[1], height);
        Self {
            left,
            right,
            top,
            bottom,
            fu: x - floor,
            fv,
        }
    }

    /// Clamps in u and v.
    #[inline(always)]
    pub fn clamped(uv: [f32; 2], width: usize, height: usize) -> Self {
        let (left, right, fu) = Self::clamped_axis(uv[0], width);
        let (top, bottom, fv) = Self::clamped_axis(uv[1], height);
        Self {
            left,
            right,
            top,
            bottom,
            fu,
            fv,
        }
    }

    #[inline(always)]
    fn clamped_axis(c: f32, n: usize) -> (usize, usize, f32) {
        let x = (c * n as f32 - 0.5).clamp(0.0, (n - 1) as f32);
        let low = (x as usize).min(n - 1);
        (low, (low + 1).min(n - 1), x - low as f32)
    }
}

impl Map {
    /// Checks a picture and takes it over.
    ///
    /// With `sanitize`, NaN, −∞ and negative values become 0 and +∞ becomes the largest finite value of the picture,
    /// and they are counted; without, the first is an error. Texels outside a disc are not looked at.
    pub fn new(
        mut image: Image,
        layout: Layout,
        file: Option<&Path>,
        sanitize: bool,
    ) -> Result<Self, EnvError> {
        let (width, height) = (image.width, image.height);
        let shape = |expected| EnvError::Shape {
            file: file.map(Path::to_owned),
            width,
            height,
            expected,
        };
        if width == 0 || height == 0 || image.pixels.len() != width * height {
            return Err(shape("at least 1 × 1, and as many pixels as that"));
        }
        if layout.is_disc() && width != height {
            return Err(shape("a square picture for this layout"));
        }
        let mut map = Self {
            layout,
            width,
            height,
            texels: std::mem::take(&mut image.pixels),
            file: file.map(Path::to_owned),
            defects: Defects::default(),
            origin: None,
        };
        map.check(sanitize)?;
        if layout.is_disc() {
            map.extend_rim();
        }
        Ok(map)
    }

    /// Whether the centre of texel (x, y) shows a direction.
    pub fn in_domain(&self, x: usize, y: usize) -> bool {
        self.layout.contains(self.centre(x, y))
    }

    /// (u, v) of the centre of texel (x, y).
    pub fn centre(&self, x: usize, y: usize) -> [f64; 2] {
        [
            (x as f64 + 0.5) / self.width as f64,
            (y as f64 + 0.5) / self.height as f64,
        ]
    }

    fn check(&mut self, sanitize: bool) -> Result<(), EnvError> {
        let (width, height) = (self.width, self.height);
        let remedy = if sanitize {
            Remedy::Clamp
        } else {
            Remedy::Refuse
        };
        let mut image = Image {
            width,
            height,
            pixels: std::mem::take(&mut self.texels),
        };
        let file = self.file.clone();
        let shown = |x, y| self.in_domain(x, y);
        self.defects = texels::check(&mut image, shown, file.as_deref(), remedy)?;
        self.texels = image.pixels;
        Ok(())
    }

    /// Gives each texel outside the disc the value of the outermost texel inside it on the way to the centre.
    fn extend_rim(&mut self) {
        let n = self.width;
        let source: Vec<usize> = (0..n * n)
            .map(|k| self.nearest_in_disc(k % n, k / n))
            .collect();
        let inside = std::mem::take(&mut self.texels);
        self.texels = source.into_iter().map(|k| inside[k]).collect();
    }

    fn nearest_in_disc(&self, x: usize, y: usize) -> usize {
        let n = self.width;
        let [px, py] = disc_from_uv(self.centre(x, y));
        let r = (px * px + py * py).sqrt();
        if r <= 1.0 {
            return y * n + x;
        }
        // Steps of half a texel along the radius; the centre itself is always inside.
        let step = 1.0 / n as f64;
        let mut target = 1.0;
        loop {
            let k = target / r;
            let at = |p: f64| ((((p * k + 1.0) * 0.5 * n as f64).max(0.0)) as usize).min(n - 1);
            let (i, j) = (at(px), at(-py));
            if self.in_domain(i, j) || target <= step {
                return j * n + i;
            }
            target -= step;
        }
    }

    /// Where the picture is read for the picture coordinates `uv`.
    #[inline(always)]
    pub fn cell(&self, uv: [f32; 2]) -> Bilinear {
        if self.layout.is_disc() {
            Bilinear::clamped(uv, self.width, self.height)
        } else {
            Bilinear::wrapped(uv, self.width, self.height)
        }
    }

    /// The interpolated radiance.
    #[inline(always)]
    pub fn radiance_in(&self, b: Bilinear) -> [f32; 3] {
        let (top, bottom) = (b.top * self.width, b.bottom * self.width);
        let t = [self.texels[top + b.left], self.texels[top + b.right]];
        let l = [self.texels[bottom + b.left], self.texels[bottom + b.right]];
        let (gu, gv) = (1.0 - b.fu, 1.0 - b.fv);
        let mut rgb = [0.0; 3];
        for c in 0..3 {
            let high = t[0][c] * gu + t[1][c] * b.fu;
            let low = l[0][c] * gu + l[1][c] * b.fu;
            rgb[c] = high * gv + low * b.fv;
        }
        rgb
    }

    /// [`Map::radiance_in`] at the picture coordinates `uv` of each lane.
    #[inline(always)]
    pub fn radiances<const L: usize>(&self, uv: [Lanes<L>; 2]) -> [Lanes<L>; 3] {
        let zero = Lanes([0.0; L]);
        let mut corners = [[0; L]; 4];
        let (mut fu, mut fv) = (zero, zero);
        for lane in 0..L {
            let b = self.cell([uv[0].0[lane], uv[1].0[lane]]);
            let (top, bottom) = (b.top * self.width, b.bottom * self.width);
            corners[0][lane] = top + b.left;
            corners[1][lane] = top + b.right;
            corners[2][lane] = bottom + b.left;
            corners[3][lane] = bottom + b.right;
            fu.0[lane] = b.fu;
            fv.0[lane] = b.fv;
        }
        let mut texels = [[zero; 3]; 4];
        // Corner by corner: while one lane waits for memory, so do the others.
        for k in [0, 2, 1, 3] {
            for lane in 0..L {
                let texel = &self.texels[corners[k][lane]];
                for c in 0..3 {
                    texels[k][c].0[lane] = texel[c];
                }
            }
        }
        let (gu, gv) = (Lanes::one() - fu, Lanes::one() - fv);
        let mut rgb = [zero; 3];
        for c in 0..3 {
            let high = texels[0][c] * gu + texels[1][c] * fu;
            let low = texels[2][c] * gu + texels[3][c] * fu;
            rgb[c] = high * gv + low * fv;
        }
        rgb
    }

    /// The radiance from the unit direction `d`, in the picture's own frame.
    #[inline(always)]
    pub fn radiance(&self, d: Vec3<f32>) -> [f32; 3] {
        self.radiance_in(self.cell(self.layout.uv(d)))
    }

    /// Largest luminance of the texels that show a direction, and where: (x, y). The first of equals.
    pub fn peak(&self) -> (f64, usize, usize) {
        let mut best = (-1.0, 0, 0);
        for y in 0..self.height {
            for x in 0..self.width {
                let l = luminance(self.texels[y * self.width + x]);
                if l > best.0 && self.in_domain(x, y) {
                    best = (l, x, y);
                }
            }
        }
        best
    }
}
