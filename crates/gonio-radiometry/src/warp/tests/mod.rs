//! Tests of the warps: [`smooth`] holds what every family must do, [`scale`] tiny and huge domains, [`number_types`] lanes
//! and derivatives, [`area`] flat shapes, [`tables`] the tables.

mod area;
mod number_types;
mod scale;
mod smooth;
mod tables;

use crate::sequence::Rng;
use crate::testing::{LIMIT, chi_squared};
use gonio_num::Vec3;

/// A warp to directions, in double precision.
struct Directions<'a> {
    name: &'a str,
    map: &'a dyn Fn([f64; 2]) -> Vec3<f64>,
    density: &'a dyn Fn(Vec3<f64>) -> f64,
    inverse: &'a dyn Fn(Vec3<f64>) -> [f64; 2],
}

/// Points of the open square, from the test's name.
fn squares(name: &str, n: usize) -> impl Iterator<Item = [f64; 2]> {
    let mut rng = Rng::from_name(name);
    (0..n).map(move |_| [rng.next_f64(), rng.next_f64()])
}

/// χ² of samples of [0, 1]² against what `density` expects in 24 × 24 cells of the box `[low, high]`, by the midpoint rule
/// of 24 × 24 points a cell. Samples outside the box count in the nearest cell. The expectations sum to 1 within `tolerance`.
fn chi_squared_of(
    name: &str,
    samples: &[[f64; 2]],
    [low, high]: [[f64; 2]; 2],
    density: impl Fn(f64, f64) -> f64,
    tolerance: f64,
) -> f64 {
    const SIDE: usize = 24;
    const FINE: usize = 24;
    let size = [high[0] - low[0], high[1] - low[1]];
    let cell = |p: [f64; 2], k: usize| {
        ((p[k] - low[k]) / size[k] * SIDE as f64).clamp(0.0, (SIDE - 1) as f64) as usize
    };
    let mut observed = vec![0.0; SIDE * SIDE];
    for &p in samples {
        observed[cell(p, 1) * SIDE + cell(p, 0)] += 1.0;
    }
    let step = size.map(|s| s / (SIDE * FINE) as f64);
    let mut expected = vec![0.0; SIDE * SIDE];
    for j in 0..SIDE * FINE {
        for i in 0..SIDE * FINE {
            let (x, y) = (i as f64 + 0.5, j as f64 + 0.5);
            let value = density(low[0] + x * step[0], low[1] + y * step[1]);
            expected[j / FINE * SIDE + i / FINE] += value * step[0] * step[1];
        }
    }
    let whole: f64 = expected.iter().sum();
    assert!(
        (whole - 1.0).abs() < tolerance,
        "{name}: the density integrates to {whole}"
    );
    for e in &mut expected {
        *e *= samples.len() as f64;
    }
    chi_squared(&observed, &expected)
}

/// The χ² test of a warp's 200 000 samples against its density, and its negative control: a density tilted by 5 %.
fn assert_distributed(
    name: &str,
    map: impl Fn([f64; 2]) -> [f64; 2],
    density: impl Fn(f64, f64) -> f64,
    tolerance: f64,
) {
    let samples: Vec<_> = squares(name, 200_000).map(map).collect();
    let bounds = around(&samples);
    let right = chi_squared_of(name, &samples, bounds, &density, tolerance);
    assert!(right < LIMIT, "{name}: χ² is {right} deviations off");
    // Half of the samples are expected 1/20 too often, half too rarely: χ² rises by about 0.0025 · 200 000.
    let mut ys: Vec<f64> = samples.iter().map(|p| p[1]).collect();
    ys.sort_unstable_by(f64::total_cmp);
    let middle = ys[ys.len() / 2];
    let tilted = |x, y| density(x, y) * if y < middle { 1.05 } else { 0.95 };
    let wrong = chi_squared_of(name, &samples, bounds, tilted, 0.1);
    assert!(wrong > LIMIT, "{name}: a wrong density passes ({wrong})");
}

/// The box around the samples, a little widened within [0, 1]²: small domains fill the cells too.
fn around(samples: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let mut bounds = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
    for p in samples {
        for k in 0..2 {
            bounds[0][k] = bounds[0][k].min(p[k]);
            bounds[1][k] = bounds[1][k].max(p[k]);
        }
    }
    let [low, high] = bounds;
    let wide = |k: usize| 0.02 * (high[k] - low[k]);
    [
        [0, 1].map(|k| (low[k] - wide(k)).max(0.0)),
        [0, 1].map(|k| (high[k] + wide(k)).min(1.0)),
    ]
}
