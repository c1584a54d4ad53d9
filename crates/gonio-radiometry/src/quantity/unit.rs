//! Units in text: "3 W/m^2", "12 mW m⁻² sr⁻¹", "250 nit".

use super::{Kind, Quantity};
use crate::RadiometryError;
use gonio_num::Real;
use std::str::FromStr;

/// Powers of the base units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    /// Power of the watt.
    pub watt: i8,
    /// Power of the lumen.
    pub lumen: i8,
    /// Power of the second.
    pub second: i8,
    /// Power of the metre; wavelengths count here, too.
    pub metre: i8,
    /// Power of the steradian.
    pub steradian: i8,
}

impl Dimension {
    /// A plain number.
    pub const NONE: Self = Self::new(0, 0, 0, 0, 0);

    const fn new(watt: i8, lumen: i8, second: i8, metre: i8, steradian: i8) -> Self {
        Self {
            watt,
            lumen,
            second,
            metre,
            steradian,
        }
    }

    /// The dimension of a product.
    pub const fn times(self, o: Self) -> Self {
        Self::new(
            self.watt.saturating_add(o.watt),
            self.lumen.saturating_add(o.lumen),
            self.second.saturating_add(o.second),
            self.metre.saturating_add(o.metre),
            self.steradian.saturating_add(o.steradian),
        )
    }

    /// The dimension of the `n`th power.
    pub const fn power(self, n: i8) -> Self {
        Self::new(
            self.watt.saturating_mul(n),
            self.lumen.saturating_mul(n),
            self.second.saturating_mul(n),
            self.metre.saturating_mul(n),
            self.steradian.saturating_mul(n),
        )
    }

    /// Whether the two are the same, as a constant.
    pub const fn equals(self, o: Self) -> bool {
        self.watt == o.watt
            && self.lumen == o.lumen
            && self.second == o.second
            && self.metre == o.metre
            && self.steradian == o.steradian
    }
}

/// Symbols and names of units with their dimension. "cd" and "J" are products of base units; decimal prefixes come apart.
const UNITS: &[(&str, Dimension)] = &[
    ("W", Dimension::new(1, 0, 0, 0, 0)),
    ("watt", Dimension::new(1, 0, 0, 0, 0)),
    ("J", Dimension::new(1, 0, 1, 0, 0)),
    ("joule", Dimension::new(1, 0, 1, 0, 0)),
    ("s", Dimension::new(0, 0, 1, 0, 0)),
    ("second", Dimension::new(0, 0, 1, 0, 0)),
    ("m", Dimension::new(0, 0, 0, 1, 0)),
    ("metre", Dimension::new(0, 0, 0, 1, 0)),
    ("meter", Dimension::new(0, 0, 0, 1, 0)),
    ("sr", Dimension::new(0, 0, 0, 0, 1)),
    ("steradian", Dimension::new(0, 0, 0, 0, 1)),
    ("lm", Dimension::new(0, 1, 0, 0, 0)),
    ("lumen", Dimension::new(0, 1, 0, 0, 0)),
    ("cd", Dimension::new(0, 1, 0, 0, -1)),
    ("candela", Dimension::new(0, 1, 0, 0, -1)),
    ("lx", Dimension::new(0, 1, 0, -2, 0)),
    ("lux", Dimension::new(0, 1, 0, -2, 0)),
    ("nit", Dimension::new(0, 1, 0, -2, -1)),
    ("nt", Dimension::new(0, 1, 0, -2, -1)),
];

/// Decimal prefixes and their powers of ten.
const PREFIXES: &[(&str, i8)] = &[
    ("G", 9),
    ("M", 6),
    ("k", 3),
    ("c", -2),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("μ", -6),
    ("n", -9),
    ("p", -12),
];

/// Dimension and decimal power of one symbol, with or without a prefix.
fn symbol(word: &str) -> Option<(Dimension, i8)> {
    let plain = |w: &str| UNITS.iter().find(|(name, _)| *name == w).map(|u| u.1);
    if let Some(dimension) = plain(word) {
        return Some((dimension, 0));
    }
    // A plural is a whole word: "watts", not "Ws".
    if word.len() > 3
        && let Some(dimension) = word.strip_suffix('s').and_then(plain)
    {
        return Some((dimension, 0));
    }
    PREFIXES.iter().find_map(|&(prefix, power)| {
        let rest = word.strip_prefix(prefix)?;
        Some((plain(rest)?, power))
    })
}

/// The symbol nearest to `word`, or the one that differs only in upper and lower case.
fn suggest(word: &str) -> Option<&'static str> {
    if let Some((name, _)) = UNITS
        .iter()
        .find(|(name, _)| name.eq_ignore_ascii_case(word))
    {
        return Some(name);
    }
    UNITS
        .iter()
        .map(|&(name, _)| (strsim::damerau_levenshtein(name, word), name))
        // A one-letter symbol is one edit from any two letters: no help.
        .filter(|&(distance, name)| distance <= name.chars().count() / 2)
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, name)| name)
}

/// Dimension and decimal power of a product of units; the error says which part isn't understood.
///
/// Factors follow one another with a space, "·", "*" or "/"; powers are "^-2", "-2", "2" or "⁻²". A "/" divides by all
/// that follows up to the next "/" or "*": "W/m² sr" is W m⁻² sr⁻¹, as people write it.
pub(super) fn parse_unit(text: &str) -> Result<(Dimension, i32), String> {
    let mut dimension = Dimension::NONE;
    let mut scale = 0;
    let mut divide = false;
    let mut rest = text;
    loop {
        rest = rest.trim_start_matches([' ', '\t', '·', '⋅', '(', ')', '[', ']']);
        let Some(first) = rest.chars().next() else {
            return Ok((dimension, scale));
        };
        if first == '/' || first == '*' {
            divide = first == '/';
            rest = &rest[1..];
            continue;
        }
        let end = rest
            .find(|c: char| !c.is_alphabetic())
            .unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        if word.is_empty() {
            return Err(format!("\"{first}\" isn't part of a unit"));
        }
        let (unit, prefix) = symbol(word).ok_or_else(|| match suggest(word) {
            Some(near) => format!("unknown unit \"{word}\"; did you mean \"{near}\"?"),
            None => format!("unknown unit \"{word}\""),
        })?;
        let (power, after) = parse_power(after)?;
        let power = if divide { -power } else { power };
        dimension = dimension.times(unit.power(power));
        scale += i32::from(prefix) * i32::from(power);
        rest = after;
    }
}

/// The power at the start of `text` (1 if there is none) and what follows it.
fn parse_power(text: &str) -> Result<(i8, &str), String> {
    let digits = text.strip_prefix('^').unwrap_or(text);
    let mut plain = String::new();
    let mut end = 0;
    for c in digits.chars() {
        plain.push(match c {
            '⁻' | '−' | '-' => '-',
            '0'..='9' => c,
            '⁰' => '0',
            '¹' => '1',
            '²' => '2',
            '³' => '3',
            '⁴' => '4',
            _ => break,
        });
        end += c.len_utf8();
    }
    if plain.is_empty() && digits.len() == text.len() {
        return Ok((1, text));
    }
    let power: i8 = plain
        .parse()
        .ok()
        .filter(|p: &i8| (1..=9).contains(&p.unsigned_abs()))
        .ok_or_else(|| format!("\"{plain}\" isn't a power from 1 to 9"))?;
    Ok((power, &digits[end..]))
}

/// Splits "3.5e-2 W/m²" into number and unit.
fn split_number(text: &str) -> (&str, &str) {
    let mut end = 0;
    for (i, c) in text.char_indices() {
        let next = i + c.len_utf8();
        // The "e" of an exponent, but not that of a word: a digit or a sign must follow.
        let exponent = matches!(c, 'e' | 'E')
            && text[next..].starts_with(|d: char| d.is_ascii_digit() || d == '-' || d == '+');
        if !(c.is_ascii_digit() || matches!(c, '.' | '-' | '+') || exponent) {
            break;
        }
        end = next;
    }
    (&text[..end], text[end..].trim())
}

/// Reads a number and a unit: `"3 W/m^2"`, `"12 mW m⁻² sr⁻¹"`, `"550 nm"`.
///
/// A unit of the same dimension is converted ("20 cm" is a length of 0.2 m); any other is an error that names the unit
/// expected. A number without a unit is an error too.
///
/// ```
/// use gonio_radiometry::quantity::*;
/// let e: Irradiance = "0.3 mW/cm^2".parse()?;
/// assert!((e.value() - 3.0).abs() < 1e-12);
/// let error = "3 W/m^2".parse::<Radiance>().unwrap_err();
/// assert_eq!(error.to_string(), "\"3 W/m^2\" isn't a radiance: the unit is W/m^2; expected W m⁻² sr⁻¹");
/// # Ok::<(), gonio_radiometry::RadiometryError>(())
/// ```
impl<R: Real, K: Kind> FromStr for Quantity<R, K> {
    type Err = RadiometryError;

    fn from_str(text: &str) -> Result<Self, RadiometryError> {
        let error = |found: String| RadiometryError::QuantityText {
            text: text.chars().take(80).collect(),
            quantity: K::NAME,
            found,
            expected: K::UNIT,
        };
        let (number, unit) = split_number(text.trim());
        let number: f64 = number
            .parse()
            .ok()
            .filter(|x: &f64| x.is_finite())
            .ok_or_else(|| error("it doesn't begin with a finite number".to_owned()))?;
        if unit.is_empty() {
            return Err(error("it has no unit".to_owned()));
        }
        // "0.3 1/sr" is how some write 0.3 sr⁻¹.
        let bare = unit
            .strip_prefix('1')
            .filter(|u| u.trim_start().starts_with('/'));
        let (dimension, scale) = parse_unit(bare.unwrap_or(unit)).map_err(&error)?;
        if dimension != K::DIMENSION {
            return Err(error(format!("the unit is {unit}")));
        }
        let power = scale - i32::from(K::SCALE);
        let factor = 10f64.powi(power.abs());
        let value = if power < 0 {
            number / factor
        } else {
            number * factor
        };
        if !value.is_finite() {
            return Err(error("the number is too large".to_owned()));
        }
        Ok(Self::new(R::lit(value)))
    }
}
