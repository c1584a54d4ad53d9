//! One file a format, and the choice among them.

mod dds;
mod ktx2;
pub(crate) mod openexr;
mod primaries;
pub(crate) mod radiance;
pub(crate) mod raster;
mod supercompression;
mod texel;
pub(crate) mod texture;

pub use texel::TexelFormat;

pub(crate) use primaries::{apply as apply_matrix, to_rec709};
pub(crate) use raster::Orientation;

use crate::limits::Source;
use crate::{Image, ImageError, Limits, RawData, RawImage};
use std::io::{Cursor, Seek, SeekFrom};
use std::path::Path;

/// The name of a file that is none.
pub(crate) const MEMORY: &str = "<memory>";

/// Bytes that tell every format.
const LONGEST_MAGIC: u64 = 12;

/// A file format that this crate knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileFormat {
    /// OpenEXR, `.exr`.
    Exr,
    /// Radiance RGBE, `.hdr` or `.pic`.
    Hdr,
    /// Portable Network Graphics, `.png`.
    Png,
    /// JPEG, `.jpg` or `.jpeg`; read only.
    Jpeg,
    /// Khronos texture container 2.0, `.ktx2`.
    Ktx2,
    /// DirectDraw Surface, `.dds`.
    Dds,
    /// TIFF, `.tif` or `.tiff`; read only.
    Tiff,
}

impl FileFormat {
    /// The format whose files begin with these bytes.
    pub fn of_content(bytes: &[u8]) -> Option<Self> {
        const MAGIC: [(&[u8], FileFormat); 9] = [
            (&[0x76, 0x2f, 0x31, 0x01], FileFormat::Exr),
            (b"#?RADIANCE", FileFormat::Hdr),
            (b"#?RGBE", FileFormat::Hdr),
            (b"\x89PNG\r\n\x1a\n", FileFormat::Png),
            (&[0xff, 0xd8, 0xff], FileFormat::Jpeg),
            (&ktx2::IDENTIFIER, FileFormat::Ktx2),
            (&dds::MAGIC, FileFormat::Dds),
            (b"II*\0", FileFormat::Tiff),
            (b"MM\0*", FileFormat::Tiff),
        ];
        MAGIC
            .iter()
            .find(|(magic, _)| bytes.starts_with(magic))
            .map(|&(_, format)| format)
    }

    /// The format of files with this name's extension, in capitals or not.
    ///
    /// # Errors
    /// `Unsupported` for another extension, or none.
    pub fn of_extension(path: &Path) -> Result<Self, ImageError> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("hdr" | "pic") => Ok(Self::Hdr),
            Some("png") => Ok(Self::Png),
            Some("jpg" | "jpeg") => Ok(Self::Jpeg),
            Some("ktx2") => Ok(Self::Ktx2),
            Some("dds") => Ok(Self::Dds),
            Some("tif" | "tiff") => Ok(Self::Tiff),
            other => Err(ImageError::unsupported(
                path.display().to_string(),
                other.map_or_else(
                    || "a name without an extension".into(),
                    |e| format!("the extension `{e}`"),
                ),
                "use .exr, .hdr, .png, .ktx2 or .dds",
            )),
        }
    }
}

/// The format of `bytes`, or an error that says what they begin with.
fn sniff(file: &str, bytes: &[u8]) -> Result<FileFormat, ImageError> {
    FileFormat::of_content(bytes).ok_or_else(|| {
        let found = if bytes.is_empty() {
            "an empty file".into()
        } else {
            let start: Vec<String> = bytes.iter().take(8).map(|b| format!("{b:02x}")).collect();
            format!("bytes {}", start.join(" "))
        };
        ImageError::format(
            file,
            "start",
            found,
            "EXR, Radiance HDR, PNG, JPEG, TIFF, KTX2 or DDS",
        )
    })
}

/// Reads a picture piece by piece where its format lets it: all but JPEG, KTX2 and DDS.
pub(crate) fn read_image(
    file: &str,
    mut source: Source,
    limits: &Limits,
) -> Result<Image, ImageError> {
    let io = |source| ImageError::Io {
        file: file.into(),
        action: "read it",
        source,
    };
    let start = source.start(LONGEST_MAGIC).map_err(io)?;
    match sniff(file, &start)? {
        FileFormat::Exr => openexr::decode_image(file, source, limits),
        FileFormat::Hdr => {
            let length = source.seek(SeekFrom::End(0)).map_err(io)?;
            source.rewind().map_err(io)?;
            radiance::decode(file, source, length, limits)
        }
        kind @ (FileFormat::Png | FileFormat::Jpeg | FileFormat::Tiff) => {
            raster::decode_image(file, source, kind, limits)
        }
        FileFormat::Ktx2 | FileFormat::Dds => {
            texture::decode_image(file, &source.into_bytes().map_err(io)?, limits)
        }
    }
}

pub(crate) fn decode_image(file: &str, bytes: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    match sniff(file, bytes)? {
        FileFormat::Exr => openexr::decode_image(file, Cursor::new(bytes), limits),
        FileFormat::Hdr => radiance::decode(file, bytes, bytes.len() as u64, limits),
        FileFormat::Ktx2 | FileFormat::Dds => texture::decode_image(file, bytes, limits),
        kind @ (FileFormat::Png | FileFormat::Jpeg | FileFormat::Tiff) => {
            raster::decode_image(file, Cursor::new(bytes), kind, limits)
        }
    }
}

pub(crate) fn decode_raw(
    file: &str,
    bytes: &[u8],
    orientation: Orientation,
    limits: &Limits,
) -> Result<RawImage, ImageError> {
    match sniff(file, bytes)? {
        FileFormat::Exr => openexr::decode_raw(file, bytes, limits),
        kind @ (FileFormat::Hdr | FileFormat::Ktx2 | FileFormat::Dds) => {
            let image = match kind {
                FileFormat::Hdr => radiance::decode(file, bytes, bytes.len() as u64, limits)?,
                _ => texture::decode_image(file, bytes, limits)?,
            };
            Ok(RawImage {
                width: image.width,
                height: image.height,
                data: RawData::F32(
                    image
                        .pixels
                        .iter()
                        .map(|&[r, g, b]| [r, g, b, 1.0])
                        .collect(),
                ),
                has_alpha: false,
            })
        }
        kind @ (FileFormat::Png | FileFormat::Jpeg | FileFormat::Tiff) => {
            raster::decode(file, bytes, kind, orientation, limits)
        }
    }
}
