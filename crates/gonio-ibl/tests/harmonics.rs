//! Spherical harmonics of panoramas against closed forms.

#![allow(clippy::unwrap_used)]

use gonio_env::{Environment, Layout};
use gonio_ibl::Harmonics;
use gonio_ibl::harmonics::{Window, basis, directions};
use gonio_image::Image;
use gonio_num::Vec3;
use std::f64::consts::PI;

fn panorama(width: usize, f: impl Fn(Vec3<f64>) -> [f64; 3]) -> Environment {
    let height = width / 2;
    let image = Image::from_fn(width, height, |x, y| {
        let uv = [
            (x as f64 + 0.5) / width as f64,
            (y as f64 + 0.5) / height as f64,
        ];
        f(Layout::LatLong.direction(uv)).map(|c| c as f32)
    });
    Environment::from_image(image, Layout::LatLong).unwrap()
}

#[test]
fn uniform_light_is_its_first_coefficient() {
    let env = panorama(32, |_| [1.0, 2.0, 3.0]);
    let sh = Harmonics::of_radiance(&env, 10).unwrap();
    for (i, c) in sh.coefficients().iter().enumerate() {
        for k in 0..3 {
            let expected = if i == 0 {
                (k + 1) as f64 * (4.0 * PI).sqrt()
            } else {
                0.0
            };
            // Sums of 1e4 products in double precision.
            assert!((c[k] - expected).abs() < 1e-11, "{i}: {c:?}");
        }
    }
    assert_eq!(
        Harmonics::of_radiance(&Environment::uniform([1.0; 3]), 3)
            .unwrap()
            .bands(),
        3
    );
}

/// A picture of one harmonic (and a constant, to stay positive) gives that coefficient and no other.
#[test]
fn a_known_harmonic_comes_back() {
    let width = 512;
    for index in [1, 2, 3, 6, 8, 20, 47, 90] {
        let env = panorama(width, |d| [2.0 + basis(10, d)[index]; 3]);
        let sh = Harmonics::of_radiance(&env, 10).unwrap();
        for (i, c) in sh.coefficients().iter().enumerate() {
            let expected = match i {
                0 => 2.0 * (4.0 * PI).sqrt(),
                i if i == index => 1.0,
                _ => 0.0,
            };
            // Interpolation flattens a wave of l periods by (l Δ)²/12 at most, Δ = 2π/512: 1e-3 for l = 9, and single
            // precision of the texels adds 1e-6.
            assert!(
                (c[0] - expected).abs() < 1.5e-3,
                "{index} {i}: {} {expected}",
                c[0]
            );
        }
        // Negative control: the neighbour's coefficient is not 1.
        assert!((sh.coefficients()[index - 1][0] - 1.0).abs() > 0.1);
    }
}

/// The interpolated picture itself, by brute force: what `of_radiance` integrates exactly.
#[test]
fn the_integral_is_that_of_the_interpolated_picture() {
    let env =
        panorama(8, |d| [if d.x > 0.3 { 5.0 } else { 0.5 }, 1.0 + d.y, 1.0]).rotated_deg(37.0);
    let sh = Harmonics::of_radiance(&env, 4).unwrap();
    let n = 1200;
    let mut sum = vec![[0.0; 3]; 16];
    for y in 0..n / 2 {
        for x in 0..n {
            let uv = [
                (f64::from(x) + 0.5) / f64::from(n),
                (f64::from(y) + 0.5) / f64::from(n / 2),
            ];
            let d: Vec3<f64> = Layout::LatLong.direction(uv);
            let w = Layout::LatLong.jacobian(uv) / f64::from(n * (n / 2));
            let rgb = env.radiance(d.to_f32());
            for (s, b) in sum.iter_mut().zip(basis(4, d)) {
                for k in 0..3 {
                    s[k] += w * b * f64::from(rgb[k]);
                }
            }
        }
    }
    for (a, b) in sh.coefficients().iter().zip(&sum) {
        for k in 0..3 {
            // The midpoint rule: (step)² of a function with kinks, 3e-5 times its slope of about 5.
            assert!((a[k] - b[k]).abs() < 3e-4, "{a:?} {b:?}");
        }
    }
}

/// Ramamoorthi & Hanrahan: three bands of irradiance are within a few per cent, ten are near.
#[test]
fn irradiance_from_harmonics_is_near_the_exact_one() {
    let env = panorama(128, |d| {
        let sun = f64::from(u8::from(d.dot(Vec3::new(0.6, 0.8, 0.0)) > 0.98));
        [0.5 + 20.0 * sun, 1.0 + d.y, 0.3]
    });
    let mean = env.mean_radiance()[0] * PI;
    let error = |bands: usize| {
        let sh = Harmonics::of_radiance(&env, bands).unwrap().irradiance();
        directions(60)
            .map(|d| (sh.evaluate(d)[0] - env.irradiance(d.to_f32())[0]).abs() / mean)
            .fold(0.0, f64::max)
    };
    let (three, ten) = (error(3), error(10));
    assert!(three < 0.12 && ten < 0.01 && ten < three, "{three} {ten}");
}

#[test]
fn windows_report_what_they_take() {
    let env = panorama(128, |d| [if d.y > 0.95 { 100.0 } else { 0.1 }; 3]);
    let sh = Harmonics::of_radiance(&env, 6).unwrap();
    let (same, none) = Window::None.apply(&sh);
    assert_eq!(same, sh);
    assert_eq!((none.largest, none.rms), (0.0, 0.0));
    assert!(none.smallest_before < -0.1);
    for window in [Window::Hann, Window::Lanczos, Window::Laplacian] {
        let (damped, r) = window.apply(&sh);
        assert!(
            r.rms > 0.01 && r.largest > r.rms && r.smallest_after > r.smallest_before,
            "{window:?} {r:?}"
        );
        assert_eq!(damped.coefficients()[0], sh.coefficients()[0]);
    }
    let (_, r) = Window::Laplacian.apply(&sh);
    assert!(
        r.smallest_after >= -1e-9 && r.lambda.unwrap() > 0.0,
        "{r:?}"
    );
    // Light that does not ring is left alone.
    let (_, r) = Window::Laplacian
        .apply(&Harmonics::of_radiance(&Environment::uniform([1.0; 3]), 3).unwrap());
    assert_eq!(r.lambda, Some(0.0));
}

#[test]
fn bands_out_of_range_are_refused() {
    let env = Environment::uniform([1.0; 3]);
    for bands in [0, 11, usize::MAX] {
        let error = Harmonics::of_radiance(&env, bands).unwrap_err().to_string();
        assert!(error.contains("from 1 to 10"), "{error}");
    }
    assert!(Harmonics::new(vec![[0.0; 3]; 5]).is_err());
    assert!("hamming".parse::<Window>().is_err());
}
