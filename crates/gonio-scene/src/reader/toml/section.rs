//! One table of a scene file, read key by key; every error points at the key or the value.

use super::source::{Source, did_you_mean};
use crate::SceneError;
use gonio_num::Vec3;
use std::ops::Range;
use std::path::PathBuf;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A value with its place.
pub(super) type Value<'a> = Spanned<DeValue<'a>>;

/// A table whose keys are all known.
#[derive(Clone, Copy)]
pub(super) struct Section<'a> {
    pub source: &'a Source,
    name: &'a str,
    span: (usize, usize),
    table: &'a DeTable<'a>,
}

impl<'a> Section<'a> {
    /// The table `value`, called `name` in errors, whose keys must be among `known`.
    ///
    /// # Errors
    /// [`SceneError::Description`] if the value is no table or has a key that isn't known.
    pub fn new(
        source: &'a Source,
        name: &'a str,
        value: &'a Value<'a>,
        known: &[&str],
    ) -> Result<Self, SceneError> {
        let section = Self::open(source, name, value)?;
        section.allow(known)?;
        Ok(section)
    }

    /// The table `value` with any keys.
    pub fn open(
        source: &'a Source,
        name: &'a str,
        value: &'a Value<'a>,
    ) -> Result<Self, SceneError> {
        match value.get_ref() {
            DeValue::Table(table) => Ok(Self::of_table(source, name, value.span(), table)),
            other => Err(source.error(
                value.span(),
                format!("{name} is {}, expected a table", kind(other)),
                None,
            )),
        }
    }

    /// A table that is not a value: the whole file.
    pub fn of_table(
        source: &'a Source,
        name: &'a str,
        span: Range<usize>,
        table: &'a DeTable<'a>,
    ) -> Self {
        Self {
            source,
            name,
            span: (span.start, span.end),
            table,
        }
    }

    /// # Errors
    /// [`SceneError::Description`] at the first key that is not among `known`.
    pub fn allow(&self, known: &[&str]) -> Result<(), SceneError> {
        let unknown = self
            .table
            .keys()
            .filter(|k| !known.contains(&k.get_ref().as_ref()));
        // In the order of the file, not of the table.
        match unknown.min_by_key(|k| k.span().start) {
            None => Ok(()),
            Some(key) => {
                let word: &str = key.get_ref();
                let message = format!("unknown key `{word}` in {}", self.name);
                Err(self
                    .source
                    .error(key.span(), message, did_you_mean(word, known)))
            }
        }
    }

    /// All keys with their places and values, in the order of the file.
    pub fn entries(&self) -> Vec<(&'a str, Range<usize>, &'a Value<'a>)> {
        let mut all: Vec<_> = self
            .table
            .iter()
            .map(|(k, v)| (k.get_ref().as_ref(), k.span(), v))
            .collect();
        all.sort_by_key(|(_, span, _)| span.start);
        all
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&'a Value<'a>> {
        self.table.get(key)
    }

    /// The value of a key that must be there.
    pub fn require(&self, key: &str) -> Result<&'a Value<'a>, SceneError> {
        self.get(key)
            .ok_or_else(|| self.error(format!("{} has no `{key}`", self.name), None))
    }

    /// An error about the whole table.
    pub fn error(&self, message: impl Into<String>, help: Option<String>) -> SceneError {
        self.source.error(self.span.0..self.span.1, message, help)
    }

    /// An error about the value of `key`, or about the whole table where it is missing.
    pub fn error_at(
        &self,
        key: &str,
        message: impl Into<String>,
        help: Option<String>,
    ) -> SceneError {
        let span = self
            .get(key)
            .map_or(self.span.0..self.span.1, Spanned::span);
        self.source.error(span, message, help)
    }

    fn wrong(&self, key: &str, value: &Value, expected: &str) -> SceneError {
        let message = format!(
            "`{key}` in {} is {}, expected {expected}",
            self.name,
            kind(value.get_ref())
        );
        self.source.error(value.span(), message, None)
    }

    /// A text.
    pub fn text(&self, key: &str) -> Result<Option<&'a str>, SceneError> {
        self.get(key)
            .map(|v| {
                v.get_ref()
                    .as_str()
                    .ok_or_else(|| self.wrong(key, v, "a text in quotes"))
            })
            .transpose()
    }

    /// A path, relative to the file's folder.
    pub fn path(&self, key: &str) -> Result<Option<PathBuf>, SceneError> {
        Ok(self.text(key)?.map(|text| self.source.relative(text)))
    }

    /// True or false.
    pub fn flag(&self, key: &str) -> Result<Option<bool>, SceneError> {
        self.get(key)
            .map(|v| {
                v.get_ref()
                    .as_bool()
                    .ok_or_else(|| self.wrong(key, v, "true or false"))
            })
            .transpose()
    }

    /// A finite number.
    pub fn number(&self, key: &str) -> Result<Option<f64>, SceneError> {
        self.get(key)
            .map(|v| self.finite(key, v, "a number"))
            .transpose()
    }

    /// A number in `low..=high`, said in words by `expected`.
    pub fn number_in(
        &self,
        key: &str,
        low: f64,
        high: f64,
        expected: &str,
    ) -> Result<Option<f64>, SceneError> {
        let number = self.number(key)?;
        match number {
            Some(x) if !(x >= low && x <= high) => Err(self.error_at(
                key,
                format!("`{key}` in {} is {x}, expected {expected}", self.name),
                None,
            )),
            _ => Ok(number),
        }
    }

    /// A point or direction.
    pub fn vector(&self, key: &str) -> Result<Option<Vec3<f32>>, SceneError> {
        Ok(self.numbers::<3>(key)?.map(|v| Vec3::from(v).to_f32()))
    }

    /// `N` finite numbers.
    pub fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>, SceneError> {
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let expected = format!("{N} numbers");
        let items = value.get_ref().as_array().filter(|a| a.len() == N);
        let items = items.ok_or_else(|| match value.get_ref().as_array() {
            Some(a) => {
                let message = format!(
                    "`{key}` in {} has {} items, expected {expected}",
                    self.name,
                    a.len()
                );
                self.source.error(value.span(), message, None)
            }
            None => self.wrong(key, value, &expected),
        })?;
        let mut out = [0.0; N];
        for (slot, item) in out.iter_mut().zip(items.iter()) {
            *slot = self.finite(key, item, &expected)?;
        }
        Ok(Some(out))
    }

    /// Linear RGB: a number for all three, `[r, g, b]`, or a text `#rrggbb` (sRGB-encoded). None below 0.
    pub fn colour(&self, key: &str) -> Result<Option<[f32; 3]>, SceneError> {
        const EXPECTED: &str = "a colour: a number, [r, g, b] or \"#rrggbb\", none below 0";
        let Some(value) = self.get(key) else {
            return Ok(None);
        };
        let rgb = match value.get_ref() {
            DeValue::Array(_) => self.numbers::<3>(key)?,
            DeValue::String(text) => {
                Some(hex_colour(text).ok_or_else(|| self.wrong(key, value, EXPECTED))?)
            }
            _ => Some([self.finite(key, value, EXPECTED)?; 3]),
        };
        match rgb {
            Some(rgb) if rgb.iter().all(|&c| c >= 0.0 && (c as f32).is_finite()) => {
                Ok(Some(rgb.map(|c| c as f32)))
            }
            _ => Err(self.error_at(
                key,
                format!(
                    "`{key}` in {} is out of range, expected {EXPECTED}",
                    self.name
                ),
                None,
            )),
        }
    }

    /// One of some words.
    pub fn choice<T: Copy>(
        &self,
        key: &str,
        options: &[(&str, T)],
    ) -> Result<Option<T>, SceneError> {
        let Some(word) = self.text(key)? else {
            return Ok(None);
        };
        if let Some((_, value)) = options.iter().find(|(name, _)| *name == word) {
            return Ok(Some(*value));
        }
        let names: Vec<&str> = options.iter().map(|(name, _)| *name).collect();
        let message = format!(
            "`{key}` in {} is `{word}`, expected one of {}",
            self.name,
            names.join(", ")
        );
        Err(self.error_at(key, message, did_you_mean(word, &names)))
    }

    /// The tables of a key that may be one table (`[key]`) or several (`[[key]]`).
    pub fn tables(&self, key: &str) -> Result<Vec<&'a Value<'a>>, SceneError> {
        match self.get(key) {
            None => Ok(Vec::new()),
            Some(value) => match value.get_ref() {
                DeValue::Array(items) => Ok(items.iter().collect()),
                DeValue::Table(_) => Ok(vec![value]),
                _ => Err(self.wrong(key, value, "a table or a list of tables")),
            },
        }
    }

    /// A value that must be a finite number.
    fn finite(&self, key: &str, value: &Value, expected: &str) -> Result<f64, SceneError> {
        let number = number_of(value.get_ref()).ok_or_else(|| self.wrong(key, value, expected))?;
        if number.is_finite() && number.abs() <= f64::from(f32::MAX) {
            return Ok(number);
        }
        let message = format!(
            "`{key}` in {} is {number}, expected {expected}, finite",
            self.name
        );
        Err(self.source.error(value.span(), message, None))
    }
}

/// The number that a value is, an integer or not.
pub(super) fn number_of(value: &DeValue) -> Option<f64> {
    match value {
        DeValue::Float(x) => x.as_str().parse().ok(),
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix())
            .ok()
            .map(|i| i as f64),
        _ => None,
    }
}

/// What a value is, with its text where that is short.
pub(super) fn kind(value: &DeValue) -> String {
    match value {
        DeValue::String(text) if text.chars().count() <= 40 => format!("the text {text:?}"),
        DeValue::String(_) => "a text".into(),
        DeValue::Integer(i) => format!("the number {i}"),
        DeValue::Float(x) => format!("the number {x}"),
        DeValue::Boolean(b) => format!("{b}"),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(_) => "a list".into(),
        DeValue::Table(_) => "a table".into(),
    }
}

/// Linear RGB of `#rrggbb`.
fn hex_colour(text: &str) -> Option<[f64; 3]> {
    let hex = text
        .strip_prefix('#')
        .filter(|h| h.len() == 6 && h.is_ascii())?;
    let mut rgb = [0.0; 3];
    for (k, c) in rgb.iter_mut().enumerate() {
        let code = u8::from_str_radix(&hex[2 * k..2 * k + 2], 16).ok()?;
        *c = crate::texture::srgb_decode(f64::from(code) / 255.0);
    }
    Some(rgb)
}

#[cfg(test)]
#[path = "section_tests.rs"]
mod tests;
