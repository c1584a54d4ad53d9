//! Parts of pictures: films with the range of samples that they hold, in files.
//!
//! A picture is divided by samples, not by tiles: every part has all pixels, so that filters cross no borders and every part alone is a
//! noisier picture of the whole. Sums are functions of the set of samples ([`crate::PixelSums`]), so parts of any ranges, added in any
//! order, give the bits of the picture that one machine takes. A checkpoint is a part as well: that of the samples so far.
//!
//! # The file
//! All numbers are little-endian.
//!
//! | bytes | what |
//! |---|---|
//! | 8 | `89 67 6f 6e 69 6f 70 0a`: 0x89, `goniop`, a line feed |
//! | 4 | version of the format: 2 |
//! | 4 | length of the header |
//! | … | the header, JSON: see [`Header`] |
//! | … | for each pixel, row after row from the top left, its numbers, each in the number of bytes that the header's `columns` say |
//! | 32 | BLAKE3 hash of everything before |
//!
//! The numbers of a pixel are: the places of the highest digits (7), the digits of radiance (2 for each of R, G and B), of its square (3
//! for each) and of depth (2), then the sums of albedo (3) and normal (3) in units of 2⁻²⁴, doubled, those of negative sums 1 less than
//! twice their amount; hits; samples: 32. The layers that the header's `kept` has add to them: the position two sums of three numbers, of
//! positive components and of negative ones, and `direct`, `indirect` and each group of lights one such sum, of 9 numbers: the places of the
//! highest digits (3), then the digits (2 for each of three). Then the material: the bits of a single-precision number, the squared
//! distance of a sample from the pixel's middle, and 1 and the index of the material, or 0; after it, with `reweighted`, three sums for each of 16 levels of
//! brightness, in units of 2⁻³¹ of it. A digit of place t weighs 2^(32t − 1075), and the first digit of a sum is that of the highest place.

mod merge;
mod read;
mod write;

pub use merge::Parts;
pub use read::{Opened, is_one, open};
pub use write::{write, write_alone};

use crate::film::{Kept, Names};
use crate::{Film, Identity, RayCounts, Rejected, RejectedSample, RenderError};
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::time::Duration;

const MAGIC: [u8; 8] = *b"\x89goniop\n";
const VERSION: u32 = 2;
/// Bytes before the header.
const BEFORE: u64 = 16;
/// Bytes of the hash.
const HASH: u64 = 32;
/// Bytes that a header may have.
const LARGEST_HEADER: u32 = 1 << 26;

/// A film, with the samples that it holds and what they cost.
#[derive(Debug, Clone)]
pub struct Exposure {
    /// The sums.
    pub film: Film,
    /// The indices of the samples that every pixel has; at most, where they are taken adaptively: those of a pixel are the first ones.
    pub samples: Range<u32>,
    /// Rays that were followed.
    pub rays: RayCounts,
    /// Time spent.
    pub elapsed: Duration,
}

impl Exposure {
    /// Without samples; the first will have the index `first`.
    ///
    /// # Errors
    /// As [`Film::new`].
    pub fn new(width: u32, height: u32, first: u32) -> Result<Self, RenderError> {
        Self::keeping(Kept::NOTHING, width, height, first)
    }

    /// As [`Exposure::new`], of a film that keeps more layers.
    ///
    /// # Errors
    /// As [`Film::keeping`].
    pub fn keeping(kept: Kept, width: u32, height: u32, first: u32) -> Result<Self, RenderError> {
        Ok(Self {
            film: Film::keeping(kept, width, height)?,
            samples: first..first,
            rays: RayCounts::default(),
            elapsed: Duration::ZERO,
        })
    }
}

/// What a part is one of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Label {
    /// What decides the value of every sample.
    pub identity: Identity,
    /// What the scene is called.
    pub scene: String,
    /// Samples per pixel of the whole picture, if that is settled.
    pub of: Option<u32>,
    /// What the indices of materials and groups of lights are names of.
    pub names: Names,
}

/// The header of a part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// What decides the value of every sample.
    pub identity: Identity,
    /// What the scene is called.
    pub scene: String,
    /// Samples per pixel of the whole picture, if that is settled.
    pub of: Option<u32>,
    /// What the indices of materials and groups of lights are names of.
    pub names: Names,
    /// Layers beside those that every film has.
    pub kept: Kept,
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Index of the first sample.
    pub first: u32,
    /// Index after the last sample.
    pub end: u32,
    /// Rays that were followed.
    pub rays: RayCounts,
    /// Time spent \[s].
    pub seconds: f64,
    rejected: StoredRejected,
    /// Bytes of each number of a pixel.
    columns: Vec<u8>,
}

impl Header {
    /// Samples that were kept out of the picture.
    pub fn rejected(&self) -> Rejected {
        self.rejected.clone().into()
    }

    /// The samples that the part holds.
    pub fn samples(&self) -> Range<u32> {
        self.first..self.end
    }

    /// What it is a part of.
    pub fn label(&self) -> Label {
        Label {
            identity: self.identity.clone(),
            scene: self.scene.clone(),
            of: self.of,
            names: self.names.clone(),
        }
    }
}

/// [`Rejected`] with the bits of radiances: JSON has no NaN.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct StoredRejected {
    count: u64,
    in_layers: u64,
    first: Option<StoredSample>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct StoredSample {
    pixel: [u32; 2],
    sample: u32,
    radiance_bits: [u32; 3],
    material: Option<u32>,
}

impl From<&Rejected> for StoredRejected {
    fn from(rejected: &Rejected) -> Self {
        Self {
            count: rejected.count,
            in_layers: rejected.in_layers,
            first: rejected.first.as_ref().map(|first| StoredSample {
                pixel: first.pixel,
                sample: first.sample,
                radiance_bits: first.radiance.map(f32::to_bits),
                material: first.material,
            }),
        }
    }
}

impl From<StoredRejected> for Rejected {
    fn from(stored: StoredRejected) -> Self {
        Self {
            count: stored.count,
            in_layers: stored.in_layers,
            first: stored.first.map(|first| RejectedSample {
                pixel: first.pixel,
                sample: first.sample,
                radiance: first.radiance_bits.map(f32::from_bits),
                material: first.material,
            }),
        }
    }
}
