//! OpenEXR, by the `exr` crate: what is read here, its blocks in [`blocks`], writing in [`write`].

mod blocks;
mod write;

pub(crate) use write::{encode, write_rows};

use crate::contain::contain;
use crate::layers::{self, Chromaticities};
use crate::{Channel, ChannelData, Image, ImageError, Layers, Limits, RawData, RawImage, f16};
use blocks::read_blocks;
use exr::block::reader::Reader;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, SampleType, Text};
use exr::meta::header::{Header, standard_names};
use std::collections::BTreeMap;
use std::io::{Cursor, Read, Seek};

/// What an `Unsupported` error recommends.
const READ: &str = "flat, full-resolution pictures with parts of one size are";

/// The picture to show of an EXR. Its samples go from the file's blocks straight into the picture, which is held once.
pub(crate) fn decode_image(
    file: &str,
    source: impl Read + Seek,
    limits: &Limits,
) -> Result<Image, ImageError> {
    guarded(file, || {
        let reader = open(file, source)?;
        let (width, height) = check_headers(file, reader.headers(), limits)?;
        let names = names(file, reader.headers())?;
        let shown = Shown::among(file, &names)?;
        let colours = match shown {
            Shown::Rgb(_) => chromaticities(reader.headers()),
            Shown::Grey(_) => None,
        };
        let mut image = Image::new(width, height);
        let mut line = Vec::with_capacity(width);
        read_blocks(
            file,
            reader,
            |part| {
                names
                    .iter()
                    .enumerate()
                    .any(|(i, n)| n.part == part && shown.has(i))
            },
            |found, x, y, samples| {
                let Some(i) = names.iter().position(|n| (n.part, n.channel) == found) else {
                    return;
                };
                let components = match shown {
                    Shown::Grey(grey) if grey == i => 0..3,
                    Shown::Rgb(rgb) => match rgb.iter().position(|c| *c == i) {
                        Some(c) => c..c + 1,
                        None => return,
                    },
                    Shown::Grey(_) => return,
                };
                line.clear();
                samples.push_to(&mut line);
                let start = y * width + x;
                for (pixel, value) in image.pixels[start..start + line.len()]
                    .iter_mut()
                    .zip(&line)
                {
                    pixel[components.clone()].fill(*value);
                }
            },
        )?;
        if let Some(matrix) = colours.as_ref().and_then(super::to_rec709) {
            for pixel in &mut image.pixels {
                *pixel = super::apply_matrix(&matrix, *pixel);
            }
        }
        Ok(image)
    })
}

/// Reads what [`write_rows`] wrote; `seen` gets each channel of each row. Returns columns and rows.
pub(crate) fn read_rows(
    file: &str,
    source: impl Read + Seek,
    limits: &Limits,
    seen: &mut dyn FnMut(usize, usize, &[f32]),
) -> Result<[usize; 2], ImageError> {
    guarded(file, || {
        let reader = open(file, source)?;
        let (width, height) = check_headers(file, reader.headers(), limits)?;
        let mut line = Vec::with_capacity(width);
        read_blocks(
            file,
            reader,
            |_| true,
            |(_, channel), _, y, samples| {
                line.clear();
                samples.push_to(&mut line);
                // Blue, green and red: sorted by name.
                seen(y, 2_usize.saturating_sub(channel), &line);
            },
        )?;
        Ok([width, height])
    })
}

/// The picture to show of an EXR, with its alpha.
pub(crate) fn decode_raw(
    file: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<RawImage, ImageError> {
    let layers = decode(file, Cursor::new(bytes), limits)?;
    let names: Vec<&str> = layers.channels.iter().map(|c| c.name.as_str()).collect();
    let image = layers
        .to_image()
        .ok_or_else(|| nothing_to_show(file, &names))?;
    let alpha = layers.alpha();
    let pixels = image
        .pixels
        .iter()
        .enumerate()
        .map(|(i, &[r, g, b])| [r, g, b, alpha.map_or(1.0, |a| a.samples.get(i))]);
    Ok(RawImage {
        width: image.width,
        height: image.height,
        data: RawData::F32(pixels.collect()),
        has_alpha: alpha.is_some(),
    })
}

/// Which channels of an EXR are shown, by their places among all.
#[derive(Clone, Copy)]
enum Shown {
    Rgb([usize; 3]),
    Grey(usize),
}

impl Shown {
    fn among(file: &str, names: &[Name]) -> Result<Self, ImageError> {
        let names: Vec<&str> = names.iter().map(|n| n.name.as_str()).collect();
        match layers::shown(&names) {
            Some((rgb, false)) => Ok(Self::Rgb(rgb)),
            Some(([grey, ..], true)) => Ok(Self::Grey(grey)),
            None => Err(nothing_to_show(file, &names)),
        }
    }

    fn has(self, channel: usize) -> bool {
        match self {
            Self::Rgb(rgb) => rgb.contains(&channel),
            Self::Grey(grey) => grey == channel,
        }
    }
}

fn nothing_to_show(file: &str, names: &[&str]) -> ImageError {
    let some: Vec<&str> = names.iter().take(20).copied().collect();
    ImageError::unsupported(
        file,
        format!("a picture of the channels {}", some.join(", ")),
        "R, G and B, or Y, of one layer are",
    )
}

/// Every part, channel and string of an EXR.
pub(crate) fn decode(
    file: &str,
    source: impl Read + Seek,
    limits: &Limits,
) -> Result<Layers, ImageError> {
    guarded(file, || {
        let reader = open(file, source)?;
        let headers = reader.headers();
        let (width, height) = check_headers(file, headers, limits)?;
        let names = names(file, headers)?;
        let metadata = strings(headers);
        let chromaticities = chromaticities(headers);
        let pixels = width * height;
        let mut channels: Vec<Channel> = names
            .iter()
            .map(|n| Channel {
                name: n.name.clone(),
                samples: match n.kind {
                    SampleType::F16 => ChannelData::Half(vec![f16::ZERO; pixels]),
                    SampleType::F32 => ChannelData::Float(vec![0.0; pixels]),
                    SampleType::U32 => ChannelData::Uint(vec![0; pixels]),
                },
            })
            .collect();
        read_blocks(
            file,
            reader,
            |_| true,
            |found, x, y, samples| {
                if let Some(i) = names.iter().position(|n| (n.part, n.channel) == found) {
                    samples.copy_to(&mut channels[i].samples, y * width + x);
                }
            },
        )?;
        Ok(Layers {
            width,
            height,
            channels,
            metadata,
            chromaticities,
        })
    })
}

/// Runs a decoder, which may panic on a corrupt file.
fn guarded<T>(file: &str, decode: impl FnOnce() -> Result<T, ImageError>) -> Result<T, ImageError> {
    contain(decode).unwrap_or_else(|panic| Err(given_up(file, &panic)))
}

fn given_up(file: &str, panic: &str) -> ImageError {
    ImageError::format(
        file,
        "EXR data",
        format!("data that its decoder gave up on ({panic})"),
        "a valid OpenEXR file",
    )
}

fn open<S: Read + Seek>(file: &str, source: S) -> Result<Reader<S>, ImageError> {
    exr::block::read(source, false).map_err(|e| translate(file, "EXR header", e))
}

fn chromaticities(headers: &[Header]) -> Option<Chromaticities> {
    let point = |v: Vec2<f32>| [v.x(), v.y()];
    let c = headers.first()?.shared_attributes.chromaticities?;
    Some(Chromaticities {
        red: point(c.red),
        green: point(c.green),
        blue: point(c.blue),
        white: point(c.white),
    })
}

/// A channel of a part, and its name among all.
struct Name {
    part: usize,
    channel: usize,
    kind: SampleType,
    name: String,
}

/// The channels of every part; no two have one name.
fn names(file: &str, headers: &[Header]) -> Result<Vec<Name>, ImageError> {
    let mut all: Vec<Name> = Vec::new();
    for (part, header) in headers.iter().enumerate() {
        let of_part = header.own_attributes.layer_name.as_ref().map(string);
        for (channel, description) in header.channels.list.iter().enumerate() {
            let name = match of_part.as_deref() {
                Some(part) if headers.len() > 1 => channel_name(part, &string(&description.name)),
                _ => string(&description.name),
            };
            if all.iter().any(|n| n.name == name) {
                return Err(ImageError::unsupported(
                    file,
                    format!("two channels named `{name}`"),
                    READ,
                ));
            }
            all.push(Name {
                part,
                channel,
                kind: description.sample_type,
                name,
            });
        }
    }
    Ok(all)
}

/// `part.channel`, unless the part is unnamed or the channel says so already.
fn channel_name(part: &str, channel: &str) -> String {
    let said = channel
        .strip_prefix(part)
        .is_some_and(|rest| rest.starts_with('.'));
    if part.is_empty() || said {
        channel.into()
    } else {
        format!("{part}.{channel}")
    }
}

/// Checks everything before pixels are allocated; returns the size of all parts.
fn check_headers(
    file: &str,
    headers: &[Header],
    limits: &Limits,
) -> Result<(usize, usize), ImageError> {
    let Some(first) = headers.first() else {
        return Err(ImageError::format(
            file,
            "EXR header",
            "no part",
            "at least one",
        ));
    };
    let size = first.layer_size;
    let mut bytes_per_pixel = 0u64;
    for header in headers {
        if header.deep {
            return Err(ImageError::unsupported(file, "deep data", READ));
        }
        if header.layer_size != size {
            let (a, b) = (size, header.layer_size);
            return Err(ImageError::unsupported(
                file,
                format!(
                    "a file with parts of {} × {} and {} × {} pixels",
                    a.x(),
                    a.y(),
                    b.x(),
                    b.y()
                ),
                READ,
            ));
        }
        for channel in &header.channels.list {
            if channel.sampling != Vec2(1, 1) {
                return Err(ImageError::unsupported(
                    file,
                    format!("the subsampled channel `{}`", string(&channel.name)),
                    READ,
                ));
            }
            bytes_per_pixel += match channel.sample_type {
                SampleType::F16 => 2,
                SampleType::F32 | SampleType::U32 => 4,
            };
        }
    }
    for header in headers {
        // A decoder's buffer holds a whole block, and a block may be larger than the picture: 256 scan lines, or any tile.
        let block = header.max_block_pixel_size();
        let pixels = (block.x() as u64).saturating_mul(block.y() as u64);
        limits.check_bytes(file, pixels.saturating_mul(bytes_per_pixel))?;
    }
    // Shown as three floats in the end.
    limits.check(
        file,
        size.x() as u64,
        size.y() as u64,
        bytes_per_pixel.max(12),
    )?;
    Ok((size.x(), size.y()))
}

/// Strings and numbers among the attributes, sorted by name. A later part's, where it differs from the first's, has the
/// part's name before it.
fn strings(headers: &[Header]) -> Vec<(String, String)> {
    let mut all = BTreeMap::new();
    for header in headers {
        let part = header.own_attributes.layer_name.as_ref().map(string);
        for (name, value) in header.all_named_attributes() {
            let reserved = standard_names::ALL.contains(&name) && !TEXTS.contains(&name);
            let value = match value {
                AttributeValue::Text(t) => string(&t),
                AttributeValue::I32(n) => n.to_string(),
                AttributeValue::F32(n) => n.to_string(),
                AttributeValue::F64(n) => n.to_string(),
                _ => continue,
            };
            if reserved {
                continue;
            }
            let name = utf8(name);
            match all.get(&name) {
                None => {
                    all.insert(name, value);
                }
                Some(first) if *first == value => {}
                Some(_) => {
                    let part = part.as_deref().unwrap_or_default();
                    all.insert(format!("{part}.{name}"), value);
                }
            }
        }
    }
    all.into_iter().collect()
}

/// Reserved names of strings; `write` knows where the `exr` crate keeps each.
const TEXTS: [&[u8]; 8] = [
    standard_names::OWNER,
    standard_names::COMMENTS,
    standard_names::CAPTURE_DATE,
    standard_names::SOFTWARE,
    standard_names::VIEW,
    standard_names::WRAP_MODES,
    standard_names::RENDERING_TRANSFORM,
    standard_names::LOOK_MOD_TRANSFORM,
];

fn string(text: &Text) -> String {
    utf8(text.as_slice())
}

/// UTF-8, which is what programs write today; what isn't is taken as Latin-1.
fn utf8(bytes: &[u8]) -> String {
    std::str::from_utf8(bytes).map_or_else(
        |_| bytes.iter().map(|&b| char::from(b)).collect(),
        str::to_string,
    )
}

fn translate(file: &str, place: &str, error: exr::error::Error) -> ImageError {
    use exr::error::Error;
    let found = match error {
        Error::NotSupported(what) => return ImageError::unsupported(file, what, READ),
        Error::Invalid(message) => message.to_string(),
        Error::Io(e) => e.to_string(),
        Error::Aborted => "an interruption".into(),
    };
    ImageError::format(file, place, found, "a valid OpenEXR file")
}

#[cfg(test)]
mod tests;
