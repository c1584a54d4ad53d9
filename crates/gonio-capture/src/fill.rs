//! Texels without confidence, filled: the membrane that the texels around them span.
//!
//! Δ ln(L + ε) = 0 on the sphere inside, the values that were seen around it. In longitude φ and polar angle θ the flux
//! through a side of a texel is (Δθ / (Δφ sin θ)) times the difference across a meridian and (Δφ sin θ / Δθ) across a
//! parallel, and nothing passes through a pole. Solved by successive over-relaxation, coarse to fine. The logarithm keeps a
//! bright lamp beside the hole from outshining it.

use gonio_image::Image;
use gonio_num::Real;
use std::f64::consts::PI;

/// Texels of less confidence than this are filled.
pub const LEAST_CONFIDENCE: f32 = 0.05;
/// Sweeps a level; each level begins with the coarser one's solution.
const SWEEPS: usize = 80;

/// Fills the texels of less than [`LEAST_CONFIDENCE`]; returns how many. Nothing is filled if there is nothing to fill from.
pub fn fill(image: &mut Image, confidence: &[f32]) -> usize {
    let known: Vec<bool> = confidence.iter().map(|c| *c >= LEAST_CONFIDENCE).collect();
    let count = known.iter().filter(|k| !**k).count();
    if count == 0 || count == known.len() {
        return 0;
    }
    let seen = image.pixels.iter().zip(&known).filter(|(_, k)| **k);
    let (sum, n) = seen.fold((0.0, 0.0), |(s, n), (p, _)| {
        (s + f64::from(p[0] + p[1] + p[2]) / 3.0, n + 1.0)
    });
    let floor = (1e-4 * sum / n).max(1e-30);
    for c in 0..3 {
        let values: Vec<f64> = image
            .pixels
            .iter()
            .map(|p| Real::ln(f64::from(p[c]).max(0.0) + floor))
            .collect();
        let solved = solve(&values, &known, image.width, image.height);
        for (k, p) in image.pixels.iter_mut().enumerate() {
            if !known[k] {
                p[c] = (Real::exp(solved[k]) - floor).max(0.0) as f32;
            }
        }
    }
    count
}

fn solve(values: &[f64], known: &[bool], w: usize, h: usize) -> Vec<f64> {
    let mut x = values.to_vec();
    if w >= 8 && h >= 8 && w.is_multiple_of(2) && h.is_multiple_of(2) {
        // The mean of what is known of each four; unknown where none is.
        let (cw, ch) = (w / 2, h / 2);
        let (mut coarse, mut has) = (vec![0.0; cw * ch], vec![false; cw * ch]);
        for k in 0..cw * ch {
            let (i, j) = (2 * (k % cw), 2 * (k / cw));
            let four = [
                j * w + i,
                j * w + i + 1,
                (j + 1) * w + i,
                (j + 1) * w + i + 1,
            ];
            let n = four.iter().filter(|q| known[**q]).count();
            if n > 0 {
                let sum: f64 = four.iter().filter(|q| known[**q]).map(|q| values[*q]).sum();
                (coarse[k], has[k]) = (sum / n as f64, true);
            }
        }
        let coarse = solve(&coarse, &has, cw, ch);
        for k in 0..w * h {
            if !known[k] {
                x[k] = coarse[(k / w / 2) * cw + (k % w) / 2];
            }
        }
    } else {
        let n = known.iter().filter(|k| **k).count().max(1);
        let mean = (0..w * h)
            .filter(|k| known[*k])
            .map(|k| values[k])
            .sum::<f64>()
            / n as f64;
        for k in (0..w * h).filter(|k| !known[*k]) {
            x[k] = mean;
        }
    }
    let (d_phi, d_theta) = (2.0 * PI / w as f64, PI / h as f64);
    let unknown: Vec<usize> = (0..w * h).filter(|k| !known[*k]).collect();
    for _ in 0..SWEEPS {
        for &k in &unknown {
            let (i, j) = (k % w, k / w);
            let across = d_theta / (d_phi * Real::sin((j as f64 + 0.5) * d_theta));
            let side = |row: usize| d_phi / d_theta * Real::sin(row as f64 * d_theta);
            let (mut sum, mut weight) = (0.0, 0.0);
            let mut add = |value: f64, w: f64| (sum, weight) = (sum + w * value, weight + w);
            add(x[j * w + (i + 1) % w], across);
            add(x[j * w + (i + w - 1) % w], across);
            if j > 0 {
                add(x[k - w], side(j));
            }
            if j + 1 < h {
                add(x[k + w], side(j + 1));
            }
            x[k] += 1.7 * (sum / weight - x[k]);
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::panorama::direction;

    /// ln tan(θ/2) is harmonic on the sphere without its poles, so a hole in it is filled with itself, up to the discretisation:
    /// second order, (π/64)² = 0.0024 times derivatives of order 1.
    #[test]
    fn a_harmonic_function_is_continued() {
        let mut image = Image::new(128, 64);
        let mut confidence = vec![1.0; 128 * 64];
        let truth: Vec<f64> = (0..128 * 64)
            .map(|k| {
                let d = direction(&image, k);
                Real::exp(0.5 * Real::ln(((1.0 - d.y) / (1.0 + d.y)).sqrt()))
            })
            .collect();
        for k in 0..128 * 64 {
            let d = direction(&image, k);
            image.pixels[k] = [truth[k] as f32; 3];
            if d.z > 0.9 {
                image.pixels[k] = [77.0; 3];
                confidence[k] = 0.0;
            }
        }
        let filled = fill(&mut image, &confidence);
        // A cap of 5 % of the sphere, on the equator, where texels are largest.
        assert!(filled > 200, "{filled}");
        for (p, t) in image.pixels.iter().zip(&truth) {
            let found = f64::from(p[0]);
            assert!((found / t - 1.0).abs() < 0.01, "{found} {t}");
        }
    }

    #[test]
    fn a_pole_is_filled_too() {
        let mut image = Image::filled(64, 32, [2.0; 3]);
        let confidence: Vec<f32> = (0..64 * 32)
            .map(|k| if k < 256 { 0.0 } else { 1.0 })
            .collect();
        image.pixels[..256].fill([0.0; 3]);
        assert_eq!(fill(&mut image, &confidence), 256);
        assert!(image.pixels.iter().all(|p| (p[1] - 2.0).abs() < 1e-3));
    }

    #[test]
    fn nothing_to_fill_from_leaves_all_as_it_is() {
        let mut image = Image::new(8, 4);
        assert_eq!(fill(&mut image, &[0.0; 32]), 0);
        assert_eq!(fill(&mut image, &[1.0; 32]), 0);
    }
}
