//! [`CubeMap`]: six square pictures and their smaller copies.

use crate::format::texture;
use crate::{FileFormat, Image, ImageError, Limits, TexelFormat, atomic};
use std::path::Path;

/// The six faces of a cube map with its mip levels, as KTX2 and DDS files hold them.
///
/// Faces are in the order +x, −x, +y, −y, +z, −z, rows from the top, just as the file stores them. Which way the axes
/// point, and whether a face is mirrored, is a convention of the program that made the file: `gonio-env` knows some.
#[derive(Debug, Clone, PartialEq)]
pub struct CubeMap {
    /// Columns, and rows, of a face of the first level.
    pub size: usize,
    /// The levels, each with half the size of the one before, rounded down, at least 1.
    pub levels: Vec<[Image; 6]>,
}

impl CubeMap {
    /// A cube map without smaller levels.
    ///
    /// # Errors
    /// `Parameter` if a face is not square, empty, or of another size than the first.
    pub fn new(faces: [Image; 6]) -> Result<Self, ImageError> {
        Self::with_levels(vec![faces])
    }

    /// A cube map of these levels, the largest first.
    ///
    /// # Errors
    /// `Parameter` if there is none, or a face has not the size of its level.
    pub fn with_levels(levels: Vec<[Image; 6]>) -> Result<Self, ImageError> {
        let size = levels.first().map_or(0, |faces| faces[0].width);
        let cube = Self { size, levels };
        cube.check()?;
        Ok(cube)
    }

    fn check(&self) -> Result<(), ImageError> {
        if self.size == 0 || self.levels.is_empty() {
            return Err(ImageError::parameter(
                "a cube map has at least one level of one texel",
            ));
        }
        for (level, faces) in self.levels.iter().enumerate() {
            let expected = texture::side(self.size, level);
            for (face, image) in faces.iter().enumerate() {
                let whole = image.pixels.len() == image.width * image.height;
                if image.width != expected || image.height != expected || !whole {
                    return Err(ImageError::parameter(format!(
                        "face {face} of level {level} of a cube map has {} × {} pixels, expected {expected} × {expected}",
                        image.width, image.height
                    )));
                }
            }
        }
        if self.levels.len() > texture::level_count(self.size, self.size) {
            return Err(ImageError::parameter(format!(
                "a cube map of {} has at most {} levels, not {}",
                self.size,
                texture::level_count(self.size, self.size),
                self.levels.len()
            )));
        }
        Ok(())
    }

    /// Bytes from the start of a file that [`CubeMap::is_in`] needs.
    pub const HEADER: usize = 148;

    /// Whether a file that begins like this holds a cube map: KTX2 or DDS with six faces. Nothing is checked besides.
    pub fn is_in(start: &[u8]) -> bool {
        let number = |at: usize| {
            let bytes = start.get(at..at + 4)?.try_into().ok()?;
            Some(u32::from_le_bytes(bytes))
        };
        match FileFormat::of_content(start) {
            Some(FileFormat::Ktx2) => number(36) == Some(6),
            // The old header's mark, or that of DX10.
            Some(FileFormat::Dds) => {
                let dx10 = start.get(84..88) == Some(b"DX10");
                number(112).is_some_and(|caps| caps & 0x200 != 0)
                    || dx10 && number(136).is_some_and(|flags| flags & 4 != 0)
            }
            _ => false,
        }
    }

    /// Reads a KTX2 or DDS file, whatever its name, within the default [`Limits`].
    ///
    /// # Errors
    /// Every variant of [`ImageError`] but `Parameter`; `Unsupported` for a file that holds a plain picture.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        Self::read_within(path, &Limits::default())
    }

    /// [`CubeMap::read`] within other limits.
    ///
    /// # Errors
    /// As [`CubeMap::read`].
    pub fn read_within(path: &Path, limits: &Limits) -> Result<Self, ImageError> {
        let bytes = limits.read_file(path)?;
        Self::of_texture(&path.display().to_string(), &bytes, limits)
    }

    /// [`CubeMap::read`] of bytes in memory.
    ///
    /// # Errors
    /// As [`CubeMap::read`], with `<memory>` for the file's name.
    pub fn decode(bytes: &[u8], limits: &Limits) -> Result<Self, ImageError> {
        limits.check_bytes(crate::format::MEMORY, bytes.len() as u64)?;
        Self::of_texture(crate::format::MEMORY, bytes, limits)
    }

    fn of_texture(file: &str, bytes: &[u8], limits: &Limits) -> Result<Self, ImageError> {
        let texture = texture::decode(file, bytes, limits)?;
        if texture.faces != 6 {
            return Err(ImageError::unsupported(
                file,
                "a texture that is no cube map",
                "six faces are expected",
            ));
        }
        let size = texture.width;
        let mut levels = Vec::with_capacity(texture.levels.len());
        for faces in texture.levels {
            levels.push(
                <[Image; 6]>::try_from(faces).expect("invariant: the reader gives every face"),
            );
        }
        Ok(Self { size, levels })
    }

    /// Writes a KTX2 or DDS file, by the name's extension, and reads it again before it is put in place.
    ///
    /// Samples above the largest that `format` can hold become that: [`CubeMap::above`] counts them.
    ///
    /// # Errors
    /// `Unsupported` for another extension; `Parameter` for a cube map whose faces are of the wrong size, or with values
    /// that the format cannot hold (RGB9E5 and BC6H: finite values ≥ 0); `Io` with nothing half-written.
    pub fn write(&self, path: &Path, format: TexelFormat) -> Result<(), ImageError> {
        let kind = FileFormat::of_extension(path)?;
        let bytes = self.encode(path, kind, format)?;
        atomic::write(path, &bytes)
    }

    /// The bytes of a KTX2 or DDS file; `path` names it in errors.
    ///
    /// # Errors
    /// As [`CubeMap::write`], without `Io`.
    pub fn encode(
        &self,
        path: &Path,
        kind: FileFormat,
        format: TexelFormat,
    ) -> Result<Vec<u8>, ImageError> {
        self.check()
            .map_err(|e| ImageError::parameter(format!("{}: {e}", path.display())))?;
        let levels: Vec<&[Image]> = self.levels.iter().map(<[Image; 6]>::as_slice).collect();
        texture::encode(path, kind, &levels, format)
    }

    /// How many samples are above the largest that `format` can hold.
    pub fn above(&self, format: TexelFormat) -> u64 {
        let images = self.levels.iter().flatten();
        images.map(|image| format.above(image)).sum()
    }
}
