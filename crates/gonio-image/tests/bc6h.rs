//! Blocks of all fourteen modes of BC6H against another decoder.
//!
//! `bc6h_blocks.txt`: blocks of random bits, three of each mode, and codes of 8 bits of their texels. A line has `u` (unsigned) or
//! `s` (signed), the block, and red, green and blue of 16 texels, in [0, 1] times 255, truncated.
//! - Unsigned ones, and signed ones without differences, are by Pillow 13.0.0, whose decoder is its own:
//!   `Image.frombytes("RGB", (4, 4), block, "bcn", (6, "BC6H"))`, and `"BC6HS"`. 28,000 unsigned blocks agreed, 2000 of each mode.
//! - It does not wrap signed differences around, so signed blocks of modes 12 to 14 are by a program written after Microsoft's
//!   "BC6H Format" alone.

#![allow(clippy::unwrap_used)]

use gonio_image::{Image, Limits, TexelFormat};

const BLOCKS: &str = include_str!("bc6h_blocks.txt");

fn bytes(hex: &str) -> Vec<u8> {
    let digit = |k: usize| u8::from_str_radix(&hex[k..k + 2], 16).unwrap();
    (0..hex.len()).step_by(2).map(digit).collect()
}

/// A DDS file of one block: the header is that of any picture of 4 × 4.
fn file(block: &[u8], signed: bool, header: &[u8]) -> Vec<u8> {
    let mut file = header.to_vec();
    // DXGI_FORMAT_BC6H_UF16 is 95, DXGI_FORMAT_BC6H_SF16 is 96.
    file[128] = if signed { 96 } else { 95 };
    file.extend(block);
    file
}

/// Texels of `block` whose codes are not `expected`, and the block's mode.
fn wrong(line: &str, header: &[u8], spoil: bool) -> (usize, u8) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let mut block = bytes(words[1]);
    let mode = if block[0] & 3 < 2 {
        block[0] & 3
    } else {
        block[0] & 31
    };
    if spoil {
        // Steps of two or three texels, in every mode.
        block[13] ^= 0xff;
    }
    let image = Image::decode(&file(&block, words[0] == "s", header), &Limits::default()).unwrap();
    let codes = bytes(words[2]);
    let differing = image
        .pixels
        .iter()
        .flatten()
        .zip(&codes)
        .filter(|(value, code)| {
            // The other truncates codes, and may round a half float to its neighbour: 255 / 2048 of a code.
            (value.clamp(0.0, 1.0) * 255.0 - f32::from(**code)).abs() > 1.125
        });
    (differing.count(), mode)
}

#[test]
fn every_mode_is_decoded_as_another_program_decodes_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.dds");
    Image::new(4, 4)
        .write_texture(&path, TexelFormat::Bc6h)
        .unwrap();
    let header = &std::fs::read(&path).unwrap()[..148];
    let (mut modes, mut spoiled) = (Vec::new(), 0);
    for (number, line) in BLOCKS.lines().enumerate() {
        let (count, mode) = wrong(line, header, false);
        assert_eq!(count, 0, "line {}: mode {mode:05b}", number + 1);
        modes.push(mode);
        spoiled += usize::from(wrong(line, header, true).0 > 0);
    }
    modes.sort_unstable();
    modes.dedup();
    assert_eq!(modes.len(), 14, "{modes:?}");
    // Seen unless all that a step leads to is beyond [0, 1].
    assert!(spoiled > BLOCKS.lines().count() / 2, "{spoiled}");
}
