//! [`PixelSums`]: the sums over the samples of one pixel.

use super::binned;

/// The sums over the samples of one pixel. They are functions of the set of samples: order and grouping leave no trace, so
/// that parts of a picture add up to the bits of the whole.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PixelSums {
    /// Σ L.
    pub(super) radiance: [[u64; 2]; 3],
    /// Σ L².
    pub(super) radiance_squared: [[u64; 3]; 3],
    /// Σ of the distance to the first surface, over the samples that hit one.
    pub(super) depth: [u64; 2],
    /// Σ of the first surface's albedo, in units of [`FIXED`].
    pub(super) albedo: [i64; 3],
    /// Σ of the first surface's shading normal, world space, in units of [`FIXED`].
    pub(super) normal: [i64; 3],
    /// Samples that hit a surface.
    pub(super) hits: u32,
    /// Samples taken, rejected ones included.
    pub(super) samples: u32,
    /// The places of the highest digits: of radiance, of its square, of depth.
    pub(super) tops: [u8; 7],
}

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

#[inline(always)]
fn fixed(x: f32) -> i64 {
    // NaN becomes 0. The nearest integer: the sum is exact, as a number of 24 bits that is no integer is below 2²⁴; `f64::round` is a call.
    let x = (f64::from(x) * FIXED).clamp(-MOST_FIXED, MOST_FIXED);
    (x + 0.5_f64.copysign(x)) as i64
}

impl PixelSums {
    /// Samples taken, rejected ones included.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Mean radiance; 0 without samples.
    pub fn mean(&self) -> [f64; 3] {
        let n = f64::from(self.samples.max(1));
        std::array::from_fn(|c| binned::value(&self.radiance[c], self.tops[c]) / n)
    }

    /// Variance of the mean, by the sample variance s² / n; ∞ below two samples.
    pub fn variance_of_mean(&self) -> [f64; 3] {
        if self.samples < 2 {
            return [f64::INFINITY; 3];
        }
        let n = f64::from(self.samples);
        let mean = self.mean();
        std::array::from_fn(|c| {
            let squares = binned::value(&self.radiance_squared[c], self.tops[3 + c]);
            let s2 = (squares / n - mean[c] * mean[c]).max(0.0) * n / (n - 1.0);
            s2 / n
        })
    }

    /// Mean albedo of the first surface, over all samples; 0 without.
    pub fn albedo(&self) -> [f32; 3] {
        self.mean_of_fixed(self.albedo)
    }

    /// Mean shading normal of the first surface, over all samples, not normalised; 0 without.
    pub fn normal(&self) -> [f32; 3] {
        self.mean_of_fixed(self.normal)
    }

    /// Mean distance to the first surface, over the samples that hit one; ∞ if none did.
    pub fn depth(&self) -> f32 {
        if self.hits == 0 {
            return f32::INFINITY;
        }
        (binned::value(&self.depth, self.tops[6]) / f64::from(self.hits)) as f32
    }

    fn mean_of_fixed(&self, sums: [i64; 3]) -> [f32; 3] {
        let n = f64::from(self.samples.max(1));
        sums.map(|s| (s as f64 / FIXED / n) as f32)
    }

    /// Adds a sample of finite radiance that is not negative.
    pub(super) fn add(&mut self, sample: &FilmSample) {
        self.samples += 1;
        for c in 0..3 {
            let l = f64::from(sample.radiance[c]);
            binned::add(&mut self.radiance[c], &mut self.tops[c], l);
            binned::add(&mut self.radiance_squared[c], &mut self.tops[3 + c], l * l);
        }
        if let Some(first) = &sample.first {
            self.hits += 1;
            if first.depth.is_finite() && first.depth > 0.0 {
                binned::add(&mut self.depth, &mut self.tops[6], f64::from(first.depth));
            }
            for c in 0..3 {
                self.albedo[c] += fixed(first.albedo[c]);
                self.normal[c] += fixed(first.normal[c]);
            }
        }
    }

    /// Adds the sums of other samples of the same pixel, fewer than 2³² with those that are here.
    pub fn merge(&mut self, other: &Self) {
        for c in 0..3 {
            let (own, tops) = (&mut self.radiance[c], &mut self.tops);
            binned::merge(own, &mut tops[c], (&other.radiance[c], other.tops[c]));
            let squares = (&other.radiance_squared[c], other.tops[3 + c]);
            binned::merge(&mut self.radiance_squared[c], &mut tops[3 + c], squares);
            self.albedo[c] += other.albedo[c];
            self.normal[c] += other.normal[c];
        }
        let depth = (&other.depth, other.tops[6]);
        binned::merge(&mut self.depth, &mut self.tops[6], depth);
        self.hits += other.hits;
        self.samples += other.samples;
    }

    /// Whether sums read from a file can be those of at most `count` samples.
    pub(super) fn is_sound(&self, count: u32) -> bool {
        let n = self.samples;
        let most = i64::from(n) << 31;
        let fixed = self.albedo.iter().chain(&self.normal);
        n <= count
            && self.hits <= n
            && (0..3).all(|c| binned::is_sound(&self.radiance[c], self.tops[c], n))
            && (0..3).all(|c| binned::is_sound(&self.radiance_squared[c], self.tops[3 + c], n))
            && binned::is_sound(&self.depth, self.tops[6], n)
            && fixed.into_iter().all(|s| (-most..=most).contains(s))
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
            sums.add(&s);
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
    fn parts_of_samples_add_up_to_the_bits_of_the_whole() {
        let samples: Vec<FilmSample> = (1..50_u16)
            .map(|k| sample(1.0 / f32::from(k * k), f32::from(k) * 0.1))
            .collect();
        let of = |samples: &[FilmSample]| {
            let mut sums = PixelSums::default();
            samples.iter().for_each(|s| sums.add(s));
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

    /// A pixel takes 200 bytes: the sums of radiance and its square 120, depth 16, albedo and normal 48, counts and places 16.
    #[test]
    fn a_pixel_is_small() {
        assert_eq!(size_of::<PixelSums>(), 200);
    }
}
