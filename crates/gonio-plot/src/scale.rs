//! Axes: which value stands where, and which values are written beside them.

use crate::PlotError;
use gonio_num::Real;

/// How a value becomes a length.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ScaleKind {
    /// In proportion, unless a curve would be too thin or too small to be seen: then the cube root.
    #[default]
    Auto,
    /// In proportion.
    Linear,
    /// As the cube root, which shows weak lobes beside strong ones and still ends at 0.
    CubeRoot,
    /// As the logarithm, ten decades at most.
    Log,
}

impl ScaleKind {
    /// Every kind, with its name.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Auto, "auto"),
        (Self::Linear, "linear"),
        (Self::CubeRoot, "cube-root"),
        (Self::Log, "log"),
    ];
}

impl std::str::FromStr for ScaleKind {
    type Err = PlotError;

    fn from_str(text: &str) -> Result<Self, PlotError> {
        let found = Self::ALL.iter().find(|(_, name)| *name == text);
        found.map(|(kind, _)| *kind).ok_or(PlotError::Option {
            option: "scale",
            found: text.into(),
            expected: "auto, linear, cube-root or log".into(),
        })
    }
}

/// Decades that a logarithmic axis has at most.
const DECADES: i32 = 10;

/// An axis from 0 (or from a power of ten) to a round number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Scale {
    /// Never [`ScaleKind::Auto`].
    pub kind: ScaleKind,
    /// The value at its beginning: 0 unless logarithmic.
    pub low: f64,
    /// The value at its end, > `low`.
    pub high: f64,
}

/// A value that an axis shows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Tick {
    pub value: f64,
    /// From 0 at the beginning of the axis to 1 at its end.
    pub position: f64,
    /// Nothing where there is only a line.
    pub label: String,
}

impl Scale {
    /// An axis that holds values up to `most`; the smallest positive one of interest is `least`. `thin` is whether a curve would not be
    /// seen in proportion.
    pub fn new(kind: ScaleKind, least: f64, most: f64, thin: bool) -> Self {
        let most = if most.is_finite() && most > 0.0 {
            most
        } else {
            1.0
        };
        let kind = match kind {
            ScaleKind::Auto if thin => ScaleKind::CubeRoot,
            ScaleKind::Auto => ScaleKind::Linear,
            kind => kind,
        };
        if kind != ScaleKind::Log {
            let high = round_up(most);
            return Self {
                kind,
                low: 0.0,
                high,
            };
        }
        let top = exponent(most * (1.0 - 1e-9)) + 1;
        let bottom = if least > 0.0 && least.is_finite() {
            exponent(least * (1.0 + 1e-9))
        } else {
            top - DECADES
        };
        Self {
            kind,
            low: power_of_ten(bottom.clamp(top - DECADES, top - 1)),
            high: power_of_ten(top),
        }
    }

    /// Where `value` stands, 0 at the beginning and 1 at the end; a value outside stands at the nearer end, NaN stays NaN.
    pub fn position(&self, value: f64) -> f64 {
        if value.is_nan() {
            return value;
        }
        let share = match self.kind {
            ScaleKind::Log => {
                Real::ln((value / self.low).max(1e-300)) / Real::ln(self.high / self.low)
            }
            ScaleKind::CubeRoot => Real::powf((value / self.high).max(0.0), 1.0 / 3.0),
            _ => value / self.high,
        };
        share.clamp(0.0, 1.0)
    }

    /// The value at a position, the inverse of [`Scale::position`].
    pub fn value(&self, position: f64) -> f64 {
        match self.kind {
            ScaleKind::Log => self.low * Real::powf(self.high / self.low, position),
            ScaleKind::CubeRoot => self.high * position * position * position,
            _ => self.high * position,
        }
    }

    /// The values that are shown, from the beginning on; those without a label between them.
    pub fn ticks(&self) -> Vec<Tick> {
        let mut values: Vec<(f64, bool)> = Vec::new();
        match self.kind {
            ScaleKind::Log => {
                let (first, last) = (exponent(self.low * 1.5), exponent(self.high * 1.5));
                for e in first..=last {
                    let decade = power_of_ten(e);
                    values.push((decade, true));
                    if e < last && last - first <= 6 {
                        values.extend((2..10).map(|k| (decade * f64::from(k), false)));
                    }
                }
            }
            ScaleKind::CubeRoot => {
                values.push((0.0, true));
                let mut decades = Vec::new();
                // Not so near the end that the labels touch, nor so near 0 that the lines do.
                let mut e = exponent(self.high * 0.6);
                while self.position(power_of_ten(e)) > 0.12 {
                    decades.push((power_of_ten(e), true));
                    e -= 1;
                }
                values.extend(decades.into_iter().rev());
                values.push((self.high, true));
            }
            _ => {
                // 1.5, 3 and 6 in thirds, 5 in fifths, the others in quarters.
                let lead = self.high / power_of_ten(exponent(self.high * (1.0 + 1e-9)));
                let parts = match (lead * 2.0).round() as u32 {
                    3 | 6 | 12 => 3_u32,
                    10 => 5,
                    _ => 4,
                };
                let part = |k: u32| self.high * f64::from(k) / f64::from(parts);
                values.extend((0..=parts).map(|k| (part(k), true)));
            }
        }
        let tick = |(value, labelled): (f64, bool)| Tick {
            value,
            position: self.position(value),
            label: if labelled {
                number(value)
            } else {
                String::new()
            },
        };
        values.into_iter().map(tick).collect()
    }

    /// How a reader has to take the axis, nothing for a linear one.
    pub fn words(&self) -> &'static str {
        match self.kind {
            ScaleKind::Log => "logarithmic",
            ScaleKind::CubeRoot => "cube root",
            _ => "",
        }
    }
}

/// The exponent of the largest power of ten that is not above `value` > 0.
fn exponent(value: f64) -> i32 {
    let e = (Real::ln(value) / std::f64::consts::LN_10).floor() as i32;
    // A logarithm may be off by rounding at a power of ten.
    if power_of_ten(e + 1) <= value {
        e + 1
    } else {
        e
    }
}

fn power_of_ten(e: i32) -> f64 {
    format!("1e{e}").parse().unwrap_or(0.0)
}

/// The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten that is not below `value` > 0.
fn round_up(value: f64) -> f64 {
    let decade = power_of_ten(exponent(value));
    [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0]
        .into_iter()
        .map(|lead| lead * decade)
        .find(|&round| round >= value * (1.0 - 1e-9))
        .unwrap_or(10.0 * decade)
}

/// `x` with three significant digits; as a power of ten where it is tiny or huge: 0.32, 1200, 4.5 × 10⁶, 10⁻⁴.
pub(crate) fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".into() } else { x.to_string() };
    }
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    let sign = if rounded < 0.0 { "−" } else { "" };
    let size = rounded.abs();
    if (1e-3..1e5).contains(&size) {
        return format!("{sign}{size}");
    }
    let text = format!("{size:e}");
    let (lead, power) = text.split_once('e').unwrap_or((&text, "0"));
    let power: String = power.chars().map(superscript).collect();
    match lead {
        "1" => format!("{sign}10{power}"),
        lead => format!("{sign}{lead} × 10{power}"),
    }
}

fn superscript(c: char) -> char {
    const SMALL: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match c.to_digit(10) {
        Some(digit) => SMALL[digit as usize],
        None => '⁻',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_end_at_round_numbers() {
        for (most, end) in [
            (0.32, 0.4),
            (1.0, 1.0),
            (1.01, 1.5),
            (8.5, 10.0),
            (7e-5, 8e-5),
        ] {
            let scale = Scale::new(ScaleKind::Linear, 0.0, most, false);
            assert!((scale.high / end - 1.0).abs() < 1e-12, "{most}: {scale:?}");
        }
        let log = Scale::new(ScaleKind::Log, 3e-3, 250.0, false);
        assert_eq!((log.low, log.high), (1e-3, 1e3));
        let log = Scale::new(ScaleKind::Log, 1e-30, 1000.0, false);
        assert_eq!((log.low, log.high), (1e-7, 1e3));
        // All of one value, nothing at all.
        assert_eq!(Scale::new(ScaleKind::Log, 1.0, 1.0, false).high, 1.0);
        assert_eq!(Scale::new(ScaleKind::Auto, 0.0, 0.0, false).high, 1.0);
        assert_eq!(
            Scale::new(ScaleKind::Auto, f64::NAN, f64::NAN, true).high,
            1.0
        );
    }

    #[test]
    fn positions_and_values_are_inverse() {
        for kind in [ScaleKind::Linear, ScaleKind::CubeRoot, ScaleKind::Log] {
            let scale = Scale::new(kind, 0.01, 37.0, false);
            for k in 0..=10 {
                let position = f64::from(k) / 10.0;
                let there = scale.position(scale.value(position));
                assert!(
                    (there - position).abs() < 1e-12,
                    "{kind:?} {position} {there}"
                );
            }
            assert_eq!(scale.position(-1.0), 0.0);
            assert_eq!(scale.position(1e9), 1.0);
            assert!(scale.position(f64::NAN).is_nan());
        }
    }

    #[test]
    fn ticks_rise_from_end_to_end() {
        for kind in [ScaleKind::Linear, ScaleKind::CubeRoot, ScaleKind::Log] {
            for most in [1e-12, 0.02, 0.32, 1.0, 4.9, 1e3, 7.7e9] {
                let scale = Scale::new(kind, most * 1e-3, most, false);
                let ticks = scale.ticks();
                assert_eq!(ticks.first().unwrap().position, 0.0, "{kind:?} {most}");
                assert!((ticks.last().unwrap().position - 1.0).abs() < 1e-12);
                assert!(ticks.windows(2).all(|w| w[0].position < w[1].position));
                let labels = ticks.iter().filter(|t| !t.label.is_empty()).count();
                assert!((2..=11).contains(&labels), "{kind:?} {most}: {labels}");
            }
        }
    }

    #[test]
    fn numbers_read_well() {
        let all = [0.0, 0.3216, 1200.0, 4.5e6, 1e-4, -0.25, -2e-7, 1e5].map(number);
        let expected = [
            "0",
            "0.322",
            "1200",
            "4.5 × 10⁶",
            "10⁻⁴",
            "−0.25",
            "−2 × 10⁻⁷",
            "10⁵",
        ];
        assert_eq!(all, expected);
    }
}
