//! RGB spaces.

use super::{Matrix3, bradford, xyz_of_xy};
use crate::RadiometryError;
use std::str::FromStr;

/// A linear RGB space: three primaries and a white point.
///
/// RGB (1, 1, 1) is the white point with Y = 1. Transfer functions aren't part of it: sRGB and Rec.709 share one space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RgbSpace {
    /// Its name.
    pub name: &'static str,
    /// Chromaticities (x, y) of red, green and blue.
    pub primaries: [[f64; 2]; 3],
    /// Chromaticity (x, y) of white.
    pub white: [f64; 2],
}

/// The white of D65 as the RGB standards round it.
const D65: [f64; 2] = [0.3127, 0.3290];
/// The white of ACES, near D60. Source: SMPTE ST 2065-1.
const ACES: [f64; 2] = [0.32168, 0.33767];

impl RgbSpace {
    /// sRGB and Rec.709: what `[R; 3]` is in this project unless stated. Source: IEC 61966-2-1, ITU-R BT.709.
    pub const SRGB: Self = Self {
        name: "sRGB",
        primaries: [[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]],
        white: D65,
    };
    /// Rec.2020, of ultra-high-definition television. Source: ITU-R BT.2020.
    pub const REC2020: Self = Self {
        name: "Rec.2020",
        primaries: [[0.708, 0.292], [0.170, 0.797], [0.131, 0.046]],
        white: D65,
    };
    /// DCI-P3, of cinema projectors. Source: SMPTE RP 431-2.
    pub const DCI_P3: Self = Self {
        name: "DCI-P3",
        primaries: [[0.680, 0.320], [0.265, 0.690], [0.150, 0.060]],
        white: [0.314, 0.351],
    };
    /// Display P3: the primaries of DCI-P3 with the white of D65. Source: SMPTE EG 432-1.
    pub const DISPLAY_P3: Self = Self {
        name: "Display P3",
        white: D65,
        ..Self::DCI_P3
    };
    /// ACEScg, with the primaries AP1. Source: Academy S-2014-004.
    pub const ACESCG: Self = Self {
        name: "ACEScg",
        primaries: [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044]],
        white: ACES,
    };
    /// ACES2065-1, with the primaries AP0, which enclose all colours. Source: SMPTE ST 2065-1.
    pub const ACES2065_1: Self = Self {
        name: "ACES2065-1",
        primaries: [[0.7347, 0.2653], [0.0, 1.0], [0.0001, -0.077]],
        white: ACES,
    };
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::SRGB,
        Self::REC2020,
        Self::DCI_P3,
        Self::DISPLAY_P3,
        Self::ACESCG,
        Self::ACES2065_1,
    ];

    /// Relative luminance of the primaries of [`RgbSpace::SRGB`]: 0.2126, 0.7152, 0.0722 to four digits.
    pub const SRGB_LUMINANCE_WEIGHTS: [f64; 3] = Self::SRGB.luminance_weights();

    /// Relative luminance of the primaries, which sums to 1: the Y row of [`RgbSpace::to_xyz`].
    pub const fn luminance_weights(&self) -> [f64; 3] {
        // Cramer's rule on Σ Yᵢ (xᵢ/yᵢ, 1, (1 − xᵢ − yᵢ)/yᵢ) = white; with gᵢ = Yᵢ/yᵢ the unknowns are Σ gᵢ (xᵢ, yᵢ, 1 − xᵢ − yᵢ),
        // and adding the first two rows to the third makes it Σ gᵢ = 1/y_w.
        let [r, g, b] = self.primaries;
        let w = self.white;
        let area = cross(r, g, b);
        [
            r[1] * cross(w, g, b) / area / w[1],
            g[1] * cross(r, w, b) / area / w[1],
            b[1] * cross(r, g, w) / area / w[1],
        ]
    }

    /// XYZ of the white point, Y = 1.
    pub fn white_xyz(&self) -> [f64; 3] {
        xyz_of_xy(self.white)
    }

    /// Linear RGB to XYZ, relative to this space's white.
    pub fn to_xyz(&self) -> Matrix3 {
        let weights = self.luminance_weights();
        let mut columns = [[0.0; 3]; 3];
        for (k, column) in columns.iter_mut().enumerate() {
            let [x, y] = self.primaries[k];
            // Not through xyz_of_xyy: a primary may have y near 0 with a weight that cancels it.
            let s = weights[k] / y;
            *column = [x * s, weights[k], (1.0 - x - y) * s];
        }
        Matrix3::from_columns(columns)
    }

    /// XYZ, relative to this space's white, to linear RGB.
    ///
    /// # Panics
    /// If the three primaries lie on a line: such a space has two dimensions.
    pub fn from_xyz(&self) -> Matrix3 {
        self.to_xyz()
            .inverse()
            .expect("the primaries of an RGB space span a triangle")
    }

    /// Linear RGB of this space to that of `other`; white goes to white (Bradford).
    pub fn to_space(&self, other: &Self) -> Matrix3 {
        self.to_xyz()
            .then(&bradford(self.white_xyz(), other.white_xyz()))
            .then(&other.from_xyz())
    }
}

/// Twice the signed area of the triangle a, b, c.
const fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
}

/// By name, in upper or lower case; "Rec.709" is sRGB.
impl FromStr for RgbSpace {
    type Err = RadiometryError;

    fn from_str(name: &str) -> Result<Self, RadiometryError> {
        let plain = |s: &str| {
            s.chars()
                .filter(|c| c.is_alphanumeric())
                .collect::<String>()
                .to_lowercase()
        };
        let word = plain(name);
        if word == "rec709" || word == "bt709" {
            return Ok(Self::SRGB);
        }
        Self::ALL
            .into_iter()
            .find(|s| plain(s.name) == word)
            .ok_or_else(|| {
                RadiometryError::unknown_name("RGB space", name, &Self::ALL.map(|s| s.name))
            })
    }
}
