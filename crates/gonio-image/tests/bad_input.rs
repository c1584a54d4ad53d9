//! Broken files of every format: one clear error, no panic, no allocation past the limit.

#![allow(clippy::unwrap_used)]

use gonio_image::{FileFormat, Image, ImageError, Layers, Limits, RawImage, tonemap::ToneMap};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::path::{Path, PathBuf};

/// Remembers each thread's largest single allocation since it was last reset: tests run side by side.
struct Watching;

thread_local! {
    static LARGEST: Cell<usize> = const { Cell::new(0) };
}

fn note(size: usize) {
    // While a thread ends its variables are gone.
    let _ = LARGEST.try_with(|largest| largest.set(largest.get().max(size)));
}

// SAFETY: every call goes to `System` unchanged; `note` does not allocate. There is no safe way to see allocations.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Watching {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note(layout.size());
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        note(layout.size());
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, p: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note(size);
        unsafe { System.realloc(p, layout, size) }
    }
    unsafe fn dealloc(&self, p: *mut u8, layout: Layout) {
        unsafe { System.dealloc(p, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Watching = Watching;

/// Small, so that a mutated header soon claims too much; the pictures here have 300 pixels.
const LIMITS: Limits = Limits {
    max_pixels: 1 << 16,
    max_bytes: 1 << 20,
};
/// Decoders hold tables of their own besides the picture: EXR's PIZ takes some hundred KiB, others less.
const LARGEST_ALLOWED: usize = 4 << 20;

fn picture() -> Image {
    Image::from_fn(20, 15, |x, y| {
        [
            x as f32 / 20.0,
            y as f32 / 15.0,
            ((x * 7 + y * 3) % 5) as f32 / 5.0,
        ]
    })
}

/// A valid file of every format and variant.
fn samples(folder: &Path) -> Vec<(String, Vec<u8>)> {
    use gonio_image::Compression::{None, Piz, Rle, Zip};
    let mut all = Vec::new();
    let mut keep = |path: PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        all.push((name, std::fs::read(&path).unwrap()));
    };
    for (name, compression) in [("none", None), ("rle", Rle), ("zip", Zip), ("piz", Piz)] {
        let path = folder.join(format!("{name}.exr"));
        let mut layers = Layers::from_image(&picture());
        layers.push_rgb("albedo", &picture()).unwrap();
        layers.set_metadata("note", "text");
        layers.to_half().write_exr_with(&path, compression).unwrap();
        keep(path);
    }
    for name in ["a.hdr", "a.png"] {
        picture().write(&folder.join(name)).unwrap();
        keep(folder.join(name));
    }
    picture()
        .write_png16(&folder.join("deep.png"), ToneMap::Linear, 0.0)
        .unwrap();
    keep(folder.join("deep.png"));
    let codes = picture().to_srgb8(ToneMap::Linear, 0.0);
    let mut jpeg = Vec::new();
    image::codecs::jpeg::JpegEncoder::new(&mut jpeg)
        .encode(&codes, 20, 15, image::ExtendedColorType::Rgb8)
        .unwrap();
    all.push(("a.jpg".into(), jpeg));
    all
}

/// Decodes by every door; whatever comes out, memory stays within bounds.
fn decode(bytes: &[u8], name: &str) -> Result<Image, ImageError> {
    LARGEST.set(0);
    let result = Image::decode(bytes, &LIMITS);
    let raw = RawImage::decode_within(bytes, &LIMITS);
    assert_eq!(result.is_ok(), raw.is_ok(), "{name}: the two readers agree");
    if FileFormat::of_content(bytes) == Some(FileFormat::Exr) {
        let layers = Layers::decode_exr(bytes, &LIMITS);
        assert!(result.is_err() || layers.is_ok(), "{name}");
    }
    let largest = LARGEST.get();
    assert!(
        largest <= LARGEST_ALLOWED,
        "{name}: {largest} bytes at once"
    );
    if let Ok(image) = &result {
        assert_eq!(image.pixels.len(), image.width * image.height, "{name}");
    }
    result
}

#[test]
fn broken_files_of_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples(folder.path()) {
        let image = decode(&bytes, &name).unwrap();
        assert_eq!((image.width, image.height), (20, 15), "{name}");

        // Truncated: everywhere in short files, at 400 places in longer ones. Only what a decoder does not need may be
        // missing: the end mark of a PNG, and nothing at all of the others.
        let step = bytes.len().div_ceil(400);
        for length in (0..bytes.len()).step_by(step) {
            let cut = decode(&bytes[..length], &name);
            let trailer = name.ends_with("png") && length + 16 >= bytes.len();
            assert!(
                cut.is_err() || trailer,
                "{name}: {length} of {} bytes are enough",
                bytes.len()
            );
            if let Err(e) = cut {
                let text = e.to_string();
                assert!(
                    text.starts_with("<memory>: ") && !text.contains('\n'),
                    "{name}: {text}"
                );
            }
        }

        // Flipped and overwritten bytes: a deterministic sweep over the header, then over everything.
        let mut state = 0x9e37_79b9_u32;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 17;
            state ^= state << 5;
            state
        };
        for round in 0..1500 {
            let mut broken = bytes.clone();
            let reach = if round % 2 == 0 {
                broken.len().min(400)
            } else {
                broken.len()
            };
            for _ in 0..=random() % 3 {
                let at = random() as usize % reach;
                broken[at] = match random() % 4 {
                    0 => 0xff,
                    1 => 0,
                    2 => broken[at] ^ (1 << (random() % 8)),
                    _ => random() as u8,
                };
            }
            if let Err(e) = decode(&broken, &name) {
                assert!(e.to_string().starts_with("<memory>: "), "{name}: {e}");
            }
        }
    }
}

#[test]
fn a_tiny_file_that_claims_a_huge_picture_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let side = 100_000u32;
    for (name, bytes) in samples(folder.path()) {
        let mut huge = bytes.clone();
        if name.ends_with("exr") {
            // dataWindow: the third and fourth of four integers are the last column and row.
            let key = b"dataWindow\0box2i\0";
            let at = huge.windows(key.len()).position(|w| w == key).unwrap() + key.len() + 4;
            huge[at + 8..at + 12].copy_from_slice(&(side - 1).to_le_bytes());
            huge[at + 12..at + 16].copy_from_slice(&(side - 1).to_le_bytes());
            // The number of blocks has to fit, else that is the error: 1, 16 or 32 scan lines each.
            let lines = match name.as_str() {
                "zip.exr" => 16,
                "piz.exr" => 32,
                _ => 1,
            };
            let key = b"chunkCount\0int\0";
            let at = huge.windows(key.len()).position(|w| w == key).unwrap() + key.len() + 4;
            huge[at..at + 4].copy_from_slice(&side.div_ceil(lines).to_le_bytes());
        } else if name.ends_with("hdr") {
            let text = String::from_utf8_lossy(&huge).find("-Y 15 +X 20").unwrap();
            huge.splice(text..text + 11, b"-Y 100000 +X 100000".iter().copied());
        } else if name.ends_with("png") {
            // IHDR begins at 16; its CRC at 29.
            huge[16..20].copy_from_slice(&side.to_be_bytes());
            huge[20..24].copy_from_slice(&side.to_be_bytes());
            let crc = crc32(&huge[12..29]);
            huge[29..33].copy_from_slice(&crc.to_be_bytes());
        } else {
            // SOF0: FF C0, length, precision, height, width.
            let at = huge.windows(2).position(|w| w == [0xff, 0xc0]).unwrap() + 5;
            huge[at..at + 4].copy_from_slice(&[0xff; 4]);
        }
        let error = decode(&huge, &name).unwrap_err();
        assert!(matches!(error, ImageError::Limit { .. }), "{name}: {error}");
        assert!(
            error.to_string().contains("exceed the limit of"),
            "{name}: {error}"
        );
        assert!(LARGEST.get() < 1 << 20, "{name}");
        // The default limits refuse it, too.
        assert!(Image::decode(&huge, &Limits::default()).is_err(), "{name}");
    }
}

fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |c, _| {
            if c & 1 == 1 {
                0xedb8_8320 ^ (c >> 1)
            } else {
                c >> 1
            }
        })
    })
}

#[test]
fn missing_empty_and_foreign_files() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| Image::read(&folder.path().join(name)).unwrap_err();
    let missing = read("missing.exr");
    assert!(matches!(missing, ImageError::Io { .. }));
    assert!(
        missing.to_string().contains("missing.exr: cannot open it"),
        "{missing}"
    );
    let io = Image::read(folder.path()).unwrap_err();
    assert!(matches!(io, ImageError::Io { .. }), "a folder: {io}");
    std::fs::write(folder.path().join("empty.png"), b"").unwrap();
    let empty = read("empty.png").to_string();
    assert!(
        empty.contains("empty.png: start: found an empty file"),
        "{empty}"
    );
    std::fs::write(folder.path().join("text.exr"), b"hello, world").unwrap();
    let text = read("text.exr").to_string();
    assert!(
        text.contains("found bytes 68 65 6c 6c") && text.contains("expected EXR"),
        "{text}"
    );
    // `Layers` read nothing but EXR, and say so.
    picture().write(&folder.path().join("a.png")).unwrap();
    let png = Layers::read_exr(&folder.path().join("a.png")).unwrap_err();
    assert!(matches!(png, ImageError::Format { .. }), "{png}");
    // A limit holds for the file itself, before it is read.
    let tight = Limits {
        max_bytes: 10,
        ..LIMITS
    };
    let error = Image::read_within(&folder.path().join("a.png"), &tight).unwrap_err();
    assert!(
        matches!(error, ImageError::Limit { limit: 10, .. }),
        "{error}"
    );
}

#[test]
fn the_name_does_not_matter() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bytes) in samples(folder.path()) {
        let path = folder.path().join(format!("{name}.txt"));
        std::fs::write(&path, &bytes).unwrap();
        assert_eq!(
            Image::read(&path).unwrap(),
            Image::decode(&bytes, &LIMITS).unwrap()
        );
    }
}
