//! How far a picture is from a reference.
//!
//! With a the picture, b the reference, n the number of samples (three a pixel):
//!
//! | figure | equation |
//! |---|---|
//! | RMSE | √(Σ (a − b)² / n) |
//! | relative MSE | Σ (a − b)² / (b² + 0.01) / n |
//! | PSNR in dB | 20 log₁₀(peak / RMSE) |
//! | ꟻLIP | what an observer who flips between the two sees, in [0, 1]; module [`flip`] |
//!
//! The first three are of linear values, in `f64`, summed row by row.

pub mod flip;

use crate::{Found, Image, ImageError, colormap};
use flip::FlipKind;
use gonio_num::Real;
use serde::Serialize;

/// Added to b² in the relative error, so that black pixels do not divide by 0.
const RELATIVE_FLOOR: f64 = 1e-2;

/// Which ꟻLIP to compute.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FlipMode {
    /// HDR-ꟻLIP if a sample of either picture is above 1, LDR-ꟻLIP otherwise.
    #[default]
    Auto,
    /// LDR-ꟻLIP of values clamped to [0, 1].
    Ldr,
    /// HDR-ꟻLIP.
    Hdr,
}

/// How to compare.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Which ꟻLIP.
    pub flip: FlipMode,
    /// Pixels in a degree of the observer's field of view, in [1, 1000]. The default, 67.02, is the one of the ꟻLIP papers: a
    /// screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
    pub pixels_per_degree: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            flip: FlipMode::Auto,
            pixels_per_degree: 3840.0 * std::f64::consts::PI / 180.0,
        }
    }
}

/// The largest absolute difference of a sample, and where it is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Largest {
    /// Column, from the left.
    pub x: usize,
    /// Row, from the top.
    pub y: usize,
    /// 0 red, 1 green, 2 blue.
    pub channel: usize,
    /// The picture's value.
    pub a: f32,
    /// The reference's value.
    pub b: f32,
    /// |a − b|.
    pub difference: f64,
}

/// What [`compare`] found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Difference {
    /// Columns of both pictures.
    pub width: usize,
    /// Rows of both pictures.
    pub height: usize,
    /// Root of the mean squared error, in the pictures' unit.
    pub rmse: f64,
    /// Mean of (a − b)² / (b² + 0.01).
    pub relative_mse: f64,
    /// Peak signal-to-noise ratio in dB; +∞ (`null` in JSON) for equal pictures.
    pub psnr_db: f64,
    /// The peak of the PSNR: the reference's largest sample, at least 1.
    pub peak: f64,
    /// Mean of the ꟻLIP map, in [0, 1]; 0 for equal pictures.
    pub flip_mean: f64,
    /// Which ꟻLIP it is, and at which exposures.
    pub flip: FlipKind,
    /// Pixels in a degree of the observer's field of view.
    pub pixels_per_degree: f64,
    /// The first of the largest differences.
    pub largest: Largest,
    /// ꟻLIP of every pixel, row after row from the top left.
    #[serde(skip)]
    pub flip_map: Vec<f32>,
}

/// Compares the picture `a` with the reference `b`, with default [`Options`].
///
/// # Errors
/// `Parameter` for pictures of different sizes, without pixels, or with a NaN or an infinity: it has no difference to
/// anything, so its place is told instead.
pub fn compare(a: &Image, b: &Image) -> Result<Difference, ImageError> {
    compare_with(a, b, &Options::default())
}

/// [`compare`] with other options.
///
/// # Errors
/// As [`compare`], and `Parameter` for `pixels_per_degree` outside [1, 1000].
pub fn compare_with(a: &Image, b: &Image, options: &Options) -> Result<Difference, ImageError> {
    check(a, b, options)?;
    let n = (3 * a.pixels.len()) as f64;
    let (mut squares, mut relative, mut peak) = (0.0f64, 0.0f64, 1.0f64);
    let mut largest = Largest {
        x: 0,
        y: 0,
        channel: 0,
        a: a.pixels[0][0],
        b: b.pixels[0][0],
        difference: 0.0,
    };
    for (row, (row_a, row_b)) in a
        .pixels
        .chunks(a.width)
        .zip(b.pixels.chunks(b.width))
        .enumerate()
    {
        let (mut row_squares, mut row_relative) = (0.0, 0.0);
        for (x, (pixel_a, pixel_b)) in row_a.iter().zip(row_b).enumerate() {
            for (channel, (&a, &b)) in pixel_a.iter().zip(pixel_b).enumerate() {
                let reference = f64::from(b);
                let difference = f64::from(a) - reference;
                let square = difference * difference;
                row_squares += square;
                row_relative += square / (reference * reference + RELATIVE_FLOOR);
                peak = peak.max(reference);
                if difference.abs() > largest.difference {
                    largest = Largest {
                        x,
                        y: row,
                        channel,
                        a,
                        b,
                        difference: difference.abs(),
                    };
                }
            }
        }
        squares += row_squares;
        relative += row_relative;
    }
    let rmse = (squares / n).sqrt();
    let above_one = |image: &Image| image.pixels.iter().flatten().any(|&c| c > 1.0);
    let hdr = match options.flip {
        FlipMode::Auto => above_one(a) || above_one(b),
        FlipMode::Ldr => false,
        FlipMode::Hdr => true,
    };
    let (flip_map, kind) = if hdr {
        flip::hdr(a, b, options.pixels_per_degree)
    } else {
        (flip::ldr(a, b, options.pixels_per_degree), FlipKind::Ldr)
    };
    let flip_mean = flip_map.iter().map(|&e| f64::from(e)).sum::<f64>() / flip_map.len() as f64;
    Ok(Difference {
        width: a.width,
        height: a.height,
        rmse,
        relative_mse: relative / n,
        psnr_db: if rmse == 0.0 {
            f64::INFINITY
        } else {
            20.0 * Real::ln(peak / rmse) / std::f64::consts::LN_10
        },
        peak,
        flip_mean,
        flip: kind,
        pixels_per_degree: options.pixels_per_degree,
        largest,
        flip_map,
    })
}

fn check(a: &Image, b: &Image, options: &Options) -> Result<(), ImageError> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(ImageError::parameter(format!(
            "pictures of {} × {} and {} × {} pixels cannot be compared: their sizes differ",
            a.width, a.height, b.width, b.height
        )));
    }
    if !(1.0..=1000.0).contains(&options.pixels_per_degree) {
        return Err(ImageError::parameter(format!(
            "pixels per degree: found {}, expected 1 to 1000",
            options.pixels_per_degree
        )));
    }
    for (image, name) in [(a, "first"), (b, "second")] {
        let pixels = image.width * image.height;
        if pixels == 0 || image.pixels.len() != pixels {
            return Err(ImageError::parameter(format!(
                "the {name} picture of {} × {} has {} pixels: nothing to compare",
                image.width,
                image.height,
                image.pixels.len()
            )));
        }
        if let Some(found) = first_non_finite(image) {
            return Err(ImageError::parameter(format!(
                "the {name} picture has {} in channel {} of pixel ({}, {}): no difference can be told",
                found.value,
                ["R", "G", "B"][found.channel],
                found.x,
                found.y
            )));
        }
    }
    Ok(())
}

fn first_non_finite(image: &Image) -> Option<Found> {
    image.pixels.iter().enumerate().find_map(|(i, pixel)| {
        let channel = pixel.iter().position(|c| !c.is_finite())?;
        Some(Found {
            x: i % image.width,
            y: i / image.width,
            channel,
            value: pixel[channel],
        })
    })
}

/// The ꟻLIP map as a picture: dark where nothing differs, bright where much does ([`colormap::magma`] over [0, 1]).
pub fn heatmap(difference: &Difference) -> Image {
    Image {
        width: difference.width,
        height: difference.height,
        pixels: difference
            .flip_map
            .iter()
            .map(|&e| colormap::magma(e))
            .collect(),
    }
}

#[cfg(test)]
mod tests;
