//! [`Layers`]: named channels with metadata.

use crate::format::{self, openexr};
use crate::{Image, ImageError, Limits, atomic, f16};
use std::io::Cursor;
use std::path::Path;

/// The samples of one channel, in the precision of the file. Row after row from the top left.
#[derive(Debug, Clone, PartialEq)]
pub enum ChannelData {
    /// IEEE 754 binary16.
    Half(Vec<f16>),
    /// IEEE 754 binary32.
    Float(Vec<f32>),
    /// Unsigned integers: identifiers, counts.
    Uint(Vec<u32>),
}

impl ChannelData {
    /// Samples.
    pub fn len(&self) -> usize {
        match self {
            Self::Half(s) => s.len(),
            Self::Float(s) => s.len(),
            Self::Uint(s) => s.len(),
        }
    }

    /// Without samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Sample `i` as `f32`; integers above 2²⁴ are rounded.
    ///
    /// # Panics
    /// Outside the samples.
    pub fn get(&self, i: usize) -> f32 {
        match self {
            Self::Half(s) => s[i].to_f32(),
            Self::Float(s) => s[i],
            Self::Uint(s) => s[i] as f32,
        }
    }
}

/// A channel of [`Layers`].
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// `R`, `albedo.R`, `variance.R`, `depth.Z` …: the layer's name, a full stop, the component.
    pub name: String,
    /// The samples; `width * height` of them.
    pub samples: ChannelData,
}

/// The CIE 1931 (x, y) of red, green, blue and white.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chromaticities {
    /// Red primary.
    pub red: [f32; 2],
    /// Green primary.
    pub green: [f32; 2],
    /// Blue primary.
    pub blue: [f32; 2],
    /// White: what R = G = B is.
    pub white: [f32; 2],
}

impl Chromaticities {
    /// Rec. 709 and sRGB, white D65; what an EXR without the attribute means.
    pub const REC709: Self = Self {
        red: [0.64, 0.33],
        green: [0.30, 0.60],
        blue: [0.15, 0.06],
        white: [0.3127, 0.3290],
    };

    pub(crate) fn flat(&self) -> [f32; 8] {
        let (r, g, b, w) = (self.red, self.green, self.blue, self.white);
        [r[0], r[1], g[0], g[1], b[0], b[1], w[0], w[1]]
    }
}

/// Lossless compressions of an EXR.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Compression {
    /// None.
    None,
    /// Run lengths: fast, good for masks.
    Rle,
    /// Deflate over 16 scan lines: the usual choice.
    #[default]
    Zip,
    /// Wavelets and Huffman codes: smaller for noisy pictures.
    Piz,
}

/// Any number of named channels of one size, with metadata: what an OpenEXR file holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Layers {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// The channels. Read from a file, they are in the file's order: sorted by name within a part.
    pub channels: Vec<Channel>,
    /// Names and values of string attributes, each name once; read from a file, sorted by name. Numbers are read as
    /// strings, too; attributes of other types are not.
    pub metadata: Vec<(String, String)>,
    /// The colours of R, G and B, if the file says; without it, [`Chromaticities::REC709`].
    pub chromaticities: Option<Chromaticities>,
}

impl Layers {
    /// Without channels and metadata.
    pub fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            ..Self::default()
        }
    }

    /// The channels R, G and B of `image`, as floats.
    pub fn from_image(image: &Image) -> Self {
        let mut layers = Self::new(image.width, image.height);
        layers.channels = rgb_channels("", image);
        layers
    }

    /// Adds the channels `layer.R`, `layer.G` and `layer.B` as floats; R, G and B if `layer` is empty.
    ///
    /// # Errors
    /// `Parameter` if the image has another size, or a channel of that name is there.
    pub fn push_rgb(&mut self, layer: &str, image: &Image) -> Result<(), ImageError> {
        if (image.width, image.height) != (self.width, self.height) {
            return Err(ImageError::parameter(format!(
                "layer `{layer}` has {} × {} pixels, the picture {} × {}",
                image.width, image.height, self.width, self.height
            )));
        }
        for channel in rgb_channels(layer, image) {
            self.push(channel.name, channel.samples)?;
        }
        Ok(())
    }

    /// Adds one channel.
    ///
    /// # Errors
    /// `Parameter` if there are not `width * height` samples, or a channel of that name is there.
    pub fn push(
        &mut self,
        name: impl Into<String>,
        samples: ChannelData,
    ) -> Result<(), ImageError> {
        let name = name.into();
        if samples.len() != self.width * self.height {
            return Err(ImageError::parameter(format!(
                "channel `{name}` has {} samples, the picture {} × {} pixels",
                samples.len(),
                self.width,
                self.height
            )));
        }
        if self.channel(&name).is_some() {
            return Err(ImageError::parameter(format!(
                "channel `{name}` is there already"
            )));
        }
        self.channels.push(Channel { name, samples });
        Ok(())
    }

    /// The channel of this name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }

    /// The channels `layer.R`, `layer.G`, `layer.B` (R, G, B if `layer` is empty) as they are; nothing if one is missing.
    pub fn rgb(&self, layer: &str) -> Option<Image> {
        let [r, g, b] = ["R", "G", "B"].map(|c| self.channel(&qualified(layer, c)));
        let (r, g, b) = (r?, g?, b?);
        Some(self.compose(|i| [r.samples.get(i), g.samples.get(i), b.samples.get(i)]))
    }

    /// The picture one would show: R, G and B of the default layer, else its Y as grey, else the same of the first layer
    /// that has them, else an only channel as grey. Brought to Rec. 709 if [`Layers::chromaticities`] are others.
    pub fn to_image(&self) -> Option<Image> {
        let ([r, g, b], grey) = shown(&self.names())?;
        let [r, g, b] = [r, g, b].map(|i| &self.channels[i].samples);
        let mut image = self.compose(|i| [r.get(i), g.get(i), b.get(i)]);
        if let (false, Some(colours)) = (grey, &self.chromaticities)
            && let Some(matrix) = format::to_rec709(colours)
        {
            for pixel in &mut image.pixels {
                *pixel = format::apply_matrix(&matrix, *pixel);
            }
        }
        Some(image)
    }

    /// The samples of the alpha channel beside what [`Layers::to_image`] shows.
    pub(crate) fn alpha(&self) -> Option<&Channel> {
        let names = self.names();
        self.channel(&qualified(shown_layer(&names)?, "A"))
    }

    fn names(&self) -> Vec<&str> {
        self.channels.iter().map(|c| c.name.as_str()).collect()
    }

    fn compose(&self, pixel: impl Fn(usize) -> [f32; 3]) -> Image {
        Image {
            width: self.width,
            height: self.height,
            pixels: (0..self.width * self.height).map(pixel).collect(),
        }
    }

    /// The value of the string attribute `name`.
    pub fn metadata(&self, name: &str) -> Option<&str> {
        self.metadata
            .iter()
            .find(|(n, _)| n == name)
            .map(|(_, v)| v.as_str())
    }

    /// Sets the string attribute `name`, replacing a value it had.
    pub fn set_metadata(&mut self, name: impl Into<String>, value: impl Into<String>) {
        let (name, value) = (name.into(), value.into());
        match self.metadata.iter_mut().find(|(n, _)| *n == name) {
            Some(entry) => entry.1 = value,
            None => self.metadata.push((name, value)),
        }
    }

    /// Every channel rounded to half precision, but integers: half the size. What is beyond 65,504 becomes infinite.
    pub fn to_half(mut self) -> Self {
        for channel in &mut self.channels {
            if let ChannelData::Float(samples) = &channel.samples {
                channel.samples =
                    ChannelData::Half(samples.iter().map(|&s| f16::from_f32(s)).collect());
            }
        }
        self
    }

    /// Reads an EXR within the default [`Limits`]: every part and channel. The channels of a file of several parts have the
    /// part's name before their own (`albedo.R`), those of the default part named `""` or unnamed have not.
    ///
    /// The picture is the data window; where it lies in the display window is not kept.
    ///
    /// # Errors
    /// `Unsupported` for deep data, subsampled channels and parts of different sizes; `Format`, `Limit`, `Io`.
    pub fn read_exr(path: &Path) -> Result<Self, ImageError> {
        let limits = Limits::default();
        openexr::decode(&path.display().to_string(), limits.open(path)?, &limits)
    }

    /// [`Layers::read_exr`] of bytes in memory.
    ///
    /// # Errors
    /// As [`Layers::read_exr`], with `<memory>` for the file's name.
    pub fn decode_exr(bytes: &[u8], limits: &Limits) -> Result<Self, ImageError> {
        limits.check_bytes(format::MEMORY, bytes.len() as u64)?;
        openexr::decode(format::MEMORY, Cursor::new(bytes), limits)
    }

    /// Writes an EXR of one part, with [`Compression::Zip`].
    ///
    /// # Errors
    /// `Parameter` without pixels or channels, for a channel with another number of samples, for names that are empty,
    /// longer than 255 bytes, there twice, or that OpenEXR reserves; `Io` with nothing half-written.
    pub fn write_exr(&self, path: &Path) -> Result<(), ImageError> {
        self.write_exr_with(path, Compression::default())
    }

    /// [`Layers::write_exr`] with another compression.
    ///
    /// # Errors
    /// As [`Layers::write_exr`].
    pub fn write_exr_with(&self, path: &Path, compression: Compression) -> Result<(), ImageError> {
        let mut target = atomic::Pending::create(path)?;
        openexr::encode(&path.display().to_string(), self, compression, &mut target)?;
        target.put_in_place()
    }
}

/// The places among `names` of the channels that [`Layers::to_image`] shows, and whether they are one grey.
pub(crate) fn shown(names: &[&str]) -> Option<([usize; 3], bool)> {
    let layer = shown_layer(names)?;
    let find = |component: &str| {
        let name = qualified(layer, component);
        names.iter().position(|n| *n == name)
    };
    if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
        return Some(([r, g, b], false));
    }
    Some(([find("Y").unwrap_or(0); 3], true))
}

/// The name of the layer that [`Layers::to_image`] shows.
fn shown_layer<'a>(names: &[&'a str]) -> Option<&'a str> {
    let complete = |layer: &str| {
        let has = |c| names.contains(&qualified(layer, c).as_str());
        (has("R") && has("G") && has("B")) || has("Y")
    };
    let layers = names
        .iter()
        .map(|n| n.rsplit_once('.').map_or("", |(layer, _)| layer));
    std::iter::once("")
        .chain(layers)
        .find(|layer| complete(layer))
        .or((names.len() == 1).then_some(""))
}

fn qualified(layer: &str, component: &str) -> String {
    if layer.is_empty() {
        component.into()
    } else {
        format!("{layer}.{component}")
    }
}

fn rgb_channels(layer: &str, image: &Image) -> Vec<Channel> {
    ["R", "G", "B"]
        .iter()
        .enumerate()
        .map(|(c, component)| Channel {
            name: qualified(layer, component),
            samples: ChannelData::Float(image.pixels.iter().map(|p| p[c]).collect()),
        })
        .collect()
}
