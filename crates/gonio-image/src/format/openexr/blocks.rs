//! The blocks of an OpenEXR: read one after the other, decompressed side by side, handed over line by line.
//!
//! No more of the file is in memory than a few blocks, each 1 to 256 scan lines or a tile.

use super::{READ, given_up, translate};
use crate::contain::contain;
use crate::{ChannelData, ImageError, f16};
use exr::block::UncompressedBlock;
use exr::block::chunk::Chunk;
use exr::block::reader::{ChunksReader, Reader};
use exr::math::Vec2;
use exr::meta::attribute::SampleType;
use rayon::prelude::*;
use std::collections::HashSet;
use std::io::{Read, Seek};

/// Samples of one channel, neighbours in a row, as the decoder leaves them: in the machine's byte order.
pub(crate) struct Samples<'a> {
    kind: SampleType,
    bytes: &'a [u8],
}

impl Samples<'_> {
    /// Appends them as `f32`; integers above 2²⁴ are rounded.
    pub fn push_to(&self, line: &mut Vec<f32>) {
        match self.kind {
            SampleType::F16 => line.extend(halves(self.bytes).map(f16::to_f32)),
            SampleType::F32 => line.extend(words(self.bytes).map(f32::from_ne_bytes)),
            SampleType::U32 => line.extend(words(self.bytes).map(|b| u32::from_ne_bytes(b) as f32)),
        }
    }

    /// Puts them in place from `start` on.
    pub fn copy_to(&self, channel: &mut ChannelData, start: usize) {
        match channel {
            ChannelData::Half(all) => put(&mut all[start..], halves(self.bytes)),
            ChannelData::Float(all) => {
                put(&mut all[start..], words(self.bytes).map(f32::from_ne_bytes))
            }
            ChannelData::Uint(all) => {
                put(&mut all[start..], words(self.bytes).map(u32::from_ne_bytes))
            }
        }
    }
}

fn put<T>(to: &mut [T], from: impl Iterator<Item = T>) {
    for (to, from) in to.iter_mut().zip(from) {
        *to = from;
    }
}

fn halves(bytes: &[u8]) -> impl Iterator<Item = f16> + '_ {
    bytes
        .chunks_exact(2)
        .map(|b| f16::from_ne_bytes([b[0], b[1]]))
}

fn words(bytes: &[u8]) -> impl Iterator<Item = [u8; 4]> + '_ {
    bytes.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]])
}

/// Blocks that are in memory at a time: enough to keep threads busy, and no more on a machine of many.
pub(super) fn at_once() -> usize {
    (2 * rayon::current_num_threads()).min(16)
}

/// Reads the blocks of the largest level of the parts that are `wanted`. `put` gets the part and channel, the column and row of
/// the first sample, and the samples; in any order.
pub(super) fn read_blocks<S: Read + Seek>(
    file: &str,
    reader: Reader<S>,
    wanted: impl Fn(usize) -> bool,
    mut put: impl FnMut((usize, usize), usize, usize, &Samples<'_>),
) -> Result<(), ImageError> {
    let mut chunks = reader
        .filter_chunks(false, |_, _, block| {
            wanted(block.layer) && block.level == Vec2(0, 0)
        })
        .map_err(|e| translate(file, "EXR header", e))?;
    let meta = chunks.meta_data().clone();
    let at_once = at_once();
    let mut seen = HashSet::new();
    loop {
        let some: Vec<Chunk> = chunks
            .by_ref()
            .take(at_once)
            .collect::<Result<_, _>>()
            .map_err(|e| translate(file, "EXR pixels", e))?;
        if some.is_empty() {
            return Ok(());
        }
        // A panic must not leave the thread that it happens in.
        let blocks: Vec<_> = some
            .into_par_iter()
            .map(|chunk| contain(|| UncompressedBlock::decompress_chunk(chunk, &meta, false)))
            .collect();
        for block in blocks {
            let block = block
                .map_err(|panic| given_up(file, &panic))?
                .map_err(|e| translate(file, "EXR pixels", e))?;
            let index = block.index;
            let place = index.pixel_position;
            // As many blocks come as the picture has: one that comes twice stands where another is missing.
            if index.level != Vec2(0, 0) || !seen.insert((index.layer, place)) {
                return Err(ImageError::format(
                    file,
                    "EXR pixels",
                    format!("the block at ({}, {}) twice", place.x(), place.y()),
                    "each block once",
                ));
            }
            let Some(header) = meta.headers.get(index.layer) else {
                return Err(ImageError::unsupported(file, "a block of no part", READ));
            };
            for line in block.lines(&header.channels) {
                let at = line.location;
                let samples = Samples {
                    kind: header.channels.list[at.channel].sample_type,
                    bytes: line.value,
                };
                put(
                    (at.layer, at.channel),
                    at.position.x(),
                    at.position.y(),
                    &samples,
                );
            }
        }
    }
}
