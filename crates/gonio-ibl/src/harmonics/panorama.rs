//! The harmonics of a panorama, exactly as it is interpolated.
//!
//! A bilinear picture is a sum of products of hat functions in longitude and latitude, and so are the harmonics about its vertical.
//! Along a row the integral of a hat with cos mφ is known: Δ sinc²(mΔ/2) cos mφᵢ. Between rows the integrand is smooth, and
//! Gauss–Legendre rules are exact to rounding.

use super::{Harmonics, basis};
use gonio_env::LatLongTexels;
use gonio_num::{Real, Vec3};
use gonio_radiometry::quadrature::GaussLegendre;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Numbers that are summed side by side.
const WIDTH: usize = 4;
/// A band is integrated in pieces no wider than this \[rad], by rules of 8 nodes: harmonics of degree 9 then are exact to 1e-16.
const WIDEST: f64 = PI / 16.0;

/// The coefficients in the basis of the world.
pub(super) fn project(texels: &LatLongTexels<'_>, bands: usize) -> Harmonics {
    let local = project_local(texels, bands);
    // In the picture's own frame the polar axis is +y, φ = 0 looks along −z and φ = 90° along +x.
    let axis = |x: f64, y: f64, z: f64| texels.to_world(Vec3::new(x, y, z));
    let (x, y, z) = (
        axis(0.0, 0.0, -1.0),
        axis(1.0, 0.0, 0.0),
        axis(0.0, 1.0, 0.0),
    );
    Harmonics::of_function(bands, |d| {
        let d = Vec3::new(d.dot(x), d.dot(y), d.dot(z));
        local.evaluate(d)
    })
}

fn project_local(texels: &LatLongTexels<'_>, bands: usize) -> Harmonics {
    let (w, h) = (texels.width, texels.height);
    let step = TAU / w as f64;
    // For each of cos 0, cos φ, sin φ, cos 2φ, …: the integral of each column's hat with it.
    let waves: Vec<Vec<f64>> = (0..2 * bands - 1)
        .map(|k| {
            let m = k.div_ceil(2) as f64;
            let half = 0.5 * m * step;
            let sinc = if m > 0.0 { Real::sin(half) / half } else { 1.0 };
            (0..w)
                .map(|i| {
                    let phi = step * (i as f64 + 0.5) - PI;
                    let wave = if k % 2 == 1 || k == 0 {
                        Real::cos(m * phi)
                    } else {
                        Real::sin(m * phi)
                    };
                    step * sinc * sinc * wave
                })
                .collect()
        })
        .collect();
    let rows: Vec<Vec<[f64; 3]>> = (0..h)
        .into_par_iter()
        .map(|j| around(&texels.texels[j * w..(j + 1) * w], &waves))
        .collect();
    let edge = |band: usize| match band {
        0 => 0.0,
        b if b > h => PI,
        b => PI * (b as f64 - 0.5) / h as f64,
    };
    let rule = GaussLegendre::new(8);
    let mut coefficients = vec![[0.0; 3]; bands * bands];
    for band in 0..=h {
        let (above, below) = (band.saturating_sub(1), band.min(h - 1));
        let (a, b) = (edge(band), edge(band + 1));
        let pieces = ((b - a) / WIDEST).ceil().max(1.0) as usize;
        let piece = (b - a) / pieces as f64;
        for k in 0..pieces {
            let from = a + piece * k as f64;
            for (theta, weight) in rule.on(from, from + piece) {
                let (sin, cos) = (Real::sin(theta), Real::cos(theta));
                // At φ = 0 the cosines are 1: the associated Legendre functions alone remain.
                let p = basis(bands, Vec3::new(sin, 0.0, cos));
                let t = (theta - a) / (b - a);
                let weights = [(above, weight * sin * (1.0 - t)), (below, weight * sin * t)];
                for (row, weight) in weights {
                    for l in 0..bands {
                        for m in 0..=l {
                            let centre = l * l + l;
                            let f = weight * p[centre + m];
                            let k = (2 * m).saturating_sub(1);
                            add(&mut coefficients[centre + m], rows[row][k], f);
                            if m > 0 {
                                add(&mut coefficients[centre - m], rows[row][k + 1], f);
                            }
                        }
                    }
                }
            }
        }
    }
    for c in &mut coefficients {
        for k in 0..3 {
            c[k] *= f64::from(texels.scale[k]);
        }
    }
    Harmonics {
        bands,
        coefficients,
    }
}

#[inline(always)]
fn add(sum: &mut [f64; 3], value: [f64; 3], factor: f64) {
    for k in 0..3 {
        sum[k] += value[k] * factor;
    }
}

/// ∫ of a row with each wave.
fn around(row: &[[f32; 3]], waves: &[Vec<f64>]) -> Vec<[f64; 3]> {
    let channels: [Vec<f64>; 3] = [0, 1, 2].map(|c| row.iter().map(|t| f64::from(t[c])).collect());
    waves
        .iter()
        .map(|wave| [0, 1, 2].map(|c| dot(&channels[c], wave)))
        .collect()
}

/// Σ aᵢ bᵢ in a fixed order that fills vector registers.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; WIDTH];
    let (whole_a, whole_b) = (a.chunks_exact(WIDTH), b.chunks_exact(WIDTH));
    let rest: f64 = whole_a
        .remainder()
        .iter()
        .zip(whole_b.remainder())
        .map(|(x, y)| x * y)
        .sum();
    for (x, y) in whole_a.zip(whole_b) {
        for k in 0..WIDTH {
            sums[k] += x[k] * y[k];
        }
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}
