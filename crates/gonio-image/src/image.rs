//! [`Image`]: a rectangle of linear RGB.

use crate::format::{self, FileFormat};
use crate::rows::{Store, write_rows};
use crate::tonemap::{self, ToneMap};
use crate::{ImageError, Limits, RawImage, TexelFormat, atomic};
use std::path::Path;

/// A rectangle of linear RGB with Rec. 709 (sRGB) primaries, in whatever unit its maker says, usually radiance
/// [W m⁻² sr⁻¹].
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Row after row from the top left; `width * height` of them.
    pub pixels: Vec<[f32; 3]>,
}

impl Image {
    /// A black image.
    pub fn new(width: usize, height: usize) -> Self {
        Self::filled(width, height, [0.0; 3])
    }

    /// An image of one colour.
    pub fn filled(width: usize, height: usize, rgb: [f32; 3]) -> Self {
        Self {
            width,
            height,
            pixels: vec![rgb; width * height],
        }
    }

    /// The image whose pixel in column x, row y is `f(x, y)`; called row by row from the top left.
    pub fn from_fn(
        width: usize,
        height: usize,
        mut f: impl FnMut(usize, usize) -> [f32; 3],
    ) -> Self {
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            for x in 0..width {
                pixels.push(f(x, y));
            }
        }
        Self {
            width,
            height,
            pixels,
        }
    }

    /// The pixel in column `x`, row `y`.
    ///
    /// # Panics
    /// Outside the image.
    pub fn get(&self, x: usize, y: usize) -> [f32; 3] {
        self.pixels[self.index(x, y)]
    }

    /// Replaces the pixel in column `x`, row `y`.
    ///
    /// # Panics
    /// Outside the image.
    pub fn set(&mut self, x: usize, y: usize, rgb: [f32; 3]) {
        let i = self.index(x, y);
        self.pixels[i] = rgb;
    }

    fn index(&self, x: usize, y: usize) -> usize {
        assert!(
            x < self.width && y < self.height,
            "pixel ({x}, {y}) of an image of {} × {}",
            self.width,
            self.height
        );
        y * self.width + x
    }

    /// Reads an EXR, Radiance HDR, PNG, JPEG or TIFF file, whatever its name, within the default [`Limits`].
    ///
    /// - EXR: the channels R, G, B, or Y as grey, of the default layer, else of the first layer that has them.
    ///   Other primaries (`chromaticities`) are converted to Rec. 709, with Bradford's adaptation to D65.
    /// - HDR: values divided by the file's exposure.
    /// - PNG, JPEG and TIFF: 8- and 16-bit sRGB, decoded to linear light (floats of a TIFF are linear); alpha is dropped; colour profiles are not applied;
    ///   a JPEG's EXIF orientation is. [`RawImage`] keeps alpha and the codes.
    ///
    /// Values are not altered otherwise: an EXR's NaN stays ([`Image::scan`] finds it).
    ///
    /// # Errors
    /// Every variant of [`ImageError`] but `Parameter`.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        Self::read_within(path, &Limits::default())
    }

    /// [`Image::read`] within other limits.
    ///
    /// # Errors
    /// As [`Image::read`].
    pub fn read_within(path: &Path, limits: &Limits) -> Result<Self, ImageError> {
        format::read_image(&path.display().to_string(), limits.open(path)?, limits)
    }

    /// [`Image::read`] of bytes in memory.
    ///
    /// # Errors
    /// As [`Image::read`], with `<memory>` for the file's name.
    pub fn decode(bytes: &[u8], limits: &Limits) -> Result<Self, ImageError> {
        limits.check_bytes(format::MEMORY, bytes.len() as u64)?;
        format::decode_image(format::MEMORY, bytes, limits)
    }

    /// Writes an EXR (float, lossless), HDR, PNG (8-bit, sRGB transfer, clamped to [0, 1]), KTX2 or DDS (half floats) file,
    /// by the name's extension.
    ///
    /// # Errors
    /// `Unsupported` for another extension; `Parameter` for an empty image, or one that the format cannot hold (HDR: finite
    /// values ≥ 0); `Io` with nothing half-written.
    pub fn write(&self, path: &Path) -> Result<(), ImageError> {
        match FileFormat::of_extension(path)? {
            FileFormat::Exr => self.write_by_rows(path, Store::ExrFloat),
            FileFormat::Hdr => self.write_by_rows(path, Store::Hdr),
            FileFormat::Png => self.write_png(path, ToneMap::Linear, 0.0),
            kind @ (FileFormat::Ktx2 | FileFormat::Dds) => {
                self.write_as_texture(path, kind, TexelFormat::Half)
            }
            kind @ (FileFormat::Jpeg | FileFormat::Tiff) => Err(ImageError::unsupported(
                path.display().to_string(),
                match kind {
                    FileFormat::Tiff => "writing TIFF",
                    _ => "writing JPEG",
                },
                "write .png, .exr or .hdr",
            )),
        }
    }

    /// Writes a KTX2 or DDS file of one picture, by the name's extension, and reads it again before it is put in place.
    ///
    /// # Errors
    /// As [`CubeMap::write`](crate::CubeMap::write).
    pub fn write_texture(&self, path: &Path, format: TexelFormat) -> Result<(), ImageError> {
        self.write_as_texture(path, FileFormat::of_extension(path)?, format)
    }

    fn write_as_texture(
        &self,
        path: &Path,
        kind: FileFormat,
        format: TexelFormat,
    ) -> Result<(), ImageError> {
        self.check_shape(path)?;
        let faces: &[Image] = std::slice::from_ref(self);
        let bytes = format::texture::encode(path, kind, &[faces], format)?;
        atomic::write(path, &bytes)
    }

    /// Writes an 8-bit PNG: the image times 2^`exposure_ev`, tone mapped, with the sRGB transfer.
    ///
    /// # Errors
    /// `Parameter` for an empty image; `Io` with nothing half-written.
    pub fn write_png(
        &self,
        path: &Path,
        tonemap: ToneMap,
        exposure_ev: f32,
    ) -> Result<(), ImageError> {
        self.write_by_rows(
            path,
            Store::Png {
                tonemap,
                exposure_ev,
                deep: false,
            },
        )
    }

    /// Writes a 16-bit PNG: as [`Image::write_png`], with 65,536 steps.
    ///
    /// # Errors
    /// As [`Image::write_png`].
    pub fn write_png16(
        &self,
        path: &Path,
        tonemap: ToneMap,
        exposure_ev: f32,
    ) -> Result<(), ImageError> {
        self.write_by_rows(
            path,
            Store::Png {
                tonemap,
                exposure_ev,
                deep: true,
            },
        )
    }

    fn write_by_rows(&self, path: &Path, store: Store) -> Result<(), ImageError> {
        self.check_shape(path)?;
        write_rows(
            path,
            [self.width, self.height],
            store,
            &mut |first, rows| {
                let start = first * self.width;
                rows.copy_from_slice(&self.pixels[start..start + rows.len()]);
                Ok(())
            },
        )
    }

    /// 8-bit sRGB codes, three a pixel: the image times 2^`exposure_ev`, tone mapped, with the sRGB transfer.
    pub fn to_srgb8(&self, tonemap: ToneMap, exposure_ev: f32) -> Vec<u8> {
        let scale = tonemap::exposure_scale(exposure_ev);
        self.pixels
            .iter()
            .flat_map(|p| tonemap::encode_srgb8(tonemap.apply(p.map(|c| c * scale))))
            .collect()
    }

    /// Refuses an image without pixels, or whose `pixels` are not `width * height`.
    pub(crate) fn check_shape(&self, path: &Path) -> Result<(), ImageError> {
        if self.width == 0 || self.height == 0 || self.pixels.len() != self.width * self.height {
            return Err(ImageError::parameter(format!(
                "{}: an image of {} × {} with {} pixels cannot be written",
                path.display(),
                self.width,
                self.height,
                self.pixels.len()
            )));
        }
        Ok(())
    }
}

impl From<&RawImage> for Image {
    /// Decodes sRGB codes to linear light and drops alpha. Floats are taken as linear.
    fn from(raw: &RawImage) -> Self {
        Self {
            width: raw.width,
            height: raw.height,
            pixels: raw.srgb_to_linear().map(|[r, g, b, _]| [r, g, b]).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_row_major_from_the_top_left() {
        let mut image = Image::from_fn(3, 2, |x, y| [x as f32, y as f32, 0.0]);
        assert_eq!(image.pixels[4], [1.0, 1.0, 0.0]);
        image.set(2, 0, [9.0; 3]);
        assert_eq!(image.pixels[2], [9.0; 3]);
        assert_eq!(image.get(0, 1), [0.0, 1.0, 0.0]);
    }

    #[test]
    #[should_panic(expected = "pixel (3, 0) of an image of 3 × 2")]
    fn a_pixel_outside_is_refused() {
        Image::new(3, 2).get(3, 0);
    }

    #[test]
    fn what_cannot_be_written_is_refused_before_the_disk_is_touched() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in ["a.exr", "a.hdr", "a.png"] {
            let empty = Image::new(0, 3).write(&at(name));
            assert!(matches!(empty, Err(ImageError::Parameter { .. })), "{name}");
            let ragged = Image {
                width: 2,
                height: 2,
                pixels: vec![[0.0; 3]; 3],
            };
            assert!(matches!(
                ragged.write(&at(name)),
                Err(ImageError::Parameter { .. })
            ));
        }
        let jpeg = Image::new(1, 1)
            .write(&at("a.jpg"))
            .unwrap_err()
            .to_string();
        assert!(
            jpeg.contains("writing JPEG is not supported; write .png"),
            "{jpeg}"
        );
        let none = Image::new(1, 1).write(&at("a")).unwrap_err().to_string();
        assert!(none.contains("exr"), "{none}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
