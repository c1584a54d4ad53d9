//! DirectDraw Surface (`.dds`): textures for Direct3D, with the DX10 header.
//!
//! Layout: a magic number, a header of 124 bytes, with the four-character code `DX10` 20 more, then each face with all its
//! levels. Source: Microsoft, "Programming Guide for DDS".

use super::texel::Storage;
use super::texture::{Shape, Texture, slice, u32_at};
use crate::{ImageError, Limits};

pub(super) const MAGIC: [u8; 4] = *b"DDS ";
const HEADER: usize = 128;
const DX10: usize = 20;
const CUBE: u32 = 0x200;
const ALL_FACES: u32 = 0xfc00;
const INSTEAD: &str =
    "one picture or one cube of half floats, floats, RGB9E5, R11G11B10, BC6H or 8-bit codes is";

/// `DXGI_FORMAT` numbers.
const FORMATS: [(u32, Storage); 15] = [
    (2, Storage::Float { channels: 4 }),
    (6, Storage::Float { channels: 3 }),
    (10, Storage::Half { channels: 4 }),
    (26, Storage::Rg11b10),
    (
        28,
        Storage::Codes {
            bytes: 4,
            rgb: [0, 1, 2],
            srgb: false,
        },
    ),
    (
        29,
        Storage::Codes {
            bytes: 4,
            rgb: [0, 1, 2],
            srgb: true,
        },
    ),
    (34, Storage::Half { channels: 2 }),
    (41, Storage::Float { channels: 1 }),
    (54, Storage::Half { channels: 1 }),
    (67, Storage::Rgb9e5),
    (
        87,
        Storage::Codes {
            bytes: 4,
            rgb: [2, 1, 0],
            srgb: false,
        },
    ),
    (
        88,
        Storage::Codes {
            bytes: 4,
            rgb: [2, 1, 0],
            srgb: false,
        },
    ),
    (
        91,
        Storage::Codes {
            bytes: 4,
            rgb: [2, 1, 0],
            srgb: true,
        },
    ),
    (95, Storage::Bc6h { signed: false }),
    (96, Storage::Bc6h { signed: true }),
];

/// Numbers of `D3DFORMAT` that older files have for a four-character code.
const OLD_FORMATS: [(u32, Storage); 6] = [
    (111, Storage::Half { channels: 1 }),
    (112, Storage::Half { channels: 2 }),
    (113, Storage::Half { channels: 4 }),
    (114, Storage::Float { channels: 1 }),
    (116, Storage::Float { channels: 4 }),
    // The code `BC6H`, which some programs write.
    (0x4836_4342, Storage::Bc6h { signed: false }),
];

pub(super) fn decode(file: &str, bytes: &[u8], limits: &Limits) -> Result<Texture, ImageError> {
    let header = slice(file, bytes, 0, HEADER as u64, || "the header".into())?;
    let number = |at: usize| u32_at(header, at);
    for (at, size) in [(4, 124), (76, 32)] {
        if number(at) != size {
            return Err(ImageError::format(
                file,
                format!("byte {at}"),
                format!("a structure of {} bytes", number(at)),
                size.to_string(),
            ));
        }
    }
    let caps2 = number(112);
    let (storage, cube, start) = if &header[84..88] == b"DX10" {
        let more = slice(file, bytes, HEADER as u64, DX10 as u64, || {
            "the DX10 header".into()
        })?;
        let (format, dimension, flags, array) = (
            u32_at(more, 0),
            u32_at(more, 4),
            u32_at(more, 8),
            u32_at(more, 12),
        );
        if dimension != 3 || array > 1 {
            return Err(ImageError::unsupported(
                file,
                format!("a resource of kind {dimension} with {array} elements"),
                INSTEAD,
            ));
        }
        let found = FORMATS.iter().find(|(number, _)| *number == format);
        let found = found.map(|(_, storage)| *storage);
        (
            found.ok_or_else(|| {
                ImageError::unsupported(file, format!("DXGI_FORMAT {format}"), INSTEAD)
            })?,
            flags & 4 != 0,
            HEADER + DX10,
        )
    } else {
        (old_storage(file, header)?, caps2 & CUBE != 0, HEADER)
    };
    if caps2 & CUBE != 0 && caps2 & ALL_FACES != ALL_FACES {
        return Err(ImageError::unsupported(
            file,
            "a cube map without all of its faces",
            INSTEAD,
        ));
    }
    let shape = Shape {
        width: number(16) as usize,
        height: number(12) as usize,
        faces: if cube { 6 } else { 1 },
        levels: number(28).max(1) as usize,
        storage,
    };
    shape.check(file, limits)?;
    // All of it must be there before anything is made of it.
    let face_bytes: u64 = (0..shape.levels).map(|level| shape.face_bytes(level)).sum();
    let total = face_bytes * shape.faces as u64;
    let data = slice(file, bytes, start as u64, total, || {
        format!("{} face(s) of {} level(s)", shape.faces, shape.levels)
    })?;
    let mut levels: Vec<Vec<_>> = (0..shape.levels).map(|_| Vec::new()).collect();
    let mut at = 0;
    for _ in 0..shape.faces {
        for (level, faces) in levels.iter_mut().enumerate() {
            let (width, height) = shape.level_size(level);
            let end = at + shape.face_bytes(level) as usize;
            faces.push(storage.decode(&data[at..end], width, height));
            at = end;
        }
    }
    Ok(Texture {
        width: shape.width,
        faces: shape.faces,
        levels,
    })
}

/// The form of a file without the DX10 header.
fn old_storage(file: &str, header: &[u8]) -> Result<Storage, ImageError> {
    let number = |at: usize| u32_at(header, at);
    let unsupported = |what: String| Err(ImageError::unsupported(file, what, INSTEAD));
    let (flags, code) = (number(80), number(84));
    if flags & 4 != 0 {
        let found = OLD_FORMATS.iter().find(|(number, _)| *number == code);
        return match found {
            Some((_, storage)) => Ok(*storage),
            None => unsupported(format!(
                "the four-character code {:?}",
                String::from_utf8_lossy(&header[84..88])
            )),
        };
    }
    let place = |mask: u32| {
        let whole = mask != 0 && mask >> mask.trailing_zeros() == 0xff;
        (whole && mask.trailing_zeros().is_multiple_of(8))
            .then(|| mask.trailing_zeros() as usize / 8)
    };
    let masks = (place(number(92)), place(number(96)), place(number(100)));
    match (flags & 0x40 != 0, number(88), masks) {
        (true, bits @ (24 | 32), (Some(r), Some(g), Some(b)))
            if r.max(g).max(b) < bits as usize / 8 =>
        {
            Ok(Storage::Codes {
                bytes: bits as usize / 8,
                rgb: [r, g, b],
                // Such files don't say; their colours are made for the display, as those of a PNG are.
                srgb: true,
            })
        }
        (_, bits, _) => unsupported(format!("a pixel format of {bits} bits")),
    }
}

/// The bytes of a file; `data` has the faces of each level.
pub(super) fn assemble(shape: &Shape, data: &[Vec<u8>]) -> Vec<u8> {
    let cube = shape.faces == 6;
    let first_level = shape.face_bytes(0) as u32;
    let (format, length_flag, length) = match shape.storage {
        Storage::Half { .. } => (10, 0x8, 8 * shape.width as u32),
        Storage::Float { .. } => (2, 0x8, 16 * shape.width as u32),
        Storage::Rgb9e5 => (67, 0x8, 4 * shape.width as u32),
        _ => (95, 0x8_0000, first_level),
    };
    // Caps, height, width, pixel format and number of levels are given.
    let flags = 0x1 | 0x2 | 0x4 | 0x1000 | 0x2_0000 | length_flag;
    let mut header = [0_u32; 37];
    header[0] = u32::from_le_bytes(MAGIC);
    header[1] = 124;
    header[2] = flags;
    header[3] = shape.height as u32;
    header[4] = shape.width as u32;
    header[5] = length;
    header[7] = data.len() as u32;
    header[19] = 32;
    header[20] = 4;
    header[21] = u32::from_le_bytes(*b"DX10");
    // A texture; complex and with levels where it is.
    header[27] = 0x1000 | if data.len() > 1 { 0x40_0008 } else { 0 } | if cube { 0x8 } else { 0 };
    header[28] = if cube { CUBE | ALL_FACES } else { 0 };
    header[32] = format;
    header[33] = 3;
    header[34] = if cube { 4 } else { 0 };
    header[35] = 1;
    let mut bytes: Vec<u8> = header.iter().flat_map(|n| n.to_le_bytes()).collect();
    for face in 0..shape.faces {
        for (level, faces) in data.iter().enumerate() {
            let length = shape.face_bytes(level) as usize;
            bytes.extend(&faces[face * length..(face + 1) * length]);
        }
    }
    bytes
}
