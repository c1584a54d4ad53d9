//! Standard illuminants and the daylight series.

use super::{SpectralColumns, Spectrum};
use crate::RadiometryError;
use gonio_num::Real;
use std::fmt;
use std::str::FromStr;
use std::sync::LazyLock;

/// A standard illuminant of the CIE: relative spectral power, 100 at 560 nm.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Illuminant {
    /// Incandescent light, 2856 K.
    A,
    /// Daylight, 5003 K: the white of print.
    D50,
    /// Daylight, 5503 K.
    D55,
    /// Daylight, 6504 K: the white of screens.
    D65,
    /// Daylight, 7504 K.
    D75,
    /// The same power at all wavelengths.
    E,
}

impl Illuminant {
    /// All of them.
    pub const ALL: [Self; 6] = [Self::A, Self::D50, Self::D55, Self::D65, Self::D75, Self::E];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::D50 => "D50",
            Self::D55 => "D55",
            Self::D65 => "D65",
            Self::D75 => "D75",
            Self::E => "E",
        }
    }

    /// Its relative spectral power.
    pub fn spectrum(self) -> Spectrum {
        match self {
            Self::A => Spectrum::function(illuminant_a),
            Self::D50 => D[0].clone(),
            Self::D55 => D[1].clone(),
            Self::D65 => D[2].clone(),
            Self::D75 => D[3].clone(),
            Self::E => Spectrum::Constant(100.0),
        }
    }
}

impl fmt::Display for Illuminant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// By name, in upper or lower case.
impl FromStr for Illuminant {
    type Err = RadiometryError;

    fn from_str(name: &str) -> Result<Self, RadiometryError> {
        Self::ALL
            .into_iter()
            .find(|i| i.name().eq_ignore_ascii_case(name.trim()))
            .ok_or_else(|| {
                RadiometryError::unknown_name("illuminant", name, &Self::ALL.map(Self::name))
            })
    }
}

/// CIE standard illuminant A: 100 (560/λ)⁵ (e^(c₂/(2848·560)) − 1) / (e^(c₂/(2848 λ)) − 1) with c₂ = 1.435 × 10⁷ nm K.
///
/// The constants are those of its definition of 1931. Source: ISO/CIE 11664-2, eq. 1.
fn illuminant_a(lambda_nm: f64) -> f64 {
    let e = |l: f64| Real::exp(1.435e7 / (2848.0 * l)) - 1.0;
    100.0 * (560.0 / lambda_nm).pow5() * e(560.0) / e(lambda_nm)
}

/// c₂ was 1.4380 × 10⁻² m K when the D illuminants were named, and 1.4388 × 10⁻² when their temperatures were restated.
const NAMED_TEMPERATURE: f64 = 1.4388 / 1.4380;

static D: LazyLock<[Spectrum; 4]> = LazyLock::new(|| {
    [5000.0, 5500.0, 6500.0, 7500.0].map(|t| {
        daylight(t * NAMED_TEMPERATURE).expect("invariant: within the series' temperatures")
    })
});

/// S₀, S₁ and S₂ of the daylight series.
static COMPONENTS: LazyLock<SpectralColumns> = LazyLock::new(|| {
    SpectralColumns::parse(
        include_str!("data/daylight_components_5nm.csv"),
        "daylight_components_5nm.csv",
    )
    .expect("invariant: the table in the source is well-formed")
});

/// Chromaticity (x, y) of daylight of the correlated colour temperature `cct_k`.
///
/// # Errors
/// If `cct_k` isn't in [4000, 25 000] K, for which the series is defined. Source: CIE 15:2018, eq. 3 to 5.
pub fn daylight_chromaticity(cct_k: f64) -> Result<[f64; 2], RadiometryError> {
    if !(4000.0..=25_000.0).contains(&cct_k) {
        return Err(RadiometryError::OutOfRange {
            name: "the colour temperature of daylight [K]",
            value: cct_k,
            expected: "4000 to 25000",
        });
    }
    let u = 1e3 / cct_k;
    let x = if cct_k <= 7000.0 {
        0.244063 + u * (0.09911 + u * (2.9678 - u * 4.6070))
    } else {
        0.237040 + u * (0.24748 + u * (1.9018 - u * 2.0064))
    };
    Ok([x, x * (2.870 - 3.000 * x) - 0.275])
}

/// Relative spectral power of daylight of the correlated colour temperature `cct_k`, 100 at 560 nm.
///
/// S = S₀ + M₁S₁ + M₂S₂, with M₁ and M₂ rounded to three decimals as the CIE does, so that D50, D55, D65 and D75 are the
/// published tables. By 5 nm from 300 to 830 nm, linear between, held beyond.
///
/// # Errors
/// If `cct_k` isn't in [4000, 25 000] K. Source: CIE 15:2018, section 4.1.2.
pub fn daylight(cct_k: f64) -> Result<Spectrum, RadiometryError> {
    let [x, y] = daylight_chromaticity(cct_k)?;
    let m = 0.0241 + 0.2562 * x - 0.7341 * y;
    let round = |v: f64| (v * 1000.0).round() / 1000.0;
    let m1 = round((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
    let m2 = round((0.0300 - 31.4424 * x + 30.0717 * y) / m);
    let [s0, s1, s2] = [0, 1, 2].map(|k| &COMPONENTS.values[k]);
    let values = (0..s0.len())
        .map(|i| s0[i] + m1 * s1[i] + m2 * s2[i])
        .collect();
    Spectrum::regular(COMPONENTS.lambda_nm[0], 5.0, values)
}
