//! Parameters: how a model declares them, and the values they take.

use crate::{BrdfError, ModelSpec};
use gonio_radiometry::colour::srgb_decode;
use std::fmt;
use std::path::Path;

/// One parameter of a model, declared once next to the formula that uses it.
#[derive(Debug, Clone, Copy)]
pub struct ParameterInfo {
    /// Name, as written in a description.
    pub name: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// What it means, one line.
    pub meaning: &'static str,
}

/// The values that a parameter takes. Ranges include their ends.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
    /// A real number.
    Number {
        /// Unit; empty for a pure number.
        unit: &'static str,
        /// Smallest value.
        low: f64,
        /// Largest value.
        high: f64,
        /// Value when not given; `None`: then it has no effect.
        default: Option<f64>,
    },
    /// One number a colour component (linear RGB).
    Colour {
        /// Smallest component.
        low: f64,
        /// Largest component.
        high: f64,
        /// Value when not given; `None`: then it has no effect.
        default: Option<[f64; 3]>,
    },
    /// One of a list of words.
    Choice {
        /// The words.
        options: &'static [&'static str],
        /// Value when not given; `None`: then it has no effect.
        default: Option<&'static str>,
    },
    /// The path of a file, to be given.
    Path,
    /// A name in that file; without it what the file's kind has.
    Name,
    /// Other models, to be given.
    Models,
}

impl ParameterInfo {
    /// A number in [low, high].
    pub const fn number(
        name: &'static str,
        unit: &'static str,
        (low, high): (f64, f64),
        default: Option<f64>,
        meaning: &'static str,
    ) -> Self {
        let kind = Kind::Number {
            unit,
            low,
            high,
            default,
        };
        Self {
            name,
            kind,
            meaning,
        }
    }

    /// A colour with components in [low, high].
    pub const fn colour(
        name: &'static str,
        (low, high): (f64, f64),
        default: Option<[f64; 3]>,
        meaning: &'static str,
    ) -> Self {
        Self {
            name,
            kind: Kind::Colour { low, high, default },
            meaning,
        }
    }

    /// One of `options`.
    pub const fn choice(
        name: &'static str,
        options: &'static [&'static str],
        default: Option<&'static str>,
        meaning: &'static str,
    ) -> Self {
        Self {
            name,
            kind: Kind::Choice { options, default },
            meaning,
        }
    }

    /// The value when none is given; `None` if the parameter then has no effect or must be given.
    pub fn default_value(&self) -> Option<Value> {
        match self.kind {
            Kind::Number { default, .. } => default.map(Value::Number),
            Kind::Colour { default, .. } => default.map(Value::Colour),
            Kind::Choice { default, .. } => default.map(|c| Value::Choice(c.into())),
            Kind::Path | Kind::Name | Kind::Models => None,
        }
    }

    /// The allowed values in words, such as `a number from 0 to 1`.
    pub fn expected(&self) -> String {
        match self.kind {
            Kind::Number {
                unit, low, high, ..
            } => {
                let unit = if unit.is_empty() {
                    String::new()
                } else {
                    format!(" {unit}")
                };
                format!("a number from {low} to {high}{unit}")
            }
            Kind::Colour { low, high, .. } => {
                format!("a colour r/g/b, #rrggbb or one number, each from {low} to {high}")
            }
            Kind::Choice { options, .. } => format!("one of {}", options.join(", ")),
            Kind::Path => "a file's path".into(),
            Kind::Name => "a name".into(),
            Kind::Models => "one or more models".into(),
        }
    }

    /// Whether textures may drive it: numbers and colours.
    pub fn is_continuous(&self) -> bool {
        matches!(self.kind, Kind::Number { .. } | Kind::Colour { .. })
    }

    /// Reads and checks the text of a value. Paths are relative to the folder.
    pub(crate) fn parse(&self, model: &str, text: &str, folder: &Path) -> Result<Value, BrdfError> {
        let text = text.trim();
        let value = match self.kind {
            Kind::Number { .. } => text.parse().ok().map(Value::Number),
            Kind::Colour { .. } => parse_colour(text).map(Value::Colour),
            Kind::Choice { .. } => Some(Value::Choice(text.into())),
            Kind::Path => (!text.is_empty()).then(|| Value::Path(join(folder, text))),
            Kind::Name => (!text.is_empty()).then(|| Value::Choice(text.into())),
            Kind::Models => return Ok(Value::Models(ModelSpec::parse_list(text, folder)?)),
        };
        let value = value.ok_or_else(|| self.error(model, format!("`{text}`")))?;
        self.check(model, value)
    }

    /// Checks a value against the declared kind and range; a number given for a colour is taken for all components.
    pub(crate) fn check(&self, model: &str, value: Value) -> Result<Value, BrdfError> {
        // NaN is in no range.
        let inside = |x: f64, low: f64, high: f64| x >= low && x <= high;
        match (&self.kind, &value) {
            (Kind::Number { low, high, .. }, Value::Number(x)) if inside(*x, *low, *high) => {
                Ok(value)
            }
            (Kind::Colour { low, high, .. }, Value::Number(x)) if inside(*x, *low, *high) => {
                Ok(Value::Colour([*x; 3]))
            }
            (Kind::Colour { low, high, .. }, Value::Colour(c))
                if c.iter().all(|x| inside(*x, *low, *high)) =>
            {
                Ok(value)
            }
            (Kind::Choice { options, .. }, Value::Choice(word)) => {
                if options.contains(&word.as_str()) {
                    return Ok(value);
                }
                Err(self.error(model, format!("`{word}`")))
            }
            (Kind::Path, Value::Path(_))
            | (Kind::Name, Value::Choice(_))
            | (Kind::Models, Value::Models(_)) => Ok(value),
            _ => Err(self.error(model, format!("`{value}`"))),
        }
    }

    fn error(&self, model: &str, found: String) -> BrdfError {
        BrdfError::Parameter {
            model: model.into(),
            parameter: self.name.into(),
            found,
            expected: self.expected(),
        }
    }
}

/// The value of a parameter.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// A real number.
    Number(f64),
    /// Linear RGB, Rec.709 primaries.
    Colour([f64; 3]),
    /// A word of a list.
    Choice(String),
    /// A file.
    Path(String),
    /// Other models.
    Models(Vec<ModelSpec>),
}

impl fmt::Display for Value {
    /// As it is written in a description, so that it can be read again.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) => write!(f, "{x}"),
            Self::Colour([r, g, b]) if r == g && g == b => write!(f, "{r}"),
            Self::Colour([r, g, b]) => write!(f, "{r}/{g}/{b}"),
            Self::Choice(s) | Self::Path(s) => f.write_str(s),
            Self::Models(models) => {
                for (k, model) in models.iter().enumerate() {
                    let comma = if k > 0 { ", " } else { "" };
                    write!(f, "{comma}{model}")?;
                }
                Ok(())
            }
        }
    }
}

/// The path of a file in a folder; as it is, if it is absolute or there is no folder.
pub(crate) fn join(folder: &Path, file: &str) -> String {
    folder.join(file).to_string_lossy().into_owned()
}

/// Reads `r/g/b` and one number as they are, `#rrggbb` (and `#rgb`) as sRGB-encoded, giving linear components.
fn parse_colour(text: &str) -> Option<[f64; 3]> {
    if let Some(hex) = text.strip_prefix('#') {
        if !hex.is_ascii() {
            return None;
        }
        let byte = |s: &str| {
            let code = u8::from_str_radix(s, 16).ok()?;
            Some(srgb_decode(f64::from(code) / 255.0))
        };
        return match hex.len() {
            6 => Some([byte(&hex[0..2])?, byte(&hex[2..4])?, byte(&hex[4..6])?]),
            3 => {
                let twice = |k: usize| byte(&hex[k..=k].repeat(2));
                Some([twice(0)?, twice(1)?, twice(2)?])
            }
            _ => None,
        };
    }
    let numbers: Option<Vec<f64>> = text.split('/').map(|s| s.trim().parse().ok()).collect();
    match numbers?.as_slice() {
        [x] => Some([*x; 3]),
        [r, g, b] => Some([*r, *g, *b]),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_in_every_notation() {
        assert_eq!(parse_colour("0.5"), Some([0.5; 3]));
        assert_eq!(parse_colour("0.1/0.2/ 0.3"), Some([0.1, 0.2, 0.3]));
        assert_eq!(parse_colour("#ffffff"), Some([1.0; 3]));
        assert_eq!(parse_colour("#fff"), Some([1.0; 3]));
        // sRGB code 188 is linear 0.502886 (IEC 61966-2-1).
        assert!((parse_colour("#bcbcbc").unwrap()[0] - 0.502_886).abs() < 1e-6);
        for bad in ["", "#12", "#gggggg", "1/2", "1/2/3/4", "red", "#ééé"] {
            assert_eq!(parse_colour(bad), None, "{bad}");
        }
    }
}
