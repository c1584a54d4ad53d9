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
    /// One more stands behind the last: so four numbers can be read where any texel begins.
    padded: Vec<[f32; 3]>,
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
        Self::of(wrapped_axis(uv[0], width as u32), uv[1], height)
    }

    /// Clamps in u and v.
    #[inline(always)]
    pub fn clamped(uv: [f32; 2], width: usize, height: usize) -> Self {
        Self::of(clamped_axis(uv[0], width as u32), uv[1], height)
    }

    #[inline(always)]
    fn of((left, right, fu): (u32, u32, f32), v: f32, height: usize) -> Self {
        let (top, bottom, fv) = clamped_axis(v, height as u32);
        Self {
            left: left as usize,
            right: right as usize,
            top: top as usize,
            bottom: bottom as usize,
            fu,
            fv,
        }
    }
}

/// [`Bilinear`] in every lane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taps<const L: usize> {
    /// Upper left and right, lower left and right, each counted row by row.
    pub corners: [[u64; L]; 4],
    pub fu: Lanes<L>,
    pub fv: Lanes<L>,
}

impl<const L: usize> Taps<L> {
    /// Room for some.
    pub const NONE: Self = Self {
        corners: [[0; L]; 4],
        fu: Lanes([0.0; L]),
        fv: Lanes([0.0; L]),
    };

    /// [`Bilinear::clamped`] or [`Bilinear::wrapped`].
    #[inline(always)]
    pub fn new(uv: [Lanes<L>; 2], [width, height]: [usize; 2], clamps: bool) -> Self {
        let mut taps = Self::NONE;
        let (mut columns, mut rows) = ([[0; L]; 2], [[0; L]; 2]);
        let [u, v] = uv;
        let (width, height) = (width as u32, height as u32);
        if clamps {
            for i in 0..L {
                (columns[0][i], columns[1][i], taps.fu.0[i]) = clamped_axis(u.0[i], width);
            }
        } else {
            for i in 0..L {
                (columns[0][i], columns[1][i], taps.fu.0[i]) = wrapped_axis(u.0[i], width);
            }
        }
        for i in 0..L {
            (rows[0][i], rows[1][i], taps.fv.0[i]) = clamped_axis(v.0[i], height);
        }
        for k in 0..4 {
            for i in 0..L {
                let row = u64::from(rows[k / 2][i]) * u64::from(width);
                taps.corners[k][i] = row + u64::from(columns[k % 2][i]);
            }
        }
        taps
    }
}

/// The two of `n` texels along an axis between whose centres a coordinate lies, and how far it is from the first to the second. The
/// axis goes round.
#[inline(always)]
fn wrapped_axis(c: f32, n: u32) -> (u32, u32, f32) {
    let x = c * n as f32 - 0.5;
    let floor = x.floor();
    let left = if floor < 0.0 {
        n - 1
    } else {
        (floor as u32).min(n - 1)
    };
    let right = if left + 1 == n { 0 } else { left + 1 };
    (left, right, x - floor)
}

/// As [`wrapped_axis`], on an axis that ends.
#[inline(always)]
fn clamped_axis(c: f32, n: u32) -> (u32, u32, f32) {
    let x = (c * n as f32 - 0.5).clamp(0.0, (n - 1) as f32);
    let low = (x as u32).min(n - 1);
    (low, (low + 1).min(n - 1), x - low as f32)
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
            padded: std::mem::take(&mut image.pixels),
            file: file.map(Path::to_owned),
            defects: Defects::default(),
            origin: None,
        };
        map.check(sanitize)?;
        if layout.is_disc() {
            map.extend_rim();
        }
        map.padded.push([0.0; 3]);
        Ok(map)
    }

    /// Row-major from the top left. Outside a disc: the nearest texel of the disc, so that the rim doesn't darken.
    pub fn texels(&self) -> &[[f32; 3]] {
        &self.padded[..self.width * self.height]
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
            pixels: std::mem::take(&mut self.padded),
        };
        let file = self.file.clone();
        let shown = |x, y| self.in_domain(x, y);
        self.defects = texels::check(&mut image, shown, file.as_deref(), remedy)?;
        self.padded = image.pixels;
        Ok(())
    }

    /// Gives each texel outside the disc the value of the outermost texel inside it on the way to the centre.
    fn extend_rim(&mut self) {
        let n = self.width;
        let source: Vec<usize> = (0..n * n)
            .map(|k| self.nearest_in_disc(k % n, k / n))
            .collect();
        let inside = std::mem::take(&mut self.padded);
        self.padded = source.into_iter().map(|k| inside[k]).collect();
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
        let t = [self.padded[top + b.left], self.padded[top + b.right]];
        let l = [self.padded[bottom + b.left], self.padded[bottom + b.right]];
        let (gu, gv) = (1.0 - b.fu, 1.0 - b.fv);
        let mut rgb = [0.0; 3];
        for c in 0..3 {
            let high = t[0][c] * gu + t[1][c] * b.fu;
            let low = l[0][c] * gu + l[1][c] * b.fu;
            rgb[c] = high * gv + low * b.fv;
        }
        rgb
    }

    /// Where the picture is read for the unit direction `d`, in the picture's own frame, in every lane: [`Map::cell`].
    #[inline(always)]
    pub fn taps<const L: usize>(&self, d: Vec3<Lanes<L>>) -> Taps<L> {
        // What is laid out otherwise has become lat-long.
        let uv = match self.layout {
            Layout::Angular => Layout::Angular.uv(d),
            Layout::MirrorBall => Layout::MirrorBall.uv(d),
            _ => Layout::LatLong.uv(d),
        };
        Taps::new(uv, [self.width, self.height], self.layout.is_disc())
    }

    /// Reads something of every texel of the taps, all at once, so that memory is waited for once.
    #[inline(always)]
    pub fn touch<const L: usize>(&self, taps: &Taps<L>) -> u32 {
        let mut bits = 0;
        for k in 0..4 {
            for lane in 0..L {
                bits ^= self.padded[taps.corners[k][lane] as usize][0].to_bits();
            }
        }
        bits
    }

    /// [`Map::radiance_in`] in every lane. Calculated lane by lane, on all channels at once: that is how they lie in memory.
    #[inline(always)]
    pub fn radiances<const L: usize>(&self, taps: &Taps<L>) -> [Lanes<L>; 3] {
        let texels = self.padded.as_flattened();
        let mut found = [[0.0; 4]; L];
        for lane in 0..L {
            let at = |k: usize| {
                let first = 3 * taps.corners[k][lane] as usize;
                // The fourth number is the next texel's.
                Lanes::<4>::load(&texels[first..first + 4])
            };
            let (fu, fv) = (Lanes::splat(taps.fu.0[lane]), Lanes::splat(taps.fv.0[lane]));
            let (gu, gv) = (Lanes::one() - fu, Lanes::one() - fv);
            let high = at(0) * gu + at(1) * fu;
            let low = at(2) * gu + at(3) * fu;
            found[lane] = (high * gv + low * fv).0;
        }
        let mut rgb = [Lanes([0.0; L]); 3];
        for c in 0..3 {
            for lane in 0..L {
                rgb[c].0[lane] = found[lane][c];
            }
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
                let l = luminance(self.padded[y * self.width + x]);
                if l > best.0 && self.in_domain(x, y) {
                    best = (l, x, y);
                }
            }
        }
        best
    }
}
