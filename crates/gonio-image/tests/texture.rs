//! KTX2 and DDS: what is written is read back, other readers agree, broken files are errors.

#![allow(clippy::unwrap_used)]

use gonio_image::{CubeMap, FileFormat, Image, ImageError, Limits, TexelFormat};
use std::path::Path;

/// A cube of three levels whose texels are all different.
fn cube() -> CubeMap {
    let levels = [8, 4, 2].map(|n| {
        std::array::from_fn(|face| {
            Image::from_fn(n, n, |x, y| {
                let t = 1.0 + face as f32;
                [t, t + (x + y * n) as f32 / (n * n) as f32, 0.25 * t]
            })
        })
    });
    CubeMap::with_levels(levels.to_vec()).expect("levels that halve")
}

fn encoded(kind: FileFormat, format: TexelFormat) -> Vec<u8> {
    let file = Path::new("cube");
    cube().encode(file, kind, format).expect("a file's bytes")
}

const KINDS: [FileFormat; 2] = [FileFormat::Ktx2, FileFormat::Dds];

#[test]
fn what_is_written_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    for format in TexelFormat::ALL {
        // Of the largest channel, which is at most 7 here. BC6H: a fifteenth of the way between the colours of a block.
        let tolerance = match format {
            TexelFormat::Float => 0.0,
            TexelFormat::Half => 7.0 / 2048.0,
            TexelFormat::Rgb9e5 => 7.0 / 512.0,
            TexelFormat::Bc6h => 1.0 / 15.0,
        };
        for extension in ["ktx2", "dds", "KTX2"] {
            let path = folder.path().join(format!("{format}.{extension}"));
            cube().write(&path, format).unwrap();
            let read = CubeMap::read(&path).unwrap();
            assert_eq!((read.size, read.levels.len()), (8, 3));
            for (found, given) in read
                .levels
                .iter()
                .flatten()
                .zip(cube().levels.iter().flatten())
            {
                for (f, g) in found
                    .pixels
                    .iter()
                    .flatten()
                    .zip(given.pixels.iter().flatten())
                {
                    assert!(
                        (f - g).abs() <= tolerance,
                        "{format} {extension}: {f} for {g}"
                    );
                }
            }
        }
    }
}

#[test]
fn another_reader_finds_the_same_in_a_ktx2_file() {
    for (format, number) in [
        (TexelFormat::Half, ktx2::Format::R16G16B16A16_SFLOAT),
        (TexelFormat::Float, ktx2::Format::R32G32B32A32_SFLOAT),
        (TexelFormat::Rgb9e5, ktx2::Format::E5B9G9R9_UFLOAT_PACK32),
        (TexelFormat::Bc6h, ktx2::Format::BC6H_UFLOAT_BLOCK),
    ] {
        let bytes = encoded(FileFormat::Ktx2, format);
        let reader = ktx2::Reader::new(&bytes[..]).unwrap();
        let header = reader.header();
        assert_eq!(header.format, Some(number));
        assert_eq!(
            (header.pixel_width, header.face_count, header.level_count),
            (8, 6, 3)
        );
        assert_eq!(header.supercompression_scheme, None);
        let keys: Vec<&str> = reader.key_value_data().map(|(key, _)| key).collect();
        assert_eq!(keys, ["KTXorientation", "KTXwriter"]);
        let descriptors = reader.dfd_blocks().len();
        assert_eq!(descriptors, 1);
        let lengths: Vec<usize> = reader.levels().map(|level| level.data.len()).collect();
        if format == TexelFormat::Half {
            assert_eq!(lengths, [8 * 8 * 6 * 8, 4 * 4 * 6 * 8, 2 * 2 * 6 * 8]);
        }
    }
}

#[test]
fn a_plain_picture_is_written_and_read() {
    let folder = tempfile::tempdir().unwrap();
    let image = Image::from_fn(7, 3, |x, y| [x as f32, y as f32, 0.5]);
    for name in ["a.ktx2", "a.dds"] {
        let path = folder.path().join(name);
        image.write(&path).unwrap();
        assert_eq!(Image::read(&path).unwrap(), image);
        let error = CubeMap::read(&path).unwrap_err().to_string();
        assert!(error.contains("no cube map"), "{error}");
    }
}

#[test]
fn a_cube_is_no_picture() {
    for kind in KINDS {
        let error = Image::decode(&encoded(kind, TexelFormat::Half), &Limits::default());
        let error = error.unwrap_err().to_string();
        assert!(error.contains("cube map as one picture"), "{error}");
    }
}

#[test]
fn truncated_files_are_errors_that_name_the_byte() {
    for kind in KINDS {
        let bytes = encoded(kind, TexelFormat::Bc6h);
        for length in 0..bytes.len() {
            let error = CubeMap::decode(&bytes[..length], &Limits::default()).unwrap_err();
            assert!(
                matches!(error, ImageError::Format { .. }),
                "{kind:?} {length}: {error}"
            );
            if length >= 12 {
                assert!(
                    error.to_string().contains(&format!("byte {length}")),
                    "{error}"
                );
            }
        }
    }
}

#[test]
fn claims_are_checked_before_memory_is_taken() {
    for (kind, at) in [(FileFormat::Ktx2, [20, 24]), (FileFormat::Dds, [12, 16])] {
        let mut bytes = encoded(kind, TexelFormat::Half);
        for at in at {
            bytes[at..at + 4].copy_from_slice(&16_000_u32.to_le_bytes());
        }
        let error = CubeMap::decode(&bytes, &Limits::default()).unwrap_err();
        assert!(matches!(error, ImageError::Limit { .. }), "{error}");
        for at in at {
            bytes[at..at + 4].copy_from_slice(&4_000_u32.to_le_bytes());
        }
        let error = CubeMap::decode(&bytes, &Limits::default()).unwrap_err();
        assert!(matches!(error, ImageError::Format { .. }), "{error}");
    }
}

#[test]
fn every_byte_of_a_header_may_be_wrong() {
    for kind in KINDS {
        let good = encoded(kind, TexelFormat::Rgb9e5);
        for at in 0..good.len().min(200) {
            for value in [0, 1, 0x7f, 0xff] {
                let mut bytes = good.clone();
                bytes[at] = value;
                // Read or refused: without a panic, within the limits.
                let _ = CubeMap::decode(&bytes, &Limits::default());
            }
        }
    }
}

#[test]
fn what_a_format_cannot_hold_is_refused_or_counted() {
    let face = |value| Image::filled(4, 4, [1.0, value, 1.0]);
    let of = |value: f32| {
        let mut faces: [Image; 6] = std::array::from_fn(|_| face(1.0));
        faces[2] = face(value);
        CubeMap::new(faces).unwrap()
    };
    for format in [TexelFormat::Rgb9e5, TexelFormat::Bc6h] {
        for value in [f32::NAN, -1.0, f32::INFINITY] {
            let error = of(value)
                .encode(Path::new("a.dds"), FileFormat::Dds, format)
                .unwrap_err()
                .to_string();
            assert!(
                error.contains("a.dds: texel (0, 0) of face 2") && error.contains("≥ 0"),
                "{error}"
            );
        }
        assert_eq!(of(1e6).above(format), 16);
        let bytes = of(1e6)
            .encode(Path::new("a"), FileFormat::Ktx2, format)
            .unwrap();
        let read = CubeMap::decode(&bytes, &Limits::default()).unwrap();
        let brightest = read.levels[0][2].pixels[5][1];
        assert!(
            brightest <= format.largest() && brightest > 0.99 * format.largest(),
            "{brightest}"
        );
    }
    assert_eq!(of(1e6).above(TexelFormat::Float), 0);
}

#[test]
fn a_misshapen_cube_is_refused() {
    let square = || Image::new(4, 4);
    let faces: [Image; 6] =
        std::array::from_fn(|i| if i == 4 { Image::new(4, 5) } else { square() });
    let error = CubeMap::new(faces).unwrap_err().to_string();
    assert!(
        error.contains("face 4 of level 0") && error.contains("4 × 5"),
        "{error}"
    );
    assert!(CubeMap::with_levels(Vec::new()).is_err());
    let levels = vec![
        std::array::from_fn(|_| square()),
        std::array::from_fn(|_| square()),
    ];
    assert!(CubeMap::with_levels(levels).is_err());
}

/// The levels of a KTX2 file compressed by `pack` as `scheme`.
fn supercompressed(good: &[u8], scheme: u32, pack: impl Fn(&[u8]) -> Vec<u8>) -> Vec<u8> {
    let number = |at: usize| u64::from_le_bytes(good[at..at + 8].try_into().unwrap());
    let levels = u32::from_le_bytes(good[40..44].try_into().unwrap()) as usize;
    let at = |level: usize| 80 + 24 * level;
    // The smallest level comes first.
    let mut bytes = good[..number(at(levels - 1)) as usize].to_vec();
    bytes[44..48].copy_from_slice(&scheme.to_le_bytes());
    for level in (0..levels).rev() {
        let (offset, length) = (number(at(level)) as usize, number(at(level) + 8) as usize);
        let packed = pack(&good[offset..offset + length]);
        let (start, count) = (bytes.len() as u64, packed.len() as u64);
        bytes[at(level)..at(level) + 8].copy_from_slice(&start.to_le_bytes());
        bytes[at(level) + 8..at(level) + 16].copy_from_slice(&count.to_le_bytes());
        bytes.extend(packed);
    }
    bytes
}

fn zlib(data: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(data).unwrap();
    encoder.finish().unwrap()
}

fn zstandard(data: &[u8]) -> Vec<u8> {
    ruzstd::encoding::compress_to_vec(data, ruzstd::encoding::CompressionLevel::Fastest)
}

#[test]
fn supercompressed_levels_are_read() {
    for format in TexelFormat::ALL {
        let good = encoded(FileFormat::Ktx2, format);
        let plain = CubeMap::decode(&good, &Limits::default()).unwrap();
        for bytes in [
            supercompressed(&good, 2, zstandard),
            supercompressed(&good, 3, zlib),
        ] {
            // Another reader takes the file for sound, too.
            assert!(ktx2::Reader::new(&bytes[..]).is_ok());
            let read = CubeMap::decode(&bytes, &Limits::default()).unwrap();
            assert_eq!(read, plain, "{format}");
        }
    }
}

#[test]
fn bad_supercompression_is_an_error() {
    let good = encoded(FileFormat::Ktx2, TexelFormat::Half);
    let error = |bytes: &[u8]| {
        let error = CubeMap::decode(bytes, &Limits::default()).unwrap_err();
        error.to_string()
    };
    let basis = error(&supercompressed(&good, 1, zlib));
    assert!(
        basis.contains("BasisLZ is not supported; Zstandard"),
        "{basis}"
    );
    let other = error(&supercompressed(&good, 9, zlib));
    assert!(other.contains("scheme 9"), "{other}");
    for (scheme, pack) in [(2, zstandard as fn(&[u8]) -> Vec<u8>), (3, zlib)] {
        // Short of a byte, and a byte too many; the small levels come first in the file, the first level is read first.
        let short = error(&supercompressed(&good, scheme, |d| pack(&d[1..])));
        assert!(
            short.contains("level 0: found 3071 bytes, expected a"),
            "{short}"
        );
        let long = error(&supercompressed(&good, scheme, |d| {
            pack(&[d, &[0]].concat())
        }));
        assert!(long.contains("level 0: found more bytes"), "{long}");
        // A stream that unpacks to 32 MiB is left after the bytes that are wanted.
        let bomb = pack(&vec![0; 1 << 25]);
        let large = error(&supercompressed(&good, scheme, |_| bomb.clone()));
        assert!(large.contains("more bytes than that"), "{large}");
        // A length that is not that of the header's picture.
        let mut bytes = supercompressed(&good, scheme, pack);
        bytes[96..104].copy_from_slice(&u64::MAX.to_le_bytes());
        let claimed = error(&bytes);
        assert!(
            claimed.contains("byte 96: found 18446744073709551615"),
            "{claimed}"
        );
        // Noise instead, and each length that the file can be cut to.
        let noise = error(&supercompressed(&good, scheme, |_| vec![0xa5; 40]));
        assert!(noise.contains("level 0: found a corrupt stream"), "{noise}");
        let bytes = supercompressed(&good, scheme, pack);
        for length in 0..bytes.len() {
            assert!(CubeMap::decode(&bytes[..length], &Limits::default()).is_err());
        }
        for at in 80..bytes.len() {
            let mut bytes = bytes.clone();
            bytes[at] ^= 0x41;
            // Read or refused: without a panic, within the limits.
            let _ = CubeMap::decode(&bytes, &Limits::default());
        }
    }
}
