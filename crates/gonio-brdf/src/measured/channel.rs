//! What the numbers of a measurement stand for: colours, wavelengths, bands.

use gonio_radiometry::colour::{RgbSpace, bradford, rgb_of_reflectance};
use gonio_radiometry::spectrum::{Illuminant, Spectrum};
use std::fmt;

/// What one number of each cell stands for.
#[derive(Debug, Clone, PartialEq)]
pub enum Channel {
    /// Red of linear Rec.709.
    Red,
    /// Green of linear Rec.709.
    Green,
    /// Blue of linear Rec.709.
    Blue,
    /// CIE 1931 X, relative to a white reflector, whose X, Y and Z are 1.
    X,
    /// CIE 1931 Y.
    Y,
    /// CIE 1931 Z, as `X`.
    Z,
    /// Weighted by the eye's sensitivity, or one number for all light.
    Luminance,
    /// At one wavelength in nm.
    Wavelength(f64),
    /// Over a band with a name, such as `solar`.
    Band(String),
}

impl fmt::Display for Channel {
    /// As the container and the command write it: `red`, `x`, `luminance`, `550 nm`, `solar`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Red => f.write_str("red"),
            Self::Green => f.write_str("green"),
            Self::Blue => f.write_str("blue"),
            Self::X => f.write_str("x"),
            Self::Y => f.write_str("y"),
            Self::Z => f.write_str("z"),
            Self::Luminance => f.write_str("luminance"),
            Self::Wavelength(nm) => write!(f, "{nm} nm"),
            Self::Band(name) => f.write_str(name),
        }
    }
}

impl Channel {
    /// The inverse of its `Display`; what isn't a name above is a band.
    pub fn from_name(name: &str) -> Self {
        let name = name.trim();
        match name.to_ascii_lowercase().as_str() {
            "red" | "r" => Self::Red,
            "green" | "g" => Self::Green,
            "blue" | "b" => Self::Blue,
            "x" => Self::X,
            "y" => Self::Y,
            "z" => Self::Z,
            "luminance" => Self::Luminance,
            lower => {
                let number = lower.strip_suffix("nm").map(str::trim_end);
                match number.and_then(|n| n.parse().ok()) {
                    Some(nm) if f64::is_finite(nm) && nm > 0.0 => Self::Wavelength(nm),
                    _ => Self::Band(name.to_owned()),
                }
            }
        }
    }
}

/// Red, green, blue.
pub(crate) fn rgb() -> Vec<Channel> {
    vec![Channel::Red, Channel::Green, Channel::Blue]
}

/// X, Y, Z.
pub(crate) fn xyz() -> Vec<Channel> {
    vec![Channel::X, Channel::Y, Channel::Z]
}

/// The wavelengths among the channels, in nm.
pub fn wavelengths(channels: &[Channel]) -> Vec<f64> {
    channels
        .iter()
        .filter_map(|c| match c {
            Channel::Wavelength(nm) => Some(*nm),
            _ => None,
        })
        .collect()
}

/// How the numbers of a cell make linear RGB: RGB = Σ weightₖ valueₖ.
///
/// The choice among what there is: red, green and blue as they are; X, Y and Z, adapted from their white to D65; two or more
/// wavelengths, of which at least one is visible: linear between them, constant beyond, seen under D65 by the CIE 1931 observer; and
/// otherwise one channel, as grey: Y, luminance, the band called visible, or the first.
/// A reflectance that is the same at all wavelengths is grey under each of these.
#[derive(Debug, Clone, PartialEq)]
pub struct ToRgb {
    /// One weight for each channel and colour.
    pub weights: Vec<[f64; 3]>,
}

impl ToRgb {
    /// For these channels.
    pub fn new(channels: &[Channel]) -> Self {
        let mut weights = vec![[0.0; 3]; channels.len()];
        let place = |wanted: &Channel| channels.iter().position(|c| c == wanted);
        let all = |wanted: &[Channel]| wanted.iter().map(place).collect::<Option<Vec<_>>>();
        let lambda = wavelengths(channels);
        let visible = lambda.iter().any(|nm| (380.0..=780.0).contains(nm));
        if let Some(at) = all(&rgb()) {
            for (k, at) in at.into_iter().enumerate() {
                weights[at][k] = 1.0;
            }
        } else if let Some(at) = all(&xyz()) {
            let space = RgbSpace::SRGB;
            let adapted = bradford([1.0; 3], space.white_xyz()).then(&space.from_xyz());
            for (k, at) in at.into_iter().enumerate() {
                let mut unit = [0.0; 3];
                unit[k] = 1.0;
                weights[at] = adapted.apply(unit);
            }
        } else if lambda.len() > 1 && visible {
            spectral(channels, &lambda, &mut weights);
        } else {
            let grey = place(&Channel::Y)
                .or_else(|| place(&Channel::Luminance))
                .or_else(|| {
                    channels.iter().position(
                        |c| matches!(c, Channel::Band(b) if b.eq_ignore_ascii_case("visible")),
                    )
                })
                .unwrap_or(0);
            if let Some(w) = weights.get_mut(grey) {
                *w = [1.0; 3];
            }
        }
        Self { weights }
    }

    /// Linear RGB of one cell's numbers.
    pub fn apply(&self, values: &[f64]) -> [f64; 3] {
        let mut out = [0.0; 3];
        for (w, x) in self.weights.iter().zip(values) {
            for k in 0..3 {
                out[k] += w[k] * x;
            }
        }
        out
    }

    /// The channels that have no part in it.
    pub fn unused(&self, channels: &[Channel]) -> Vec<String> {
        let without = self.weights.iter().zip(channels);
        without
            .filter(|(w, _)| **w == [0.0; 3])
            .map(|(_, c)| c.to_string())
            .collect()
    }
}

/// The colour of each wavelength's hat function: 1 there, 0 at its neighbours, linear between.
fn spectral(channels: &[Channel], lambda: &[f64], weights: &mut [[f64; 3]]) {
    let light = Illuminant::D65.spectrum();
    let mut order: Vec<f64> = lambda.to_vec();
    order.sort_by(f64::total_cmp);
    for (channel, weight) in channels.iter().zip(weights) {
        let Channel::Wavelength(nm) = channel else {
            continue;
        };
        let hat = order.iter().map(|l| f64::from(u8::from(l == nm))).collect();
        // Wavelengths that are not increasing were refused when the measurement was made.
        if let Ok(hat) = Spectrum::irregular(order.clone(), hat) {
            *weight = rgb_of_reflectance(&hat, &light, &RgbSpace::SRGB);
        }
    }
}

/// Rec.709 luminance, never negative.
pub(crate) fn luminance(rgb: [f64; 3]) -> f64 {
    let [r, g, b] = RgbSpace::SRGB_LUMINANCE_WEIGHTS;
    (r * rgb[0] + g * rgb[1] + b * rgb[2]).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_written() {
        for c in [
            Channel::Red,
            Channel::Z,
            Channel::Luminance,
            Channel::Wavelength(550.5),
            Channel::Band("solar".into()),
        ] {
            assert_eq!(Channel::from_name(&c.to_string()), c);
        }
        assert_eq!(Channel::from_name("465nm"), Channel::Wavelength(465.0));
        assert_eq!(Channel::from_name("nm"), Channel::Band("nm".into()));
    }

    #[test]
    fn a_flat_reflectance_is_grey() {
        let lambda = |all: &[f64]| -> Vec<Channel> {
            all.iter().map(|nm| Channel::Wavelength(*nm)).collect()
        };
        for channels in [
            rgb(),
            xyz(),
            lambda(&[400.0, 500.0, 600.0, 700.0]),
            lambda(&[450.0, 1550.0]),
            lambda(&[905.0, 1550.0]),
            lambda(&[550.0]),
            vec![Channel::Luminance],
            vec![
                Channel::Band("solar".into()),
                Channel::Band("visible".into()),
            ],
        ] {
            let to_rgb = ToRgb::new(&channels);
            let c = to_rgb.apply(&vec![0.25; channels.len()]);
            for x in c {
                assert!((x - 0.25).abs() < 1e-12, "{channels:?}: {c:?}");
            }
        }
        let solar = [Channel::Band("solar".into()), Channel::Y];
        assert_eq!(ToRgb::new(&solar).unused(&solar), ["solar"]);
    }

    #[test]
    fn wavelengths_have_their_colours() {
        let channels: Vec<_> = [450.0, 550.0, 650.0].map(Channel::Wavelength).to_vec();
        let to_rgb = ToRgb::new(&channels);
        for (k, brightest) in [(0, 2), (1, 1), (2, 0)] {
            let w = to_rgb.weights[k];
            assert!((0..3).all(|c| w[c] <= w[brightest]), "{k}: {w:?}");
        }
    }
}
