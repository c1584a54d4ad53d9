//! [`Radiance`], several exposures of one view merged to what arrived at the camera.
//!
//! Each exposure j estimates E = x(Z_j) / H_j with the standard deviation σ_j = x′(Z_j) σ_Z(Z_j) / H_j, where x is the response
//! and σ_Z the noise of the codes, which is measured in the photograph itself. The merge is the mean with the weights
//! s(Z_j) / σ_j², where s falls from 1 to 0 towards saturation; so dark, noisy codes weigh little by themselves. Its variance
//! is 1 / Σ 1/σ_j², times χ² a degree of freedom where the exposures contradict each other by more than their noise.

use crate::CaptureError;
use crate::photo::Photo;
use crate::response::Response;
use gonio_image::Image;
use gonio_num::Real;
use rayon::prelude::*;

/// Codes \[1/255] between which the weight falls to 0: cameras bend their curves just below saturation.
const SHOULDER: [f64; 2] = [235.0, 250.0];
/// Standard deviation of rounding to a step of 1.
const ROUNDING: f64 = 0.288_675;
/// Classes of codes that noise is measured in.
const CLASSES: usize = 16;
/// What is assumed of pictures that hold linear values without telling their noise.
const LINEAR_NOISE: f32 = 0.01;

/// What arrived at the camera, relative to what makes code 255 at exposure 1.
#[derive(Debug, Clone)]
pub struct Radiance {
    /// Radiance.
    pub image: Image,
    /// Standard deviation of the luminance of each pixel, relative to it.
    pub sigma: Vec<f32>,
    /// Every exposure is saturated in a channel: the pixel's radiance is at least what it says.
    pub clipped: Vec<bool>,
}

/// Standard deviation of a photograph's codes \[1/255] in each channel and class of codes.
type Noise = [[f64; CLASSES]; 3];

impl Radiance {
    /// Merges the photographs of one view.
    ///
    /// - `exposures`: one a photograph \[s], > 0
    ///
    /// # Errors
    /// [`CaptureError::Size`] if the photographs differ in size; [`CaptureError::Parameter`] for linear values that are
    /// negative or not finite.
    pub fn merge(
        photos: &[Photo],
        exposures: &[f64],
        response: &Response,
    ) -> Result<Self, CaptureError> {
        Photo::check_sizes(photos)?;
        let first = &photos[0];
        let (width, height) = (first.picture.width, first.picture.height);
        let noise: Vec<Noise> = photos.iter().map(measure_noise).collect();
        let merged: Vec<([f32; 3], f32, bool)> = (0..width * height)
            .into_par_iter()
            .map(|i| pixel(photos, exposures, response, &noise, i))
            .collect();
        let image = Image {
            width,
            height,
            pixels: merged.iter().map(|m| m.0).collect(),
        };
        if let Some(found) = image.scan().first {
            return Err(CaptureError::parameter(
                "radiance of a photograph",
                format!(
                    "{} at pixel ({}, {}) of {}",
                    found.value, found.x, found.y, first.name
                ),
                "finite values ≥ 0",
            ));
        }
        Ok(Self {
            image,
            sigma: merged.iter().map(|m| m.1).collect(),
            clipped: merged.iter().map(|m| m.2).collect(),
        })
    }
}

fn pixel(
    photos: &[Photo],
    exposures: &[f64],
    response: &Response,
    noise: &[Noise],
    i: usize,
) -> ([f32; 3], f32, bool) {
    let mut rgb = [0.0_f32; 3];
    let (mut variance, mut luminance) = (0.0, 0.0);
    let mut clipped = false;
    for c in 0..3 {
        let (mut sum, mut squares, mut weights) = (0.0, 0.0, 0.0);
        let mut counted = 0;
        // The least exposed photograph, for what is saturated in all.
        let mut fallback = (f64::INFINITY, 0.0, 1.0);
        for ((photo, h), noise) in photos.iter().zip(exposures).zip(noise) {
            let code = photo.code(i)[c];
            if !photo.is_coded() {
                let e = f64::from(code) / h;
                let s = (f64::from(LINEAR_NOISE) * e).max(1e-30);
                (sum, squares, weights) = (
                    sum + e / s.sq(),
                    squares + (e / s).sq(),
                    weights + 1.0 / s.sq(),
                );
                counted += 1;
                continue;
            }
            let z = f64::from(code);
            let (x, slope) = response.exposure(c, z);
            let sigma = slope.max(1e-6) * noise[c][class(z)] / h;
            let e = x / h;
            if *h < fallback.0 {
                fallback = (*h, e, sigma);
            }
            let t = ((SHOULDER[1] - z) / (SHOULDER[1] - SHOULDER[0])).saturate();
            let w = t * t * (3.0 - 2.0 * t) / sigma.sq();
            (sum, squares, weights) = (sum + w * e, squares + w * e * e, weights + w);
            counted += usize::from(t > 0.0);
        }
        let (value, spread) = if weights > 0.0 {
            let mean = sum / weights;
            let free = f64::from(u32::try_from(counted).unwrap_or(u32::MAX)) - 1.0;
            let chi2 = (squares - weights * mean * mean).max(0.0);
            let contradiction = if free > 0.0 {
                (chi2 / free).max(1.0)
            } else {
                1.0
            };
            (mean, contradiction / weights)
        } else {
            clipped = true;
            (fallback.1, fallback.2.sq())
        };
        rgb[c] = value as f32;
        let share = [0.2126, 0.7152, 0.0722][c];
        luminance += share * value;
        variance += share * share * spread;
    }
    let sigma = (variance.sqrt() / luminance.max(1e-30)).min(1.0);
    (rgb, sigma as f32, clipped)
}

fn class(code: f64) -> usize {
    ((code * CLASSES as f64 / 256.0) as usize).min(CLASSES - 1)
}

/// Noise by Immerkær 1996, "Fast Noise Variance Estimation": the difference of two Laplacians,
/// \[1 −2 1; −2 4 −2; 1 −2 1], takes away what is linear in x or y and has the standard deviation 6 σ. Instead of its mean
/// the lower quartile is taken, which texture hardly moves: of a normal distribution 0.3186 σ. At least the rounding.
fn measure_noise(photo: &Photo) -> Noise {
    let step = ROUNDING * photo.code_step();
    let (w, h) = (photo.picture.width, photo.picture.height);
    let mut found = [[step; CLASSES]; 3];
    if !photo.is_coded() || w < 3 || h < 3 {
        return found;
    }
    // Some 200,000 places are enough.
    let stride = (((w * h) as f64 / 2e5).sqrt() as usize).max(1);
    let mut samples: [[Vec<f32>; CLASSES]; 3] = Default::default();
    for y in (1..h - 1).step_by(stride) {
        for x in (1..w - 1).step_by(stride) {
            let at = |dx: usize, dy: usize| photo.code((y + dy - 1) * w + x + dx - 1);
            let rows: [[[f32; 3]; 3]; 3] = [0, 1, 2].map(|dy| [at(0, dy), at(1, dy), at(2, dy)]);
            for c in 0..3 {
                let cross = |r: usize| rows[r][0][c] - 2.0 * rows[r][1][c] + rows[r][2][c];
                let d = cross(0) - 2.0 * cross(1) + cross(2);
                let middle = rows[1][1][c];
                if middle < SHOULDER[0] as f32 {
                    samples[c][class(f64::from(middle))].push(d.abs());
                }
            }
        }
    }
    for c in 0..3 {
        let mut last = step;
        for k in 0..CLASSES {
            let s = &mut samples[c][k];
            if s.len() >= 50 {
                let q = s.len() / 4;
                let (_, quartile, _) = s.select_nth_unstable_by(q, f32::total_cmp);
                last = (f64::from(*quartile) / (0.3186 * 6.0)).max(step);
            }
            found[c][k] = last;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::Exif;
    use gonio_image::{RawData, RawImage};
    use gonio_radiometry::sequence::Rng;

    fn gaussian(rng: &mut Rng) -> f64 {
        let r = (-2.0 * Real::ln(1.0 - rng.next_f64())).sqrt();
        r * Real::cos(std::f64::consts::TAU * rng.next_f64())
    }

    /// A linear 16-bit photograph of a ramp of radiance 0.01 … 10 with a noise of `sigma` codes of 255.
    fn shot(h: f64, sigma: f64, name: &str) -> Photo {
        let mut rng = Rng::from_name(name);
        let data = (0..256 * 64)
            .map(|i| {
                let e = Real::exp(6.9 * (i % 256) as f64 / 256.0 - 4.6);
                let z = 255.0 * e * h + sigma * gaussian(&mut rng);
                let code = (257.0 * z + 0.5).clamp(0.0, 65535.0) as u16;
                [code, code, code, 65535]
            })
            .collect();
        let picture = RawImage {
            width: 256,
            height: 64,
            data: RawData::U16(data),
            has_alpha: false,
        };
        Photo::new(name, picture, Exif::default())
    }

    /// The merge's pulls (value − truth)/σ are those of a normal distribution if its uncertainty is right: their mean square is
    /// 1 ± √(2/n), n = 16,384 · share; the estimate of the noise itself is good to about 5 % (quartile of 1,000 samples),
    /// and clipping at code 0 cuts the dark end, which is left out.
    #[test]
    fn uncertainty_is_what_scatters() {
        let exposures = [1.0, 0.1];
        let photos = [
            shot(1.0, 1.0, "uncertainty a"),
            shot(0.1, 1.0, "uncertainty b"),
        ];
        let merged = Radiance::merge(&photos, &exposures, &Response::linear()).unwrap();
        let (mut sum, mut n) = (0.0, 0);
        for (i, (p, s)) in merged.image.pixels.iter().zip(&merged.sigma).enumerate() {
            let e = Real::exp(6.9 * (i % 256) as f64 / 256.0 - 4.6);
            if merged.clipped[i] || e < 0.03 {
                continue;
            }
            // The three channels hold the same numbers: their errors don't average as σ supposes.
            let luminance_share = (0.2126_f64.sq() + 0.7152_f64.sq() + 0.0722_f64.sq()).sqrt();
            let sigma = f64::from(*s) * f64::from(p[0]) / luminance_share;
            sum += ((f64::from(p[0]) - e) / sigma).sq();
            n += 1;
        }
        let chi2 = sum / f64::from(n);
        assert!(n > 10_000 && (chi2 - 1.0).abs() < 0.2, "{chi2} of {n}");
        // Negative control: half the uncertainty would make it 4.
        assert!((4.0 * chi2 - 1.0).abs() > 0.2);
    }

    #[test]
    fn what_is_saturated_everywhere_is_marked() {
        let merged = Radiance::merge(&[shot(1.0, 0.0, "s")], &[1.0], &Response::linear()).unwrap();
        // 255 e = 250 is at column 123.6 … : ln(250/255) = −0.0198, (4.6 − 0.0198)/6.9 · 256 = 169.9.
        assert!(!merged.clipped[160] && merged.clipped[175]);
        let both = [shot(1.0, 0.0, "s"), shot(0.05, 0.0, "t")];
        let merged = Radiance::merge(&both, &[1.0, 0.05], &Response::linear()).unwrap();
        assert!(!merged.clipped[200]);
        let e = Real::exp(6.9 * 200.0 / 256.0 - 4.6);
        assert!((f64::from(merged.image.pixels[200][0]) / e - 1.0).abs() < 1e-3);
    }

    #[test]
    fn sizes_must_agree() {
        let mut other = shot(0.1, 0.0, "other");
        other.picture.height = 32;
        let photos = [shot(1.0, 0.0, "one"), other];
        let error = Radiance::merge(&photos, &[1.0, 0.1], &Response::linear()).unwrap_err();
        assert_eq!(
            error.to_string(),
            "other: 256 × 32 pixels, but one has 256 × 64: exposures of one view must be of one size"
        );
    }
}
