//! Against NVIDIA's evaluator: the pictures are made of integers alone, so that both programs get the same bits; its
//! results (flip-evaluator 1.7, float32) are the constants below.

use super::*;
use crate::difference::{FlipMode, Options, compare, compare_with};
use crate::srgb;

const WIDTH: usize = 96;
const HEIGHT: usize = 64;

fn hash(x: usize, y: usize, c: usize) -> u32 {
    let mut v = (x as u32).wrapping_mul(73_856_093)
        ^ (y as u32).wrapping_mul(19_349_663)
        ^ (c as u32).wrapping_mul(83_492_791);
    v ^= v >> 13;
    v = v.wrapping_mul(0x5bd1_e995);
    v ^ (v >> 15)
}

/// Ramps under a checkerboard, and the same with noise of ±20 codes.
fn ldr_pair() -> (Image, Image) {
    let code = |x: usize, y: usize, c: usize| {
        let ramp = (x * 3 + y * (c + 1)) & 255;
        if (x / 8 + y / 8) & 1 == 1 {
            ramp / 2
        } else {
            ramp
        }
    };
    let colour = |f: &dyn Fn(usize) -> usize| -> [f32; 3] {
        std::array::from_fn(|c| srgb::decode8(f(c) as u8))
    };
    let reference = Image::from_fn(WIDTH, HEIGHT, |x, y| colour(&|c| code(x, y, c)));
    let picture = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        colour(&|c| {
            let noisy = (code(x, y, c) + (hash(x, y, c) % 41) as usize).saturating_sub(20);
            noisy.min(255)
        })
    });
    (picture, reference)
}

/// Blocks of many brightnesses with a sun 256 times as bright, and the same with noise of ±1/4.
fn hdr_pair() -> (Image, Image) {
    let value = |x: usize, y: usize, c: usize| {
        let (dx, dy) = (x as i32 - 30, y as i32 - 20);
        let sun = if dx * dx + dy * dy < 100 { 256.0 } else { 1.0 };
        (1 + hash(x / 4, y / 4, c) % 16) as f32 / 16.0 * sun
    };
    let reference = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        std::array::from_fn(|c| value(x, y, c))
    });
    let picture = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        std::array::from_fn(|c| {
            let noise = 1.0 + ((hash(x, y, c + 7) % 9) as f32 - 4.0) / 16.0;
            value(x, y, c) * noise
        })
    });
    (picture, reference)
}

/// Single pixels: both programs compute in `f32` with other functions for powers, and a pixel is not an average.
fn near(found: f32, expected: f32) {
    assert!((found - expected).abs() < 1e-3, "{found} and {expected}");
}

#[test]
fn ldr_agrees_with_the_reference_evaluator() {
    let (picture, reference) = ldr_pair();
    let d = compare(&picture, &reference).unwrap();
    assert_eq!(d.flip, FlipKind::Ldr);
    assert!((d.flip_mean - 0.096_125_61).abs() < 2e-5, "{}", d.flip_mean);
    near(d.flip_map[10 * WIDTH + 10], 0.049_817_55);
    near(d.flip_map[40 * WIDTH + 70], 0.060_280_47);
}

#[test]
fn ldr_agrees_at_another_distance_and_with_large_differences() {
    let (noisy, reference) = ldr_pair();
    let picture = Image::from_fn(WIDTH, HEIGHT, |x, y| noisy.get((x + WIDTH - 3) % WIDTH, y));
    let options = Options {
        flip: FlipMode::Ldr,
        pixels_per_degree: 30.0,
    };
    let d = compare_with(&picture, &reference, &options).unwrap();
    assert!((d.flip_mean - 0.479_462_3).abs() < 2e-5, "{}", d.flip_mean);
    near(d.flip_map[10 * WIDTH + 10], 0.352_387_07);
}

#[test]
fn hdr_agrees_with_the_reference_evaluator() {
    let (picture, reference) = hdr_pair();
    let d = compare(&picture, &reference).unwrap();
    let FlipKind::Hdr {
        start_ev,
        stop_ev,
        exposures,
    } = d.flip
    else {
        panic!("values above 1 ask for HDR-FLIP, not {:?}", d.flip);
    };
    assert!((start_ev + 6.856_888).abs() < 1e-4, "{start_ev}");
    assert!((stop_ev - 1.959_300).abs() < 1e-4, "{stop_ev}");
    assert_eq!(exposures, 9);
    assert!((d.flip_mean - 0.106_317_42).abs() < 2e-5, "{}", d.flip_mean);
    near(d.flip_map[10 * WIDTH + 10], 0.077_138_6);
    near(d.flip_map[20 * WIDTH + 30], 0.107_206_81);
}

#[test]
fn bounds_and_black() {
    let black = Image::new(8, 8);
    let white = Image::filled(8, 8, [1.0; 3]);
    for (a, b) in [(&black, &white), (&white, &black)] {
        let d = compare(a, b).unwrap();
        assert!(d.flip_mean > 0.9 && d.flip_mean <= 1.0, "{}", d.flip_mean);
    }
    // A black reference, and one whose median is black, under HDR-FLIP.
    let mut spark = Image::new(8, 8);
    spark.set(3, 3, [1e6; 3]);
    for (a, b) in [(&spark, &black), (&black, &spark), (&spark, &spark)] {
        let d = compare(a, b).unwrap();
        assert!(matches!(d.flip, FlipKind::Hdr { .. }));
        assert!(d.flip_map.iter().all(|e| (0.0..=1.0).contains(e)));
        assert_eq!(d.flip_mean == 0.0, std::ptr::eq(a, b));
    }
}
