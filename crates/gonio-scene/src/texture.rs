//! [`Texture`]: a picture laid over a surface by its texture coordinates.
//!
//! Texture coordinates are glTF's: (0, 0) is the upper left corner of the picture's first texel, u grows to the right and
//! v downwards. There is no prefiltered pyramid: a path tracer takes many samples a pixel, and the mean of bilinear
//! look-ups is the unbiased answer that a pyramid only approximates.

use gonio_image::{RawData, RawImage};
use gonio_num::Real;
use std::sync::{Arc, LazyLock};

/// How a texture goes on beyond \[0, 1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Wrap {
    /// Again and again.
    #[default]
    Repeat,
    /// The texel at the border for ever.
    Clamp,
    /// Again and again, every second copy mirrored.
    Mirror,
}

/// What lies between texel centres.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// Bilinear interpolation of the four nearest texels, after decoding.
    #[default]
    Bilinear,
    /// The nearest texel.
    Nearest,
}

/// What the stored numbers of an integer picture mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Transfer {
    /// Colour, encoded by the sRGB transfer function (IEC 61966-2-1); alpha is linear.
    #[default]
    Srgb,
    /// Numbers: roughness, normals, masks.
    Linear,
}

/// A picture in memory that textures share.
///
/// Integer pictures keep their 8 or 16 bits and are decoded as they are looked up, since one picture may serve both as colour
/// and as numbers. Float pictures are linear, whatever a texture's [`Transfer`].
#[derive(Clone, PartialEq)]
pub struct Bitmap {
    name: String,
    image: RawImage,
}

impl std::fmt::Debug for Bitmap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (width, height) = (self.image.width, self.image.height);
        write!(
            f,
            "Bitmap({}, {width}×{height}, {} bits)",
            self.name,
            self.image.bit_depth()
        )
    }
}

impl Bitmap {
    /// A picture, called `name` in messages.
    ///
    /// # Panics
    /// If the picture has no pixels; no reader makes such.
    pub fn new(name: impl Into<String>, image: RawImage) -> Self {
        let texels = match &image.data {
            RawData::U8(d) => d.len(),
            RawData::U16(d) => d.len(),
            RawData::F32(d) => d.len(),
        };
        assert!(
            texels > 0 && image.width.checked_mul(image.height) == Some(texels),
            "a picture of {} × {} with {texels} pixels",
            image.width,
            image.height
        );
        Self {
            name: name.into(),
            image,
        }
    }

    /// What error messages call it: its file or its index in the scene file.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Texels a row.
    pub fn width(&self) -> usize {
        self.image.width
    }
    /// Rows.
    pub fn height(&self) -> usize {
        self.image.height
    }

    /// Texel (x, y), decoded.
    #[inline]
    fn texel(&self, x: usize, y: usize, transfer: Transfer) -> [f32; 4] {
        let i = y * self.image.width + x;
        match &self.image.data {
            RawData::U8(t) => {
                let [r, g, b, a] = t[i].map(usize::from);
                let table: &[f32; 256] = match transfer {
                    Transfer::Srgb => &SRGB_BYTES,
                    Transfer::Linear => &LINEAR_BYTES,
                };
                [table[r], table[g], table[b], LINEAR_BYTES[a]]
            }
            RawData::U16(t) => {
                let [r, g, b, a] = t[i].map(|v| f32::from(v) / 65535.0);
                match transfer {
                    Transfer::Srgb => [srgb_decode(r), srgb_decode(g), srgb_decode(b), a],
                    Transfer::Linear => [r, g, b, a],
                }
            }
            RawData::F32(t) => t[i],
        }
    }
}

static SRGB_BYTES: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| srgb_decode(i as f64 / 255.0) as f32));
static LINEAR_BYTES: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|i| (i as f64 / 255.0) as f32));

/// Linear value of an sRGB-encoded one in \[0, 1]. Source: IEC 61966-2-1:1999.
pub(crate) fn srgb_decode<R: Real>(v: R) -> R {
    let low = v / R::lit(12.92);
    let high = Real::powf((v + R::lit(0.055)) / R::lit(1.055), R::lit(2.4));
    R::select(v.le(R::lit(0.04045)), low, high)
}

/// An affine map of texture coordinates: uv ↦ offset + R(rotation) · (scale ∘ uv), as KHR_texture_transform has it.
///
/// The rotation is counter-clockwise about the origin as seen in the picture, v pointing down:
/// u′ = cos·u + sin·v, v′ = −sin·u + cos·v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UvTransform {
    row_u: [f32; 3],
    row_v: [f32; 3],
}

impl Default for UvTransform {
    fn default() -> Self {
        Self::new([0.0; 2], 0.0, [1.0; 2])
    }
}

impl UvTransform {
    /// The map with these three parts; `rotation_rad` in radians.
    pub fn new(offset: [f32; 2], rotation_rad: f32, scale: [f32; 2]) -> Self {
        let (s, c) = Real::sin_cos(f64::from(rotation_rad));
        let (sx, sy) = (f64::from(scale[0]), f64::from(scale[1]));
        Self {
            row_u: [(c * sx) as f32, (s * sy) as f32, offset[0]],
            row_v: [(-s * sx) as f32, (c * sy) as f32, offset[1]],
        }
    }

    /// The mapped coordinates.
    #[inline]
    pub fn apply(&self, [u, v]: [f32; 2]) -> [f32; 2] {
        let row = |r: &[f32; 3]| r[0] * u + r[1] * v + r[2];
        [row(&self.row_u), row(&self.row_v)]
    }
}

/// A bitmap with all that says how to look it up.
#[derive(Debug, Clone, PartialEq)]
pub struct Texture {
    /// The picture.
    pub bitmap: Arc<Bitmap>,
    /// What its numbers mean.
    pub transfer: Transfer,
    /// Continuation along u and along v.
    pub wrap: [Wrap; 2],
    /// Interpolation.
    pub filter: Filter,
    /// Map applied to the surface's texture coordinates first.
    pub transform: UvTransform,
    /// Which of the surface's sets of texture coordinates: 0 or 1.
    pub uv_set: u8,
}

impl Texture {
    /// A texture of `bitmap` with repeat, bilinear filter, no transform and the first set of coordinates.
    pub fn new(bitmap: Arc<Bitmap>, transfer: Transfer) -> Self {
        Self {
            bitmap,
            transfer,
            wrap: [Wrap::Repeat; 2],
            filter: Filter::Bilinear,
            transform: UvTransform::default(),
            uv_set: 0,
        }
    }

    /// The decoded red, green, blue and alpha for a surface with the two sets of texture coordinates.
    #[inline]
    pub fn lookup(&self, uv: [f32; 2], uv1: [f32; 2]) -> [f32; 4] {
        self.sample(
            self.transform
                .apply(if self.uv_set == 0 { uv } else { uv1 }),
        )
    }

    /// The decoded red, green, blue and alpha at picture coordinates (u, v), the transform already applied.
    ///
    /// Texel (i, j) is centred at ((i + ½)/width, (j + ½)/height). Coordinates that are not finite read the first texel.
    pub fn sample(&self, uv: [f32; 2]) -> [f32; 4] {
        let bitmap = &*self.bitmap;
        let (x, fx) = place(uv[0], bitmap.image.width, self.wrap[0], self.filter);
        let (y, fy) = place(uv[1], bitmap.image.height, self.wrap[1], self.filter);
        let texel = |i: usize, j: usize| bitmap.texel(x[i], y[j], self.transfer);
        if self.filter == Filter::Nearest {
            return texel(0, 0);
        }
        let (t00, t10, t01, t11) = (texel(0, 0), texel(1, 0), texel(0, 1), texel(1, 1));
        std::array::from_fn(|k| {
            let top = t00[k] + fx * (t10[k] - t00[k]);
            let bottom = t01[k] + fx * (t11[k] - t01[k]);
            top + fy * (bottom - top)
        })
    }

    /// Mean of the decoded texels, over a grid of at most 256² of them: enough to weigh a light among others.
    pub fn mean(&self) -> [f64; 4] {
        let bitmap = &*self.bitmap;
        let (nx, ny) = (bitmap.image.width.min(256), bitmap.image.height.min(256));
        let mut sum = [0.0; 4];
        for j in 0..ny {
            for i in 0..nx {
                let texel = bitmap.texel(
                    i * bitmap.image.width / nx,
                    j * bitmap.image.height / ny,
                    self.transfer,
                );
                for (s, t) in sum.iter_mut().zip(texel) {
                    *s += f64::from(t);
                }
            }
        }
        sum.map(|s| s / (nx * ny) as f64)
    }
}

/// The two neighbouring texels along an axis and the weight of the second.
#[inline]
fn place(coordinate: f32, size: usize, wrap: Wrap, filter: Filter) -> ([usize; 2], f32) {
    if !coordinate.is_finite() {
        return ([0, 0], 0.0);
    }
    // One period first, so that far tiles lose no more precision than the coordinate itself has lost.
    let period = match wrap {
        Wrap::Repeat => coordinate - coordinate.floor(),
        Wrap::Mirror => coordinate - 2.0 * (0.5 * coordinate).floor(),
        Wrap::Clamp => coordinate.clamp(-1.0, 2.0),
    };
    let x = period * size as f32;
    let x = if filter == Filter::Bilinear {
        x - 0.5
    } else {
        x
    };
    let low = x.floor();
    let first = low as i64;
    (
        [wrapped(first, size, wrap), wrapped(first + 1, size, wrap)],
        x - low,
    )
}

/// Index of a texel of the endless picture in the stored one.
#[inline]
fn wrapped(i: i64, size: usize, wrap: Wrap) -> usize {
    let n = size as i64;
    let index = match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let m = i.rem_euclid(2 * n);
            if m < n { m } else { 2 * n - 1 - m }
        }
    };
    index as usize
}

#[cfg(test)]
#[path = "texture_tests.rs"]
mod tests;
