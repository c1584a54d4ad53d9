//! PNG, JPEG and TIFF, by the `image` crate's codecs.

use super::FileFormat;
use crate::contain::contain;
use crate::{Image, ImageError, Limits, RawData, RawImage, srgb};
use image::codecs::jpeg::JpegDecoder;
use image::codecs::png::{CompressionType, FilterType, PngDecoder, PngEncoder};
use image::codecs::tiff::TiffDecoder;
use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder};
use std::io::{BufRead, Cursor, Seek, Write};
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
    picture(file, Cursor::new(bytes), kind, orientation, limits).map(to_raw)
}

/// Decodes a PNG, JPEG or TIFF to linear light, without its alpha. Of a PNG or TIFF no more is read than its decoder asks for.
pub(crate) fn decode_image(
    file: &str,
    source: impl BufRead + Seek,
    kind: FileFormat,
    limits: &Limits,
) -> Result<Image, ImageError> {
    picture(file, source, kind, Orientation::Apply, limits).map(to_linear)
}

fn picture(
    file: &str,
    mut source: impl BufRead + Seek,
    kind: FileFormat,
    orientation: Orientation,
    limits: &Limits,
) -> Result<DynamicImage, ImageError> {
    let failed = |e| translate(file, kind, limits, e);
    let mut jpeg = Vec::new();
    if kind == FileFormat::Jpeg {
        source
            .read_to_end(&mut jpeg)
            .map_err(|e| failed(image::ImageError::IoError(e)))?;
        check_jpeg_is_whole(file, &jpeg)?;
    }
    let outcome = contain(|| match kind {
        FileFormat::Jpeg => JpegDecoder::new(Cursor::new(&jpeg))
            .map_err(failed)
            .and_then(|d| decode_with(file, kind, d, orientation, limits)),
        FileFormat::Tiff => TiffDecoder::new(source)
            .map_err(failed)
            .and_then(|d| decode_with(file, kind, d, orientation, limits)),
        _ => {
            let mut within = image::Limits::no_limits();
            within.max_alloc = Some(limits.max_bytes);
            PngDecoder::with_limits(source, within)
                .map_err(failed)
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
) -> Result<DynamicImage, ImageError> {
    let (width, height) = decoder.dimensions();
    // Four samples a pixel, whatever the file has; linear light is three floats.
    let bytes_per_pixel = match decoder.color_type() {
        c if c.bytes_per_pixel() / c.channel_count() > 2 => 16,
        _ => 12,
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
    Ok(picture)
}

/// Codes decoded from sRGB, floats as they are; grey is spread.
fn to_linear(picture: DynamicImage) -> Image {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    /// Of each pixel the channels of a colour, or the only one.
    fn of<T: Copy>(samples: &[T], channels: usize, linear: impl Fn(T) -> f32) -> Vec<[f32; 3]> {
        let at = if channels < 3 { [0; 3] } else { [0, 1, 2] };
        let pixels = samples.chunks_exact(channels);
        pixels.map(|p| at.map(|c| linear(p[c]))).collect()
    }
    let channels = usize::from(picture.color().channel_count());
    // Of 16 bits each code once: the transfer function takes longer than a look.
    let table: Vec<f32> = match picture.color().bytes_per_pixel() as usize / channels {
        2 => (0..=u16::MAX).map(srgb::decode16).collect(),
        _ => Vec::new(),
    };
    let decode16 = |code: u16| table[usize::from(code)];
    let pixels = match &picture {
        DynamicImage::ImageLuma8(p) => of(p, channels, srgb::decode8),
        DynamicImage::ImageLumaA8(p) => of(p, channels, srgb::decode8),
        DynamicImage::ImageRgb8(p) => of(p, channels, srgb::decode8),
        DynamicImage::ImageRgba8(p) => of(p, channels, srgb::decode8),
        DynamicImage::ImageLuma16(p) => of(p, channels, decode16),
        DynamicImage::ImageLumaA16(p) => of(p, channels, decode16),
        DynamicImage::ImageRgb16(p) => of(p, channels, decode16),
        DynamicImage::ImageRgba16(p) => of(p, channels, decode16),
        DynamicImage::ImageRgb32F(p) => of(p, channels, |c| c),
        DynamicImage::ImageRgba32F(p) => of(p, channels, |c| c),
        // A kind of picture that the library may add.
        other => return Image::from(&to_raw(other.clone())),
    };
    Image {
        width,
        height,
        pixels,
    }
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
        // Decoders say so in several ways when the bytes end.
        image::ImageError::IoError(e) if e.raw_os_error().is_none() => {
            corrupt(file, kind, format!("the end of the file ({e})"))
        }
        image::ImageError::IoError(source) => ImageError::Io {
            file: file.into(),
            action: "read it",
            source,
        },
        other => corrupt(file, kind, other.to_string()),
    }
}

/// Writes a PNG of RGB codes, three a pixel: 8 bits each, or, if `deep`, 16 in the machine's byte order.
pub(crate) fn encode(
    path: &Path,
    target: &mut impl Write,
    codes: &[u8],
    [width, height]: [usize; 2],
    deep: bool,
) -> Result<(), ImageError> {
    let side = |n: usize| {
        u32::try_from(n).map_err(|_| {
            ImageError::parameter(format!(
                "{}: a side of {n} does not fit a PNG",
                path.display()
            ))
        })
    };
    let colour = if deep {
        ExtendedColorType::Rgb16
    } else {
        ExtendedColorType::Rgb8
    };
    PngEncoder::new_with_quality(target, CompressionType::Default, FilterType::Adaptive)
        .write_image(codes, side(width)?, side(height)?, colour)
        .map_err(|e| match e {
            image::ImageError::IoError(e) => ImageError::io(path, "write it", e),
            other => ImageError::parameter(format!("{}: {other}", path.display())),
        })
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

    /// Codes have the sRGB transfer, floats are radiance.
    #[test]
    fn a_tiff_becomes_linear_light() {
        let shown = |bytes: &[u8]| {
            let source = Cursor::new(bytes);
            decode_image("a.tif", source, FileFormat::Tiff, &Limits::default()).unwrap()
        };
        let write = |bytes: &[u8], colour| {
            let mut file = Cursor::new(Vec::new());
            TiffEncoder::new(&mut file)
                .write_image(bytes, 2, 1, colour)
                .unwrap();
            file.into_inner()
        };
        let codes = [0, 10, 255, 128, 64, 32];
        let eight = shown(&write(&codes, ExtendedColorType::Rgb8));
        let linear: Vec<f32> = codes.iter().map(|c| srgb::decode8(*c)).collect();
        assert_eq!(eight.pixels.as_flattened(), linear);
        let grey = shown(&write(&codes[3..5], ExtendedColorType::L8));
        assert_eq!(grey.pixels, [[linear[3]; 3], [linear[4]; 3]]);
        let deep = shown(&write(
            &[0_u16, 700, 65_535, 3, 40_000, 1]
                .map(u16::to_ne_bytes)
                .concat(),
            ExtendedColorType::Rgb16,
        ));
        assert_eq!(deep.pixels[1][1], srgb::decode16(40_000));
        let values = [0.5_f32, 1e-6, 70_000.0, 0.0, -1.0, f32::INFINITY];
        let bytes = values.map(f32::to_ne_bytes).concat();
        let float = shown(&write(&bytes, ExtendedColorType::Rgb32F));
        assert_eq!(float.pixels.as_flattened(), values);
        let rgba = [values, values].concat();
        let bytes: Vec<u8> = rgba[..8].iter().flat_map(|v| v.to_ne_bytes()).collect();
        let with_alpha = shown(&write(&bytes, ExtendedColorType::Rgba32F));
        assert_eq!(with_alpha.pixels[0], [0.5, 1e-6, 70_000.0]);
        assert_eq!(with_alpha.pixels[1], [-1.0, f32::INFINITY, 0.5]);
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
