//! OpenEXR, by the `exr` crate: reading here, writing in [`write`].

mod write;

pub(crate) use write::encode;

use crate::contain::contain;
use crate::layers::Chromaticities;
use crate::{Channel, ChannelData, Image, ImageError, Layers, Limits, RawData, RawImage};
use exr::image::FlatSamples;
use exr::math::Vec2;
use exr::meta::attribute::{AttributeValue, SampleType, Text};
use exr::meta::header::{Header, standard_names};
use exr::prelude::{ReadChannels, ReadLayers};
use std::collections::BTreeMap;
use std::io::Cursor;

/// What an `Unsupported` error recommends.
const READ: &str = "flat, full-resolution pictures with parts of one size are";

/// The picture to show of an EXR.
pub(crate) fn decode_image(file: &str, bytes: &[u8], limits: &Limits) -> Result<Image, ImageError> {
    shown(file, &decode(file, bytes, limits)?)
}

/// The picture to show of an EXR, with its alpha.
pub(crate) fn decode_raw(
    file: &str,
    bytes: &[u8],
    limits: &Limits,
) -> Result<RawImage, ImageError> {
    let layers = decode(file, bytes, limits)?;
    let image = shown(file, &layers)?;
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

fn shown(file: &str, layers: &Layers) -> Result<Image, ImageError> {
    layers.to_image().ok_or_else(|| {
        let names: Vec<&str> = layers
            .channels
            .iter()
            .map(|c| c.name.as_str())
            .take(20)
            .collect();
        ImageError::unsupported(
            file,
            format!("a picture of the channels {}", names.join(", ")),
            "R, G and B, or Y, of one layer are",
        )
    })
}

/// Every part, channel and string of an EXR.
pub(crate) fn decode(file: &str, bytes: &[u8], limits: &Limits) -> Result<Layers, ImageError> {
    contain(|| decode_unguarded(file, bytes, limits)).unwrap_or_else(|panic| {
        Err(ImageError::format(
            file,
            "EXR data",
            format!("data that its decoder gave up on ({panic})"),
            "a valid OpenEXR file",
        ))
    })
}

fn decode_unguarded(file: &str, bytes: &[u8], limits: &Limits) -> Result<Layers, ImageError> {
    let chunks = exr::block::read(Cursor::new(bytes), false)
        .map_err(|e| translate(file, "EXR header", e))?;
    let headers = chunks.headers();
    let size = check_headers(file, headers, limits)?;
    let metadata = strings(headers);
    let chromaticities = headers[0].shared_attributes.chromaticities.map(|c| {
        let point = |v: Vec2<f32>| [v.x(), v.y()];
        Chromaticities {
            red: point(c.red),
            green: point(c.green),
            blue: point(c.blue),
            white: point(c.white),
        }
    });
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_chunks(chunks)
        .map_err(|e| translate(file, "EXR pixels", e))?;

    let several = image.layer_data.len() > 1;
    let mut channels: Vec<Channel> = Vec::new();
    for layer in image.layer_data {
        let part = layer.attributes.layer_name.as_ref().map(string);
        for channel in layer.channel_data.list {
            let name = match part.as_deref() {
                Some(part) if several => channel_name(part, &string(&channel.name)),
                _ => string(&channel.name),
            };
            if channels.iter().any(|c| c.name == name) {
                return Err(ImageError::unsupported(
                    file,
                    format!("two channels named `{name}`"),
                    READ,
                ));
            }
            let samples = match channel.sample_data {
                FlatSamples::F16(s) => ChannelData::Half(s),
                FlatSamples::F32(s) => ChannelData::Float(s),
                FlatSamples::U32(s) => ChannelData::Uint(s),
            };
            channels.push(Channel { name, samples });
        }
    }
    Ok(Layers {
        width: size.0,
        height: size.1,
        channels,
        metadata,
        chromaticities,
    })
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
