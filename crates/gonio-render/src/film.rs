//! [`Film`]: per-pixel sums of radiance samples.

mod binned;
mod kept;
mod layers;
mod levels;
mod pixel;
pub(crate) mod record;
mod row;
mod triple;

pub use kept::Kept;
pub use layers::{Names, picture};
pub use pixel::{FilmSample, FirstSurface, PixelSums};
pub(crate) use row::{FilmRow, Place};

use crate::RenderError;
use gonio_image::Image;
use levels::Levels;
use rayon::prelude::*;
use triple::{Nearest, Triple};

/// Samples that were not finite or negative, kept out of the image.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Rejected {
    /// How many.
    pub count: u64,
    /// Shares of samples that are in the image, kept out of their layers because they alone are negative or not finite.
    #[serde(default)]
    pub in_layers: u64,
    /// The first rejected sample, in the order of sample, row and column.
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
        self.in_layers = self.in_layers.saturating_add(other.in_layers);
        let order = |r: &RejectedSample| (r.sample, r.pixel[1], r.pixel[0]);
        self.first = match (self.first.take(), other.first) {
            (Some(a), Some(b)) => Some(if order(&b) < order(&a) { b } else { a }),
            (a, b) => a.or(b),
        };
    }
}

/// The picture being taken: sums of samples per pixel, row-major from the top left.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    width: u32,
    height: u32,
    kept: Kept,
    pixels: Vec<PixelSums>,
    /// As many as [`Kept::triples`] for each pixel, in the same order.
    triples: Vec<Triple>,
    /// One a pixel where materials are kept.
    nearest: Vec<Nearest>,
    /// One a pixel where samples are told apart by their brightness.
    levels: Vec<Levels>,
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
        Self::keeping(Kept::NOTHING, width, height)
    }

    /// An empty film that keeps more layers than all do.
    ///
    /// # Errors
    /// As [`Film::new`].
    pub fn keeping(kept: Kept, width: u32, height: u32) -> Result<Self, RenderError> {
        Self::check(kept, width, height)?;
        let pixels = width as usize * height as usize;
        Ok(Self {
            width,
            height,
            kept,
            pixels: vec![PixelSums::default(); pixels],
            triples: vec![Triple::default(); pixels * kept.triples()],
            nearest: vec![Nearest::default(); if kept.material { pixels } else { 0 }],
            levels: vec![Levels::default(); if kept.reweighted { pixels } else { 0 }],
            rejected: Rejected::default(),
        })
    }

    /// Fails as [`Film::keeping`] does, without making one.
    pub(crate) fn check(kept: Kept, width: u32, height: u32) -> Result<(), RenderError> {
        if width == 0 || height == 0 {
            return Err(RenderError::Parameter {
                option: "size",
                found: format!("{width}×{height}"),
                expected: "at least 1×1 pixels",
            });
        }
        let count = u64::from(width) * u64::from(height);
        let with = |kept: bool, size: usize| if kept { size } else { 0 };
        let each = size_of::<PixelSums>()
            + kept.triples() * size_of::<Triple>()
            + with(kept.material, size_of::<Nearest>())
            + with(kept.reweighted, size_of::<Levels>());
        let bytes = count.saturating_mul(each as u64);
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
    /// The layers that it keeps beside those that every film has.
    pub fn kept(&self) -> Kept {
        self.kept
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
    /// Samples of all pixels.
    pub fn samples(&self) -> u64 {
        self.pixels.iter().map(|p| u64::from(p.samples)).sum()
    }

    /// The rows, which different threads may write.
    pub(crate) fn rows_mut(&mut self) -> Vec<FilmRow<'_>> {
        let (kept, width) = (self.kept, self.width as usize);
        let (mut triples, mut nearest) = (&mut self.triples[..], &mut self.nearest[..]);
        let mut levels = &mut self.levels[..];
        let rows = self.pixels.chunks_exact_mut(width);
        rows.map(|pixels| FilmRow {
            kept,
            pixels,
            triples: front(&mut triples, width * kept.triples()),
            nearest: front(&mut nearest, if kept.material { width } else { 0 }),
            levels: front(&mut levels, if kept.reweighted { width } else { 0 }),
        })
        .collect()
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
        // Of each pixel the mean and its variance.
        let pixels: Vec<[f64; 2]> = self
            .pixels
            .par_iter()
            .map(|p| [sum(p.mean()), sum(p.variance_of_mean())])
            .collect();
        let mean = pixels.iter().map(|[mean, _]| mean).sum::<f64>() / pixels.len() as f64;
        if mean == 0.0 {
            return if self.samples_per_pixel() < 2 {
                f64::INFINITY
            } else {
                0.0
            };
        }
        let mut errors: Vec<f64> = pixels
            .iter()
            .map(|[own, variance]| variance.sqrt() / (own + 0.01 * mean))
            .collect();
        let k = (errors.len() - 1) * 95 / 100;
        *errors.select_nth_unstable_by(k, f64::total_cmp).1
    }

    fn map(&self, f: impl Fn(&PixelSums) -> [f32; 3]) -> Image {
        Image {
            width: self.width as usize,
            height: self.height as usize,
            pixels: self.pixels.iter().map(f).collect(),
        }
    }
}

/// Takes the first `n` of `rest` from it.
fn front<'a, T>(rest: &mut &'a mut [T], n: usize) -> &'a mut [T] {
    let (front, others) = std::mem::take(rest).split_at_mut(n);
    *rest = others;
    front
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

    fn at(pixel: [u32; 2], index: u32) -> Place {
        Place {
            pixel,
            index,
            off_centre: 0.0,
        }
    }

    #[test]
    fn mean_and_variance_of_known_samples() {
        let mut film = Film::new(1, 1).unwrap();
        let mut rejected = Rejected::default();
        for (k, l) in [1.0, 2.0, 3.0, 6.0].into_iter().enumerate() {
            let row = &mut film.rows_mut()[0];
            row.add(&sample(l), &[], &at([0, 0], k as u32), &mut rejected);
        }
        let sums = film.pixels()[0];
        assert_eq!(sums.mean(), [3.0; 3]);
        // Deviations −2, −1, 0, 3: s² = 14 / 3, of the mean 14 / 12.
        for v in sums.variance_of_mean() {
            assert!((v - 14.0 / 12.0).abs() < 1e-12);
        }
        assert_eq!(rejected, Rejected::default());
    }

    #[test]
    fn faulty_samples_are_counted_and_kept_out() {
        let mut film = Film::new(4, 1).unwrap();
        let mut rejected = Rejected::default();
        for (k, l) in [1.0, f32::NAN, -1.0, f32::INFINITY].into_iter().enumerate() {
            let row = &mut film.rows_mut()[0];
            row.add(&sample(l), &[], &at([3, 4], k as u32), &mut rejected);
        }
        assert_eq!(film.pixels()[3].mean(), [0.25; 3]);
        assert_eq!(rejected.count, 3);
        let first = rejected.first.expect("three were rejected");
        assert_eq!((first.pixel, first.sample), ([3, 4], 1));
    }

    #[test]
    fn the_first_rejected_sample_does_not_depend_on_the_order() {
        let at = |pixel, sample| Rejected {
            count: 1,
            in_layers: 0,
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

    /// A fault that hides in the sum of two shares is in neither layer, and is counted.
    #[test]
    fn faulty_shares_are_kept_out_of_their_layers() {
        let kept = Kept {
            direct: true,
            indirect: true,
            ..Kept::NOTHING
        };
        let mut film = Film::keeping(kept, 2, 1).unwrap();
        let mut rejected = Rejected::default();
        let row = &mut film.rows_mut()[0];
        let shares = [[1.0; 3], [2.0; 3]];
        row.add(&sample(3.0), &shares, &at([0, 0], 0), &mut rejected);
        row.add(
            &sample(1.0),
            &[[2.0; 3], [-1.0; 3]],
            &at([1, 0], 0),
            &mut rejected,
        );
        assert_eq!((rejected.count, rejected.in_layers), (0, 1));
        // A sample that is black is black in every layer.
        row.add(&sample(f32::NAN), &shares, &at([1, 0], 1), &mut rejected);
        assert_eq!((rejected.count, rejected.in_layers), (1, 1));
        let names = Names::default();
        let layers = film.layers(&names, Vec::new());
        let of = |name: &str| layers.rgb(name).unwrap().pixels.clone();
        assert_eq!(of("direct"), [[1.0; 3], [1.0; 3]]);
        assert_eq!(of("indirect"), [[2.0; 3], [0.0; 3]]);
        assert_eq!(of(""), [[3.0; 3], [0.5; 3]]);
    }

    #[test]
    fn impossible_sizes_are_errors() {
        let groups = Kept {
            groups: u32::MAX,
            ..Kept::NOTHING
        };
        assert!(matches!(
            Film::keeping(groups, 64, 64),
            Err(RenderError::Limit { .. })
        ));
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
