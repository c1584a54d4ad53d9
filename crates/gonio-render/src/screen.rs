//! [`Screen`]: how the samples of different pixels relate to each other.

/// How the samples of different pixels relate to each other.
///
/// By default ([`Screen::INDEPENDENT`]) every pixel has a sequence of its own. With [`Screen::blue_noise`] all pixels share one sequence: a pixel has
/// the 2^S points that come after those of the pixel before it along the Z-order curve. Points that are neighbours in an Owen-scrambled Sobol'
/// sequence complement each other, and neighbours along the curve are mostly neighbours on the screen: so are the errors of 2 × 2 pixels, of
/// 4 × 4, and so on. What is left of the noise after a blur, as an eye or a display far away does it, is much less; the error of each
/// pixel by itself is what it was. Source: Ahmed and Wonka 2020, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical
/// Ordering of Pixels"; the scramble of the sequence's order by nested binary digits stands for their shuffling of quadrants.
///
/// The points of one pixel are a scrambled Sobol' set as before, so the expectation of every pixel is what it was. Errors of pixels aren't
/// independent of each other any more.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Screen {
    /// S.
    log2_samples: u32,
}

impl Default for Screen {
    fn default() -> Self {
        Self::INDEPENDENT
    }
}

impl Screen {
    /// Every pixel by itself.
    pub const INDEPENDENT: Self = Self { log2_samples: 32 };

    /// Error as blue noise in pictures of this number of samples per pixel, rounded up to a power of two. Of another number of samples the
    /// error is no worse than that of independent pixels, but less blue.
    pub fn blue_noise(samples: u32) -> Self {
        let log2_samples = u64::from(samples.max(1)).next_power_of_two().ilog2();
        Self { log2_samples }
    }

    /// Whether every pixel is by itself.
    pub fn is_independent(self) -> bool {
        self == Self::INDEPENDENT
    }

    /// The sequence of sample `k` of a pixel, and the index in it.
    ///
    /// An index has 32 bits: S for the samples, the others for places on the curve. Where they don't suffice for the whole picture each square of as
    /// many pixels has a sequence of its own, and from sample 2^S on there are new ones.
    #[inline]
    pub(crate) fn place(self, width: u32, [x, y]: [u32; 2], k: u32) -> (u32, u32) {
        let side_bits = ((32 - self.log2_samples) / 2).min(16);
        let mask = (1 << side_bits) - 1;
        let curve = u64::from(interleaved(x & mask) | interleaved(y & mask) << 1);
        let across = width.div_ceil(1 << side_bits);
        let block = (y >> side_bits) * across + (x >> side_bits);
        let (within, later) = match 1_u32.checked_shl(self.log2_samples) {
            Some(count) => (k % count, k / count),
            None => (k, 0),
        };
        let index = (curve << self.log2_samples) as u32 | within;
        // Squares have numbers below 2³² / 4^side_bits: no later sequence is one of another square, in pictures that exist.
        (block.wrapping_add(later.wrapping_mul(0x9e37_79b1)), index)
    }
}

/// The 16 lower bits of `x` at the even places.
#[inline]
fn interleaved(x: u32) -> u32 {
    let mut x = x & 0xffff;
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::{SampleStream, SamplerKind};
    use std::collections::HashSet;

    #[test]
    fn no_two_samples_have_the_same_place() {
        for samples in [1, 5, 16, 1 << 22, 1 << 28] {
            let screen = Screen::blue_noise(samples);
            let mut seen = HashSet::new();
            for y in 0..33 {
                for x in 0..70 {
                    for k in (0..3).chain(samples..samples + 2) {
                        if k >= 3 || k < samples {
                            assert!(
                                seen.insert(screen.place(70, [x, y], k)),
                                "{samples} {x} {y} {k}"
                            );
                        }
                    }
                }
            }
        }
        assert_eq!(
            Screen::INDEPENDENT.place(70, [3, 2], u32::MAX),
            (143, u32::MAX)
        );
        assert_eq!(
            Screen::blue_noise(16).place(70, [3, 2], 5),
            (0, 0b1101 << 4 | 5)
        );
    }

    const SIDE: u32 = 64;

    /// Errors of the mean of a function over the samples of each pixel: a step, whose place is another in each of two directions.
    fn errors(screen: Screen, samples: u32, seed: u64) -> Vec<f64> {
        let mut out = Vec::new();
        for y in 0..SIDE {
            for x in 0..SIDE {
                let mut sum = 0.0;
                for k in 0..samples {
                    let (pixel, index) = screen.place(SIDE, [x, y], k);
                    let mut stream = SampleStream::new(SamplerKind::Sobol, seed, pixel, index);
                    stream.seek(4);
                    let [u, v] = stream.next_2d();
                    // ∫∫ [u + v/2 < 0.7] = ∫ min(1, 0.7 − v/2) dv = 0.45.
                    sum += f64::from(u8::from(u + 0.5 * v < 0.7));
                }
                out.push(sum / f64::from(samples) - 0.45);
            }
        }
        out
    }

    /// The variance of the means of squares of 8 × 8 pixels, times their number, over the variance of pixels: the power at the lowest frequencies
    /// over the mean power, 1 for white noise.
    fn share_at_low_frequencies(errors: &[f64]) -> f64 {
        let mut squares = 0.0;
        for top in (0..SIDE).step_by(8) {
            for left in (0..SIDE).step_by(8) {
                let mut sum = 0.0;
                for y in top..top + 8 {
                    for x in left..left + 8 {
                        sum += errors[(y * SIDE + x) as usize];
                    }
                }
                squares += sum * sum / 64.0;
            }
        }
        let all: f64 = errors.iter().map(|e| e * e).sum();
        squares / (all / 64.0)
    }

    /// The control is white: 64 squares tell the share to 1 ± √(2/64) = 18 %, four times that at most.
    #[test]
    fn the_error_is_blue() {
        for samples in [1, 4, 16] {
            let blue = share_at_low_frequencies(&errors(Screen::blue_noise(samples), samples, 1));
            let white = share_at_low_frequencies(&errors(Screen::INDEPENDENT, samples, 1));
            println!("{samples}: {blue:.3}, white {white:.3}");
            assert!(blue < 0.15, "{samples}: {blue}");
            assert!((0.3..1.8).contains(&white), "{samples}: {white}");
        }
    }

    /// Over many seeds each pixel's mean error is 0, by a z-test within 5 standard errors for each of 4096 pixels (false alarm 0.2 %), and pixels are
    /// as noisy as independent ones to 10 %. The control: the 5 % that a wrong integral would be off by.
    #[test]
    fn pixels_are_as_they_were_by_themselves() {
        let (mut sums, mut squares) = (vec![0.0; 4096], vec![0.0; 4096]);
        let mut alone = 0.0;
        let seeds = 300;
        for seed in 0..seeds {
            for (i, e) in errors(Screen::blue_noise(4), 4, seed)
                .into_iter()
                .enumerate()
            {
                sums[i] += e;
                squares[i] += e * e;
            }
            if seed < 20 {
                let all = errors(Screen::INDEPENDENT, 4, seed);
                alone += all.iter().map(|e| e * e).sum::<f64>() / 20.0;
            }
        }
        let n = seeds as f64;
        let z = |i: usize, off: f64| {
            let mean = sums[i] / n + off;
            mean / ((squares[i] / n - (sums[i] / n).powi(2)).max(1e-12) / n).sqrt()
        };
        let worst = (0..4096).map(|i| z(i, 0.0).abs()).fold(0.0, f64::max);
        assert!(worst < 5.0, "{worst}");
        let control = (0..4096).filter(|&i| z(i, 0.05).abs() > 5.0).count();
        assert!(control > 1000, "{control}");
        let ratio = squares.iter().sum::<f64>() / n / alone;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
}
