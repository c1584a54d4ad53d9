//! Tone mapping: from linear light of any brightness to what a display can show.
//!
//! Every curve takes linear Rec. 709 RGB and gives *display-linear* RGB in [0, 1]; the sRGB transfer comes after
//! ([`encode_srgb8`]). A negative or NaN component counts as 0 and +∞ as the largest `f32`, so a curve never gives NaN.
//! Exposure is a factor 2^EV before the curve ([`exposure_scale`]).

use crate::{ImageError, srgb};
use gonio_num::Real;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// A tone curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ToneMap {
    /// No curve: values above 1 clip.
    Linear,
    /// ACES-like: Stephen Hill's fit of the reference rendering transform and the 100-nit sRGB output transform of ACES
    /// 1.0 (published in "Baking Lab", 2016). Saturated highlights run to white.
    Aces,
    /// AgX, the base look without a grade: Troy Sobotka's transform (2022), with Benjamin Wrensch's polynomial for its
    /// contrast curve ("Minimal AgX Implementation", 2023) over 16.5 stops from 2^−12.47393 to 2^4.026069.
    AgX,
    /// Khronos PBR Neutral (specification of 2024): below 0.76 colours stay as they are, less the 4 % that a dielectric
    /// reflects at normal incidence; above, the brightest component is compressed and the colour fades towards white.
    #[default]
    PbrNeutral,
}

/// 2^`ev`. An integer `ev` gives the exact power.
///
/// `ev`: stops, clamped to [−126, 127]; NaN counts as 0.
pub fn exposure_scale(ev: f32) -> f32 {
    let ev = if ev.is_nan() { 0.0 } else { f64::from(ev) };
    let ev = ev.clamp(-126.0, 127.0);
    let whole = Real::floor(ev);
    let power = f64::from_bits(((whole as i64 + 1023) as u64) << 52);
    let rest = ev - whole;
    if rest == 0.0 {
        return power as f32;
    }
    (power * Real::exp(rest * std::f64::consts::LN_2)) as f32
}

/// Nearest 8-bit sRGB codes of display-linear `rgb`. Clamps; NaN gives 0.
pub fn encode_srgb8(rgb: [f32; 3]) -> [u8; 3] {
    rgb.map(srgb::encode8)
}

impl ToneMap {
    /// Every curve, in the order of the documentation.
    pub const ALL: [Self; 4] = [Self::Linear, Self::Aces, Self::AgX, Self::PbrNeutral];

    /// The name that [`FromStr`] takes.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Aces => "aces",
            Self::AgX => "agx",
            Self::PbrNeutral => "pbr-neutral",
        }
    }

    /// Maps linear `rgb` to display-linear RGB in [0, 1].
    pub fn apply(self, rgb: [f32; 3]) -> [f32; 3] {
        // NaN fails the comparison, and becomes 0 with the negative ones.
        let light = rgb.map(|c| if c > 0.0 { c.min(f32::MAX) } else { 0.0 });
        let shown = match self {
            Self::Linear => light,
            Self::Aces => aces(light),
            Self::AgX => agx(light),
            Self::PbrNeutral => pbr_neutral(light),
        };
        shown.map(|c| c.clamp(0.0, 1.0))
    }
}

impl fmt::Display for ToneMap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ToneMap {
    type Err = ImageError;

    /// `linear` (or `srgb`), `aces`, `agx`, `pbr-neutral` (or `neutral`), in capitals or not.
    fn from_str(text: &str) -> Result<Self, ImageError> {
        match text.to_ascii_lowercase().as_str() {
            "linear" | "srgb" => Ok(Self::Linear),
            "aces" => Ok(Self::Aces),
            "agx" => Ok(Self::AgX),
            "pbr-neutral" | "pbr_neutral" | "pbrneutral" | "neutral" => Ok(Self::PbrNeutral),
            _ => Err(ImageError::parameter(format!(
                "`{text}` is no tone map: linear, aces, agx and pbr-neutral are"
            ))),
        }
    }
}

/// Rows times a column.
fn transform(matrix: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    [
        matrix[0][0] * v[0] + matrix[0][1] * v[1] + matrix[0][2] * v[2],
        matrix[1][0] * v[0] + matrix[1][1] * v[1] + matrix[1][2] * v[2],
        matrix[2][0] * v[0] + matrix[2][1] * v[1] + matrix[2][2] * v[2],
    ]
}

/// Rec. 709 to AP1 at D60, with the saturation matrix of the rendering transform.
const ACES_IN: [[f32; 3]; 3] = [
    [0.59719, 0.35458, 0.04823],
    [0.07600, 0.90834, 0.01566],
    [0.02840, 0.13383, 0.83777],
];

/// The output transform's saturation, then AP1 to Rec. 709 at D65.
const ACES_OUT: [[f32; 3]; 3] = [
    [1.60475, -0.53108, -0.07367],
    [-0.10208, 1.10813, -0.00605],
    [-0.00327, -0.07276, 1.07602],
];

/// Above this the rational curve is flat to the last bit of `f32`, and its squares would overflow.
const ACES_LARGEST: f32 = 1e9;

fn aces(rgb: [f32; 3]) -> [f32; 3] {
    let fitted = transform(&ACES_IN, rgb.map(|c| c.min(ACES_LARGEST))).map(|v| {
        let above = v * (v + 0.024_578_6) - 0.000_090_537;
        let below = v * (0.983_729 * v + 0.432_951) + 0.238_081;
        above / below
    });
    transform(&ACES_OUT, fitted)
}

/// Towards the inset primaries that keep saturated light from clipping to a hue.
const AGX_IN: [[f32; 3]; 3] = [
    [0.842_479_1, 0.078_433_6, 0.079_223_745],
    [0.042_328_24, 0.878_468_6, 0.079_166_13],
    [0.042_375_656, 0.078_433_6, 0.879_143],
];

/// Back from them.
const AGX_OUT: [[f32; 3]; 3] = [
    [1.196_879, -0.098_020_88, -0.099_029_74],
    [-0.052_896_85, 1.151_903_1, -0.098_961_18],
    [-0.052_971_635, -0.098_043_45, 1.151_073_7],
];

const AGX_DARKEST_EV: f32 = -12.473_93;
const AGX_BRIGHTEST_EV: f32 = 4.026_069;

fn agx(rgb: [f32; 3]) -> [f32; 3] {
    let inset = transform(&AGX_IN, rgb.map(|c| c.min(1e9)));
    let curved = inset.map(|v| {
        let stops = Real::ln(v.max(1e-10)) * std::f32::consts::LOG2_E;
        let x = ((stops - AGX_DARKEST_EV) / (AGX_BRIGHTEST_EV - AGX_DARKEST_EV)).clamp(0.0, 1.0);
        let (x2, x4) = (x * x, x * x * x * x);
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x
            - 0.002_32
    });
    // The curve ends in the encoding of a display with exponent 2.2.
    transform(&AGX_OUT, curved).map(|c| Real::powf(c.max(0.0), 2.2))
}

fn pbr_neutral(rgb: [f32; 3]) -> [f32; 3] {
    const F90_OFFSET: f32 = 0.04;
    const START: f32 = 0.8 - F90_OFFSET;
    const DESATURATION: f32 = 0.15;
    let least = rgb[0].min(rgb[1]).min(rgb[2]);
    let offset = if least < 2.0 * F90_OFFSET {
        least - 6.25 * least * least
    } else {
        F90_OFFSET
    };
    let colour = rgb.map(|c| c - offset);
    let peak = colour[0].max(colour[1]).max(colour[2]);
    if peak < START {
        return colour;
    }
    let room = 1.0 - START;
    let new_peak = 1.0 - room * room / (peak + room - START);
    let fade = 1.0 - 1.0 / (DESATURATION * (peak - new_peak) + 1.0);
    colour.map(|c| (1.0 - fade) * (c / peak * new_peak) + fade * new_peak)
}

#[cfg(test)]
mod tests;
