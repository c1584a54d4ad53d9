//! What KTX2 and DDS have in common: one picture, or the six faces of a cube, with mip levels.

use super::{FileFormat, dds, ktx2, sniff};
use crate::format::texel::Storage;
use crate::{Image, ImageError, Limits, TexelFormat};
use std::path::Path;

/// The pictures of a texture file.
pub(crate) struct Texture {
    /// Columns of the first level.
    pub width: usize,
    /// 1 or 6.
    pub faces: usize,
    /// Largest first; of each level, every face.
    pub levels: Vec<Vec<Image>>,
}

/// What a header says.
pub(crate) struct Shape {
    pub width: usize,
    pub height: usize,
    pub faces: usize,
    pub levels: usize,
    pub storage: Storage,
}

/// A side of level `level`.
pub(crate) fn side(size: usize, level: usize) -> usize {
    (size >> level.min(63)).max(1)
}

/// Levels down to one texel.
pub(crate) fn level_count(width: usize, height: usize) -> usize {
    width.max(height).max(1).ilog2() as usize + 1
}

impl Shape {
    /// Refuses what is too large or has too many levels, before anything is allocated.
    pub fn check(&self, file: &str, limits: &Limits) -> Result<(), ImageError> {
        let height = self.height as u64;
        limits.check(file, self.width as u64, height * self.faces as u64, 12)?;
        let most = level_count(self.width, self.height);
        if self.levels > most {
            return Err(ImageError::format(
                file,
                "header",
                format!("{} levels", self.levels),
                format!("at most {most} for {} × {}", self.width, self.height),
            ));
        }
        if self.faces == 6 && self.width != self.height {
            return Err(ImageError::format(
                file,
                "header",
                format!("cube faces of {} × {}", self.width, self.height),
                "square faces",
            ));
        }
        Ok(())
    }

    /// Columns and rows of a level.
    pub fn level_size(&self, level: usize) -> (usize, usize) {
        (side(self.width, level), side(self.height, level))
    }

    /// Bytes of one face of a level.
    pub fn face_bytes(&self, level: usize) -> u64 {
        let (width, height) = self.level_size(level);
        self.storage.bytes(width, height)
    }
}

/// A place among bytes that has to be there.
pub(crate) fn slice<'a>(
    file: &str,
    bytes: &'a [u8],
    start: u64,
    length: u64,
    what: impl Fn() -> String,
) -> Result<&'a [u8], ImageError> {
    let end = start.checked_add(length);
    end.filter(|&end| end <= bytes.len() as u64)
        .map(|end| &bytes[start as usize..end as usize])
        .ok_or_else(|| {
            ImageError::format(
                file,
                format!("byte {}", bytes.len()),
                "the end of the file",
                format!("{} ({length} bytes from byte {start})", what()),
            )
        })
}

/// A little-endian number at `at` of a header whose length is checked.
pub(crate) fn u32_at(header: &[u8], at: usize) -> u32 {
    let bytes = header[at..at + 4].try_into();
    u32::from_le_bytes(bytes.expect("invariant: four bytes"))
}

/// A little-endian number at `at` of a header whose length is checked.
pub(crate) fn u64_at(header: &[u8], at: usize) -> u64 {
    let bytes = header[at..at + 8].try_into();
    u64::from_le_bytes(bytes.expect("invariant: eight bytes"))
}

/// Reads a KTX2 or DDS file.
pub(crate) fn decode(file: &str, bytes: &[u8], limits: &Limits) -> Result<Texture, ImageError> {
    match sniff(file, bytes)? {
        FileFormat::Ktx2 => ktx2::decode(file, bytes, limits),
        FileFormat::Dds => dds::decode(file, bytes, limits),
        _ => Err(ImageError::unsupported(
            file,
            "a picture of another format as a texture",
            "KTX2 and DDS are",
        )),
    }
}

/// The only picture of a KTX2 or DDS file.
pub(crate) fn decode_image(file: &str, bytes: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    let mut texture = decode(file, bytes, limits)?;
    if texture.faces != 1 {
        return Err(ImageError::unsupported(
            file,
            "a cube map as one picture",
            "read it as an environment (`gonio env convert` makes a panorama of it)",
        ));
    }
    Ok(texture.levels.swap_remove(0).swap_remove(0))
}

/// The bytes of a KTX2 or DDS file, which have been read again.
pub(crate) fn encode(
    path: &Path,
    kind: FileFormat,
    levels: &[&[Image]],
    format: TexelFormat,
) -> Result<Vec<u8>, ImageError> {
    let file = path.display().to_string();
    let first = &levels[0][0];
    let shape = Shape {
        width: first.width,
        height: first.height,
        faces: levels[0].len(),
        levels: levels.len(),
        storage: format.storage(),
    };
    if u32::try_from(first.width.max(first.height)).is_err() {
        return Err(ImageError::parameter(format!(
            "{file}: {} × {} does not fit the format",
            first.width, first.height
        )));
    }
    for (level, faces) in levels.iter().enumerate() {
        for (face, image) in faces.iter().enumerate() {
            if let Some((x, y, value)) = format.unfit(image) {
                return Err(ImageError::parameter(format!(
                    "{file}: texel ({x}, {y}) of face {face}, level {level}, is {value}; {format} holds finite numbers ≥ 0"
                )));
            }
        }
    }
    let data: Vec<Vec<u8>> = levels
        .iter()
        .map(|faces| {
            let mut all = Vec::new();
            for image in *faces {
                all.extend(format.storage().encode(image));
            }
            all
        })
        .collect();
    let bytes = match kind {
        FileFormat::Ktx2 => ktx2::assemble(&shape, &data),
        FileFormat::Dds => dds::assemble(&shape, &data),
        _ => {
            return Err(ImageError::unsupported(
                file,
                "a cube map in this format",
                "write .ktx2 or .dds",
            ));
        }
    };
    check_written(&file, &bytes, levels, format)?;
    Ok(bytes)
}

/// Reads what was written; it must be what was to be written, to the format's precision.
fn check_written(
    file: &str,
    bytes: &[u8],
    levels: &[&[Image]],
    format: TexelFormat,
) -> Result<(), ImageError> {
    let limits = Limits {
        max_pixels: u64::MAX,
        max_bytes: u64::MAX,
    };
    let read = decode(file, bytes, &limits)?;
    let wrong = |what: String| ImageError::format(file, "what was written", what, "what was given");
    if read.levels.len() != levels.len() || read.faces != levels[0].len() {
        return Err(wrong(format!(
            "{} levels of {} faces",
            read.levels.len(),
            read.faces
        )));
    }
    for (level, (found, given)) in read.levels.iter().zip(levels).enumerate() {
        for (face, (found, given)) in found.iter().zip(*given).enumerate() {
            if (found.width, found.height) != (given.width, given.height)
                || !format.is_near(found, given)
            {
                return Err(wrong(format!(
                    "another picture in level {level}, face {face}"
                )));
            }
        }
    }
    Ok(())
}
