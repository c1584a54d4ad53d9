//! [`PixelSums`]: the sums over the samples of one pixel.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::binned;

/// The sums over the samples of one pixel. They are functions of the set of samples: order and grouping leave no trace, so
/// that parts of a picture add up to the bits of the whole.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PixelSums {
    /// The first and second digits of Σ L² ([`SQUARES`] and the two after it), of Σ L ([`RADIANCE`]) and of Σ of the distance to the first
    /// surface ([`DEPTH`]), over the samples that hit one; the last place is empty.
    pub(super) digits: [[u64; SUMS]; 2],
    /// The third digits of Σ L².
    pub(super) third: [u64; 3],
    /// Σ of the first surface's albedo, and of its shading normal in world space, in units of [`FIXED`].
    pub(super) surface: [i64; 6],
    /// Samples that hit a surface.
    pub(super) hits: u32,
    /// Samples taken, rejected ones included.
    pub(super) samples: u32,
    /// The places of the highest digits.
    pub(super) tops: [u8; SUMS],
}

/// Sums that are binned, side by side: as many as fit vector registers.
pub(super) const SUMS: usize = 8;
/// The first of three.
pub(super) const SQUARES: usize = 0;
/// The first of three.
pub(super) const RADIANCE: usize = 3;
pub(super) const DEPTH: usize = 6;

/// What the auxiliary layers keep of the first surface that a camera ray meets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstSurface {
    /// Approximate directional–hemispherical reflectance.
    pub albedo: [f32; 3],
    /// Shading normal, world space, unit.
    pub normal: [f32; 3],
    /// Where it is, world space.
    pub position: [f32; 3],
    /// Distance along the ray.
    pub depth: f32,
    /// Index of the material.
    pub material: u32,
}

/// One sample of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSample {
    /// Radiance along the camera ray.
    pub radiance: [f32; 3],
    /// The first surface met, if any.
    pub first: Option<FirstSurface>,
}

/// Units in 1 of the sums of albedo and normal: their components are about 1 at most, so that 2⁻²⁴ is the last bit of an `f32`.
const FIXED: f64 = (1 << 24) as f64;
/// Units that one sample may add: 2³² samples fit an `i64`. It is an albedo of 128.
const MOST_FIXED: f64 = (1_i64 << 31) as f64;

/// The whole number of units nearest to x, away from 0 of two as near; 0 for NaN. Without conversions to integers or calls, so that it vectorises.
#[inline(always)]
fn fixed(x: f32) -> f64 {
    // Of a number of this size the last bit is 1.
    const WHOLE: f64 = 1.5 * (1_u64 << 52) as f64;
    let x = f64::from(x) * FIXED;
    let x = if x < MOST_FIXED {
        x
    } else {
        MOST_FIXED * f64::from(x >= MOST_FIXED)
    };
    let x = if x > -MOST_FIXED { x } else { -MOST_FIXED };
    // To the even one of two as near, of which the other may be further from 0.
    let near = (x + WHOLE) - WHOLE;
    let left = x - near;
    let further = if x > 0.0 { 1.0 } else { -1.0 };
    near + if left == 0.5 * further { further } else { 0.0 }
}

/// What a sample adds to the sums that are binned.
#[inline(always)]
fn binned_of(sample: &FilmSample) -> [f64; SUMS] {
    let [r, g, b] = sample.radiance;
    let depth = sample.first.map_or(0.0, |first| first.depth);
    let known = depth > 0.0 && depth < f32::INFINITY;
    let left = [r, g, b, r, g, b, if known { depth } else { 0.0 }, 0.0];
    let right = [r, g, b, 1.0, 1.0, 1.0, 1.0, 0.0];
    let mut values = [0.0; SUMS];
    for i in 0..SUMS {
        values[i] = f64::from(left[i]) * f64::from(right[i]);
    }
    values
}

impl PixelSums {
    /// Samples taken, rejected ones included.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Mean radiance; 0 without samples.
    pub fn mean(&self) -> [f64; 3] {
        let n = f64::from(self.samples.max(1));
        std::array::from_fn(|c| self.sum(RADIANCE + c) / n)
    }

    /// Variance of the mean, by the sample variance s² / n; ∞ below two samples.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        if self.samples < 2 {
            return [f64::INFINITY; 3];
        }
        let n = f64::from(self.samples);
        let mean = self.mean();
        std::array::from_fn(|c| {
            let squares = self.sum(SQUARES + c);
            let s2 = (squares / n - mean[c] * mean[c]).max(0.0) * n / (n - 1.0);
            s2 / n
        })
    }

    /// Mean albedo of the first surface, over all samples; 0 without.
    pub fn albedo(&self) -> [f32; 3] {
        let [r, g, b, ..] = self.surface;
        self.mean_of_fixed([r, g, b])
    }

    /// Mean shading normal of the first surface, over all samples, not normalised; 0 without.
    pub fn normal(&self) -> [f32; 3] {
        let [.., x, y, z] = self.surface;
        self.mean_of_fixed([x, y, z])
    }

    /// Mean distance to the first surface, over the samples that hit one; ∞ if none did.
    pub fn depth(&self) -> f32 {
        if self.hits == 0 {
            return f32::INFINITY;
        }
        (self.sum(DEPTH) / f64::from(self.hits)) as f32
    }

    fn mean_of_fixed(&self, sums: [i64; 3]) -> [f32; 3] {
        let n = f64::from(self.samples.max(1));
        sums.map(|s| (s as f64 / FIXED / n) as f32)
    }

    /// All digits of sum `i`.
    pub(super) fn digits_of(&self, i: usize) -> [u64; 3] {
        let third = self.third.get(i).copied().unwrap_or(0);
        [self.digits[0][i], self.digits[1][i], third]
    }

    pub(super) fn set_digits(&mut self, i: usize, [first, second, third]: [u64; 3]) {
        self.digits[0][i] = first;
        self.digits[1][i] = second;
        // Of the others the third digits are given up.
        if let Some(own) = self.third.get_mut(i) {
            *own = third;
        }
    }

    fn sum(&self, i: usize) -> f64 {
        binned::value(&self.digits_of(i), self.tops[i])
    }

    /// Adds samples of finite radiance that is not negative.
    #[inline(always)]
    pub(super) fn add(&mut self, samples: &[FilmSample]) {
        let mut largest = [0.0; SUMS];
        for sample in samples {
            let values = binned_of(sample);
            for i in 0..SUMS {
                largest[i] = if largest[i] < values[i] {
                    values[i]
                } else {
                    largest[i]
                };
            }
        }
        if binned::are_above(&self.tops, &largest) {
            self.raise(&largest);
        }
        let [r, g, b] = self.third;
        let mut digits = [self.digits[0], self.digits[1], [r, g, b, 0, 0, 0, 0, 0]];
        // As many samples as fit memory have sums that are exact.
        let (mut surface, mut hits) = ([0.0; SUMS], 0);
        for sample in samples {
            binned::add_all(&mut digits, &self.tops, &binned_of(sample));
            if let Some(first) = &sample.first {
                hits += 1;
                let ([r, g, b], [x, y, z]) = (first.albedo, first.normal);
                let numbers = [r, g, b, x, y, z, 0.0, 0.0];
                for i in 0..SUMS {
                    surface[i] += fixed(numbers[i]);
                }
            }
        }
        self.digits = [digits[0], digits[1]];
        self.third.copy_from_slice(&digits[2][..3]);
        for (sum, more) in self.surface.iter_mut().zip(surface) {
            *sum += more as i64;
        }
        self.hits += hits;
        self.samples += samples.len() as u32;
    }

    /// Makes room for sums of such numbers.
    #[cold]
    #[inline(never)]
    fn raise(&mut self, largest: &[f64; SUMS]) {
        for (i, largest) in largest.iter().enumerate() {
            let mut digits = self.digits_of(i);
            binned::raise(&mut digits, &mut self.tops[i], binned::place(*largest));
            self.set_digits(i, digits);
        }
    }

    /// Adds the sums of other samples of the same pixel, fewer than 2³² with those that are here.
    pub fn merge(&mut self, other: &Self) {
        for i in 0..SUMS {
            let mut digits = self.digits_of(i);
            let others = (&other.digits_of(i), other.tops[i]);
            binned::merge(&mut digits, &mut self.tops[i], others);
            self.set_digits(i, digits);
        }
        for (sum, other) in self.surface.iter_mut().zip(other.surface) {
            *sum += other;
        }
        self.hits += other.hits;
        self.samples += other.samples;
    }

    /// Whether sums read from a file can be those of at most `count` samples.
    pub(super) fn is_sound(&self, count: u32) -> bool {
        let n = self.samples;
        let most = i64::from(n) << 31;
        n <= count
            && self.hits <= n
            && (0..SUMS).all(|i| binned::is_sound(&self.digits_of(i), self.tops[i], n))
            && self.surface.iter().all(|s| (-most..=most).contains(s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(l: f32, depth: f32) -> FilmSample {
        FilmSample {
            radiance: [l, 2.0 * l, 0.0],
            first: Some(FirstSurface {
                albedo: [0.5, 0.25, 300.0],
                normal: [0.0, -1.0, f32::NAN],
                position: [0.0; 3],
                depth,
                material: 0,
            }),
        }
    }

    #[test]
    fn means_of_known_samples() {
        let mut sums = PixelSums::default();
        let missed = FilmSample {
            first: None,
            ..sample(1.0, 0.0)
        };
        for s in [sample(1.0, 3.0), sample(4.0, 5.0), missed] {
            sums.add(&[s]);
        }
        assert_eq!((sums.mean(), sums.samples()), ([2.0, 4.0, 0.0], 3));
        assert_eq!(sums.depth(), 4.0);
        let third = 2.0_f32 / 3.0;
        assert_eq!(sums.albedo(), [0.5 * third, 0.25 * third, 128.0 * third]);
        assert_eq!(sums.normal(), [0.0, -third, 0.0]);
        assert_eq!(PixelSums::default().depth(), f32::INFINITY);
        assert_eq!(PixelSums::default().mean(), [0.0; 3]);
    }

    #[test]
    fn units_are_rounded_away_from_0() {
        let unit = 1.0 / FIXED as f32;
        for (x, units) in [
            (0.0, 0.0),
            (0.5 * unit, 1.0),
            (1.5 * unit, 2.0),
            (2.5 * unit, 3.0),
            (2.499 * unit, 2.0),
            (-0.5 * unit, -1.0),
            (-1.5 * unit, -2.0),
            (-1.501 * unit, -2.0),
            (0.7, 11_744_051.0),
            (-127.0, -127.0 * FIXED),
            (1e9, MOST_FIXED),
            (f32::INFINITY, MOST_FIXED),
            (f32::NEG_INFINITY, -MOST_FIXED),
            (f32::NAN, 0.0),
        ] {
            assert_eq!(fixed(x), units, "{x}");
        }
        let same = |x: f32| fixed(x) == (f64::from(x) * FIXED).round();
        assert!((0..10_000).all(|k| same(1.3_f32.powi(k % 80 - 77) * (k as f32 - 5000.0) * 1e-4)));
    }

    #[test]
    fn parts_of_samples_add_up_to_the_bits_of_the_whole() {
        let samples: Vec<FilmSample> = (1..50_u16)
            .map(|k| sample(1.0 / f32::from(k * k), f32::from(k) * 0.1))
            .collect();
        let of = |samples: &[FilmSample]| {
            let mut sums = PixelSums::default();
            sums.add(samples);
            sums
        };
        let whole = of(&samples);
        for cut in [0, 1, 17, 48, 49] {
            let (a, b) = samples.split_at(cut);
            let mut later_first = of(b);
            later_first.merge(&of(a));
            assert_eq!(later_first, whole);
        }
        assert!(whole.is_sound(49) && !whole.is_sound(48));
    }

    /// A pixel takes 216 bytes: the sums of radiance, its square and depth 152, albedo and normal 48, counts and places 16.
    #[test]
    fn a_pixel_is_small() {
        assert_eq!(size_of::<PixelSums>(), 216);
    }
}
