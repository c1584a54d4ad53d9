//! Writing OpenEXR.

use super::blocks;
use crate::rows::Fill;
use crate::{Channel, ChannelData, Compression, ImageError, Layers, f16};
use exr::block::writer::ChunksWriter;
use exr::block::{BlockIndex, UncompressedBlock};
use exr::math::Vec2;
use exr::meta::BlockDescription;
use exr::meta::attribute::{self, AttributeValue, ChannelDescription, LineOrder, SampleType, Text};
use exr::meta::header::{Header, LayerAttributes, standard_names};
use rayon::prelude::*;
use std::io::{BufWriter, Read, Seek, Write};
use std::ops::Range;

/// Where an EXR is written: its header and its table of blocks are completed in the end.
pub(crate) trait Target: Read + Write + Seek {}
impl<T: Read + Write + Seek> Target for T {}

/// Writes an EXR of one part.
pub(crate) fn encode(
    file: &str,
    layers: &Layers,
    compression: Compression,
    target: &mut impl Target,
) -> Result<(), ImageError> {
    let wrong = |why| ImageError::parameter(format!("{file}: {why}"));
    let channels = channels(layers).map_err(wrong)?;
    let mut header = header(
        [layers.width, layers.height],
        channels
            .iter()
            .map(|(name, c)| (name.clone(), sample_type(&c.samples))),
        compression,
    )
    .map_err(wrong)?;
    header.own_attributes = attributes(&layers.metadata).map_err(wrong)?;
    header.shared_attributes.chromaticities = layers.chromaticities.map(|c| {
        let point = |[x, y]: [f32; 2]| Vec2(x, y);
        attribute::Chromaticities {
            red: point(c.red),
            green: point(c.green),
            blue: point(c.blue),
            white: point(c.white),
        }
    });
    let width = layers.width;
    write_blocks(file, header, target, &mut |rows, bytes| {
        for y in rows {
            let row = y * width..(y + 1) * width;
            for (_, channel) in &channels {
                match &channel.samples {
                    ChannelData::Half(s) => {
                        bytes.extend(
                            s[row.clone()]
                                .iter()
                                .flat_map(|v| v.to_bits().to_ne_bytes()),
                        );
                    }
                    ChannelData::Float(s) => {
                        bytes.extend(s[row.clone()].iter().flat_map(|v| v.to_ne_bytes()));
                    }
                    ChannelData::Uint(s) => {
                        bytes.extend(s[row.clone()].iter().flat_map(|v| v.to_ne_bytes()));
                    }
                }
            }
        }
        Ok(())
    })
}

/// Writes an EXR of the channels R, G and B, whose rows are made when they are needed: `fill` gets the first row and room for
/// some. With `half` samples are rounded to half precision; `seen` gets each row as it is stored.
pub(crate) fn write_rows(
    file: &str,
    size: [usize; 2],
    half: bool,
    target: &mut impl Target,
    fill: &mut Fill<'_>,
    seen: &mut dyn FnMut(usize, usize, &[f32]),
) -> Result<(), ImageError> {
    let wrong = |why| ImageError::parameter(format!("{file}: {why}"));
    let kind = if half {
        SampleType::F16
    } else {
        SampleType::F32
    };
    // Sorted by name, as the format wants them.
    let names = ["B", "G", "R"].map(|name| (Text::from_slice_unchecked(name.as_bytes()), kind));
    let header = header(size, names.into_iter(), Compression::Zip).map_err(wrong)?;
    let width = size[0];
    let mut pixels = Vec::new();
    let mut line = vec![0.0_f32; width];
    write_blocks(file, header, target, &mut |rows, bytes| {
        pixels.resize(rows.len() * width, [0.0; 3]);
        fill(rows.start, &mut pixels)?;
        for (y, row) in rows.zip(pixels.chunks_exact(width)) {
            for c in [2, 1, 0] {
                for (to, from) in line.iter_mut().zip(row) {
                    *to = from[c];
                    if half {
                        let rounded = f16::from_f32(from[c]);
                        bytes.extend(rounded.to_bits().to_ne_bytes());
                        *to = rounded.to_f32();
                    } else {
                        bytes.extend(from[c].to_ne_bytes());
                    }
                }
                seen(y, c, &line);
            }
        }
        Ok(())
    })
}

fn sample_type(samples: &ChannelData) -> SampleType {
    match samples {
        ChannelData::Half(_) => SampleType::F16,
        ChannelData::Float(_) => SampleType::F32,
        ChannelData::Uint(_) => SampleType::U32,
    }
}

/// The header of a part without attributes.
fn header(
    [width, height]: [usize; 2],
    channels: impl ExactSizeIterator<Item = (Text, SampleType)>,
    compression: Compression,
) -> Result<Header, String> {
    if width == 0 || height == 0 || channels.len() == 0 {
        return Err(format!(
            "a picture of {width} × {height} pixels and {} channels cannot be written",
            channels.len()
        ));
    }
    if i32::try_from(width).is_err() || i32::try_from(height).is_err() {
        return Err(format!("{width} × {height} does not fit an EXR"));
    }
    let channels = channels
        .map(|(name, kind)| ChannelDescription::named(name, kind))
        .collect();
    let compression = match compression {
        Compression::None => attribute::Compression::Uncompressed,
        Compression::Rle => attribute::Compression::RLE,
        Compression::Zip => attribute::Compression::ZIP16,
        Compression::Piz => attribute::Compression::PIZ,
    };
    let mut header = Header::new(Text::from_slice_unchecked(b""), (width, height), channels)
        .with_encoding(
            compression,
            BlockDescription::ScanLines,
            LineOrder::Increasing,
        );
    header.own_attributes = LayerAttributes::default();
    Ok(header)
}

/// Appends the samples of some rows: of each row, channel after channel.
type Lines<'a> = dyn FnMut(Range<usize>, &mut Vec<u8>) -> Result<(), ImageError> + 'a;

/// Writes a file of one part; a few blocks are made at a time, and compressed side by side.
fn write_blocks(
    file: &str,
    header: Header,
    target: &mut impl Target,
    lines: &mut Lines<'_>,
) -> Result<(), ImageError> {
    let Vec2(width, height) = header.layer_size;
    let line_bytes = width * header.channels.bytes_per_pixel;
    let block_rows = header.max_block_pixel_size().y();
    let at_once = block_rows * blocks::at_once().max(16_usize.div_ceil(block_rows));
    let mut plain = Vec::new();
    let header_bytes = Header::write_all(std::slice::from_ref(&header), &mut plain, false)
        .map(|()| plain.len())
        .map_err(|e| failed(file, e))?;
    // What the rows' maker says has to get through the encoder's own errors.
    let mut refused = None;
    let headers = std::iter::once(header).collect();
    let outcome = exr::block::write(
        BufWriter::new(&mut *target),
        headers,
        true,
        |meta, writer| {
            let mut bytes = Vec::new();
            for first in (0..height).step_by(at_once) {
                let rows = first..(first + at_once).min(height);
                bytes.clear();
                if let Err(why) = lines(rows.clone(), &mut bytes) {
                    refused = Some(why);
                    return Err(exr::error::Error::Aborted);
                }
                let chunks: Vec<_> = bytes
                    .par_chunks(block_rows * line_bytes)
                    .enumerate()
                    .map(|(k, data)| {
                        UncompressedBlock {
                            index: BlockIndex {
                                layer: 0,
                                pixel_position: Vec2(0, first + k * block_rows),
                                pixel_size: Vec2(width, data.len() / line_bytes),
                                level: Vec2(0, 0),
                            },
                            data: data.to_vec(),
                        }
                        .compress_to_chunk(&meta.headers)
                    })
                    .collect();
                for (k, chunk) in chunks.into_iter().enumerate() {
                    writer.write_chunk(first / block_rows + k, chunk?)?;
                }
            }
            Ok(())
        },
    );
    if let Some(why) = refused {
        return Err(why);
    }
    outcome.map_err(|e| failed(file, e))?;
    sort_header(target, HEADER_START + header_bytes).map_err(|e| failed(file, e.into()))
}

fn failed(file: &str, error: exr::error::Error) -> ImageError {
    match error {
        exr::error::Error::Io(source) => ImageError::Io {
            file: file.into(),
            action: "write it",
            source,
        },
        other => ImageError::parameter(format!("{file}: {other}")),
    }
}

fn checked_name(what: &str, name: &str) -> Result<Text, String> {
    if !(1..=255).contains(&name.len()) || name.contains('\0') {
        return Err(format!(
            "{what} names are 1 to 255 bytes without NUL, not {name:?}"
        ));
    }
    Ok(Text::from_slice_unchecked(name.as_bytes()))
}

/// The channels and their names, sorted by name as the format wants them.
fn channels(layers: &Layers) -> Result<Vec<(Text, &Channel)>, String> {
    let mut list: Vec<(Text, &Channel)> = Vec::new();
    for channel in &layers.channels {
        if channel.samples.len() != layers.width * layers.height {
            return Err(format!(
                "channel `{}` has {} samples, the picture {} × {} pixels",
                channel.name,
                channel.samples.len(),
                layers.width,
                layers.height
            ));
        }
        let name = checked_name("channel", &channel.name)?;
        if list.iter().any(|(n, _)| *n == name) {
            return Err(format!("two channels are named `{}`", channel.name));
        }
        list.push((name, channel));
    }
    list.sort_by(|(a, _), (b, _)| a.as_slice().cmp(b.as_slice()));
    Ok(list)
}

/// The string attributes.
fn attributes(metadata: &[(String, String)]) -> Result<LayerAttributes, String> {
    let mut attributes = LayerAttributes::default();
    for (name, value) in metadata {
        let key = checked_name("attribute", name)?;
        let text = Text::from_slice_unchecked(value.as_bytes());
        let twice = if let Some(place) = reserved_text(&mut attributes, name.as_bytes()) {
            place.replace(text).is_some()
        } else if standard_names::ALL.contains(&name.as_bytes()) {
            return Err(format!(
                "OpenEXR reserves the attribute name `{name}`, and not for a string"
            ));
        } else {
            let value = AttributeValue::Text(text);
            attributes.other.insert(key, value).is_some()
        };
        if twice {
            return Err(format!("two attributes are named `{name}`"));
        }
    }
    Ok(attributes)
}

/// Bytes of the magic number and the version, before the attributes.
const HEADER_START: usize = 8;

/// Sorts the header's attributes by name. The encoder keeps them in a hash map, whose order changes from run to run: files
/// of the same picture would differ. Sorted, the header is as long as it was, so offsets stay right.
fn sort_header(target: &mut impl Target, length: usize) -> std::io::Result<()> {
    let mut bytes = vec![0; length];
    target.rewind()?;
    target.read_exact(&mut bytes)?;
    sort_attributes(&mut bytes);
    target.rewind()?;
    target.write_all(&bytes)
}

fn sort_attributes(bytes: &mut [u8]) {
    let mut records: Vec<&[u8]> = Vec::new();
    let mut at = HEADER_START;
    // Each record: name, NUL, type, NUL, length (32 bits), value. An empty name ends the header.
    while bytes[at] != 0 {
        let after_nul = |from: usize| {
            from + 1
                + bytes[from..]
                    .iter()
                    .position(|&b| b == 0)
                    .expect("invariant: the encoder ends names by NUL")
        };
        let length_at = after_nul(after_nul(at));
        let length = bytes[length_at..]
            .first_chunk()
            .map(|&b| i32::from_le_bytes(b) as usize)
            .expect("invariant: the encoder writes a length after the type");
        let end = length_at + 4 + length;
        records.push(&bytes[at..end]);
        at = end;
    }
    records.sort_unstable();
    let sorted = records.concat();
    bytes[HEADER_START..at].copy_from_slice(&sorted);
}

/// Where the `exr` crate keeps a reserved string.
fn reserved_text<'a>(
    attributes: &'a mut LayerAttributes,
    name: &[u8],
) -> Option<&'a mut Option<Text>> {
    Some(match name {
        standard_names::OWNER => &mut attributes.owner,
        standard_names::COMMENTS => &mut attributes.comments,
        standard_names::CAPTURE_DATE => &mut attributes.capture_date,
        standard_names::SOFTWARE => &mut attributes.software_name,
        standard_names::VIEW => &mut attributes.view_name,
        standard_names::WRAP_MODES => &mut attributes.wrap_mode_name,
        standard_names::RENDERING_TRANSFORM => &mut attributes.rendering_transform_name,
        standard_names::LOOK_MOD_TRANSFORM => &mut attributes.look_modification_transform_name,
        _ => return None,
    })
}
