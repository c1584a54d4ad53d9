//! How textures store their texels.

mod bc6h;
mod rgb9e5;

use crate::{Image, f16, srgb};
use std::fmt;

/// How a KTX2 or DDS file stores its texels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TexelFormat {
    /// Four half floats, alpha 1: 8 bytes a texel, 11 significant bits, up to 65,504.
    #[default]
    Half,
    /// Four floats, alpha 1: 16 bytes a texel, lossless.
    Float,
    /// Three mantissas of 9 bits and a shared exponent of 5: 4 bytes a texel, up to 65,408.
    Rgb9e5,
    /// BC6H, unsigned, as blocks of 4 × 4 texels: 1 byte a texel, up to 65,504; lossy.
    Bc6h,
}

impl TexelFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Half, Self::Float, Self::Rgb9e5, Self::Bc6h];

    /// `half`, `float`, `rgb9e5` or `bc6h`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Half => "half",
            Self::Float => "float",
            Self::Rgb9e5 => "rgb9e5",
            Self::Bc6h => "bc6h",
        }
    }

    /// The largest value it holds.
    pub fn largest(self) -> f32 {
        match self {
            Self::Half | Self::Bc6h => f16::MAX.to_f32(),
            Self::Float => f32::MAX,
            Self::Rgb9e5 => rgb9e5::LARGEST,
        }
    }

    /// How many samples of `image` are finite and above [`TexelFormat::largest`].
    pub fn above(self, image: &Image) -> u64 {
        let samples = image.pixels.iter().flatten();
        samples
            .filter(|c| c.is_finite() && **c > self.largest())
            .count() as u64
    }

    pub(crate) fn storage(self) -> Storage {
        match self {
            Self::Half => Storage::Half { channels: 4 },
            Self::Float => Storage::Float { channels: 4 },
            Self::Rgb9e5 => Storage::Rgb9e5,
            Self::Bc6h => Storage::Bc6h { signed: false },
        }
    }

    /// The first texel that the format can't hold, and its value.
    pub(crate) fn unfit(self, image: &Image) -> Option<(usize, usize, f32)> {
        if !matches!(self, Self::Rgb9e5 | Self::Bc6h) {
            return None;
        }
        image.pixels.iter().enumerate().find_map(|(i, texel)| {
            let bad = texel.iter().find(|c| !(c.is_finite() && **c >= 0.0));
            bad.map(|c| (i % image.width, i / image.width, *c))
        })
    }

    /// Whether `found` is what reading gives back of `given`. BC6H has no bound for each texel.
    pub(crate) fn is_near(self, found: &Image, given: &Image) -> bool {
        let largest = self.largest();
        let near = |f: f32, g: f32, texel: &[f32; 3]| match self {
            Self::Float => f.to_bits() == g.to_bits(),
            Self::Half => f.to_bits() == half(g).to_f32().to_bits(),
            // Half a step of the shared exponent: 2⁻⁹ of the largest channel, or of the smallest exponent.
            Self::Rgb9e5 => {
                let high = texel.iter().fold(0.0_f32, |m, c| m.max(*c)).min(largest);
                (f - g.min(largest)).abs() <= (high / 512.0).max(rgb9e5::SMALLEST)
            }
            Self::Bc6h => f.is_finite() && f >= 0.0,
        };
        let pairs = found.pixels.iter().zip(&given.pixels);
        pairs
            .into_iter()
            .all(|(f, g)| (0..3).all(|c| near(f[c], g[c], g)))
    }
}

impl fmt::Display for TexelFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The half float nearest to `x`; finite values above the largest become it.
pub(crate) fn half(x: f32) -> f16 {
    if x.is_finite() {
        f16::from_f32(x.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
    } else {
        f16::from_f32(x)
    }
}

/// Every form that can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Storage {
    Half {
        channels: usize,
    },
    Float {
        channels: usize,
    },
    /// Unsigned floats of 11, 11 and 10 bits.
    Rg11b10,
    Rgb9e5,
    Bc6h {
        signed: bool,
    },
    /// Codes of 8 bits: bytes a texel, where red, green and blue stand, and whether they have the sRGB transfer.
    Codes {
        bytes: usize,
        rgb: [usize; 3],
        srgb: bool,
    },
}

impl Storage {
    /// Bytes of a block of texels.
    pub fn block_bytes(self) -> usize {
        match self {
            Self::Half { channels } => 2 * channels,
            Self::Float { channels } => 4 * channels,
            Self::Rg11b10 | Self::Rgb9e5 => 4,
            Self::Bc6h { .. } => 16,
            Self::Codes { bytes, .. } => bytes,
        }
    }

    /// Columns, and rows, of a block.
    pub fn block_side(self) -> usize {
        match self {
            Self::Bc6h { .. } => 4,
            _ => 1,
        }
    }

    /// Bytes of a picture.
    pub fn bytes(self, width: usize, height: usize) -> u64 {
        let blocks = |n: usize| n.div_ceil(self.block_side()) as u64;
        (blocks(width) * blocks(height)).saturating_mul(self.block_bytes() as u64)
    }

    /// The picture in `bytes`, which are as many as [`Storage::bytes`] says.
    pub fn decode(self, bytes: &[u8], width: usize, height: usize) -> Image {
        if let Self::Bc6h { signed } = self {
            return bc6h::decode(bytes, width, height, signed);
        }
        let texels = bytes.chunks_exact(self.block_bytes());
        Image {
            width,
            height,
            pixels: texels.map(|t| self.texel(t)).collect(),
        }
    }

    fn texel(self, t: &[u8]) -> [f32; 3] {
        let grey_or = |channels: usize, at: &dyn Fn(usize) -> f32| {
            let mut rgb = [0.0; 3];
            for (c, value) in rgb.iter_mut().enumerate() {
                if channels == 1 {
                    *value = at(0);
                } else if c < channels {
                    *value = at(c);
                }
            }
            rgb
        };
        match self {
            Self::Half { channels } => grey_or(channels, &|c| {
                f16::from_bits(u16::from_le_bytes([t[2 * c], t[2 * c + 1]])).to_f32()
            }),
            Self::Float { channels } => grey_or(channels, &|c| {
                f32::from_le_bytes([t[4 * c], t[4 * c + 1], t[4 * c + 2], t[4 * c + 3]])
            }),
            Self::Rgb9e5 => rgb9e5::decode(u32::from_le_bytes([t[0], t[1], t[2], t[3]])),
            Self::Rg11b10 => {
                let bits = u32::from_le_bytes([t[0], t[1], t[2], t[3]]);
                // Unsigned floats with the exponent of a half: shifted, they are halves.
                let float = |code: u32, shift: u32| f16::from_bits((code << shift) as u16).to_f32();
                [
                    float(bits & 0x7ff, 4),
                    float(bits >> 11 & 0x7ff, 4),
                    float(bits >> 22, 5),
                ]
            }
            Self::Codes { rgb, srgb, .. } => {
                let mut linear = [0.0; 3];
                for (value, at) in linear.iter_mut().zip(rgb) {
                    *value = if srgb {
                        srgb::decode8(t[at])
                    } else {
                        f32::from(t[at]) / 255.0
                    };
                }
                linear
            }
            Self::Bc6h { .. } => [0.0; 3],
        }
    }

    /// The bytes of a picture, for the forms of [`TexelFormat`].
    pub fn encode(self, image: &Image) -> Vec<u8> {
        match self {
            Self::Bc6h { .. } => bc6h::encode(image),
            Self::Rgb9e5 => {
                let texels = image.pixels.iter();
                texels
                    .flat_map(|t| rgb9e5::encode(*t).to_le_bytes())
                    .collect()
            }
            Self::Half { .. } => {
                let one = f16::ONE.to_bits().to_le_bytes();
                let mut bytes = Vec::with_capacity(image.pixels.len() * 8);
                for texel in &image.pixels {
                    for c in texel {
                        bytes.extend(half(*c).to_bits().to_le_bytes());
                    }
                    bytes.extend(one);
                }
                bytes
            }
            _ => {
                let mut bytes = Vec::with_capacity(image.pixels.len() * 16);
                for texel in &image.pixels {
                    for c in texel {
                        bytes.extend(c.to_le_bytes());
                    }
                    bytes.extend(1.0_f32.to_le_bytes());
                }
                bytes
            }
        }
    }
}
