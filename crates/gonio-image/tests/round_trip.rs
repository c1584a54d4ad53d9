//! What is written reads back; what others write reads as they mean it.

#![allow(clippy::unwrap_used)]

use gonio_image::tonemap::{ToneMap, encode_srgb8};
use gonio_image::{Image, Limits, RawData, RawImage, srgb};
use image::{ExtendedColorType, ImageEncoder};
use proptest::prelude::*;

fn codes(image: &Image) -> Vec<[u8; 3]> {
    image.pixels.iter().map(|&p| encode_srgb8(p)).collect()
}

fn png(bytes: &[u8], width: u32, height: u32, colour: ExtendedColorType) -> Vec<u8> {
    let mut out = Vec::new();
    image::codecs::png::PngEncoder::new(&mut out)
        .write_image(bytes, width, height, colour)
        .unwrap();
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn png_keeps_every_code(width in 1usize..20, height in 1usize..20, seed in any::<u32>()) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        let code = |x: usize, y: usize, c: usize| (seed.wrapping_mul((1 + x + 31 * y + 997 * c) as u32) >> 13) as u8;
        let image = Image::from_fn(width, height, |x, y| std::array::from_fn(|c| srgb::decode8(code(x, y, c))));
        image.write(&path).unwrap();
        prop_assert_eq!(Image::read(&path).unwrap(), image);
    }

    #[test]
    fn exr_keeps_every_bit(width in 1usize..20, values in prop::collection::vec(any::<f32>(), 60)) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.EXR");
        let image = Image::from_fn(width, 2, |x, y| std::array::from_fn(|c| values[(x + 20 * y + 7 * c) % 60]));
        image.write(&path).unwrap();
        let bits = |i: &Image| i.pixels.iter().flatten().map(|v| v.to_bits()).collect::<Vec<_>>();
        prop_assert_eq!(bits(&Image::read(&path).unwrap()), bits(&image));
    }
}

#[test]
fn hdr_is_written_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.hdr");
    let image = Image::from_fn(50, 9, |x, y| [x as f32, 2.0 * y as f32, 1e-3]);
    image.write(&path).unwrap();
    let back = Image::read(&path).unwrap();
    for (p, q) in image.pixels.iter().zip(&back.pixels) {
        let step = p.iter().fold(0.0f32, |m, &c| m.max(c)) / 256.0;
        for (v, w) in p.iter().zip(q) {
            assert!((v - w).abs() <= step);
        }
    }
    let mut bad = image;
    bad.set(3, 4, [1.0, -0.5, 0.0]);
    let error = bad.write(&path).unwrap_err().to_string();
    assert!(
        error.contains("channel G of pixel (3, 4) is -0.5"),
        "{error}"
    );
    assert_eq!(
        Image::read(&path).unwrap(),
        back,
        "the file that stood there is whole"
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn png_16_bits() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let image = Image::from_fn(300, 3, |x, y| [x as f32 / 300.0, y as f32 / 3.0, 0.5]);
    image.write_png16(&path, ToneMap::Linear, 0.0).unwrap();
    let raw = RawImage::read(&path).unwrap();
    assert_eq!(
        (raw.bit_depth(), raw.channels(), raw.has_alpha),
        (16, 4, false)
    );
    for (p, q) in image.pixels.iter().zip(Image::from(&raw).pixels) {
        for (v, w) in p.iter().zip(q) {
            // Half a code: 0.5/65535, times the steepest slope of the decoding, 1.055·2.4/1.055^2.4… < 2.3.
            assert!((v - w).abs() < 2.3 * 0.5 / 65535.0 + 1e-7);
        }
    }
}

#[test]
fn exposure_and_tone_map_are_applied() {
    let image = Image::filled(1, 1, [0.18; 3]);
    assert_eq!(image.to_srgb8(ToneMap::Linear, 0.0), [118, 118, 118]);
    assert_eq!(
        image.to_srgb8(ToneMap::PbrNeutral, 1.0),
        encode_srgb8([0.36 - 0.04; 3])
    );
}

#[test]
fn png_with_alpha_grey_and_palette() {
    let rgba = [[10, 20, 30, 0], [255, 128, 0, 77]];
    let raw = RawImage::decode(&png(&rgba.concat(), 2, 1, ExtendedColorType::Rgba8)).unwrap();
    assert!(raw.has_alpha);
    assert_eq!(raw.data, RawData::U8(rgba.to_vec()));
    assert_eq!(raw.get(1, 0), [1.0, 128.0 / 255.0, 0.0, 77.0 / 255.0]);
    let colour: Vec<[f32; 4]> = raw.srgb_to_linear().collect();
    assert_eq!(colour[1], [1.0, srgb::decode8(128), 0.0, 77.0 / 255.0]);
    assert_eq!(raw.linear().nth(1), Some(raw.get(1, 0)));
    // Alpha is dropped, not multiplied.
    assert_eq!(codes(&Image::from(&raw)), [[10, 20, 30], [255, 128, 0]]);

    let grey = RawImage::decode(&png(&[0, 200], 2, 1, ExtendedColorType::L8)).unwrap();
    assert_eq!(
        grey.data,
        RawData::U8(vec![[0, 0, 0, 255], [200, 200, 200, 255]])
    );
    let deep: Vec<u8> = [300u16, 65535]
        .iter()
        .flat_map(|c| c.to_ne_bytes())
        .collect();
    let deep = RawImage::decode(&png(&deep, 2, 1, ExtendedColorType::L16)).unwrap();
    assert_eq!(
        deep.data,
        RawData::U16(vec![[300, 300, 300, 65535], [65535; 4]])
    );

    // 2 × 1, two bits a pixel, palette of three colours of which the second is half transparent; made by hand.
    let palette = palette_png();
    let raw = RawImage::decode(&palette).unwrap();
    assert!(raw.has_alpha);
    assert_eq!(
        raw.data,
        RawData::U8(vec![[1, 2, 3, 255], [40, 50, 60, 128]])
    );
}

/// Signature, IHDR (2 × 1, depth 2, palette), PLTE, tRNS, IDAT (stored block: filter 0, pixels 0 and 1), IEND.
fn palette_png() -> Vec<u8> {
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        out.extend((data.len() as u32).to_be_bytes());
        let body = [kind.as_slice(), data].concat();
        out.extend(&body);
        let crc = !body.iter().fold(!0u32, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |c, _| {
                if c & 1 == 1 {
                    0xedb8_8320 ^ (c >> 1)
                } else {
                    c >> 1
                }
            })
        });
        out.extend(crc.to_be_bytes());
    };
    chunk(b"IHDR", &[0, 0, 0, 2, 0, 0, 0, 1, 2, 3, 0, 0, 0]);
    chunk(b"PLTE", &[1, 2, 3, 40, 50, 60, 7, 8, 9]);
    chunk(b"tRNS", &[255, 128]);
    // Adler-32 of [0, 0x10]: a = 1 + 16 = 17, b = 1 + 17 = 18.
    chunk(
        b"IDAT",
        &[0x78, 0x01, 1, 2, 0, 0xfd, 0xff, 0, 0x10, 0, 18, 0, 17],
    );
    chunk(b"IEND", &[]);
    out
}

#[test]
fn jpeg_is_read_and_turned() {
    // Left half white, right half black: flat enough for a JPEG to keep.
    let pixels: Vec<u8> = (0..16 * 8)
        .flat_map(|i| [if i % 16 < 8 { 255u8 } else { 0 }; 3])
        .collect();
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, 100)
        .encode(&pixels, 16, 8, ExtendedColorType::Rgb8)
        .unwrap();
    let limits = Limits::default();
    let upright = Image::decode(&bytes, &limits).unwrap();
    assert_eq!((upright.width, upright.height), (16, 8));
    assert!(upright.get(0, 4)[0] > 0.99 && upright.get(15, 4)[0] < 0.01);

    // EXIF orientation 6 (turn 90° clockwise to look right), put behind the start marker.
    let mut exif = vec![0xff, 0xe1, 0, 34];
    exif.extend(b"Exif\0\0MM\0*\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0");
    let turned_bytes = [&bytes[..2], &exif, &bytes[2..]].concat();
    let turned = Image::decode(&turned_bytes, &limits).unwrap();
    assert_eq!((turned.width, turned.height), (8, 16));
    assert!(turned.get(4, 0)[0] > 0.99 && turned.get(4, 15)[0] < 0.01);
    let raw = RawImage::decode(&turned_bytes).unwrap();
    assert_eq!(
        (raw.width, raw.height),
        (16, 8),
        "textures keep the stored order"
    );

    // Data after the end marker is nobody's business; without the marker the picture is not whole.
    assert!(Image::decode(&[&bytes, b"trailer".as_slice()].concat(), &limits).is_ok());
    let error = Image::decode(&bytes[..bytes.len() - 2], &limits)
        .unwrap_err()
        .to_string();
    assert!(error.contains("end-of-image"), "{error}");
}
