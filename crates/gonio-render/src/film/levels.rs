//! [`Levels`]: the samples of a pixel by their brightness, and the picture in which fireflies weigh less.
//!
//! After Zirr, Hanika and Dachsbacher 2018, "Re-weighting firefly samples for improved finite-sample Monte Carlo estimates". A firefly is a sample
//! that is much brighter than the others and so rare that its brightness says nothing about the pixel yet. Samples are therefore summed apart by
//! brightness, and when the picture is written each sum counts as far as it can be relied on.
//!
//! The brightness L of a sample is its largest channel. Level j is at B_j = 8^j. A sample between B_j and B_(j+1) is divided between these two, with
//! the share a = (B_(j+1) / L − 1) / 7 to the lower one: then a sample gives a level no more than B_j, and L·a / B_j + L·(1 − a) / B_(j+1) = 1. So the
//! sum S_j of a level, divided by B_j, is a number of samples.
//!
//! From the lowest level up, with sums over the window of 3 × 3 pixels around the pixel, n samples in the pixel and N in the window:
//!
//! - t = Σ_window (S_(j−1) / B_(j−1) + S_j / B_j + S_(j+1) / B_(j+1)): samples that are about as bright
//! - m = Σ_(i<j) w_i Σ_window S_i / N: the brightness of the lower levels
//! - w_j = max((t − 1) / (k − 1), n·m / (κ·B_j)), within 0 and 1, with k = κ, or N / 2 if that is less
//!
//! A level counts as a whole where κ samples of its kind are in the window, or half of those that there are, or where one of them would be a κth of the
//! pixel at most. A single sample adds to a pixel at most m/κ in each of its two levels.
//!
//! The paper has κ as well. It takes the pixel's own number of samples where the window has enough of them; here the window decides alone, so that a
//! pixel that has two fireflies by chance is not brighter than its neighbours.

use super::{Film, PixelSums};
use gonio_image::Image;
use rayon::prelude::*;

/// Levels: from 8⁻⁶ to 8⁹.
pub(super) const COUNT: usize = 16;
/// The power of 8 of the lowest.
const FIRST: i32 = -6;
/// Bits of a brightness from one level to the next.
const BITS: i32 = 3;
/// 8.
const BASE: f64 = (1 << BITS) as f64;
/// Units of a sum in its level's brightness: 2³² samples fit, as each adds one brightness at most.
const UNITS: f64 = (1_u64 << 31) as f64;
/// Samples at which a level is relied on.
const KAPPA: f64 = 8.0;

/// Sums of radiance of each level, in units of 2⁻³¹ of the level's brightness. Whole numbers: functions of the set of samples, as all sums of a film are.
///
/// What is above the last level is in that level, and sums there end at 2³³ times its brightness.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Levels(pub(super) [[u64; 3]; COUNT]);

impl Default for Levels {
    fn default() -> Self {
        Self([[0; 3]; COUNT])
    }
}

/// The brightness of a level.
fn brightness(level: usize) -> f64 {
    let exponent = i64::from(BITS * (FIRST + level as i32));
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

impl Levels {
    /// Adds a sample of finite radiance that is not negative.
    #[inline]
    pub fn add(&mut self, radiance: [f32; 3]) {
        let [r, g, b] = radiance.map(f64::from);
        let bright = r.max(g).max(b);
        // ⌊log₂⌋ by the exponent; 0 is far below all levels.
        let exponent = (bright.to_bits() >> 52) as i32 - 1023;
        let level = exponent.div_euclid(BITS) - FIRST;
        let (lower, share) = if level < 0 {
            (0, 1.0)
        } else if level as usize >= COUNT - 1 {
            (COUNT - 1, 1.0)
        } else {
            let level = level as usize;
            (level, (brightness(level + 1) / bright - 1.0) / (BASE - 1.0))
        };
        self.give(lower, [r, g, b], share);
        if share < 1.0 {
            self.give(lower + 1, [r, g, b], 1.0 - share);
        }
    }

    #[inline]
    fn give(&mut self, level: usize, radiance: [f64; 3], share: f64) {
        let scale = share * UNITS / brightness(level);
        for (sum, l) in self.0[level].iter_mut().zip(radiance) {
            // A conversion to an integer saturates, and so does the sum: whatever the order, it is the least of the true one and the largest.
            *sum = sum.saturating_add((l * scale + 0.5) as u64);
        }
    }

    pub fn merge(&mut self, other: &Self) {
        let others = other.0.as_flattened();
        for (sum, other) in self.0.as_flattened_mut().iter_mut().zip(others) {
            *sum = sum.saturating_add(*other);
        }
    }

    /// Whether sums read from a file can be those of at most `count` samples: each adds 1 at most, to within a rounding, but for the last level.
    pub fn is_sound(&self, count: u32) -> bool {
        let most = u64::from(count) * (UNITS as u64 + 1);
        let below = self.0[..COUNT - 1].as_flattened();
        below.iter().all(|sum| *sum <= most) && (count > 0 || self.0[COUNT - 1] == [0; 3])
    }

    /// Radiance of a level.
    fn radiance(&self, level: usize) -> [f64; 3] {
        self.0[level].map(|sum| sum as f64 / UNITS * brightness(level))
    }

    /// Samples of a level.
    fn samples(&self, level: usize) -> f64 {
        let [r, g, b] = self.0[level];
        r.max(g).max(b) as f64 / UNITS
    }
}

/// The weight of each level.
///
/// - `samples`: of each level, in the window
/// - `of_pixel`, `of_window`: samples that were taken
fn weights(samples: &[f64; COUNT], of_pixel: f64, of_window: f64) -> [f64; COUNT] {
    let enough = KAPPA.min((0.5 * of_window).max(1.0));
    let mut below = 0.0;
    std::array::from_fn(|level| {
        let near = level.saturating_sub(1)..(level + 2).min(COUNT);
        let seen: f64 = samples[near].iter().sum();
        let counted = if seen >= enough {
            1.0
        } else {
            (seen - 1.0) / (enough - 1.0)
        };
        let harmless = of_pixel * (below / of_window) / (KAPPA * brightness(level));
        let weight = counted.max(harmless).clamp(0.0, 1.0);
        below += weight * samples[level] * brightness(level);
        weight
    })
}

impl Film {
    /// The picture in which fireflies weigh less, if the film keeps what it takes ([`super::Kept::reweighted`]).
    ///
    /// It is never brighter than [`Film::image`], and darker in the mean: light that seldom comes, and much at once, is missing in part until κ = 8
    /// samples of its brightness are in the window of 3 × 3 pixels. Where all levels have as many, both are the same, to within 2⁻³¹ of the levels'
    /// brightness.
    pub fn reweighted(&self) -> Option<Image> {
        if !self.kept.reweighted {
            return None;
        }
        let (width, height) = (self.width as usize, self.height as usize);
        let around = |i: usize, end: usize| i.saturating_sub(1)..(i + 2).min(end);
        let pixel = |place: usize| {
            let (x, y) = (place % width, place / width);
            let mut samples = [0.0; COUNT];
            let mut of_window = 0.0;
            for row in around(y, height) {
                for column in around(x, width) {
                    let other = row * width + column;
                    of_window += f64::from(self.pixels[other].samples);
                    for (level, all) in samples.iter_mut().enumerate() {
                        *all += self.levels[other].samples(level);
                    }
                }
            }
            let own: &PixelSums = &self.pixels[place];
            let n = f64::from(own.samples.max(1));
            let weights = weights(&samples, n, of_window.max(1.0));
            let mut sum = [0.0; 3];
            for (level, weight) in weights.into_iter().enumerate() {
                for (sum, l) in sum.iter_mut().zip(self.levels[place].radiance(level)) {
                    *sum += weight * l;
                }
            }
            sum.map(|l| (l / n) as f32)
        };
        Some(Image {
            width,
            height,
            pixels: (0..width * height).into_par_iter().map(pixel).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{FilmSample, Kept, Place, Rejected};
    use gonio_radiometry::sequence::Rng;

    fn of(samples: &[[f32; 3]]) -> Levels {
        let mut levels = Levels::default();
        samples.iter().for_each(|s| levels.add(*s));
        levels
    }

    /// A film of `side` × `side` pixels of `n` samples, `value` being that of sample k of a pixel.
    fn film(side: u32, n: u32, mut value: impl FnMut([u32; 2], u32) -> f32) -> Film {
        let kept = Kept {
            reweighted: true,
            ..Kept::NOTHING
        };
        let mut film = Film::keeping(kept, side, side).unwrap();
        for (y, row) in (0..).zip(&mut film.rows_mut()) {
            for (x, index) in (0..side).flat_map(|x| (0..n).map(move |k| (x, k))) {
                let sample = FilmSample {
                    radiance: [value([x, y], index); 3],
                    first: None,
                };
                let place = Place {
                    pixel: [x, y],
                    index,
                    off_centre: 0.0,
                };
                row.add(&sample, &[], &place, &mut Rejected::default());
            }
        }
        film
    }

    /// Each sum is rounded by half a unit at most, 2⁻³² of its level's brightness, of which the two of a sample are 9/8 of the upper's together.
    #[test]
    fn a_sample_is_one_and_keeps_its_radiance() {
        for k in 0..400 {
            let bright = 1.13_f32.powi(k - 90);
            let levels = of(&[[bright, 0.5 * bright, 0.0]]);
            let all = (0..COUNT).map(|j| levels.radiance(j));
            let sum = all.fold([0.0; 3], |a, b| [0, 1, 2].map(|c| a[c] + b[c]));
            let upper = BASE * f64::from(bright).max(brightness(0));
            let allowed =
                2.0_f64.powi(-32) * 1.125 * upper + 4.0 * f64::EPSILON * f64::from(bright);
            if f64::from(bright) < 4.0 * brightness(COUNT - 1) {
                assert!((sum[0] - f64::from(bright)).abs() <= allowed, "{bright}");
                assert!((sum[1] - 0.5 * f64::from(bright)).abs() <= allowed);
            }
            assert_eq!(sum[2], 0.0);
            if (brightness(0)..=brightness(COUNT - 1)).contains(&f64::from(bright)) {
                let count: f64 = (0..COUNT).map(|j| levels.samples(j)).sum();
                assert!((count - 1.0).abs() < 2.0_f64.powi(-30), "{bright} {count}");
            }
        }
        assert_eq!(of(&[[0.0; 3], [1e-42; 3]]), Levels::default());
    }

    #[test]
    fn sums_add_up_in_any_order_and_end_somewhere() {
        let samples: Vec<[f32; 3]> = (0..60)
            .map(|k| [1.7_f32.powi(k - 20), f32::MAX / 2.0_f32.powi(k), 1e-3])
            .collect();
        let whole = of(&samples);
        let reversed: Vec<[f32; 3]> = samples.iter().rev().copied().collect();
        assert_eq!(of(&reversed), whole);
        for cut in [0, 7, 30, 60] {
            let (a, b) = samples.split_at(cut);
            let mut later_first = of(b);
            later_first.merge(&of(a));
            assert_eq!(later_first, whole);
        }
        assert_eq!(whole.0[COUNT - 1][1], u64::MAX);
        assert!(whole.is_sound(60) && !of(&[[8.0; 3]; 9]).is_sound(8));
        assert!(!whole.is_sound(0) && Levels::default().is_sound(0));
    }

    /// The bound: m/κ in each of its two levels, where m is 1 for the lower one, and for the upper one what the lower one's share adds in the window of
    /// nine pixels as well. The control: without weights the pixel is far beyond it.
    #[test]
    fn a_firefly_adds_no_more_than_said() {
        let n = 64;
        let film = film(5, n, |pixel, k| match (pixel, k) {
            ([2, 2], 17) => 1e4,
            _ => 1.0,
        });
        let most = 1.0 + 1.0 / KAPPA + (1.0 + 1.0 / (9.0 * KAPPA)) / KAPPA;
        let within = |image: Image| f64::from(image.pixels[12][0]) <= most;
        let image = film.reweighted().unwrap();
        assert!(within(image.clone()), "{:?} {most}", image.pixels[12]);
        assert!(!within(film.image()));
        for (i, (found, plain)) in image.pixels.iter().zip(film.image().pixels).enumerate() {
            if i != 12 {
                assert_eq!(*found, plain, "{i}");
            }
        }
    }

    /// Where all samples are alike, or all that are unlike are many, nothing is lost but rounding: 2⁻³² of 9/8 of the brightest level, 64 here, in
    /// each sample, and the last bit of the result. At 2048 samples 369 of a window are the bright ones, and fewer than κ would be 18 standard deviations
    /// off. The control: at 8 samples they are 1.4, and the picture is too dark by many standard errors.
    #[test]
    fn with_many_samples_nothing_is_lost() {
        let mut rng = Rng::from_name("nothing is lost");
        let mut rare = |_, _| if rng.next_f32() < 0.02 { 31.0 } else { 1.0 };
        let lost = |film: &Film| {
            let (plain, found) = (film.image(), film.reweighted().unwrap());
            let all = plain.pixels.iter().zip(&found.pixels);
            all.map(|(a, b)| f64::from(a[0]) - f64::from(b[0]))
                .collect::<Vec<_>>()
        };
        let allowed = 72.0 * 2.0_f64.powi(-32) + 2.0 * f64::from(f32::EPSILON);
        let many = film(8, 2048, &mut rare);
        assert!(lost(&many).iter().all(|off| off.abs() <= allowed));
        let even = film(4, 1, |[x, y], _| 0.3 + 0.1 * (x + y) as f32);
        assert!(lost(&even).iter().all(|off| off.abs() <= allowed));
        let few = lost(&film(64, 8, &mut rare));
        let mean = few.iter().sum::<f64>() / few.len() as f64;
        // σ of a pixel is that of its 8 samples, 30 √(0.02·0.98 / 8), at most; windows share samples, as if there were a ninth of the pixels.
        let error = 30.0 * (0.02_f64 * 0.98 / 8.0).sqrt() / (few.len() as f64 / 9.0).sqrt();
        println!("lost {mean:.3} ± {error:.3} of 1.6");
        assert!(mean > 4.5 * error, "{mean} {error}");
        assert!(few.iter().all(|off| *off >= -allowed));
    }

    /// It takes as much room for any number of samples: 384 bytes a pixel.
    #[test]
    fn a_pixel_is_small() {
        assert_eq!(size_of::<Levels>(), 384);
    }
}
