//! The parameters that a shader declares, and the comments that give their ranges.

use naga::{GlobalVariable, Handle, Override};

/// What a parameter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ParameterKind {
    /// A number.
    Number,
    /// A whole number.
    Integer,
    /// 0 or 1.
    Switch,
    /// Three numbers, linear RGB.
    Colour,
}

/// A parameter of a shader.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Name, as declared.
    pub name: String,
    /// What it is.
    pub kind: ParameterKind,
    /// Value when not given; a number has it three times.
    pub default: [f64; 3],
    /// Smallest value of each component.
    pub low: f64,
    /// Largest value of each component.
    pub high: f64,
    /// What it means; empty if the shader doesn't say.
    pub meaning: String,
    pub(crate) origin: Origin,
}

/// Where the shader declares a parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Origin {
    Override(Handle<Override>),
    Global(Handle<GlobalVariable>),
    /// A member of a structure, beginning at this scalar.
    Member(Handle<GlobalVariable>, usize),
}

/// The range of a number whose shader gives none.
pub(crate) const UNBOUNDED: f64 = 1e9;

impl Parameter {
    /// How many numbers it is.
    pub fn components(&self) -> usize {
        match self.kind {
            ParameterKind::Colour => 3,
            _ => 1,
        }
    }
}

/// What a comment after a declaration says: `[= DEFAULT] [LOW..HIGH] meaning`.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Note {
    pub default: Option<[f64; 3]>,
    pub range: Option<(f64, f64)>,
    pub meaning: String,
}

impl Note {
    /// Reads a comment. `Err`: a range that is none.
    pub fn parse(comment: &str) -> Result<Self, String> {
        let mut note = Self::default();
        let mut rest = comment.trim();
        if let Some(after) = rest.strip_prefix('=') {
            let after = after.trim_start();
            let word = after.split_whitespace().next().unwrap_or("");
            let numbers: Option<Vec<f64>> = word.split('/').map(number).collect();
            note.default = match numbers.as_deref() {
                Some([x]) => Some([*x; 3]),
                Some([r, g, b]) => Some([*r, *g, *b]),
                _ => {
                    return Err(format!(
                        "found the default `{word}`, expected a number or r/g/b"
                    ));
                }
            };
            rest = after[word.len()..].trim_start();
        }
        let word = rest.split_whitespace().next().unwrap_or("");
        if let Some((low, high)) = word.split_once("..")
            && let (Some(low), Some(high)) = (number(low), number(high))
        {
            if low > high {
                return Err(format!(
                    "found the range `{word}`, expected the smaller end first"
                ));
            }
            note.range = Some((low, high));
            rest = rest[word.len()..].trim_start();
        }
        note.meaning = rest.trim_start_matches([':', '-']).trim().to_owned();
        Ok(note)
    }
}

/// A finite number.
pub(crate) fn number(word: &str) -> Option<f64> {
    word.parse().ok().filter(|x: &f64| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn notes_have_default_range_and_meaning() {
        let note = Note::parse("= 0.8/0.5/0.2 0..1 base colour").unwrap();
        assert_eq!(note.default, Some([0.8, 0.5, 0.2]));
        assert_eq!(note.range, Some((0.0, 1.0)));
        assert_eq!(note.meaning, "base colour");
        let note = Note::parse("0.01..1 perceptual roughness").unwrap();
        assert_eq!((note.default, note.range), (None, Some((0.01, 1.0))));
        assert_eq!(Note::parse("how rough, 0..1").unwrap().range, None);
        assert_eq!(Note::parse("1e-3..1e3").unwrap().range, Some((1e-3, 1e3)));
        assert!(Note::parse("1..0 wrong").is_err());
        assert!(Note::parse("= red").is_err());
        assert_eq!(Note::parse("").unwrap(), Note::default());
    }
}
