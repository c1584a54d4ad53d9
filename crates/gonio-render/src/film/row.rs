//! [`FilmRow`], the pixels of a row, and how samples enter them.

use super::kept::Kept;
use super::levels::Levels;
use super::triple::{Nearest, Triple};
use super::{FilmSample, PixelSums, Rejected, RejectedSample};
use gonio_num::dispatch::{Kernel, dispatch};

/// A row of a film, which one thread may write.
pub(crate) struct FilmRow<'a> {
    pub(super) kept: Kept,
    pub(super) pixels: &'a mut [PixelSums],
    /// As many as [`Kept::triples`] for each pixel.
    pub(super) triples: &'a mut [Triple],
    /// One a pixel, or none.
    pub(super) nearest: &'a mut [Nearest],
    /// One a pixel, or none.
    pub(super) levels: &'a mut [Levels],
}

/// Where a sample belongs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// Column and row.
    pub pixel: [u32; 2],
    /// Index of the sample.
    pub index: u32,
    /// Squared distance from the pixel's middle, in pixels.
    pub off_centre: f32,
}

impl FilmRow<'_> {
    /// Pixels.
    pub fn len(&self) -> usize {
        self.pixels.len()
    }

    /// Samples that pixel `x` has.
    pub fn samples(&self, x: usize) -> u32 {
        self.pixels[x].samples
    }

    /// Adds a sample to its pixel, unless a channel is negative or not finite: then it counts as a sample of no light and
    /// is reported. That keeps the image finite without hiding the fault.
    ///
    /// - `shares`: of its radiance, in the order of [`Kept::shares`]; one that is negative or not finite while the whole is sound is kept
    ///   out of its layer, and counted
    pub fn add(
        &mut self,
        sample: &FilmSample,
        shares: &[[f32; 3]],
        place: &Place,
        rejected: &mut Rejected,
    ) {
        let mut sample = *sample;
        self.add_to_layers(&mut sample, shares, place, rejected);
        self.pixels[place.pixel[0] as usize].add(&[sample]);
    }

    /// [`FilmRow::add`] of many samples, those of a pixel one after the other; the radiance of one that is rejected is set to 0.
    ///
    /// - `shares`: of each sample
    /// - `places`: one a sample
    pub fn add_many<'s>(
        &mut self,
        samples: &mut [FilmSample],
        shares: impl Fn(usize) -> &'s [[f32; 3]],
        places: impl Iterator<Item = Place>,
        rejected: &mut Rejected,
    ) {
        let mut runs = Vec::with_capacity(samples.len());
        for (i, (sample, place)) in samples.iter_mut().zip(places).enumerate() {
            self.add_to_layers(sample, shares(i), &place, rejected);
            let [x, _] = place.pixel;
            match runs.last_mut() {
                Some((last, count)) if *last == x => *count += 1,
                _ => runs.push((x, 1)),
            }
        }
        dispatch(AddRuns {
            pixels: self.pixels,
            runs: &runs,
            samples,
        });
    }

    /// Adds a sample to the layers that are kept, and takes its radiance if it is none.
    #[inline]
    fn add_to_layers(
        &mut self,
        sample: &mut FilmSample,
        shares: &[[f32; 3]],
        place: &Place,
        rejected: &mut Rejected,
    ) {
        let is_sound = is_light(sample.radiance);
        if !is_sound {
            rejected.merge(Rejected {
                count: 1,
                in_layers: 0,
                first: Some(RejectedSample {
                    pixel: place.pixel,
                    sample: place.index,
                    radiance: sample.radiance,
                    material: sample.first.map(|f| f.material),
                }),
            });
            sample.radiance = [0.0; 3];
        }
        if self.kept == Kept::NOTHING {
            return;
        }
        let x = place.pixel[0] as usize;
        if let Some(levels) = self.levels.get_mut(x) {
            levels.add(sample.radiance);
        }
        let each = self.kept.triples();
        let triples = &mut self.triples[x * each..(x + 1) * each];
        if is_sound {
            let sums = &mut triples[self.kept.first_share()..];
            for (sum, share) in sums.iter_mut().zip(shares) {
                if is_light(*share) {
                    sum.add(*share);
                } else {
                    rejected.in_layers += 1;
                }
            }
        }
        if let (true, Some(first)) = (self.kept.position, &sample.first)
            && first.position.iter().all(|p| p.is_finite())
        {
            // Not by `max`, which may leave −0.
            triples[0].add(first.position.map(|p| if p > 0.0 { p } else { 0.0 }));
            triples[1].add(first.position.map(|p| if p < 0.0 { -p } else { 0.0 }));
        }
        if let Some(nearest) = self.nearest.get_mut(x) {
            let material = sample.first.map(|first| first.material);
            nearest.merge(Nearest::new(place.off_centre, material));
        }
    }
}

/// Samples of pixels, run after run.
struct AddRuns<'a> {
    pixels: &'a mut [PixelSums],
    /// Pixel and number of samples.
    runs: &'a [(u32, usize)],
    samples: &'a [FilmSample],
}

impl Kernel for AddRuns<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let mut rest = self.samples;
        for &(x, count) in self.runs {
            let (run, others) = rest.split_at(count);
            self.pixels[x as usize].add(run);
            rest = others;
        }
    }
}

fn is_light(radiance: [f32; 3]) -> bool {
    radiance.iter().all(|l| l.is_finite() && *l >= 0.0)
}
