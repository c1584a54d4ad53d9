//! [`Film`]: per-pixel sums of radiance samples, and the layers made of them.

mod binned;
mod pixel;
pub(crate) mod record;

pub use pixel::{FilmSample, FirstSurface, PixelSums};

use crate::RenderError;
use gonio_image::{Channel, ChannelData, Chromaticities, Image, Layers};

/// Samples that were not finite or negative, kept out of the image.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Rejected {
    /// How many.
    pub count: u64,
    /// The first of them, in the order of sample, row and column.
    pub first: Option<RejectedSample>,
}

/// Where a rejected sample was found.
#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RejectedSample {
    /// Column and row of the pixel.
    pub pixel: [u32; 2],
    /// Index of the sample.
    pub sample: u32,
    /// The offending radiance.
    pub radiance: [f32; 3],
    /// Index of the material of the first surface, if one was hit.
    pub material: Option<u32>,
}

impl Rejected {
    /// Counts one more sample, or those of another, keeping the first in the order of (sample, row, column).
    pub fn merge(&mut self, other: Self) {
        // Counts read from files may be any.
        self.count = self.count.saturating_add(other.count);
        let order = |r: &RejectedSample| (r.sample, r.pixel[1], r.pixel[0]);
        self.first = match (self.first.take(), other.first) {
            (Some(a), Some(b)) => Some(if order(&b) < order(&a) { b } else { a }),
            (a, b) => a.or(b),
        };
    }
}

/// The picture being taken: sums of samples per pixel, row-major from the top left.
#[derive(Debug, Clone)]
pub struct Film {
    width: u32,
    height: u32,
    pixels: Vec<PixelSums>,
    rejected: Rejected,
}

/// The largest film, in bytes of sums: 2¹⁴ × 2¹⁴ pixels fit.
const LIMIT_BYTES: u64 = 32 << 30;

impl Film {
    /// An empty film.
    ///
    /// # Errors
    /// A side of 0 pixels, or sums of more than 32 GiB.
    pub fn new(width: u32, height: u32) -> Result<Self, RenderError> {
        Self::check(width, height)?;
        Ok(Self {
            width,
            height,
            pixels: vec![PixelSums::default(); width as usize * height as usize],
            rejected: Rejected::default(),
        })
    }

    /// Fails as [`Film::new`] does, without making one.
    pub(crate) fn check(width: u32, height: u32) -> Result<(), RenderError> {
        if width == 0 || height == 0 {
            return Err(RenderError::Parameter {
                option: "size",
                found: format!("{width}×{height}"),
                expected: "at least 1×1 pixels",
            });
        }
        let count = u64::from(width) * u64::from(height);
        let bytes = count.saturating_mul(size_of::<PixelSums>() as u64);
        // A pixel's index is a 32-bit number in the sample sequences.
        if bytes > LIMIT_BYTES || count > u64::from(u32::MAX) {
            return Err(RenderError::Limit {
                width,
                height,
                needed_mib: bytes >> 20,
                limit_mib: LIMIT_BYTES >> 20,
            });
        }
        Ok(())
    }

    /// Pixels across.
    pub fn width(&self) -> u32 {
        self.width
    }
    /// Pixels down.
    pub fn height(&self) -> u32 {
        self.height
    }
    /// The sums, row-major from the top left.
    pub fn pixels(&self) -> &[PixelSums] {
        &self.pixels
    }
    /// Samples kept out of the image.
    pub fn rejected(&self) -> &Rejected {
        &self.rejected
    }
    /// Samples of the pixel that has most.
    pub fn samples_per_pixel(&self) -> u32 {
        self.pixels.iter().map(|p| p.samples).max().unwrap_or(0)
    }

    /// The rows as slices that different threads may write.
    pub(crate) fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, PixelSums> {
        self.pixels.chunks_exact_mut(self.width as usize)
    }
    pub(crate) fn pixels_mut(&mut self) -> &mut [PixelSums] {
        &mut self.pixels
    }
    pub(crate) fn note_rejected(&mut self, rejected: Rejected) {
        self.rejected.merge(rejected);
    }

    /// The mean radiance of every pixel.
    pub fn image(&self) -> Image {
        self.map(|p| p.mean().map(|v| v as f32))
    }

    /// The variance of the mean of every pixel, [`PixelSums::variance_of_mean`].
    pub fn variance(&self) -> Image {
        self.map(|p| p.variance_of_mean().map(|v| v as f32))
    }

    /// Estimated noise: the relative standard error that 95 % of the pixels stay below.
    ///
    /// Of a pixel: √(Σ_c Var(mean_c)) / (Σ_c mean_c + ε), where ε is a hundredth of the image's mean, so that black pixels
    /// do not count as infinitely noisy. ∞ below two samples a pixel.
    ///
    /// It is itself an estimate from the samples: a stop by noise favours images that look less noisy than they are, by an
    /// amount that falls with the number of samples before the first test.
    pub fn noise(&self) -> f64 {
        let sum = |v: [f64; 3]| v[0] + v[1] + v[2];
        let mean =
            self.pixels.iter().map(|p| sum(p.mean())).sum::<f64>() / self.pixels.len() as f64;
        if mean == 0.0 {
            return if self.samples_per_pixel() < 2 {
                f64::INFINITY
            } else {
                0.0
            };
        }
        let mut errors: Vec<f64> = self
            .pixels
            .iter()
            .map(|p| sum(p.variance_of_mean()).sqrt() / (sum(p.mean()) + 0.01 * mean))
            .collect();
        let k = (errors.len() - 1) * 95 / 100;
        *errors.select_nth_unstable_by(k, f64::total_cmp).1
    }

    /// All layers for an EXR file: R G B, `albedo`, `normal`, `depth.Z`, `variance` and `samples.count`.
    ///
    /// Depth is the mean over the samples that hit a surface, ∞ where none did; the normal is the unnormalised mean; the
    /// variance is that of the mean.
    pub fn layers(&self, metadata: Vec<(String, String)>) -> Layers {
        let mut channels = Vec::new();
        let mut float = |name: &str, value: &dyn Fn(&PixelSums) -> f32| {
            channels.push(Channel {
                name: name.into(),
                samples: ChannelData::Float(self.pixels.iter().map(value).collect()),
            });
        };
        for (c, name) in ["R", "G", "B"].into_iter().enumerate() {
            float(name, &|p| p.mean()[c] as f32);
            float(&format!("albedo.{name}"), &|p| p.albedo()[c]);
            float(&format!("variance.{name}"), &|p| {
                p.variance_of_mean()[c] as f32
            });
        }
        for (c, name) in ["X", "Y", "Z"].into_iter().enumerate() {
            float(&format!("normal.{name}"), &|p| p.normal()[c]);
        }
        float("depth.Z", &PixelSums::depth);
        channels.push(Channel {
            name: "samples.count".into(),
            samples: ChannelData::Uint(self.pixels.iter().map(|p| p.samples).collect()),
        });
        Layers {
            channels,
            metadata,
            chromaticities: Some(Chromaticities::REC709),
            ..Layers::new(self.width as usize, self.height as usize)
        }
    }

    fn map(&self, f: impl Fn(&PixelSums) -> [f32; 3]) -> Image {
        Image {
            width: self.width as usize,
            height: self.height as usize,
            pixels: self.pixels.iter().map(f).collect(),
        }
    }
}

/// Adds a sample to its pixel, unless a channel is negative or not finite: then it counts as a sample of no light and
/// is reported. That keeps the image finite without hiding the fault.
pub(crate) fn add(
    sums: &mut PixelSums,
    mut sample: FilmSample,
    pixel: [u32; 2],
    index: u32,
    rejected: &mut Rejected,
) {
    if sample
        .radiance
        .iter()
        .any(|l| !(l.is_finite() && *l >= 0.0))
    {
        rejected.merge(Rejected {
            count: 1,
            first: Some(RejectedSample {
                pixel,
                sample: index,
                radiance: sample.radiance,
                material: sample.first.map(|f| f.material),
            }),
        });
        sample.radiance = [0.0; 3];
    }
    sums.add(&sample);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(l: f32) -> FilmSample {
        FilmSample {
            radiance: [l; 3],
            first: None,
        }
    }

    #[test]
    fn mean_and_variance_of_known_samples() {
        let mut sums = PixelSums::default();
        let mut rejected = Rejected::default();
        for (k, l) in [1.0, 2.0, 3.0, 6.0].into_iter().enumerate() {
            add(&mut sums, sample(l), [0, 0], k as u32, &mut rejected);
        }
        assert_eq!(sums.mean(), [3.0; 3]);
        // Deviations −2, −1, 0, 3: s² = 14 / 3, of the mean 14 / 12.
        for v in sums.variance_of_mean() {
            assert!((v - 14.0 / 12.0).abs() < 1e-12);
        }
        assert_eq!(rejected, Rejected::default());
    }

    #[test]
    fn faulty_samples_are_counted_and_kept_out() {
        let mut sums = PixelSums::default();
        let mut rejected = Rejected::default();
        for (k, l) in [1.0, f32::NAN, -1.0, f32::INFINITY].into_iter().enumerate() {
            add(&mut sums, sample(l), [3, 4], k as u32, &mut rejected);
        }
        assert_eq!(sums.mean(), [0.25; 3]);
        assert_eq!(rejected.count, 3);
        let first = rejected.first.expect("three were rejected");
        assert_eq!((first.pixel, first.sample), ([3, 4], 1));
    }

    #[test]
    fn the_first_rejected_sample_does_not_depend_on_the_order() {
        let at = |pixel, sample| Rejected {
            count: 1,
            first: Some(RejectedSample {
                pixel,
                sample,
                radiance: [-1.0; 3],
                material: None,
            }),
        };
        let parts = [at([5, 1], 2), at([0, 9], 1), at([1, 0], 2)];
        let mut forward = Rejected::default();
        let mut backward = Rejected::default();
        for p in &parts {
            forward.merge(p.clone());
        }
        for p in parts.iter().rev() {
            backward.merge(p.clone());
        }
        assert_eq!(forward, backward);
        assert_eq!(forward.first.expect("not empty").pixel, [0, 9]);
    }

    #[test]
    fn impossible_sizes_are_errors() {
        assert!(matches!(
            Film::new(0, 4),
            Err(RenderError::Parameter { .. })
        ));
        assert!(matches!(
            Film::new(1 << 20, 1 << 20),
            Err(RenderError::Limit { .. })
        ));
    }
}
