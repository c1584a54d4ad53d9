//! PNG, JPEG and TIFF, by the `image` crate's codecs.

use super::FileFormat;
use crate::contain::contain;
use crate::{ImageError, Limits, RawData, RawImage};
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::codecs::tiff::TiffDecoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder};
use std::io::Cursor;
use std::path::Path;

/// What to do about an EXIF orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Orientation {
    /// Turn the picture as its camera was held.
    Apply,
    /// Keep the stored order.
    Ignore,
}

/// Decodes a PNG, JPEG or TIFF to four channels.
pub(crate) fn decode(
    file: &str,
    bytes: &[u8],
    kind: FileFormat,
    orientation: Orientation,
    limits: &Limits,
) -> Result<RawImage, ImageError> {
    if kind == FileFormat::Jpeg {
        check_jpeg_is_whole(file, bytes)?;
    }
    let outcome = contain(|| match kind {
        FileFormat::Jpeg => JpegDecoder::new(Cursor::new(bytes))
            .map_err(|e| translate(file, kind, limits, e))
            .and_then(|d| decode_with(file, kind, d, orientation, limits)),
        FileFormat::Tiff => TiffDecoder::new(Cursor::new(bytes))
            .map_err(|e| translate(file, kind, limits, e))
            .and_then(|d| decode_with(file, kind, d, orientation, limits)),
        _ => {
            let mut within = image::Limits::no_limits();
            within.max_alloc = Some(limits.max_bytes);
            PngDecoder::with_limits(Cursor::new(bytes), within)
                .map_err(|e| translate(file, kind, limits, e))
                .and_then(|d| decode_with(file, kind, d, orientation, limits))
        }
    });
    match outcome {
        Ok(result) => result,
        Err(panic) => Err(corrupt(
            file,
            kind,
            format!("data that its decoder gave up on ({panic})"),
        )),
    }
}

fn decode_with(
    file: &str,
    kind: FileFormat,
    mut decoder: impl ImageDecoder,
    orientation: Orientation,
    limits: &Limits,
) -> Result<RawImage, ImageError> {
    let (width, height) = decoder.dimensions();
    // Four samples a pixel, whatever the file has.
    let bytes_per_pixel = match decoder.color_type() {
        c if c.bytes_per_pixel() / c.channel_count() > 2 => 16,
        c if c.bytes_per_pixel() / c.channel_count() > 1 => 8,
        _ => 4,
    };
    limits.check(file, width.into(), height.into(), bytes_per_pixel)?;
    let mut within = image::Limits::no_limits();
    within.max_alloc = Some(limits.max_bytes);
    let failed = |e| translate(file, kind, limits, e);
    decoder.set_limits(within).map_err(failed)?;
    let turn = match orientation {
        Orientation::Apply => Some(decoder.orientation().map_err(failed)?),
        Orientation::Ignore => None,
    };
    let mut picture = DynamicImage::from_decoder(decoder).map_err(failed)?;
    if let Some(turn) = turn {
        picture.apply_orientation(turn);
    }
    Ok(to_raw(picture))
}

fn to_raw(picture: DynamicImage) -> RawImage {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let has_alpha = picture.color().has_alpha();
    let deep = matches!(
        picture,
        DynamicImage::ImageLuma16(_)
            | DynamicImage::ImageLumaA16(_)
            | DynamicImage::ImageRgb16(_)
            | DynamicImage::ImageRgba16(_)
    );
    let float = matches!(
        picture,
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_)
    );
    let data = if float {
        RawData::F32(picture.into_rgba32f().pixels().map(|p| p.0).collect())
    } else if deep {
        RawData::U16(picture.into_rgba16().pixels().map(|p| p.0).collect())
    } else {
        RawData::U8(picture.into_rgba8().pixels().map(|p| p.0).collect())
    };
    RawImage {
        width,
        height,
        data,
        has_alpha,
    }
}

/// The decoder fills what is missing of a truncated JPEG with grey and reports success: so the end is looked for here.
/// In entropy-coded data 0xFF is always stuffed, so after the last start of scan (0xFFDA) there has to be an end (0xFFD9);
/// both also occur in an embedded thumbnail, but earlier.
fn check_jpeg_is_whole(file: &str, bytes: &[u8]) -> Result<(), ImageError> {
    let last = |marker: u8| bytes.windows(2).rposition(|w| w == [0xff, marker]);
    match (last(0xda), last(0xd9)) {
        (Some(scan), Some(end)) if scan < end => Ok(()),
        _ => Err(ImageError::format(
            file,
            format!("JPEG, byte {}", bytes.len()),
            "the end of the file",
            "a whole scan and the end-of-image marker",
        )),
    }
}

fn corrupt(file: &str, kind: FileFormat, found: String) -> ImageError {
    let (place, expected) = match kind {
        FileFormat::Jpeg => ("JPEG data", "a valid JPEG stream"),
        FileFormat::Tiff => ("TIFF data", "a valid TIFF file"),
        _ => ("PNG data", "a valid PNG stream"),
    };
    ImageError::format(file, place, found, expected)
}

fn translate(
    file: &str,
    kind: FileFormat,
    limits: &Limits,
    error: image::ImageError,
) -> ImageError {
    match error {
        image::ImageError::Limits(_) => ImageError::Limit {
            file: file.into(),
            what: "bytes: more than".into(),
            found: limits.max_bytes,
            limit: limits.max_bytes,
        },
        image::ImageError::Unsupported(e) => ImageError::unsupported(
            file,
            e.to_string(),
            "8- and 16-bit grey, palette, RGB and RGBA are",
        ),
        // The bytes are in memory: an I/O error is their end.
        image::ImageError::IoError(e) => corrupt(file, kind, format!("the end of the file ({e})")),
        other => corrupt(file, kind, other.to_string()),
    }
}

fn encode(
    path: &Path,
    codes: &[u8],
    width: usize,
    height: usize,
    colour: ExtendedColorType,
) -> Result<Vec<u8>, ImageError> {
    let side = |n: usize| {
        u32::try_from(n).map_err(|_| {
            ImageError::parameter(format!(
                "{}: a side of {n} does not fit a PNG",
                path.display()
            ))
        })
    };
    let mut bytes = Vec::new();
    PngEncoder::new_with_quality(&mut bytes, CompressionType::Default, FilterType::Adaptive)
        .write_image(codes, side(width)?, side(height)?, colour)
        .map_err(|e| ImageError::parameter(format!("{}: {e}", path.display())))?;
    Ok(bytes)
}

/// A PNG of 8-bit RGB codes, three a pixel.
pub(crate) fn encode_png8(
    path: &Path,
    width: usize,
    height: usize,
    codes: &[u8],
) -> Result<Vec<u8>, ImageError> {
    encode(path, codes, width, height, ExtendedColorType::Rgb8)
}

/// A PNG of 16-bit RGB codes, three a pixel.
pub(crate) fn encode_png16(
    path: &Path,
    width: usize,
    height: usize,
    codes: &[u16],
) -> Result<Vec<u8>, ImageError> {
    // The encoder takes the machine's byte order and writes the format's.
    let bytes: Vec<u8> = codes.iter().flat_map(|c| c.to_ne_bytes()).collect();
    encode(path, &bytes, width, height, ExtendedColorType::Rgb16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::tiff::TiffEncoder;

    fn tiff16() -> (Vec<u8>, Vec<u16>) {
        let codes: Vec<u16> = (0..5 * 3 * 3).map(|k| k * 1457).collect();
        let bytes: Vec<u8> = codes.iter().flat_map(|c| c.to_ne_bytes()).collect();
        let mut file = Cursor::new(Vec::new());
        TiffEncoder::new(&mut file)
            .write_image(&bytes, 5, 3, ExtendedColorType::Rgb16)
            .unwrap();
        (file.into_inner(), codes)
    }

    fn read(bytes: &[u8]) -> Result<RawImage, ImageError> {
        let kind = FileFormat::of_content(bytes).unwrap_or(FileFormat::Tiff);
        decode("a.tif", bytes, kind, Orientation::Apply, &Limits::default())
    }

    #[test]
    fn a_tiff_of_16_bits_is_read_to_the_last_bit() {
        let (file, codes) = tiff16();
        assert_eq!(FileFormat::of_content(&file), Some(FileFormat::Tiff));
        let found = read(&file).unwrap();
        assert_eq!((found.width, found.height, found.has_alpha), (5, 3, false));
        let RawData::U16(pixels) = found.data else {
            panic!("16 bits became others");
        };
        let rgb: Vec<u16> = pixels.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(rgb, codes);
    }

    /// The picture's data end before its directory, so whatever is cut off is missed.
    #[test]
    fn a_truncated_tiff_is_an_error() {
        let (file, _) = tiff16();
        for n in 0..file.len() - 8 {
            match read(&file[..n]) {
                Err(
                    ImageError::Format { .. }
                    | ImageError::Unsupported { .. }
                    | ImageError::Limit { .. },
                ) => {}
                other => panic!("{n} of {} bytes: {other:?}", file.len()),
            }
        }
    }
}
