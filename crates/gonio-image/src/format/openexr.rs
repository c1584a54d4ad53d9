//! OpenEXR, by the `exr` crate.

use crate::contain::contain;
use crate::layers::Chromaticities;
use crate::{
    Channel, ChannelData, Compression, Image, ImageError, Layers, Limits, RawData, RawImage,
};
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{self, AttributeValue, LineOrder, SampleType, Text};
use exr::meta::header::{Header, LayerAttributes, standard_names};
use exr::prelude::{ReadChannels, ReadLayers, WritableImage};
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

/// Reserved names of strings.
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

/// The bytes of an EXR of one part.
pub(crate) fn encode(
    file: &str,
    layers: &Layers,
    compression: Compression,
) -> Result<Vec<u8>, ImageError> {
    let refuse = |message: String| ImageError::parameter(format!("{file}: {message}"));
    let (width, height) = (layers.width, layers.height);
    if width == 0 || height == 0 || layers.channels.is_empty() {
        return Err(refuse(format!(
            "a picture of {width} × {height} pixels and {} channels cannot be written",
            layers.channels.len()
        )));
    }
    if i32::try_from(width).is_err() || i32::try_from(height).is_err() {
        return Err(refuse(format!("{width} × {height} does not fit an EXR")));
    }
    let name_of = |what: &str, name: &str| {
        let fits = (1..=255).contains(&name.len()) && !name.contains('\0');
        if !fits {
            return Err(refuse(format!(
                "{what} names are 1 to 255 bytes without NUL, not {name:?}"
            )));
        }
        Ok(Text::from_slice_unchecked(name.as_bytes()))
    };
    let mut list: Vec<AnyChannel<FlatSamples>> = Vec::new();
    for channel in &layers.channels {
        if channel.samples.len() != width * height {
            return Err(refuse(format!(
                "channel `{}` has {} samples, the picture {width} × {height} pixels",
                channel.name,
                channel.samples.len()
            )));
        }
        let name = name_of("channel", &channel.name)?;
        if list.iter().any(|c| c.name == name) {
            return Err(refuse(format!("two channels are named `{}`", channel.name)));
        }
        let samples = match &channel.samples {
            ChannelData::Half(s) => FlatSamples::F16(s.clone()),
            ChannelData::Float(s) => FlatSamples::F32(s.clone()),
            ChannelData::Uint(s) => FlatSamples::U32(s.clone()),
        };
        list.push(AnyChannel::new(name, samples));
    }
    let mut attributes = LayerAttributes::default();
    for (name, value) in &layers.metadata {
        let key = name_of("attribute", name)?;
        let text = Text::from_slice_unchecked(value.as_bytes());
        let twice = if let Some(place) = reserved_text(&mut attributes, name.as_bytes()) {
            place.replace(text).is_some()
        } else if standard_names::ALL.contains(&name.as_bytes()) {
            return Err(refuse(format!(
                "OpenEXR reserves the attribute name `{name}`, and not for a string"
            )));
        } else {
            attributes
                .other
                .insert(key, AttributeValue::Text(text))
                .is_some()
        };
        if twice {
            return Err(refuse(format!("two attributes are named `{name}`")));
        }
    }
    let encoding = Encoding {
        compression: match compression {
            Compression::None => attribute::Compression::Uncompressed,
            Compression::Rle => attribute::Compression::RLE,
            Compression::Zip => attribute::Compression::ZIP16,
            Compression::Piz => attribute::Compression::PIZ,
        },
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let channels = AnyChannels::sort(list.into_iter().collect());
    let layer = Layer::new((width, height), attributes, encoding, channels);
    let mut image = exr::image::Image::from_layer(layer);
    image.attributes.chromaticities = layers.chromaticities.map(|c| {
        let point = |[x, y]: [f32; 2]| Vec2(x, y);
        attribute::Chromaticities {
            red: point(c.red),
            green: point(c.green),
            blue: point(c.blue),
            white: point(c.white),
        }
    });
    let mut bytes = Vec::new();
    image
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .map_err(|e| refuse(e.to_string()))?;
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// Sorts the header's attributes by name. The encoder keeps them in a hash map, whose order changes from run to run: files
/// of the same picture would differ. Sorted, the header is as long as it was, so offsets stay right.
fn sort_attributes(bytes: &mut [u8]) {
    const START: usize = 8;
    let mut records: Vec<&[u8]> = Vec::new();
    let mut at = START;
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
    bytes[START..at].copy_from_slice(&sorted);
}

#[cfg(test)]
mod tests;
