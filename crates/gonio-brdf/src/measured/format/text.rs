//! Numbers in text, with the line that each stands on.

use super::super::input::Input;
use crate::BrdfError;

/// A number and its line, from 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Number {
    pub value: f64,
    pub line: usize,
}

/// A finite number in `word`.
pub(super) fn number(input: &Input<'_>, word: &str, line: usize) -> Result<f64, BrdfError> {
    match word.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => {
            let shown: String = word.trim().chars().take(40).collect();
            Err(input.error(
                format!("line {line}"),
                format!("`{shown}`"),
                "a finite number",
            ))
        }
    }
}

/// The line that byte `at` of `text` stands on, from 1.
pub(super) fn line_of(text: &str, at: usize) -> usize {
    text.as_bytes()[..at.min(text.len())]
        .iter()
        .filter(|b| **b == b'\n')
        .count()
        + 1
}

/// A number as short as it can be written without loss in single precision.
pub(super) fn short(x: f32) -> String {
    // Rust's shortest form is exact; an exponent is shorter for small numbers.
    let plain = x.to_string();
    if plain.len() > 12 {
        format!("{x:e}")
    } else {
        plain
    }
}
