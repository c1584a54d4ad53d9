//! The filters of ꟻLIP, all separable. A pixel outside the picture is the nearest inside.

use super::colour::Opponent;
use gonio_num::Real;
use std::f64::consts::PI;

/// Contrast sensitivity in one opponent channel: a₁ √(π/b₁) e^(−π²d²/b₁) + a₂ √(π/b₂) e^(−π²d²/b₂) at distance d in degrees.
/// Source: Andersson et al. 2020, table 1 (after Johnson & Fairchild 2003).
struct Sensitivity {
    a: [f64; 2],
    b: [f64; 2],
}

const LUMINANCE: Sensitivity = Sensitivity {
    a: [1.0, 0.0],
    b: [0.0047, 1e-5],
};
const RED_GREEN: Sensitivity = Sensitivity {
    a: [1.0, 0.0],
    b: [0.0053, 1e-5],
};
const BLUE_YELLOW: Sensitivity = Sensitivity {
    a: [34.1, 13.5],
    b: [0.04, 0.025],
};
/// The widest b: it sets the radius of all.
const WIDEST: f64 = 0.04;

/// Width of an edge or a point that the feature detectors look for, in degrees.
const FEATURE_WIDTH: f64 = 0.082;

/// Weights for offsets −r ..= r.
type Kernel = Vec<f32>;

fn sampled(radius: i32, f: impl Fn(f64) -> f64) -> Vec<f64> {
    (-radius..=radius).map(|i| f(f64::from(i))).collect()
}

fn to_f32(weights: &[f64], scale: f64) -> Kernel {
    weights.iter().map(|w| (w * scale) as f32).collect()
}

/// One Gaussian of a sensitivity: its kernel, with sum 1, and its share of the two-dimensional filter.
fn gaussian(s: &Sensitivity, term: usize, radius: i32, pixels_per_degree: f64) -> (Kernel, f64) {
    let weights = sampled(radius, |i| {
        let d = i / pixels_per_degree;
        Real::exp(-PI * PI * d * d / s.b[term])
    });
    let sum: f64 = weights.iter().sum();
    let share = s.a[term] * (PI / s.b[term]).sqrt() * sum * sum;
    (to_f32(&weights, 1.0 / sum), share)
}

/// Blurs each opponent channel as the eye does.
pub(super) fn contrast_sensitivity(
    pixels: &[Opponent],
    width: usize,
    pixels_per_degree: f64,
) -> Vec<Opponent> {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let kernel = |s, term| gaussian(s, term, radius, pixels_per_degree);
    let (luminance, _) = kernel(&LUMINANCE, 0);
    let (red_green, _) = kernel(&RED_GREEN, 0);
    let (blue_wide, share_wide) = kernel(&BLUE_YELLOW, 0);
    let (blue_narrow, share_narrow) = kernel(&BLUE_YELLOW, 1);
    let wide = (share_wide / (share_wide + share_narrow)) as f32;
    let narrow = (share_narrow / (share_wide + share_narrow)) as f32;

    // The blue–yellow filter is a sum of two Gaussians: each is separable, their sum is not.
    let kernels = [&luminance, &red_green, &blue_wide, &blue_narrow];
    let spread: Vec<[f32; 4]> = pixels.iter().map(|&[y, cx, cz]| [y, cx, cz, cz]).collect();
    let rows = along_rows(&spread, width, |p| p, kernels);
    let both = along_columns(&rows, width, |p| p, kernels);
    both.into_iter()
        .map(|[y, cx, cz_wide, cz_narrow]| [y, cx, wide * cz_wide + narrow * cz_narrow])
        .collect()
}

/// Strength of edges and of points in the luminance `y`: lengths of the gradients by the first and second derivative of a
/// Gaussian, whose positive weights add up to 1 and negative to −1.
pub(super) fn features(y: &[f32], width: usize, pixels_per_degree: f64) -> Vec<[f32; 2]> {
    let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * deviation).ceil() as i32;
    let variance = deviation * deviation;
    let bell = |x: f64| Real::exp(-x * x / (2.0 * variance));
    let smooth = sampled(radius, bell);
    let smooth = to_f32(&smooth, 1.0 / smooth.iter().sum::<f64>());
    let edge = balanced(&sampled(radius, |x| -x * bell(x)));
    let point = balanced(&sampled(radius, |x| (x * x / variance - 1.0) * bell(x)));

    let rows = along_rows(y, width, |v| [v; 3], [&edge, &point, &smooth]);
    along_columns(
        &rows,
        width,
        |[e, p, s]| [e, s, p, s],
        [&smooth, &edge, &smooth, &point],
    )
    .into_iter()
    .map(|[edge_x, edge_y, point_x, point_y]| {
        [
            (edge_x * edge_x + edge_y * edge_y).sqrt(),
            (point_x * point_x + point_y * point_y).sqrt(),
        ]
    })
    .collect()
}

fn balanced(weights: &[f64]) -> Kernel {
    let positive: f64 = weights.iter().filter(|w| **w > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|w| **w < 0.0).sum::<f64>();
    weights
        .iter()
        .map(|&w| (w / if w > 0.0 { positive } else { negative }) as f32)
        .collect()
}

/// The weights of all kernels at each offset.
fn taps<const N: usize>(kernels: [&Kernel; N]) -> Vec<[f32; N]> {
    (0..kernels[0].len())
        .map(|k| std::array::from_fn(|c| kernels[c][k]))
        .collect()
}

/// `N` values of each pixel, each filtered along the rows with its own kernel; all kernels have the same length.
fn along_rows<P: Copy, const N: usize>(
    pixels: &[P],
    width: usize,
    values: impl Fn(P) -> [f32; N],
    kernels: [&Kernel; N],
) -> Vec<[f32; N]> {
    let taps = taps(kernels);
    let radius = taps.len() / 2;
    let mut out = Vec::with_capacity(pixels.len());
    for row in pixels.chunks(width) {
        for x in 0..width {
            let mut sum = [0.0f32; N];
            for (k, weights) in taps.iter().enumerate() {
                let source = (x + k).saturating_sub(radius).min(width - 1);
                let value = values(row[source]);
                for c in 0..N {
                    sum[c] += weights[c] * value[c];
                }
            }
            out.push(sum);
        }
    }
    out
}

/// As [`along_rows`], along the columns.
fn along_columns<P: Copy, const N: usize>(
    pixels: &[P],
    width: usize,
    values: impl Fn(P) -> [f32; N],
    kernels: [&Kernel; N],
) -> Vec<[f32; N]> {
    let taps = taps(kernels);
    let radius = taps.len() / 2;
    let height = pixels.len() / width;
    let mut out = Vec::with_capacity(pixels.len());
    for y in 0..height {
        let start = out.len();
        out.resize(start + width, [0.0f32; N]);
        for (k, weights) in taps.iter().enumerate() {
            let source = (y + k).saturating_sub(radius).min(height - 1);
            let row = &pixels[source * width..(source + 1) * width];
            for (sum, &pixel) in out[start..].iter_mut().zip(row) {
                let value = values(pixel);
                for c in 0..N {
                    sum[c] += weights[c] * value[c];
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_uniform_picture_stays_and_has_no_features() {
        let blurred = contrast_sensitivity(&[[50.0, -3.0, 7.0]; 30], 6, 67.0);
        for p in blurred {
            assert!((p[0] - 50.0).abs() < 1e-4 && (p[1] + 3.0).abs() < 1e-4);
            assert!((p[2] - 7.0).abs() < 1e-4);
        }
        for f in features(&[0.5; 30], 6, 67.0) {
            assert!(f[0] < 1e-6 && f[1] < 1e-6);
        }
    }

    /// Far from borders the blur of one bright pixel adds up to that pixel.
    #[test]
    fn blurring_keeps_the_sum() {
        let (width, height) = (41, 41);
        let mut pixels = vec![[0.0; 3]; width * height];
        pixels[20 * width + 20] = [1.0, 2.0, 3.0];
        let blurred = contrast_sensitivity(&pixels, width, 67.0);
        for c in 0..3 {
            let sum: f64 = blurred.iter().map(|p| f64::from(p[c])).sum();
            assert!((sum - (c + 1) as f64).abs() < 1e-5, "{sum}");
        }
    }

    #[test]
    fn a_step_is_an_edge_and_a_dot_is_a_point() {
        let width = 41;
        let step: Vec<f32> = (0..width * width)
            .map(|i| f32::from(i % width >= 20))
            .collect();
        let found = features(&step, width, 67.0);
        let centre = found[20 * width + 20];
        assert!(centre[0] > 0.8, "{centre:?}");
        assert!(found[20 * width + 2][0] < 1e-6);
        let mut dot = vec![0.0; width * width];
        dot[20 * width + 20] = 1.0;
        let centre = features(&dot, width, 67.0)[20 * width + 20];
        assert!(centre[0] < 1e-6 && centre[1] > 0.0, "{centre:?}");
    }
}
