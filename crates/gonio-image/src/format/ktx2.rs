//! KTX 2.0 (`.ktx2`): textures for Vulkan, OpenGL and the web.
//!
//! Layout: an identifier of 12 bytes, a header of 36, the index of 32, 24 bytes for each level, the data format descriptor,
//! keys and values, and the levels, the smallest first, each compressed by itself if the header says so. Source: Khronos, "KTX File Format Specification", 2.0, and "Khronos
//! Data Format Specification", 1.3.

use super::supercompression::Scheme;
use super::texel::Storage;
use super::texture::{Shape, Texture, slice, u32_at, u64_at};
use crate::{ImageError, Limits};

pub(super) const IDENTIFIER: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
const HEADER: usize = 80;
const INSTEAD: &str =
    "one picture or one cube of half floats, floats, RGB9E5, R11G11B10, BC6H or 8-bit codes is";

/// `VkFormat` numbers.
const FORMATS: [(u32, Storage); 17] = [
    (
        23,
        Storage::Codes {
            bytes: 3,
            rgb: [0, 1, 2],
            srgb: false,
        },
    ),
    (
        29,
        Storage::Codes {
            bytes: 3,
            rgb: [0, 1, 2],
            srgb: true,
        },
    ),
    (
        37,
        Storage::Codes {
            bytes: 4,
            rgb: [0, 1, 2],
            srgb: false,
        },
    ),
    (
        43,
        Storage::Codes {
            bytes: 4,
            rgb: [0, 1, 2],
            srgb: true,
        },
    ),
    (
        44,
        Storage::Codes {
            bytes: 4,
            rgb: [2, 1, 0],
            srgb: false,
        },
    ),
    (
        50,
        Storage::Codes {
            bytes: 4,
            rgb: [2, 1, 0],
            srgb: true,
        },
    ),
    (76, Storage::Half { channels: 1 }),
    (83, Storage::Half { channels: 2 }),
    (90, Storage::Half { channels: 3 }),
    (97, Storage::Half { channels: 4 }),
    (100, Storage::Float { channels: 1 }),
    (106, Storage::Float { channels: 3 }),
    (109, Storage::Float { channels: 4 }),
    (122, Storage::Rg11b10),
    (123, Storage::Rgb9e5),
    (143, Storage::Bc6h { signed: false }),
    (144, Storage::Bc6h { signed: true }),
];

pub(super) fn decode(file: &str, bytes: &[u8], limits: &Limits) -> Result<Texture, ImageError> {
    let header = slice(file, bytes, 0, HEADER as u64, || "the header".into())?;
    let number = |at: usize| u32_at(header, at);
    let vk_format = number(12);
    let unsupported = |what: String| ImageError::unsupported(file, what, INSTEAD);
    let found = FORMATS.iter().find(|(number, _)| *number == vk_format);
    let Some(&(_, storage)) = found else {
        return Err(unsupported(match vk_format {
            0 => "a texture in Basis Universal form".into(),
            n => format!("VkFormat {n}"),
        }));
    };
    let (depth, layers, faces) = (number(28), number(32), number(36));
    if depth > 1 || layers > 1 {
        return Err(unsupported(format!(
            "a texture of depth {depth} with {layers} layers"
        )));
    }
    if faces != 1 && faces != 6 {
        return Err(ImageError::format(
            file,
            "byte 36",
            format!("{faces} faces"),
            "1 or 6",
        ));
    }
    let scheme = Scheme::of(file, number(44))?;
    let shape = Shape {
        width: number(20) as usize,
        // A height of 0 is a texture of one dimension.
        height: number(24).max(1) as usize,
        faces: faces as usize,
        // 0 asks the program that loads it to make the smaller levels.
        levels: number(40).max(1) as usize,
        storage,
    };
    shape.check(file, limits)?;
    let index = slice(file, bytes, HEADER as u64, 24 * shape.levels as u64, || {
        "the index of levels".into()
    })?;
    let mut levels = Vec::with_capacity(shape.levels);
    for level in 0..shape.levels {
        let at = 24 * level;
        let (offset, length) = (u64_at(index, at), u64_at(index, at + 8));
        let face_bytes = shape.face_bytes(level);
        let expected = face_bytes.saturating_mul(shape.faces as u64);
        // Of what is compressed, the length that it is to have is written beside.
        let (said, place) = match scheme {
            Scheme::None => (length, at + 8),
            _ => (u64_at(index, at + 16), at + 16),
        };
        if said != expected {
            return Err(ImageError::format(
                file,
                format!("byte {}", HEADER + place),
                format!("{said} bytes for level {level}"),
                format!("{expected}"),
            ));
        }
        let data = slice(file, bytes, offset, length, || format!("level {level}"))?;
        let data = scheme.expand(file, level, data, expected)?;
        let (width, height) = shape.level_size(level);
        let faces = data.chunks_exact(face_bytes as usize);
        levels.push(faces.map(|d| storage.decode(d, width, height)).collect());
    }
    Ok(Texture {
        width: shape.width,
        faces: shape.faces,
        levels,
    })
}

/// The bytes of a file; `data` has the faces of each level.
pub(super) fn assemble(shape: &Shape, data: &[Vec<u8>]) -> Vec<u8> {
    let descriptor = descriptor(shape.storage);
    let pairs = key_values();
    let descriptor_at = HEADER + 24 * data.len();
    let pairs_at = descriptor_at + descriptor.len();
    // Levels begin at multiples of the block's size, and of 4.
    let alignment = shape.storage.block_bytes().max(4);
    let mut at = pairs_at + pairs.len();
    let mut offsets = vec![0; data.len()];
    for (offset, level) in offsets.iter_mut().zip(data).rev() {
        at = at.next_multiple_of(alignment);
        *offset = at;
        at += level.len();
    }
    let (vk_format, type_size) = match shape.storage {
        Storage::Half { .. } => (97, 2),
        Storage::Float { .. } => (109, 4),
        Storage::Rgb9e5 => (123, 4),
        _ => (143, 1_u32),
    };
    let mut bytes = Vec::with_capacity(at);
    bytes.extend(IDENTIFIER);
    let numbers = [
        vk_format,
        type_size,
        shape.width as u32,
        shape.height as u32,
        0,
        0,
        shape.faces as u32,
        data.len() as u32,
        0,
        descriptor_at as u32,
        descriptor.len() as u32,
        pairs_at as u32,
        pairs.len() as u32,
    ];
    bytes.extend(numbers.iter().flat_map(|n| n.to_le_bytes()));
    // No global data of a supercompression: offset and length.
    bytes.extend([0; 16]);
    for (offset, level) in offsets.iter().zip(data) {
        for n in [*offset, level.len(), level.len()] {
            bytes.extend((n as u64).to_le_bytes());
        }
    }
    bytes.extend(descriptor);
    bytes.extend(pairs);
    for (offset, level) in offsets.iter().zip(data).rev() {
        bytes.resize(*offset, 0);
        bytes.extend(level);
    }
    bytes
}

/// Keys and values, sorted: x to the right and y down, and who wrote it.
fn key_values() -> Vec<u8> {
    let writer = concat!("KTXwriter\0gonio ", env!("CARGO_PKG_VERSION"), "\0");
    let mut bytes = Vec::new();
    for pair in ["KTXorientation\0rd\0", writer] {
        bytes.extend((pair.len() as u32).to_le_bytes());
        bytes.extend(pair.bytes());
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    }
    bytes
}

/// The basic data format descriptor: what each bit of a texel means.
fn descriptor(storage: Storage) -> Vec<u8> {
    const FLOAT: u32 = 0x80;
    const SIGNED: u32 = 0x40;
    const EXPONENT: u32 = 0x20;
    const ONE: u32 = 0x3f80_0000;
    const MINUS_ONE: u32 = 0xbf80_0000;
    /// Red, green, blue and alpha.
    const CHANNELS: [u32; 4] = [0, 1, 2, 15];
    // First bit, bits, channel with its qualifiers, lower and upper bound.
    let mut samples: Vec<[u32; 5]> = Vec::new();
    let (mut model, mut block) = (1, 0);
    match storage {
        Storage::Half { .. } | Storage::Float { .. } => {
            let bits = 2 * storage.block_bytes() as u32;
            for (i, channel) in CHANNELS.into_iter().enumerate() {
                let first = bits * i as u32;
                samples.push([first, bits, channel | FLOAT | SIGNED, MINUS_ONE, ONE]);
            }
        }
        Storage::Rgb9e5 => {
            for (i, channel) in CHANNELS.into_iter().take(3).enumerate() {
                // 8448 / 512 · 2^−… is 1 with the exponent's bias of 15: the specification's own example.
                samples.push([9 * i as u32, 9, channel, 0, 8448]);
                samples.push([27, 5, channel | EXPONENT, 15, 31]);
            }
        }
        _ => {
            // KHR_DF_MODEL_BC6H; blocks of 4 × 4.
            (model, block) = (133, 0x0303);
            samples.push([0, 128, FLOAT, 0, ONE]);
        }
    }
    let size = 24 + 16 * samples.len() as u32;
    let mut words = vec![
        size + 4,
        // Khronos, basic descriptor.
        0,
        // Version 1.3.
        2 | size << 16,
        // BT.709 primaries, linear transfer, straight alpha.
        model | 1 << 8 | 1 << 16,
        block,
        storage.block_bytes() as u32,
        0,
    ];
    for [first, bits, channel, lower, upper] in samples {
        words.extend([first | (bits - 1) << 16 | channel << 24, 0, lower, upper]);
    }
    words.iter().flat_map(|w| w.to_le_bytes()).collect()
}
