//! Sun and sky: what is known of daylight, conservation between the ways to ask, sampling.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use gonio_env::{Environment, LoadOptions, Sky, SkyOptions};
use gonio_num::{Real, Vec3};
use gonio_radiometry::colour::{RgbSpace, rgb_of_emission};
use gonio_radiometry::sequence::Rng;
use gonio_radiometry::spectrum::Spectrum;
use gonio_verify::statistics::{Moments, chi_square_test, t_test};
use std::f64::consts::PI;

const UP: Vec3<f32> = Vec3::new(0.0, 1.0, 0.0);

fn sky(words: &str) -> Environment {
    Environment::parse(&format!("sky:{words}"), &LoadOptions::default()).unwrap()
}

fn luminance(rgb: [f64; 3]) -> f64 {
    0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]
}

/// Illuminance of a horizontal surface under a clear sky with the sun 60° high: 80 to 120 klx by CIE and IES handbooks, of which the
/// sky gives 8 to 25 klx. This finds a wrong unit, not a wrong digit.
#[test]
fn a_clear_day_has_the_lux_that_it_should() {
    let lux = |words: &str| 683.002 * luminance(sky(words).irradiance(UP));
    let (both, sky_alone) = (lux("elevation=60"), lux("elevation=60,sun=off"));
    assert!((80e3..120e3).contains(&both), "{both}");
    assert!((8e3..25e3).contains(&sky_alone), "{sky_alone}");
    // Negative control: near sunset it is far less.
    assert!(lux("elevation=5") < 15e3);
}

/// The RGB tables are fits of their own, the spectral ones end at 320 and 720 nm: a few per cent between them.
#[test]
fn wavelengths_and_rgb_tell_the_same() {
    let options: SkyOptions = "elevation=40,turbidity=4".parse().unwrap();
    let sky = Sky::new(options).unwrap();
    let sun = options.sun_position.direction();
    for (d, limit) in [
        (Vec3::new(0.0, 1.0, 0.0), 0.03),
        (Vec3::new(0.6, 0.64, -0.48), 0.03),
        (Vec3::new(-0.8, 0.36, 0.48), 0.03),
        // Both come from the same table; products of two linear interpolations are not linear between 40 nm.
        (sun, 0.002),
    ] {
        let values = (0..=400).map(|nm| sky.spectral_radiance(d, 320.0 + f64::from(nm)));
        let spectrum = Spectrum::regular(320.0, 1.0, values.collect()).unwrap();
        let expected = luminance(rgb_of_emission(&spectrum, &RgbSpace::SRGB));
        let found = luminance(sky.radiance(d.to_f32()).map(f64::from));
        assert!(
            (found / expected - 1.0).abs() < limit,
            "{d:?}: {found} against {expected}"
        );
    }
    assert_eq!(sky.spectral_radiance(sun, 319.0), 0.0);
    assert_eq!(sky.spectral_radiance(-sun, 500.0), 0.0);
}

#[test]
fn a_panorama_of_it_lights_as_it_does() {
    let words = "elevation=50,azimuth=70,turbidity=2.5";
    let direct = sky(words);
    let picture = direct.sky().unwrap().panorama(256);
    let picture = Environment::from_image(picture, gonio_env::Layout::LatLong).unwrap();
    for n in [UP, Vec3::new(0.6, 0.0, -0.8), Vec3::new(0.0, -1.0, 0.0)] {
        let (a, b) = (direct.irradiance(n), picture.irradiance(n));
        for c in 0..3 {
            // A texel of the sun is blurred over two, 0.7°: the sun's cosine changes by 0.5 % at most.
            assert!(
                (a[c] / b[c] - 1.0).abs() < 0.01,
                "{n:?}: {a:?} against {b:?}"
            );
        }
    }
}

#[test]
fn the_ground_is_lit_by_the_sky() {
    let env = sky("elevation=30,albedo=0.5/0.25/0");
    let e = env.irradiance(UP);
    let ground = env.radiance(-UP);
    for (c, albedo) in [0.5, 0.25, 0.0].into_iter().enumerate() {
        assert!(
            (f64::from(ground[c]) - albedo * e[c] / PI).abs() < 2e-4 * e[c],
            "{ground:?} {e:?}"
        );
    }
    assert_eq!(sky("elevation=30,ground=off").radiance(-UP), [0.0; 3]);
}

const CASES: [&str; 5] = [
    "elevation=60",
    "elevation=3,azimuth=90,turbidity=7",
    "elevation=90,sky=off,ground=off",
    "elevation=35,sun=off",
    "elevation=20,sun=off,sky=off,ground=off",
];

#[test]
fn samples_carry_radiance_and_density_to_the_bit() {
    for words in CASES {
        let env = sky(words).rotated_deg(33.0);
        let mut rng = Rng::from_name(words);
        for _ in 0..2000 {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            assert_eq!(s.pdf, env.pdf(s.wi), "{words}");
            assert_eq!((s.radiance, s.pdf), env.radiance_and_pdf(s.wi), "{words}");
            assert!(s.pdf > 0.0 && s.pdf.is_finite(), "{words}: {s:?}");
        }
    }
}

/// Columns by longitude, rows by y: even in solid angle.
const BINS: [usize; 2] = [16, 12];

fn bin(d: Vec3<f32>) -> usize {
    let turn = Real::atan2(f64::from(d.x), f64::from(-d.z)) / (2.0 * PI) + 0.5;
    let x = ((turn * BINS[0] as f64) as usize).min(BINS[0] - 1);
    let y = (((1.0 - f64::from(d.y)) * 0.5 * BINS[1] as f64) as usize).min(BINS[1] - 1);
    y * BINS[0] + x
}

#[test]
fn samples_follow_the_density() {
    const SAMPLES: u64 = 100_000;
    for words in CASES {
        let env = sky(words);
        let sun = env.sky().unwrap().sun_position().direction().to_f32();
        let disc = 0.0047;
        // The disc is far smaller than a bin: its share is what the rest leaves of 1, as is the density under it.
        let outside = |d: Vec3<f32>| {
            if (d - sun).length() < disc {
                0.0
            } else {
                f64::from(env.pdf(d))
            }
        };
        let fine = 48;
        let mut expected = vec![0.0; BINS[0] * BINS[1]];
        let cells = [BINS[0] * fine, BINS[1] * fine];
        for k in 0..cells[0] * cells[1] {
            let turn = ((k % cells[0]) as f64 + 0.5) / cells[0] as f64 - 0.5;
            let y = 1.0 - 2.0 * ((k / cells[0]) as f64 + 0.5) / cells[1] as f64;
            let (s, c) = Real::sin_cos(2.0 * PI * turn);
            let r = (1.0 - y * y).sqrt();
            let d = Vec3::new(r * s, y, -r * c).to_f32();
            expected[bin(d)] += outside(d) * 4.0 * PI / (cells[0] * cells[1]) as f64;
        }
        let total: f64 = expected.iter().sum();
        let p = 1.0 - total;
        // Without a sun that shines the density integrates to 1 by itself.
        if words.contains("sun=off") {
            assert!(p.abs() < 2e-3, "{words}: {p}");
        }
        let scale = SAMPLES as f64;
        let sun_bin = bin(sun);
        expected[sun_bin] += p;
        let mut expected: Vec<f64> = expected.iter().map(|e| e.max(0.0) * scale).collect();
        let mut rng = Rng::from_name(words);
        let mut counts = vec![0_u64; expected.len()];
        for _ in 0..SAMPLES {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            // A sun on the border of bins counts for one of them.
            counts[if (s.wi - sun).length() < disc {
                sun_bin
            } else {
                bin(s.wi)
            }] += 1;
        }
        let found = chi_square_test(&counts, &expected, 5.0);
        assert!(found.p_value > 1e-5, "{words}: {found:?}");
        // Negative control: a density 10 % too large above, as much too small below.
        let half = expected.len() / 2;
        let tilt = |k: usize| if k % BINS[0] < BINS[0] / 2 { 1.1 } else { 0.9 };
        for (k, e) in expected.iter_mut().enumerate().take(half) {
            *e *= tilt(k);
        }
        if !words.contains("sky=off") {
            let found = chi_square_test(&counts, &expected, 5.0);
            assert!(
                found.p_value < 1e-5,
                "{words}: the control passed: {found:?}"
            );
        }
    }
}

#[test]
fn the_estimator_converges_to_the_irradiance() {
    for words in ["elevation=60", "elevation=8,turbidity=6"] {
        let env = sky(words);
        let n = Vec3::new(0.48, 0.6, 0.64);
        let mut rng = Rng::from_name(words);
        let mut moments = Moments::new();
        for _ in 0..40_000 {
            let s = env.sample([rng.next_f32(), rng.next_f32()]);
            moments.push(
                f64::from(s.radiance[1]) * f64::from(n.dot(s.wi).max(0.0)) / f64::from(s.pdf),
            );
        }
        let expected = env.irradiance(n)[1];
        let found = t_test(&moments, expected);
        assert!(
            found.p_value > 1e-5,
            "{words}: {} against {expected}: {found:?}",
            moments.mean()
        );
        assert!(
            t_test(&moments, 1.05 * expected).p_value < 1e-5,
            "{words}: the control passed"
        );
    }
}
