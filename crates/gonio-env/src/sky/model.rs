//! The clear sky and the sun of Hošek & Wilkie: radiance of a direction.
//!
//! Sky: "An analytic model for full spectral sky-dome radiance", SIGGRAPH 2012, eq. 8 and 11. Sun: "Adding a solar-radiance function
//! to the Hošek–Wilkie skylight model", IEEE CG&A 33 (3), 2013.

use super::tables::{self, COEFFICIENTS, CONTROL_POINTS, Channels, LIMB, POWERS, SEGMENTS};
use gonio_num::Real;
use gonio_radiometry::colour::{RgbSpace, rgb_of_emission};
use gonio_radiometry::spectrum::Spectrum;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::OnceLock;

/// Half the angle that the sun's disc is wide: 0.5358° / 2.
pub(super) const SUN_RADIUS: f64 = 0.5358 / 360.0 * PI;

/// The distribution of one channel over the dome: nine coefficients and the mean radiance that they scale.
#[derive(Debug, Clone, Copy)]
pub(super) struct Channel<R> {
    pub coefficients: [R; COEFFICIENTS],
    pub mean: R,
}

impl<R: Real> Channel<R> {
    /// F(θ, γ) of the paper's eq. 8 times the mean radiance; never negative.
    ///
    /// (1 + A e^{B / (cosθ + 0.01)}) (C + D e^{Eγ} + F cos²γ + G χ(H, γ) + I √cosθ),
    /// χ = (1 + cos²γ) / (1 + H² − 2H cosγ)^{3/2}
    ///
    /// - `cos_theta`: of the angle from the zenith, ≥ 0
    /// - `gamma`: angle from the sun, with its cosine
    #[inline(always)]
    pub fn radiance(&self, cos_theta: R, gamma: R, cos_gamma: R) -> R {
        // The order of the published tables: χ's H comes last.
        let [a, b, c, d, e, f, g, i, h] = self.coefficients;
        let one = R::one();
        let cos2 = cos_gamma * cos_gamma;
        let base = (one + h * h - R::lit(2.0) * h * cos_gamma).max(R::lit(1e-6));
        let chi = (one + cos2) / (base * base.sqrt());
        let high = one + a * (b / (cos_theta + R::lit(0.01))).exp();
        let wide =
            c + d * (e * gamma).exp() + f * cos2 + g * chi + i * cos_theta.max(R::zero()).sqrt();
        (high * wide * self.mean).max(R::zero())
    }
}

/// The weights of neighbouring entries of a table at `x`: (index, weight of the next).
fn between(x: f64, entries: usize) -> (usize, f64) {
    let low = (x.max(0.0) as usize).min(entries - 2);
    (low, x - low as f64)
}

/// The channels of a sky under a sun of `elevation` \[rad], 0 to π/2.
///
/// Linear in turbidity and in each channel's albedo; over elevation a Bézier curve of degree five in ∛(2η/π) (eq. 11).
pub(super) fn channels(
    of: Channels,
    elevation: f64,
    turbidity: f64,
    albedo: impl Fn(usize) -> f64,
) -> Vec<Channel<f64>> {
    let (low, more) = between(turbidity - 1.0, tables::TURBIDITIES);
    let x = Real::powf(elevation.max(0.0) / FRAC_PI_2, 1.0 / 3.0).min(1.0);
    let mut bernstein = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    for (k, b) in bernstein.iter_mut().enumerate() {
        for _ in 0..k {
            *b *= x;
        }
        for _ in k + 1..CONTROL_POINTS {
            *b *= 1.0 - x;
        }
    }
    let value = |channel: usize, k: usize| {
        let white = albedo(channel);
        let mut sum = 0.0;
        for (t, of_turbidity) in [(low, 1.0 - more), (low + 1, more)] {
            for (a, of_albedo) in [(0, 1.0 - white), (1, white)] {
                for (point, b) in bernstein.iter().enumerate() {
                    sum += of_turbidity * of_albedo * b * of.sky(t, a, point, channel, k);
                }
            }
        }
        sum
    };
    (0..of.count())
        .map(|channel| Channel {
            coefficients: std::array::from_fn(|k| value(channel, k)),
            mean: value(channel, COEFFICIENTS),
        })
        .collect()
}

/// The sun's radiance over the elevation of the line of sight and the place on the disc, for the wavelengths or channels of a
/// sky: Σₖⱼ c\[k]\[j] (η − η₀)ᵏ cosʲψ in each of the segments, whose borders are η₀ = (i/45)³ π/2.
#[derive(Debug)]
pub(super) struct SunTable<const N: usize> {
    segments: Vec<[[[f64; LIMB]; POWERS]; N]>,
}

/// The RGB of each wavelength of the tables, with linear interpolation between them: of the hat function around it.
fn rgb_of_wavelengths() -> &'static [[f64; 3]; tables::WAVELENGTHS] {
    static WEIGHTS: OnceLock<[[f64; 3]; tables::WAVELENGTHS]> = OnceLock::new();
    WEIGHTS.get_or_init(|| {
        std::array::from_fn(|w| {
            let mut hat = vec![0.0; tables::WAVELENGTHS];
            hat[w] = 1.0;
            let hat = Spectrum::regular(tables::FIRST_NM, tables::STEP_NM, hat)
                .expect("invariant: eleven finite numbers at rising wavelengths");
            rgb_of_emission(&hat, &RgbSpace::SRGB)
        })
    })
}

/// Turbidity's share of the tables' entry.
fn sun_coefficient(turbidity: f64, segment: usize, wavelength: usize, k: usize) -> f64 {
    let (low, more) = between(turbidity - 1.0, tables::TURBIDITIES);
    (1.0 - more) * tables::sun(low, segment, wavelength, k)
        + more * tables::sun(low + 1, segment, wavelength, k)
}

impl SunTable<3> {
    /// Linear RGB, integrated from the wavelengths. (The RGB table beside it, with its published factor,
    /// is 7 % brighter.)
    pub fn rgb(turbidity: f64) -> Self {
        let weights = rgb_of_wavelengths();
        Self::of(|segment, channel, k, j| {
            (0..tables::WAVELENGTHS)
                .map(|w| {
                    weights[w][channel]
                        * sun_coefficient(turbidity, segment, w, k)
                        * tables::limb(w, j)
                })
                .sum()
        })
    }
}

impl SunTable<1> {
    /// One wavelength, between two of the tables'; radiance and limb darkening are each linear.
    pub fn wavelength(turbidity: f64, lambda_nm: f64) -> Self {
        let (low, more) = between(
            (lambda_nm - tables::FIRST_NM) / tables::STEP_NM,
            tables::WAVELENGTHS,
        );
        let mix = |f: &dyn Fn(usize) -> f64| (1.0 - more) * f(low) + more * f(low + 1);
        Self::of(|segment, _, k, j| {
            mix(&|w| sun_coefficient(turbidity, segment, w, k)) * mix(&|w| tables::limb(w, j))
        })
    }
}

impl<const N: usize> SunTable<N> {
    fn of(coefficient: impl Fn(usize, usize, usize, usize) -> f64) -> Self {
        let segments = (0..SEGMENTS).map(|s| {
            std::array::from_fn(|c| {
                std::array::from_fn(|k| std::array::from_fn(|j| coefficient(s, c, k, j)))
            })
        });
        Self {
            segments: segments.collect(),
        }
    }

    /// Radiance; never negative (a red sun lies outside of sRGB, and its blue is 0).
    ///
    /// - `elevation`: of the line of sight \[rad], ≥ 0
    /// - `sin_gamma`: sine of its angle from the disc's centre, at most that of the disc's radius
    pub fn radiance(&self, elevation: f64, sin_gamma: f64) -> [f64; N] {
        let position = SEGMENTS as f64 * Real::powf(elevation.max(0.0) / FRAC_PI_2, 1.0 / 3.0);
        let segment = (position as usize).min(SEGMENTS - 1);
        let share = segment as f64 / SEGMENTS as f64;
        let x = elevation - FRAC_PI_2 * share * share * share;
        let across = sin_gamma / Real::sin(SUN_RADIUS);
        let cos_psi = (1.0 - across * across).max(0.0).sqrt();
        let horner =
            |powers: &[f64; LIMB]| powers.iter().rev().fold(0.0, |sum, c| sum * cos_psi + c);
        let mut out = [0.0; N];
        for (to, by_elevation) in out.iter_mut().zip(&self.segments[segment]) {
            let sum = by_elevation
                .iter()
                .rev()
                .fold(0.0, |sum, limb| sum * x + horner(limb));
            *to = sum.max(0.0);
        }
        out
    }
}
