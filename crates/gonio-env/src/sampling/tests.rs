use super::nodes::{U_MAX, U_MIN, sample_linear};
use super::*;
use crate::Layout;
use std::f64::consts::TAU;

#[test]
fn the_linear_density_is_inverted() {
    for (a, b) in [
        (1.0, 1.0),
        (0.0, 1.0),
        (1.0, 0.0),
        (1e-30, 1.0),
        (1.0, 1e-30),
        (3.0, 5.0),
    ] {
        for u in [U_MIN, 0.1, 0.5, 0.9, U_MAX] {
            let t = sample_linear(a, b, u);
            let mass = (a * t + 0.5 * (b - a) * t * t) / (0.5 * (a + b));
            assert!(
                (mass - u).abs() < 1e-12,
                "a = {a}, b = {b}, u = {u}: t = {t}, mass {mass}"
            );
        }
    }
}

/// The running integral by 4000 midpoints, relative error (1/4000)²/24 of the curvature, agrees with u at the t that was found.
#[test]
fn a_band_is_inverted() {
    for height in [1, 2, 5, 512] {
        let nodes = Nodes::new(1, height, vec![1.0; height]).unwrap();
        for band in [0, 1, height / 2, height] {
            for (a, b) in [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (1e-6, 1.0), (2.0, 7.0)] {
                // The polar bands are of one value.
                let (a, b) = if band == 0 || band == height {
                    (1.0, 1.0)
                } else {
                    (a, b)
                };
                let [low, high] = nodes.band_ends(band);
                let integral = |to: f64| {
                    let n = 4000;
                    let step = to / f64::from(n);
                    let point = |k: i32| (f64::from(k) + 0.5) * step;
                    (0..n)
                        .map(|k| {
                            (a + (b - a) * point(k))
                                * Real::sin(low + point(k) * (high - low))
                                * step
                        })
                        .sum::<f64>()
                };
                let whole = integral(1.0);
                for u in [U_MIN, 1e-3, 0.2, 0.5, 0.97, U_MAX] {
                    let (t, [sin, cos]) = nodes.invert_band(band, a, b, u);
                    let found = integral(t) / whole;
                    // Newton stops within 1e-8 of the place; the midpoints err by 1e-7.
                    assert!(
                        (found - u).abs() < 1e-6,
                        "{height} {band} {a} {b} {u}: {t} {found}"
                    );
                    assert!((sin * sin + cos * cos - 1.0).abs() < 1e-12);
                }
            }
        }
    }
}

#[test]
fn black_has_no_density() {
    assert!(SphereTable::new(2, 1, vec![0.0, 0.0]).is_none());
}

#[test]
fn one_node_is_uniform() {
    let table = SphereTable::new(1, 1, vec![7.0]).unwrap();
    for u in [[0.0, 0.0], [0.5, 0.25], [0.999_999_94, 0.999_999_94]] {
        let d = table.sample(u);
        assert!((d.length() - 1.0).abs() < 3e-7);
        let p = table.density(Layout::LatLong.uv(d));
        assert!((p - UNIFORM_DENSITY).abs() <= UNIFORM_DENSITY * 1e-6, "{p}");
    }
    assert!(table.compensated(SamplingMethod::Inversion).is_none());
}

/// The four corners of the interpolation, and sin θ, integrate to 1 over the sphere.
#[test]
fn the_density_integrates_to_one() {
    let (w, h) = (5, 3);
    let values = (0..w * h).map(|k| ((k * 7) % 11) as f32).collect();
    let table = SphereTable::new(w, h, values).unwrap();
    let n = 900;
    let mut sum = 0.0;
    for k in 0..2 * n * n {
        let uv = [
            ((k % (2 * n)) as f64 + 0.5) / (2 * n) as f64,
            ((k / (2 * n)) as f64 + 0.5) / n as f64,
        ];
        let weight = Real::sin(PI * uv[1]) * PI / n as f64 * TAU / (2 * n) as f64;
        sum += f64::from(table.density([uv[0] as f32, uv[1] as f32])) * weight;
    }
    // Midpoints: (1/900)² of the curvature.
    assert!((sum - 1.0).abs() < 1e-5, "{sum}");
}
