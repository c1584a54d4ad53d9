//! ꟻLIP: the difference that an observer sees when flipping between two pictures.
//!
//! LDR-ꟻLIP: Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström & Fairchild, "ꟻLIP: A Difference Evaluator for
//! Alternating Images", PACM CGIT 3(2), 2020. Its steps:
//!
//! 1. both pictures go to an opponent space (luminance, red–green, blue–yellow) and are blurred as the eye's contrast
//!    sensitivity does at this viewing distance;
//! 2. the colour difference ΔE_c in [0, 1] is HyAB in a Hunt-adjusted L\*a\*b\*, compressed for large differences;
//! 3. edges and points are detected in the luminance; their difference is ΔE_f in [0, 1];
//! 4. ΔE = ΔE_c^(1 − ΔE_f).
//!
//! HDR-ꟻLIP: Andersson, Nilsson, Shirley & Akenine-Möller, "Visualizing Errors in Rendered High Dynamic Range Images",
//! Eurographics Short Papers, 2021: the largest LDR-ꟻLIP over a range of exposures, from where the reference's brightest
//! pixel is well exposed to where its median is, through a filmic curve.
//!
//! Means agree with NVIDIA's own evaluator (version 1.7) to within 2e-5, on the pictures that the tests generate and on photographs.

mod colour;
mod filter;

use crate::Image;
use colour::{Lab, Opponent};
use gonio_num::Real;
use serde::Serialize;

/// Which ꟻLIP was computed.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum FlipKind {
    /// LDR-ꟻLIP of linear values in [0, 1].
    Ldr,
    /// HDR-ꟻLIP.
    Hdr {
        /// The darkest exposure in stops.
        start_ev: f64,
        /// The brightest exposure in stops.
        stop_ev: f64,
        /// How many exposures, evenly spaced.
        exposures: usize,
    },
}

/// Exponent of the colour difference, q_c.
const COLOUR_EXPONENT: f32 = 0.7;
/// Differences up to this fraction of the largest, p_c, …
const COMPRESSION_START: f32 = 0.4;
/// … take this part of [0, 1], p_t.
const COMPRESSION_SHARE: f32 = 0.95;

/// LDR-ꟻLIP of every pixel of two pictures of the same size. Linear values, clamped to [0, 1].
pub(super) fn ldr(a: &Image, b: &Image, pixels_per_degree: f64) -> Vec<f32> {
    let prepare = |image: &Image| Seen::new(image, pixels_per_degree, |rgb| rgb);
    error_map(&prepare(a), &prepare(b))
}

/// HDR-ꟻLIP of every pixel of two pictures of the same size; negative values count as 0. `b` is the reference.
pub(super) fn hdr(a: &Image, b: &Image, pixels_per_degree: f64) -> (Vec<f32>, FlipKind) {
    let (start, stop) = exposure_range(b);
    // At most 20: the median is at least a millionth of the maximum (`exposure_range`), and log₂ 10⁶ < 20.
    let exposures = Real::max((stop - start).ceil(), 2.0) as usize;
    let mut map = vec![0.0f32; a.pixels.len()];
    for i in 0..exposures {
        let ev = start + (stop - start) * i as f64 / (exposures - 1) as f64;
        let scale = Real::exp(ev * std::f64::consts::LN_2);
        let expose = |rgb: [f32; 3]| rgb.map(|c| filmic((f64::from(c.max(0.0)) * scale) as f32));
        let errors = error_map(
            &Seen::new(a, pixels_per_degree, expose),
            &Seen::new(b, pixels_per_degree, expose),
        );
        for (largest, error) in map.iter_mut().zip(errors) {
            *largest = largest.max(error);
        }
    }
    let kind = FlipKind::Hdr {
        start_ev: start,
        stop_ev: stop,
        exposures,
    };
    (map, kind)
}

/// Coefficients of the filmic curve (p₀x² + p₁x + p₂) / (p₃x² + p₄x + p₅): Narkowicz's fit of ACES ("ACES Filmic Tone Mapping
/// Curve", 2015), with his pre-exposure of 0.6 put in.
const FILMIC: [f64; 6] = [
    0.6 * 0.6 * 2.51,
    0.6 * 0.03,
    0.0,
    0.6 * 0.6 * 2.43,
    0.6 * 0.59,
    0.14,
];

fn filmic(x: f32) -> f32 {
    let [p0, p1, p2, p3, p4, p5] = FILMIC.map(|p| p as f32);
    // Far beyond the curve's end, and its square still fits.
    let x = x.min(1e9);
    ((p0 * x * x + p1 * x + p2) / (p3 * x * x + p4 * x + p5)).clamp(0.0, 1.0)
}

/// The exposures in stops at which the reference's largest and its median luminance become 0.85 on the screen.
fn exposure_range(reference: &Image) -> (f64, f64) {
    const SCREEN: f64 = 0.85;
    // The largest x with filmic(x) = 0.85.
    let a = FILMIC[0] - SCREEN * FILMIC[3];
    let b = FILMIC[1] - SCREEN * FILMIC[4];
    let c = FILMIC[2] - SCREEN * FILMIC[5];
    let x = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    let mut luminance: Vec<f64> = reference
        .pixels
        .iter()
        .map(|&p| f64::from(colour::luminance(p.map(|c| c.max(0.0)))))
        .collect();
    luminance.sort_unstable_by(f64::total_cmp);
    let n = luminance.len();
    let median = (luminance[(n - 1) / 2] + luminance[n / 2]) / 2.0;
    let largest = luminance[n - 1];
    // A black reference has no exposure of its own; a median of 0 would ask for an endless one.
    if largest == 0.0 {
        return (0.0, 0.0);
    }
    let median = median.max(largest * 1e-6);
    let stops = |y: f64| Real::ln(x / y) * std::f64::consts::LOG2_E;
    (stops(largest), stops(median))
}

/// What ꟻLIP needs of one picture.
struct Seen {
    /// L\*a\*b\* after the eye's blur, Hunt-adjusted.
    colour: Vec<Lab>,
    /// Strength of edges and points.
    features: Vec<[f32; 2]>,
}

impl Seen {
    fn new(image: &Image, pixels_per_degree: f64, display: impl Fn([f32; 3]) -> [f32; 3]) -> Self {
        let opponent: Vec<Opponent> = image
            .pixels
            .iter()
            .map(|&p| colour::opponent(display(p).map(|c| c.clamp(0.0, 1.0))))
            .collect();
        let colour = filter::contrast_sensitivity(&opponent, image.width, pixels_per_degree)
            .into_iter()
            .map(|p| colour::hunt_lab(colour::rgb_of_opponent(p).map(|c| c.clamp(0.0, 1.0))))
            .collect();
        // Luminance in [0, 1].
        let y: Vec<f32> = opponent.iter().map(|p| (p[0] + 16.0) / 116.0).collect();
        Self {
            colour,
            features: filter::features(&y, image.width, pixels_per_degree),
        }
    }
}

fn error_map(a: &Seen, b: &Seen) -> Vec<f32> {
    // The largest colour difference there is: between green and blue.
    let extreme = colour_difference(
        colour::hunt_lab([0.0, 1.0, 0.0]),
        colour::hunt_lab([0.0, 0.0, 1.0]),
    );
    let knee = COMPRESSION_START * extreme;
    let pixels = a.colour.iter().zip(&b.colour);
    let features = a.features.iter().zip(&b.features);
    pixels
        .zip(features)
        .map(|((&colour_a, &colour_b), (feature_a, feature_b))| {
            let d = colour_difference(colour_a, colour_b);
            let colour = if d < knee {
                COMPRESSION_SHARE / knee * d
            } else {
                COMPRESSION_SHARE + (d - knee) / (extreme - knee) * (1.0 - COMPRESSION_SHARE)
            };
            let edge = (feature_a[0] - feature_b[0]).abs();
            let point = (feature_a[1] - feature_b[1]).abs();
            let feature = (edge.max(point) * std::f32::consts::FRAC_1_SQRT_2).sqrt();
            Real::powf(colour.clamp(0.0, 1.0), 1.0 - feature.min(1.0))
        })
        .collect()
}

/// HyAB (Abasi, Tehran & Fairchild 2020), |ΔL| + √(Δa² + Δb²), to the power q_c.
fn colour_difference(a: Lab, b: Lab) -> f32 {
    let [l, x, y] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    Real::powf(l.abs() + (x * x + y * y).sqrt(), COLOUR_EXPONENT)
}

#[cfg(test)]
mod tests;
