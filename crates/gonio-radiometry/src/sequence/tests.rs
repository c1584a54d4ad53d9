//! The sequences: exact stratification, uniformity, independence, reproducibility.

use super::*;
use crate::testing::{LIMIT, chi_squared};

const KINDS: [SamplerKind; 2] = [SamplerKind::Independent, SamplerKind::Sobol];

/// The draws of one sample, as a renderer makes them: 2, 1, 3, 2, 2, 1, 3 numbers.
fn draws(stream: &mut SampleStream) -> Vec<f32> {
    let mut all = Vec::new();
    all.extend(stream.next_2d());
    all.push(stream.next_1d());
    all.extend(stream.next_3d());
    all.extend(stream.next_2d());
    all.extend(stream.next_2d());
    all.push(stream.next_1d());
    all.extend(stream.next_3d());
    all
}

fn cell(x: f32, cells: u32) -> usize {
    (x * cells as f32) as usize
}

/// Whether each elementary box of volume 2^-(k − t) holds 2^t of the 2^k points, in D dimensions.
fn is_net<const D: usize>(points: &[[f32; D]], t: u32) -> bool {
    let m = points.len().ilog2() - t;
    let mut shape = [0; D];
    // All ways to write m as a sum of D numbers.
    let mut shapes = Vec::new();
    fn split<const D: usize>(d: usize, rest: u32, shape: &mut [u32; D], out: &mut Vec<[u32; D]>) {
        if d + 1 == D {
            shape[d] = rest;
            out.push(*shape);
            return;
        }
        for here in 0..=rest {
            shape[d] = here;
            split(d + 1, rest - here, shape, out);
        }
    }
    split(0, m, &mut shape, &mut shapes);
    shapes.iter().all(|shape| {
        let mut counts = vec![0u32; 1 << m];
        for p in points {
            let mut index = 0;
            for d in 0..D {
                index = (index << shape[d]) | cell(p[d], 1 << shape[d]);
            }
            counts[index] += 1;
        }
        counts.iter().all(|&c| c == 1 << t)
    })
}

#[test]
fn sets_of_two_dimensions_are_nets_in_every_block() {
    for (pixel, dimension) in [(0, 0), (17, 2), (1 << 31, 9), (u32::MAX, 40)] {
        for k in [0, 1, 2, 5, 8, 10] {
            for block in [0u32, 1, 5] {
                let points: Vec<[f32; 2]> = (0..1 << k)
                    .map(|i| {
                        let sample = (block << k) + i;
                        let mut s = SampleStream::new(SamplerKind::Sobol, 3, pixel, sample);
                        s.seek(dimension);
                        s.next_2d()
                    })
                    .collect();
                assert!(
                    is_net(&points, 0),
                    "pixel {pixel}, 2^{k} samples, block {block}"
                );
            }
        }
    }
}

#[test]
fn sets_of_three_dimensions_are_nets_of_quality_one() {
    for pixel in [0, 5, 1_000_000] {
        for k in [1, 3, 6, 9] {
            let points: Vec<[f32; 3]> = (0..1 << k)
                .map(|i| SampleStream::new(SamplerKind::Sobol, 1, pixel, i).next_3d())
                .collect();
            assert!(is_net(&points, 1), "pixel {pixel}, 2^{k} samples");
            let [x, y, z] = [0, 1, 2].map(|d| points.iter().map(|p| [p[d]]).collect::<Vec<_>>());
            assert!(is_net(&x, 0) && is_net(&y, 0) && is_net(&z, 0));
            let pairs: Vec<_> = points.iter().map(|p| [p[0], p[1]]).collect();
            assert!(is_net(&pairs, 0));
        }
    }
}

/// The negative control of the two tests above.
#[test]
fn independent_numbers_and_mixed_sets_are_no_nets() {
    let independent: Vec<_> = (0..64)
        .map(|i| SampleStream::new(SamplerKind::Independent, 3, 0, i).next_2d())
        .collect();
    assert!(!is_net(&independent, 0));
    let across_sets: Vec<_> = (0..64)
        .map(|i| {
            let mut s = SampleStream::new(SamplerKind::Sobol, 3, 0, i);
            [s.next_1d(), s.next_1d()]
        })
        .collect();
    assert!(!is_net(&across_sets, 0));
}

#[test]
fn values_are_below_one_and_depend_on_nothing_else() {
    for kind in KINDS {
        for (seed, pixel, sample) in [(0, 0, 0), (u64::MAX, u32::MAX, u32::MAX), (9, 4, 77)] {
            let mut stream = SampleStream::new(kind, seed, pixel, sample);
            let first = draws(&mut stream);
            assert_eq!(stream.dimension(), 14);
            assert!(first.iter().all(|x| (0.0..1.0).contains(x)));
            assert_eq!(
                first,
                draws(&mut SampleStream::new(kind, seed, pixel, sample))
            );
            stream.seek(3);
            assert_eq!(stream.next_3d()[..], first[3..6]);
            stream.seek(u32::MAX);
            assert!(stream.next_3d().iter().all(|x| (0.0..1.0).contains(x)));
            assert_eq!(stream.dimension(), 2);
        }
    }
    assert_eq!(unit_f32(u32::MAX), 1.0 - f32::EPSILON / 2.0);
}

/// The same bits on every machine, for ever: images depend on them.
#[test]
fn the_first_values_are_pinned() {
    let bits = |kind, seed, pixel, sample| {
        let mut s = SampleStream::new(kind, seed, pixel, sample);
        let (a, b, c) = (s.next_1d(), s.next_2d(), s.next_3d());
        [a, b[0], b[1], c[0], c[1], c[2]].map(|x| (x * 16_777_216.0) as u32)
    };
    assert_eq!(
        bits(SamplerKind::Sobol, 0, 0, 0),
        [
            1_042_870, 2_421_037, 4_170_631, 3_960_479, 10_299_712, 12_416_058
        ]
    );
    assert_eq!(
        bits(SamplerKind::Sobol, 7, 1234, 99),
        [
            1_388_283, 12_892, 13_902_865, 9_697_409, 14_577_529, 15_922_213
        ]
    );
    assert_eq!(
        bits(SamplerKind::Independent, 0, 0, 0),
        [
            5_051_091, 14_032_247, 7_752_441, 11_483_652, 10_658_373, 4_070_883
        ]
    );
    assert_eq!(
        bits(SamplerKind::Independent, 7, 1234, 99),
        [
            5_539_480, 10_968_395, 10_396_228, 882_048, 7_815_199, 10_451_714
        ]
    );
    let mut rng = Rng::from_name("pinned");
    assert_eq!(
        [rng.next_u64(), rng.next_u64()],
        [8_940_917_530_143_955_576, 2_167_551_369_761_744_207]
    );
}

/// χ² of pairs of values over an 8 × 8 grid, for every pair out of a collection: dimensions of one pixel, one dimension
/// of neighbouring pixels, samples and seeds. `points` gives the vector of values of item i.
fn worst_pair(count: u32, points: impl Fn(u32) -> Vec<f32>) -> f64 {
    let all: Vec<Vec<f32>> = (0..count).map(points).collect();
    let expected = vec![f64::from(count) / 64.0; 64];
    let mut worst = f64::NEG_INFINITY;
    for a in 0..all[0].len() {
        for b in 0..a {
            let mut counts = vec![0.0; 64];
            for values in &all {
                counts[cell(values[a], 8) * 8 + cell(values[b], 8)] += 1.0;
            }
            worst = worst.max(chi_squared(&counts, &expected));
        }
    }
    worst
}

/// Over pixels, the numbers of one fixed sample are independent uniform numbers in every dimension and between dimensions.
#[test]
fn dimensions_are_independent_over_pixels() {
    for kind in KINDS {
        for (seed, sample) in [(0, 0), (1, 1), (12345, 1000)] {
            let deviation = worst_pair(6400, |pixel| {
                draws(&mut SampleStream::new(kind, seed, pixel, sample))
            });
            assert!(deviation < LIMIT, "{kind:?} {deviation}");
        }
    }
}

#[test]
fn neighbouring_pixels_samples_and_seeds_are_independent() {
    for kind in KINDS {
        let deviation = worst_pair(6400, |i| {
            let value = |seed: u64, pixel: u32, sample: u32| {
                let mut s = SampleStream::new(kind, seed, pixel, sample);
                s.seek(2);
                s.next_2d()
            };
            // Not two samples of one pixel under Sobol': those are stratified, which isn't independent.
            [
                value(i.into(), 7, 3),
                value(u64::from(i) + 100_000, 7, 3),
                value(i.into(), 8, 3),
                value(u64::from(i) << 32, 7, 3),
                value(0, 2 * i, 3),
                value(0, 2 * i + 1, 3),
                value(0, 2 * i + 1920, 4),
            ]
            .concat()
        });
        assert!(deviation < LIMIT, "{kind:?} {deviation}");
    }
}

/// Within one pixel, draws of different sets pair like independent ones: no worse than chance.
#[test]
fn padded_sets_are_independent_within_a_pixel() {
    for pixel in 0..4 {
        let deviation = worst_pair(8192, |sample| {
            let mut s = SampleStream::new(SamplerKind::Sobol, 5, pixel, sample);
            (0..12).map(|_| s.next_1d()).collect()
        });
        assert!(deviation < LIMIT, "{deviation}");
    }
}

/// Numbers that follow from each other, strongly or weakly, are caught: the negative control of the tests above.
#[test]
fn dependent_numbers_are_caught() {
    for share in [0.0, 0.5, 0.9] {
        let deviation = worst_pair(6400, |pixel| {
            let mut s = SampleStream::new(SamplerKind::Sobol, 0, pixel, 5);
            let [a, b] = s.next_2d();
            vec![a, ((1.0 - share) * a + share * b).fract()]
        });
        assert!(deviation > LIMIT, "{share}: {deviation}");
    }
}

/// Scrambling makes the error of n samples of a smooth integrand fall faster than n^(-1/2): that is what it's for.
#[test]
fn sobol_integrates_better_than_chance() {
    let rms = |kind| {
        let mut squares = 0.0;
        for pixel in 0..64 {
            let sum: f64 = (0..256)
                .map(|i| {
                    let [x, y] = SampleStream::new(kind, 11, pixel, i)
                        .next_2d()
                        .map(f64::from);
                    gonio_num::Real::exp(-x * y) + x
                })
                .sum();
            // ∫ e^(−xy) = Σ (−1)ᵏ / ((k+1)² k!)
            let exact = 0.796_599_599_297_053_1 + 0.5;
            squares += (sum / 256.0 - exact).powi(2);
        }
        (squares / 64.0).sqrt()
    };
    let (sobol, independent) = (rms(SamplerKind::Sobol), rms(SamplerKind::Independent));
    assert!(sobol < 0.05 * independent, "{sobol} {independent}");
    // Plain Monte Carlo: σ ≈ 0.196 over √256.
    assert!((0.008..0.017).contains(&independent), "{independent}");
}

#[test]
fn the_generator_is_uniform_in_every_byte() {
    let mut rng = Rng::from_name("the_generator_is_uniform_in_every_byte");
    let mut counts = vec![vec![0.0; 256]; 8];
    let n = 100_000;
    for _ in 0..n {
        for (k, byte) in rng.next_u64().to_le_bytes().into_iter().enumerate() {
            counts[k][usize::from(byte)] += 1.0;
        }
    }
    let expected = vec![f64::from(n) / 256.0; 256];
    for byte in &counts {
        assert!(chi_squared(byte, &expected) < LIMIT);
    }
    let seeds = worst_pair(6400, |i| {
        let mut a = Rng::from_seed(i.into());
        let mut b = Rng::from_seed(u64::from(i) + 1);
        // The last bits of an f64 may round up to 1 in f32.
        let wide = (b.next_f64() as f32).min(0.999);
        vec![a.next_f32(), a.next_f32(), b.next_f32(), wide]
    });
    assert!(seeds < LIMIT, "{seeds}");
    assert_ne!(Rng::from_name("a"), Rng::from_name("b"));
}

/// Parts of a block of samples are a net, and so are those of each sample. Of the numbers of one sample and of its parts no two are alike, where an
/// index has no digits left either. The control: parts of three, which aren't stratified within a sample.
#[test]
fn parts_of_samples_are_stratified_together() {
    let parts = |sample: u32, count| {
        let stream = SampleStream::new(SamplerKind::Sobol, 3, 17, sample);
        (0..count).map(move |which| {
            let mut part = stream.split(count, which);
            part.seek(9);
            part.next_2d()
        })
    };
    let all: Vec<_> = (16..32).flat_map(|k| parts(k, 4)).collect();
    assert!(is_net(&all, 0));
    assert!(all.chunks(4).all(|each| is_net(each, 0)));
    let threes: Vec<_> = (0..64).flat_map(|k| parts(k, 3).take(2)).collect();
    assert!(!threes.chunks(2).all(|each| is_net(each, 0)));
    for kind in KINDS {
        let mut seen = std::collections::HashSet::new();
        for sample in [0, 1, 1 << 29, 1 << 30, 1 << 31, u32::MAX] {
            let stream = SampleStream::new(kind, 3, 17, sample);
            assert_eq!(stream.split(1, 0), stream);
            for which in 0..8 {
                let mut part = stream.split(8, which);
                let bits = draws(&mut part)
                    .iter()
                    .map(|x| x.to_bits())
                    .collect::<Vec<_>>();
                assert!(seen.insert(bits), "{kind:?}, part {which} of {sample}");
            }
        }
    }
}
