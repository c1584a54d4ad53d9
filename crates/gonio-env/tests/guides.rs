//! Methods and guides of sampling: each follows its density, which integrates to what is drawn, and gives the irradiance.
#![allow(clippy::unwrap_used, reason = "a test may fail")]

use gonio_env::{Environment, Guide, Layout, SamplingMethod};
use gonio_image::Image;
use gonio_num::{Real, Vec3};
use gonio_radiometry::sequence::Rng;
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use gonio_verify::statistics::{Moments, chi_square_test, sidak, t_test};
use std::f64::consts::{PI, TAU};

const METHODS: [SamplingMethod; 3] = [
    SamplingMethod::Inversion,
    SamplingMethod::Hierarchical,
    SamplingMethod::Alias,
];

fn noise(layout: Layout, width: usize, height: usize, sun: f32) -> Environment {
    let mut rng = Rng::from_name(&format!("guides {width} {height}"));
    let mut image = Image::from_fn(width, height, |_, _| {
        [rng.next_f32(), rng.next_f32(), rng.next_f32()]
    });
    image.set(width / 3, height / 3, [sun; 3]);
    Environment::from_image(image, layout).unwrap()
}

fn cases() -> Vec<(&'static str, Environment)> {
    let mut half = Image::filled(12, 6, [0.0; 3]);
    for x in 0..12 {
        for y in 0..3 {
            half.set(x, y, [1.0 + x as f32, 1.0, 0.5]);
        }
    }
    vec![
        ("one texel", noise(Layout::LatLong, 1, 1, 2.0)),
        (
            "sun",
            noise(Layout::LatLong, 16, 8, 20.0)
                .rotated_deg(40.0)
                .scaled([1.0, 2.0, 3.0]),
        ),
        ("odd sizes", noise(Layout::LatLong, 33, 17, 5.0)),
        (
            "dark ground",
            Environment::from_image(half, Layout::LatLong).unwrap(),
        ),
        ("angular", noise(Layout::Angular, 12, 12, 5.0)),
        ("uniform", Environment::uniform([1.0, 2.0, 0.5])),
    ]
}

const NORMALS: [Vec3<f32>; 3] = [
    Vec3::new(0.0, 1.0, 0.0),
    Vec3::new(0.48, -0.6, 0.64),
    Vec3::new(-0.8, 0.0, -0.6),
];

/// Bins even in solid angle: columns by longitude, rows by y.
const BINS: [usize; 2] = [20, 12];

fn bin(d: Vec3<f32>) -> usize {
    let turn = (Real::atan2(f64::from(d.x), f64::from(-d.z)) / TAU).rem_euclid(1.0);
    let x = ((turn * BINS[0] as f64) as usize).min(BINS[0] - 1);
    let y = (((1.0 - f64::from(d.y)) * 0.5 * BINS[1] as f64) as usize).min(BINS[1] - 1);
    y * BINS[0] + x
}

/// Probabilities of the bins by 40 × 40 jittered points each: where the density jumps midpoints would err to one side.
fn probabilities(pdf: impl Fn(Vec3<f32>) -> f32) -> Vec<f64> {
    const FINE: usize = 40;
    let mut rng = Rng::from_name("jitter");
    let cells = [BINS[0] * FINE, BINS[1] * FINE];
    let mut found = vec![0.0; BINS[0] * BINS[1]];
    for k in 0..cells[0] * cells[1] {
        let (i, j) = (k % cells[0], k / cells[0]);
        let y = 1.0 - 2.0 * (j as f64 + rng.next_f64()) / cells[1] as f64;
        let (sin, cos) = Real::sin_cos(TAU * (i as f64 + rng.next_f64()) / cells[0] as f64);
        let r = (1.0 - y * y).sqrt();
        let d = Vec3::new(r * sin, y, -r * cos).to_f32();
        found[j / FINE * BINS[0] + i / FINE] +=
            f64::from(pdf(d)) * 4.0 * PI / (cells[0] * cells[1]) as f64;
    }
    found
}

/// Samples follow the density, and those that are not drawn are what it lacks to 1.
fn follows(env: &Environment, guide: Guide, name: &str, tests: u64) {
    const SAMPLES: u32 = 60_000;
    let expected = probabilities(|d| env.pdf_by(guide, d));
    let mut rng = Rng::from_name(name);
    let mut counts = vec![0_u64; expected.len()];
    let mut lost = 0_u64;
    for _ in 0..SAMPLES {
        let s = env.sample_by(guide, [rng.next_f32(), rng.next_f32()]);
        assert!(
            s.pdf.is_finite() && (s.wi.length() - 1.0).abs() < 1e-6,
            "{name}: {s:?}"
        );
        if s.pdf > 0.0 {
            assert_eq!(s.pdf, env.pdf_by(guide, s.wi), "{name}: {s:?}");
            assert_eq!(s.radiance, env.radiance(s.wi), "{name}");
            counts[bin(s.wi)] += 1;
        } else {
            lost += 1;
        }
    }
    let total: f64 = expected.iter().sum();
    let lost_share = f64::from(lost as u32) / f64::from(SAMPLES);
    // Jitter at the edges of patches: of a cell 15 points wide that holds a third of all, 1/3 · 1/15 · 1/√15. 5 σ of a share besides.
    let sigma = (lost_share * (1.0 - lost_share) / f64::from(SAMPLES)).sqrt();
    assert!(
        (total + lost_share - 1.0).abs() < 6e-3 + 5.0 * sigma,
        "{name}: {total} + {lost_share}"
    );
    let scaled = |tilt: f64| -> Vec<f64> {
        let factor = |k: usize| {
            if k.is_multiple_of(2) {
                1.0 + tilt
            } else {
                1.0 - tilt
            }
        };
        let raw: Vec<f64> = expected
            .iter()
            .enumerate()
            .map(|(k, e)| e * factor(k))
            .collect();
        let drawn = f64::from(SAMPLES) * (1.0 - lost_share);
        let sum: f64 = raw.iter().sum();
        raw.iter().map(|e| e / sum * drawn).collect()
    };
    let level = sidak(1e-4, tests);
    let found = chi_square_test(&counts, &scaled(0.0), 5.0);
    assert!(found.p_value > level, "{name}: {found:?}");
    // Negative control: 10 % more in every other column.
    let control = chi_square_test(&counts, &scaled(0.1), 5.0);
    assert!(
        control.p_value < level,
        "{name}: the control passed: {control:?}"
    );
}

#[test]
fn every_method_follows_the_density() {
    for (name, env) in cases() {
        for method in METHODS {
            let env = env.clone().with_sampling_method(method);
            follows(&env, Guide::Luminance, &format!("{name} {method:?}"), 18);
        }
    }
}

#[test]
fn methods_have_one_density() {
    for (name, env) in cases() {
        let mut rng = Rng::from_name(name);
        for _ in 0..500 {
            let d = env.sample([rng.next_f32(), rng.next_f32()]).wi;
            let pdfs = METHODS.map(|m| env.clone().with_sampling_method(m).pdf(d));
            assert!(pdfs.iter().all(|p| *p == pdfs[0]), "{name}: {pdfs:?}");
        }
    }
}

#[test]
fn what_exceeds_the_mean_is_followed() {
    for (name, env) in cases() {
        for method in METHODS {
            let env = env.clone().with_sampling_method(method);
            follows(
                &env,
                Guide::Compensated,
                &format!("{name} {method:?} compensated"),
                18,
            );
        }
    }
}

#[test]
fn light_times_cosine_is_followed() {
    for (name, env) in cases() {
        for n in NORMALS {
            follows(&env, Guide::Cosine(n), &format!("{name} {n:?}"), 18);
        }
    }
}

#[test]
fn the_ends_of_the_unit_square_are_sound() {
    let one = 1.0 - f32::EPSILON / 2.0;
    for (name, env) in cases() {
        for method in METHODS {
            let env = env.clone().with_sampling_method(method);
            for guide in [
                Guide::Luminance,
                Guide::Compensated,
                Guide::Cosine(NORMALS[1]),
            ] {
                for k in 0..16 {
                    let end = |k: usize| [0.0, f32::MIN_POSITIVE, 0.5, one][k % 4];
                    let s = env.sample_by(guide, [end(k), end(k / 4)]);
                    assert!(
                        s.wi.is_finite() && s.pdf.is_finite(),
                        "{name} {method:?} {guide:?}: {s:?}"
                    );
                }
            }
        }
    }
}

/// No light above the horizon is without density.
#[test]
fn a_normal_covers_its_hemisphere() {
    for (name, env) in cases() {
        for n in NORMALS {
            let mut rng = Rng::from_name(name);
            for _ in 0..5000 {
                let d = Environment::uniform([1.0; 3])
                    .sample([rng.next_f32(), rng.next_f32()])
                    .wi;
                let pdf = env.pdf_by(Guide::Cosine(n), d);
                if n.dot(d) > 0.0 && env.pdf(d) > 0.0 {
                    assert!(pdf > 0.0, "{name} {n:?} {d:?}");
                }
            }
        }
    }
}

/// Mean and variance of the green irradiance estimated by one sample.
fn estimate(n: Vec3<f32>, name: &str, mut one: impl FnMut(&mut Rng) -> f64) -> Moments {
    let mut rng = Rng::from_name(&format!("{name} {n:?}"));
    let mut moments = Moments::new();
    for _ in 0..20_000 {
        moments.push(one(&mut rng));
    }
    moments
}

fn term(radiance: [f32; 3], n: Vec3<f32>, d: Vec3<f32>, pdf: f32) -> f64 {
    if pdf > 0.0 {
        f64::from(radiance[1]) * f64::from(n.dot(d).max(0.0)) / f64::from(pdf)
    } else {
        0.0
    }
}

/// Joined with cosine sampling by the balance heuristic, what exceeds the mean is unbiased, and of no more variance than plain
/// luminance so joined.
#[test]
fn compensation_is_for_two_strategies() {
    for (name, env) in cases() {
        for n in NORMALS {
            let truth = env.irradiance(n)[1];
            let joined = |guide: Guide| {
                estimate(n, name, |rng| {
                    let u = |rng: &mut Rng| [rng.next_f32(), rng.next_f32()];
                    let cosine =
                        |d: Vec3<f32>| cosine_hemisphere_density(Vec3::new(0.0, 0.0, n.dot(d)));
                    let a = env.sample_by(guide, u(rng));
                    let d = gonio_num::Frame::from_normal(n).to_world(cosine_hemisphere(u(rng)));
                    // Balance: f / (sum of the densities).
                    term(a.radiance, n, a.wi, a.pdf + cosine(a.wi))
                        + term(env.radiance(d), n, d, env.pdf_by(guide, d) + cosine(d))
                })
            };
            let (plain, sharp) = (joined(Guide::Luminance), joined(Guide::Compensated));
            assert!(
                t_test(&sharp, truth).p_value > 1e-5,
                "{name} {n:?}: {} against {truth}",
                sharp.mean()
            );
            if truth > 0.0 {
                assert!(
                    t_test(&sharp, 1.1 * truth).p_value < 1e-5,
                    "{name}: the control passed"
                );
            }
            // Of light all over the sphere, for which the formula is made, there is less variance; 20,000 samples tell variances
            // apart by some per cent.
            if name == "sun" || name == "odd sizes" {
                let (sharp, plain) = (sharp.variance(), plain.variance());
                assert!(sharp < 1.1 * plain, "{name} {n:?}: {sharp} {plain}");
            }
        }
        // Alone it would be biased: much light is without density.
        if name == "odd sizes" {
            let mut rng = Rng::from_name(name);
            let missed = (0..1000).filter(|_| {
                let d = env.sample([rng.next_f32(), rng.next_f32()]).wi;
                env.pdf_by(Guide::Compensated, d) == 0.0
            });
            assert!(missed.count() > 20);
        }
    }
}

#[test]
fn a_normal_gives_the_irradiance_with_less_variance() {
    for (name, env) in cases() {
        for n in NORMALS {
            let truth = env.irradiance(n)[1];
            let by = |guide: Guide| {
                estimate(n, name, |rng| {
                    let s = env.sample_by(guide, [rng.next_f32(), rng.next_f32()]);
                    term(s.radiance, n, s.wi, s.pdf)
                })
            };
            let (plain, about) = (by(Guide::Luminance), by(Guide::Cosine(n)));
            // Exact but for rounding where light is uniform.
            let off = (about.mean() - truth).abs();
            let right = off < 1e-6 * truth || t_test(&about, truth).p_value > 1e-5;
            assert!(right, "{name} {n:?}: {} against {truth}", about.mean());
            if truth > 0.0 && about.variance() > 1e-9 {
                assert!(
                    t_test(&about, 1.1 * truth).p_value < 1e-5,
                    "{name}: the control passed"
                );
            }
            // Two cells are no patches to weigh.
            let limit = if name == "one texel" { 1.05 } else { 0.9 };
            assert!(
                about.variance() < limit * plain.variance() + 1e-9,
                "{name} {n:?}: {} {}",
                about.variance(),
                plain.variance()
            );
        }
    }
}
