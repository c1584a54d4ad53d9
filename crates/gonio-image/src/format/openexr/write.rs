//! Writing OpenEXR.

use crate::{ChannelData, Compression, ImageError, Layers};
use exr::image::{AnyChannel, AnyChannels, Blocks, Encoding, FlatSamples, Layer};
use exr::math::Vec2;
use exr::meta::attribute::{self, AttributeValue, LineOrder, Text};
use exr::meta::header::{LayerAttributes, standard_names};
use exr::prelude::WritableImage;
use std::io::Cursor;

/// The bytes of an EXR of one part.
pub(crate) fn encode(
    file: &str,
    layers: &Layers,
    compression: Compression,
) -> Result<Vec<u8>, ImageError> {
    encode_or_say_why(layers, compression)
        .map_err(|why| ImageError::parameter(format!("{file}: {why}")))
}

fn encode_or_say_why(layers: &Layers, compression: Compression) -> Result<Vec<u8>, String> {
    let (width, height) = (layers.width, layers.height);
    if width == 0 || height == 0 || layers.channels.is_empty() {
        return Err(format!(
            "a picture of {width} × {height} pixels and {} channels cannot be written",
            layers.channels.len()
        ));
    }
    if i32::try_from(width).is_err() || i32::try_from(height).is_err() {
        return Err(format!("{width} × {height} does not fit an EXR"));
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
    let attributes = attributes(&layers.metadata)?;
    let layer = Layer::new((width, height), attributes, encoding, channels(layers)?);
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
        .map_err(|e| e.to_string())?;
    sort_attributes(&mut bytes);
    Ok(bytes)
}

fn checked_name(what: &str, name: &str) -> Result<Text, String> {
    if !(1..=255).contains(&name.len()) || name.contains('\0') {
        return Err(format!(
            "{what} names are 1 to 255 bytes without NUL, not {name:?}"
        ));
    }
    Ok(Text::from_slice_unchecked(name.as_bytes()))
}

/// The channels, sorted by name as the format wants them.
fn channels(layers: &Layers) -> Result<AnyChannels<FlatSamples>, String> {
    let mut list: Vec<AnyChannel<FlatSamples>> = Vec::new();
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
        if list.iter().any(|c| c.name == name) {
            return Err(format!("two channels are named `{}`", channel.name));
        }
        let samples = match &channel.samples {
            ChannelData::Half(s) => FlatSamples::F16(s.clone()),
            ChannelData::Float(s) => FlatSamples::F32(s.clone()),
            ChannelData::Uint(s) => FlatSamples::U32(s.clone()),
        };
        list.push(AnyChannel::new(name, samples));
    }
    Ok(AnyChannels::sort(list.into_iter().collect()))
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
