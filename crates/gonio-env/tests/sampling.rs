//! Sampling follows its density: χ², normalisation, coverage, and what the estimator converges to.

use gonio_env::{Environment, Layout};
use gonio_image::Image;
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;
use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{PI, TAU};

const GREY: fn(f32) -> [f32; 3] = |l| [l; 3];

fn noise(width: usize, height: usize, name: &str) -> Image {
    let mut rng = Rng::from_name(name);
    Image::from_fn(width, height, |_, _| {
        [rng.next_f32(), rng.next_f32(), rng.next_f32()]
    })
}

fn with_sun(mut image: Image, x: usize, y: usize, radiance: f32) -> Image {
    image.set(x, y, GREY(radiance));
    image
}

/// Every kind of picture, small enough for bins to resolve it.
fn cases() -> Vec<(&'static str, Environment)> {
    let lat_long =
        |image| Environment::from_image(image, Layout::LatLong).expect("a sound picture");
    let black = |w, h| Image::filled(w, h, [0.0; 3]);
    vec![
        ("uniform", Environment::uniform([1.0, 2.0, 3.0])),
        ("black", lat_long(black(4, 2))),
        ("1 × 1", lat_long(Image::filled(1, 1, [2.0; 3]))),
        ("noise 8 × 4", lat_long(noise(8, 4, "sampling 8x4"))),
        (
            "noise 5 × 3, turned",
            lat_long(noise(5, 3, "sampling 5x3")).rotated_deg(73.0),
        ),
        (
            "sun on noise, scaled",
            lat_long(with_sun(noise(16, 8, "sampling sun"), 5, 2, 300.0)).scaled([0.0, 2.0, 9.0]),
        ),
        (
            "one texel on black",
            lat_long(with_sun(black(16, 8), 0, 3, 1.0)),
        ),
        (
            "one texel at the zenith",
            lat_long(with_sun(black(8, 8), 7, 0, 1.0)),
        ),
        (
            "angular",
            Environment::from_image(noise(12, 12, "sampling angular"), Layout::Angular)
                .expect("a sound picture"),
        ),
        (
            "mirror ball",
            Environment::from_image(
                with_sun(noise(12, 12, "sampling ball"), 3, 4, 40.0),
                Layout::MirrorBall,
            )
            .expect("a sound picture"),
        ),
    ]
}

/// Bins equal in solid angle: longitude × y.
const COLUMNS: usize = 24;
const ROWS: usize = 16;

fn direction(turn: f64, y: f64) -> Vec3<f32> {
    let (sin, cos) = gonio_num::Real::sin_cos(TAU * turn);
    let r = (1.0 - y * y).sqrt();
    Vec3::new(r * sin, y, -r * cos).to_f32()
}

fn bin(d: Vec3<f32>) -> usize {
    let turn = (gonio_num::Real::atan2(f64::from(d.x), f64::from(-d.z)) / TAU).rem_euclid(1.0);
    let column = ((turn * COLUMNS as f64) as usize).min(COLUMNS - 1);
    let row = (((1.0 - f64::from(d.y)) * 0.5 * ROWS as f64) as usize).min(ROWS - 1);
    row * COLUMNS + column
}

/// Probability of each bin by the midpoint rule on n × n points, `pdf` being per steradian.
fn probabilities(pdf: impl Fn(Vec3<f32>) -> f64, n: usize) -> Vec<f64> {
    let solid_angle = 4.0 * PI / (COLUMNS * ROWS) as f64;
    let mut found = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let mut sum = 0.0;
            for j in 0..n {
                for i in 0..n {
                    let turn = (column as f64 + (i as f64 + 0.5) / n as f64) / COLUMNS as f64;
                    let y = 1.0 - 2.0 * (row as f64 + (j as f64 + 0.5) / n as f64) / ROWS as f64;
                    sum += pdf(direction(turn, y));
                }
            }
            found.push(sum / (n * n) as f64 * solid_angle);
        }
    }
    found
}

/// p-value of the counts, bins with an expectation below 5 pooled.
fn chi_squared(counts: &[u32], probabilities: &[f64], samples: u32) -> f64 {
    let (mut statistic, mut cells) = (0.0, 0);
    let (mut pooled_count, mut pooled) = (0.0, 0.0);
    for (count, p) in counts.iter().zip(probabilities) {
        let expected = p * f64::from(samples);
        if expected < 5.0 {
            pooled_count += f64::from(*count);
            pooled += expected;
        } else {
            statistic += (f64::from(*count) - expected).powi(2) / expected;
            cells += 1;
        }
    }
    if pooled >= 5.0 {
        statistic += (pooled_count - pooled).powi(2) / pooled;
        cells += 1;
    } else if pooled_count > 25.0 {
        // Samples where hardly any are expected.
        return 0.0;
    }
    ChiSquared::new(f64::from(cells - 1))
        .expect("two bins")
        .sf(statistic)
}

#[test]
fn samples_follow_the_density() {
    const SAMPLES: u32 = 200_000;
    let cases = cases();
    // Šidák: one false alarm in 1e4 runs of the whole list.
    let threshold = 1.0 - (1.0 - 1e-4_f64).powf(1.0 / cases.len() as f64);
    for (name, env) in cases {
        let mut rng = Rng::from_name(name);
        let mut counts = vec![0_u32; COLUMNS * ROWS];
        for _ in 0..SAMPLES {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            counts[bin(s.wi)] += 1;
        }
        // Bins are a fraction of a cell; midpoint error (1/16 of a bin)² is far below the noise 1/√(2e5/384).
        let pdf = |d: Vec3<f32>| f64::from(env.pdf(d));
        let p = chi_squared(&counts, &probabilities(pdf, 16), SAMPLES);
        assert!(p > threshold, "{name}: p = {p:e}");
        // Negative control: a density 5 % too large in the upper half and as much too small in the lower.
        let tilted = |d: Vec3<f32>| pdf(d) * if d.y > 0.0 { 1.05 } else { 0.95 };
        let p = chi_squared(&counts, &probabilities(tilted, 16), SAMPLES);
        assert!(p < threshold, "{name}: the control passed with p = {p:e}");
    }
}

#[test]
fn the_density_integrates_to_one() {
    for (name, env) in cases() {
        let total: f64 = probabilities(|d| f64::from(env.pdf(d)), 40).iter().sum();
        // Piecewise bilinear in the coordinates of the rule, kinks off its grid: (1/960 turn)² against cells of 1/16 turn.
        assert!((total - 1.0).abs() < 1e-3, "{name}: {total}");
    }
}

#[test]
fn a_sample_carries_exactly_its_radiance_and_density() {
    for (name, env) in cases() {
        let mut rng = Rng::from_name(name);
        for _ in 0..2000 {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            assert_eq!(s.pdf, env.pdf(s.wi), "{name}");
            assert_eq!(s.radiance, env.radiance(s.wi), "{name}");
            assert_eq!((s.radiance, s.pdf), env.radiance_and_pdf(s.wi), "{name}");
            assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{name}: {s:?}");
            assert!((s.wi.length() - 1.0).abs() < 1e-6, "{name}: {s:?}");
        }
    }
}

#[test]
fn the_ends_of_the_unit_square_are_sound() {
    let one = 1.0 - f32::EPSILON / 2.0;
    for (name, env) in cases() {
        for u in [0.0, f32::MIN_POSITIVE, 0.5, one] {
            for v in [0.0, f32::MIN_POSITIVE, 0.5, one] {
                let s = env.sample([u, v]);
                assert!(
                    s.wi.is_finite() && s.pdf.is_finite() && s.pdf > 0.0,
                    "{name} ({u}, {v}): {s:?}"
                );
            }
        }
    }
}

#[test]
fn light_is_never_without_density() {
    for (name, env) in cases() {
        let mut rng = Rng::from_name(name);
        let mut lit = 0;
        for _ in 0..20_000 {
            let d = direction(rng.next_f64(), 2.0 * rng.next_f64() - 1.0);
            let (radiance, pdf) = env.radiance_and_pdf(d);
            if radiance.into_iter().any(|l| l > 0.0) {
                lit += 1;
                assert!(pdf > 0.0, "{name}: {radiance:?} from {d:?}");
            }
            assert!(pdf >= 0.0 && pdf.is_finite(), "{name}: {pdf} at {d:?}");
        }
        assert!(lit > 100 || env.is_black(), "{name}: {lit}");
    }
}

#[test]
fn the_estimator_converges_to_the_irradiance() {
    const SAMPLES: u32 = 40_000;
    let n = Vec3::new(0.48, 0.6, -0.64);
    let cases = cases();
    for (name, env) in &cases {
        let mut rng = Rng::from_name(name);
        let (mut sum, mut squares) = (0.0, 0.0);
        for _ in 0..SAMPLES {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            let x = f64::from(s.radiance[1]) * f64::from(n.dot(s.wi).max(0.0)) / f64::from(s.pdf);
            sum += x;
            squares += x * x;
        }
        let count = f64::from(SAMPLES);
        let mean = sum / count;
        let error = ((squares / count - mean * mean) / count).sqrt();
        let expected = env.irradiance_with_error(n);
        // 4.9σ: one false alarm in 1e6, 1e5 over the list.
        let bound = 4.9 * error + 3.0 * expected.error[1];
        assert!(
            (mean - expected.value[1]).abs() <= bound,
            "{name}: {mean} ± {error} against {expected:?}"
        );
        if !env.is_black() && env.irradiance(n)[1] > 0.0 {
            // Negative control: 20 % too bright.
            assert!((1.2 * mean - expected.value[1]).abs() > bound, "{name}");
        }
    }
}

#[test]
fn black_is_black_and_still_sampled() {
    let black = Environment::from_image(Image::filled(3, 2, [0.0; 3]), Layout::LatLong).unwrap();
    assert!(black.is_black());
    assert!(Environment::uniform([0.0; 3]).is_black());
    assert!(Environment::uniform([1.0; 3]).scaled([0.0; 3]).is_black());
    let blue = Environment::uniform([0.0, 0.0, 1.0]);
    assert!(!blue.is_black());
    assert!(blue.scaled([1.0, 1.0, 0.0]).is_black());
    let s = black.sample([0.3, 0.7]);
    assert_eq!(s.radiance, [0.0; 3]);
    assert!((s.pdf - 0.25 / std::f32::consts::PI).abs() < 1e-8);
    assert_eq!(black.irradiance(Vec3::new(0.0, 1.0, 0.0)), [0.0; 3]);
}

#[test]
fn extreme_radiances_stay_finite() {
    let image = with_sun(Image::filled(8, 4, [1e-30; 3]), 3, 1, f32::MAX);
    for layout in [Layout::LatLong, Layout::Angular] {
        let image = if layout.is_disc() {
            with_sun(Image::filled(8, 8, [1e-30; 3]), 3, 3, f32::MAX)
        } else {
            image.clone()
        };
        let env = Environment::from_image(image, layout).unwrap();
        let mut rng = Rng::from_name("extreme");
        for _ in 0..1000 {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            assert!(
                s.pdf.is_finite() && s.pdf > 0.0 && s.radiance[0].is_finite(),
                "{layout}: {s:?}"
            );
        }
        assert!(env.irradiance(Vec3::new(0.0, 1.0, 0.0))[0].is_finite());
    }
}
