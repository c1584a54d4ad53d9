//! [`RawImage`]: four channels as the file holds them.

use crate::format::{self, Orientation};
use crate::{ImageError, Limits, srgb};
use std::path::Path;

/// The samples of a [`RawImage`]: red, green, blue, alpha.
#[derive(Debug, Clone, PartialEq)]
pub enum RawData {
    /// Codes of 8 bits, of a PNG or TIFF (1 to 8 bits; fewer are scaled up) or JPEG.
    U8(Vec<[u8; 4]>),
    /// Codes of 16 bits, of a PNG or TIFF.
    U16(Vec<[u16; 4]>),
    /// Linear values, of an EXR, Radiance HDR or floating-point TIFF.
    F32(Vec<[f32; 4]>),
}

/// A picture as its file holds it: four channels, nothing decoded. Textures need this: a normal map is not a colour, and
/// a base colour has alpha. Grey is spread over red, green and blue; a missing alpha is full.
///
/// An EXIF orientation is not applied: texture coordinates address the stored pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct RawImage {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row from the top left.
    pub data: RawData,
    /// The file has an alpha channel (or a transparent palette entry).
    pub has_alpha: bool,
}

impl RawImage {
    /// Reads an EXR, Radiance HDR, PNG, JPEG or TIFF file, whatever its name, within the default [`Limits`].
    ///
    /// # Errors
    /// As [`Image::read`](crate::Image::read).
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let limits = Limits::default();
        let bytes = limits.read_file(path)?;
        format::decode_raw(
            &path.display().to_string(),
            &bytes,
            Orientation::Ignore,
            &limits,
        )
    }

    /// [`RawImage::read`] of a photograph: an EXIF orientation is applied, and the file's bytes are handed over too, for
    /// what else stands in them.
    ///
    /// # Errors
    /// As [`Image::read`](crate::Image::read).
    pub fn read_upright(path: &Path) -> Result<(Self, Vec<u8>), ImageError> {
        let limits = Limits::default();
        let bytes = limits.read_file(path)?;
        let name = path.display().to_string();
        let picture = format::decode_raw(&name, &bytes, Orientation::Apply, &limits)?;
        Ok((picture, bytes))
    }

    /// Decodes bytes in memory within the default [`Limits`].
    ///
    /// # Errors
    /// As [`Image::read`](crate::Image::read), with `<memory>` for the file's name.
    pub fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        Self::decode_within(bytes, &Limits::default())
    }

    /// Decodes bytes in memory within other limits.
    ///
    /// # Errors
    /// As [`RawImage::decode`].
    pub fn decode_within(bytes: &[u8], limits: &Limits) -> Result<Self, ImageError> {
        limits.check_bytes(format::MEMORY, bytes.len() as u64)?;
        format::decode_raw(format::MEMORY, bytes, Orientation::Ignore, limits)
    }

    /// 4: red, green, blue, alpha.
    pub fn channels(&self) -> usize {
        4
    }

    /// Bits of a stored sample: 8, 16 or 32.
    pub fn bit_depth(&self) -> u32 {
        match self.data {
            RawData::U8(_) => 8,
            RawData::U16(_) => 16,
            RawData::F32(_) => 32,
        }
    }

    /// The pixel in column `x`, row `y` without a transfer function: codes divided by their largest, in [0, 1]; floats as
    /// they are.
    ///
    /// # Panics
    /// Outside the image.
    pub fn get(&self, x: usize, y: usize) -> [f32; 4] {
        assert!(x < self.width && y < self.height, "pixel ({x}, {y})");
        let i = y * self.width + x;
        match &self.data {
            RawData::U8(d) => d[i].map(|c| f32::from(c) / 255.0),
            RawData::U16(d) => d[i].map(|c| f32::from(c) / 65535.0),
            RawData::F32(d) => d[i],
        }
    }

    /// All pixels without a transfer function, as [`RawImage::get`] gives them: for normals, roughness, occlusion.
    pub fn linear(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        (0..self.width * self.height).map(|i| self.get(i % self.width, i / self.width))
    }

    /// All pixels with red, green and blue decoded from sRGB to linear light, alpha as it is: for colours. Floats are
    /// linear already.
    pub fn srgb_to_linear(&self) -> impl Iterator<Item = [f32; 4]> + '_ {
        (0..self.width * self.height).map(|i| match &self.data {
            RawData::U8(d) => {
                let [r, g, b, a] = d[i];
                let s = srgb::decode8;
                [s(r), s(g), s(b), f32::from(a) / 255.0]
            }
            RawData::U16(d) => {
                let [r, g, b, a] = d[i];
                let s = srgb::decode16;
                [s(r), s(g), s(b), f32::from(a) / 65535.0]
            }
            RawData::F32(d) => d[i],
        })
    }
}
