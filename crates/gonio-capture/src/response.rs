//! [`Response`], from a photograph's codes to what its sensor received.
//!
//! Debevec & Malik 1997, "Recovering High Dynamic Range Radiance Maps from Photographs": a code Z is f(E H) for the light E
//! that arrives at a pixel and the exposure H of its photograph. With g = ln f⁻¹ the codes of some pixels i in photographs
//! j determine g(0) … g(255) and each ln E_i as the least squares of their equation 3,
//!
//! ```text
//! Σ_ij w(Z_ij)² (g(Z_ij) − ln E_i − ln H_j)² + λ Σ_z w(z)² (g(z−1) − 2 g(z) + g(z+1))²
//! ```
//!
//! with the hat w, largest in the middle. Each ln E_i stands alone in its own equations and is eliminated: 256 unknowns
//! remain, whatever the number of pixels. One number is free in each channel: the middle code is set to what sRGB gives it,
//! so that what the camera showed as grey is grey.

use crate::photo::Photo;
use crate::{CaptureError, solve};
use gonio_image::srgb;
use gonio_num::Real;
use gonio_radiometry::sequence::Rng;
use std::fmt;

/// Codes of a channel, 0 to 255.
const CODES: usize = 256;
/// The code whose value is fixed.
const MIDDLE: usize = 128;
/// λ of the smoothness; Debevec & Malik advise more where the codes are noisy.
const SMOOTHNESS: f64 = 40.0;
/// Pixels that the curve is fitted to. Debevec & Malik ask for N (P − 1) > 255 equations; this is plenty.
const PIXELS: usize = 1500;
/// RMS of the fit in ln E beyond which exposures and pictures contradict each other: half a stop.
const WORST_RMS: f64 = 0.35;

/// Which response curve a photograph has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ResponseChoice {
    /// Recovered from several exposures of codes; sRGB for one.
    #[default]
    Auto,
    /// The sRGB transfer function.
    Srgb,
    /// Codes are proportional to light.
    Linear,
    /// Recovered, or an error.
    Recover,
}

/// Where a [`Response`] came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Origin {
    /// sRGB's transfer function, assumed.
    Srgb,
    /// Proportional to light.
    Linear,
    /// Recovered; the RMS of its fit in ln E.
    Recovered(f64),
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Srgb => f.write_str("sRGB, assumed"),
            Self::Linear => f.write_str("linear"),
            Self::Recovered(rms) => write!(f, "recovered, RMS {:.1} %", 100.0 * rms),
        }
    }
}

/// The relative exposure that makes each code, in each channel: increasing, 0 for code 0 where it is linear or sRGB.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    table: [Vec<f64>; 3],
    origin: Origin,
}

impl Response {
    /// Codes proportional to light: 255 is 1.
    pub fn linear() -> Self {
        Self::same(Origin::Linear, |code| code / 255.0)
    }

    /// The sRGB transfer function: 255 is 1.
    pub fn srgb() -> Self {
        Self::same(Origin::Srgb, |code| srgb::decode(code / 255.0))
    }

    fn same(origin: Origin, f: impl Fn(f64) -> f64) -> Self {
        let channel: Vec<f64> = (0..CODES).map(|z| f(z as f64)).collect();
        Self {
            table: [channel.clone(), channel.clone(), channel],
            origin,
        }
    }

    /// Where it came from.
    pub fn origin(&self) -> Origin {
        self.origin
    }

    /// The exposures of the codes 0 to 255 of a channel.
    pub fn channel(&self, channel: usize) -> &[f64] {
        &self.table[channel]
    }

    /// Relative exposure of a code in \[0, 255], and its derivative by the code; between codes linear.
    pub fn exposure(&self, channel: usize, code: f64) -> (f64, f64) {
        let table = &self.table[channel];
        let z = code.clamp(0.0, 255.0);
        let i = (z as usize).min(CODES - 2);
        let slope = table[i + 1] - table[i];
        (table[i] + slope * (z - i as f64), slope)
    }

    /// Recovers the curve of photographs of one view, whose exposures \[s] are known and not all equal.
    ///
    /// # Errors
    /// [`CaptureError::Response`] if too few pixels are neither black nor saturated in two photographs, or if the fit
    /// contradicts itself.
    pub fn recover(photos: &[Photo], exposures: &[f64]) -> Result<Self, CaptureError> {
        let chosen = choose_pixels(photos);
        let ln_h: Vec<f64> = exposures.iter().map(|h| Real::ln(*h)).collect();
        let mut table = [Vec::new(), Vec::new(), Vec::new()];
        let mut worst = 0.0_f64;
        for (c, channel) in table.iter_mut().enumerate() {
            let codes: Vec<Vec<f64>> = chosen
                .iter()
                .map(|i| photos.iter().map(|p| f64::from(p.code(*i)[c])).collect())
                .collect();
            let (g, rms) = fit(&codes, &ln_h)?;
            worst = worst.max(rms);
            *channel = g;
        }
        if worst > WORST_RMS {
            return Err(CaptureError::Response {
                reason: format!(
                    "exposures and codes contradict each other by {:.0} % (the camera or the scene moved, or the exposures are wrong)",
                    100.0 * worst
                ),
            });
        }
        Ok(Self {
            table,
            origin: Origin::Recovered(worst),
        })
    }
}

/// Debevec & Malik's weight, in \[0, 1]: 0 at the ends.
fn hat(code: f64) -> f64 {
    (code.min(255.0 - code) / 127.5).max(0.0)
}

/// Pixels spread over the picture and over its brightnesses, away from edges, where a shift by a fraction of a pixel would show.
fn choose_pixels(photos: &[Photo]) -> Vec<usize> {
    let (w, h) = (photos[0].picture.width, photos[0].picture.height);
    if w < 4 || h < 4 {
        return (0..w * h).collect();
    }
    let grey = |p: &Photo, i: usize| p.code(i).iter().sum::<f32>() / 3.0;
    let mut rng = Rng::from_name("pixels of the response curve");
    // Sixteen classes of the mean code, each filled with the flattest pixels of a random choice.
    let mut classes: Vec<Vec<(f32, usize)>> = vec![Vec::new(); 16];
    for _ in 0..(40 * PIXELS).min(4 * w * h) {
        let x = 1 + (rng.next_f64() * (w - 2) as f64) as usize;
        let y = 1 + (rng.next_f64() * (h - 2) as f64) as usize;
        let i = y * w + x;
        let mut mean = 0.0;
        let mut rough = 0.0_f32;
        for p in photos {
            let here = grey(p, i);
            mean += here / photos.len() as f32;
            for j in [i - 1, i + 1, i - w, i + w] {
                rough = rough.max((grey(p, j) - here).abs());
            }
        }
        classes[((mean / 16.0) as usize).min(15)].push((rough, i));
    }
    let mut chosen = Vec::with_capacity(PIXELS);
    for mut class in classes {
        class.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        class.dedup_by_key(|(_, i)| *i);
        chosen.extend(class.iter().take(PIXELS / 16).map(|(_, i)| *i));
    }
    chosen
}

/// exp g for codes 0 to 255, and the RMS of the fit.
fn fit(codes: &[Vec<f64>], ln_h: &[f64]) -> Result<(Vec<f64>, f64), CaptureError> {
    let mut a = vec![0.0; CODES * CODES];
    let mut b = vec![0.0; CODES];
    let mut useful = 0;
    for pixel in codes {
        let weights: Vec<f64> = pixel.iter().map(|z| hat(*z).sq()).collect();
        let total: f64 = weights.iter().sum();
        if weights.iter().filter(|w| **w > 0.0).count() < 2 {
            continue;
        }
        useful += 1;
        // ln E = Σ w (g − ln H) / Σ w put back: the residuals are g_j − ln H_j less their weighted mean. A code between two
        // entries of the table is their interpolation.
        let mut mean_row: Vec<(usize, f64)> = Vec::with_capacity(2 * pixel.len());
        let mut mean_h = 0.0;
        for ((z, w), h) in pixel.iter().zip(&weights).zip(ln_h) {
            let i = (*z as usize).min(CODES - 2);
            let t = z - i as f64;
            mean_row.push((i, (1.0 - t) * w / total));
            mean_row.push((i + 1, t * w / total));
            mean_h += w * h / total;
        }
        for ((z, w), h) in pixel.iter().zip(&weights).zip(ln_h) {
            let i = (*z as usize).min(CODES - 2);
            let t = z - i as f64;
            let mut row = vec![(i, 1.0 - t), (i + 1, t)];
            row.extend(mean_row.iter().map(|(i, m)| (*i, -m)));
            for (p, x) in &row {
                for (q, y) in &row {
                    a[p * CODES + q] += w * x * y;
                }
                b[*p] += w * x * (h - mean_h);
            }
        }
    }
    if useful < 32 {
        return Err(CaptureError::Response {
            reason: format!(
                "only {useful} pixels are neither black nor saturated in two photographs"
            ),
        });
    }
    // The sum's weight grows with the pixels; so does the smoothness, to mean the same for any number.
    let lambda = SMOOTHNESS * useful as f64 / CODES as f64;
    for z in 1..CODES - 1 {
        // Where the hat vanishes a little smoothness remains, which continues the curve straight.
        let w = lambda * (hat(z as f64) + 0.02).sq();
        for (p, x) in [(z - 1, 1.0), (z, -2.0), (z + 1, 1.0)] {
            for (q, y) in [(z - 1, 1.0), (z, -2.0), (z + 1, 1.0)] {
                a[p * CODES + q] += w * x * y;
            }
        }
    }
    let anchor = useful as f64;
    a[MIDDLE * CODES + MIDDLE] += anchor;
    b[MIDDLE] += anchor * Real::ln(srgb::decode(MIDDLE as f64 / 255.0));
    solve::cholesky(&mut a, &mut b).ok_or_else(|| CaptureError::Response {
        reason: "the exposures don't determine it".into(),
    })?;
    make_monotone(&mut b);
    let rms = residual(codes, ln_h, &b);
    Ok((b.into_iter().map(Real::exp).collect(), rms))
}

/// The nearest non-decreasing sequence in least squares, by pooling adjacent violators.
fn make_monotone(g: &mut [f64]) {
    let mut pools: Vec<(f64, usize)> = Vec::with_capacity(g.len());
    for value in g.iter() {
        pools.push((*value, 1));
        while let [.., (a, n), (b, m)] = pools[..]
            && a > b
        {
            pools.truncate(pools.len() - 2);
            pools.push(((a * n as f64 + b * m as f64) / (n + m) as f64, n + m));
        }
    }
    let mut k = 0;
    for (value, n) in pools {
        g[k..k + n].fill(value);
        k += n;
    }
}

fn residual(codes: &[Vec<f64>], ln_h: &[f64], g: &[f64]) -> f64 {
    let at = |z: f64| {
        let i = (z as usize).min(CODES - 2);
        g[i] + (g[i + 1] - g[i]) * (z - i as f64)
    };
    let (mut sum, mut total) = (0.0, 0.0);
    for pixel in codes {
        let terms = || {
            pixel
                .iter()
                .zip(ln_h)
                .map(|(z, h)| (hat(*z).sq(), at(*z) - h))
        };
        if terms().filter(|(w, _)| *w > 0.0).count() < 2 {
            continue;
        }
        let all: f64 = terms().map(|(w, _)| w).sum();
        let mean = terms().map(|(w, e)| w * e).sum::<f64>() / all;
        sum += terms().map(|(w, e)| w * (e - mean).sq()).sum::<f64>();
        total += all;
    }
    (sum / f64::max(total, 1e-30)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photo::Exif;
    use gonio_image::{RawData, RawImage};

    /// A ramp of radiance over four decades through `curve`, once for each exposure, in 8-bit codes.
    fn ramp(exposures: &[f64], curve: impl Fn(f64) -> f64) -> Vec<Photo> {
        exposures
            .iter()
            .map(|h| {
                let data = (0..128 * 64)
                    .map(|i| {
                        let e = Real::exp((i % 128) as f64 / 128.0 * 9.2 - 4.6);
                        let code = (255.0 * curve(e * h) + 0.5).clamp(0.0, 255.0) as u8;
                        [code, code, code, 255]
                    })
                    .collect();
                let picture = RawImage {
                    width: 128,
                    height: 64,
                    data: RawData::U8(data),
                    has_alpha: false,
                };
                Photo::new("ramp", picture, Exif::default())
            })
            .collect()
    }

    const STOPS: [f64; 5] = [1.0, 0.25, 0.0625, 0.015_625, 0.003_906_25];

    /// Half a code is 0.5/255 of the curve; for a curve x^(1/γ) that is γ · 0.5/Z of the exposure: 2.2 % at code 50 and γ = 2.2.
    /// Many codes average; a bound of 3 % holds without luck.
    #[test]
    fn a_gamma_curve_is_recovered() {
        let gamma = 2.2;
        let photos = ramp(&STOPS, |x| Real::powf(x.min(1.0), 1.0 / gamma));
        let found = Response::recover(&photos, &STOPS).unwrap();
        let at = |z: f64| Real::powf(z / 255.0, gamma);
        let scale = srgb::decode(128.0 / 255.0) / at(128.0);
        for z in 50..=235 {
            let (x, slope) = found.exposure(1, f64::from(z));
            let expected = scale * at(f64::from(z));
            assert!((x / expected - 1.0).abs() < 0.03, "{z} {x} {expected}");
            assert!(slope > 0.0);
        }
        // Negative control: it is not linear.
        let (dark, bright) = (found.exposure(1, 60.0).0, found.exposure(1, 180.0).0);
        assert!((bright / dark / 3.0 - 1.0).abs() > 1.0);
    }

    #[test]
    fn wrong_exposures_are_noticed() {
        let photos = ramp(&STOPS, |x| Real::powf(x.min(1.0), 1.0 / 2.2));
        let wrong = [1.0, 0.9, 0.0625, 0.05, 0.003_906_25];
        match Response::recover(&photos, &wrong) {
            Err(CaptureError::Response { reason }) => assert!(reason.contains("contradict")),
            Ok(found) => {
                let Origin::Recovered(rms) = found.origin() else {
                    panic!()
                };
                let right = Response::recover(&photos, &STOPS).unwrap();
                let Origin::Recovered(good) = right.origin() else {
                    panic!()
                };
                assert!(rms > 5.0 * good, "{rms} {good}");
            }
            Err(e) => panic!("{e}"),
        }
    }

    #[test]
    fn black_photographs_tell_nothing() {
        let photos = ramp(&[1.0, 0.5], |_| 0.0);
        let error = Response::recover(&photos, &[1.0, 0.5]).unwrap_err();
        assert!(error.to_string().contains("only 0 pixels"), "{error}");
    }

    #[test]
    fn given_curves_are_exact() {
        assert_eq!(Response::linear().exposure(0, 51.0).0, 0.2);
        assert_eq!(
            Response::srgb().exposure(2, 128.0).0,
            srgb::decode(128.0 / 255.0)
        );
        assert_eq!(Response::srgb().exposure(2, 300.0).0, 1.0);
    }

    #[test]
    fn pools_violators() {
        let mut g = [0.0, 2.0, 1.0, 3.0, 2.0, 1.0];
        make_monotone(&mut g);
        assert_eq!(g, [0.0, 1.5, 1.5, 2.0, 2.0, 2.0]);
    }
}
