//! The text of a scene file, and errors that show where in it they are.

use crate::SceneError;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A scene file's text.
pub(super) struct Source {
    pub path: PathBuf,
    pub text: String,
}

impl Source {
    /// The error `message` about the bytes `span`, with the line shown and the span underlined.
    pub fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> SceneError {
        let start = self.boundary(span.start);
        let end = self.boundary(span.end.max(start));
        let line_start = self.text[..start].rfind('\n').map_or(0, |i| i + 1);
        let line_end = self.text[start..]
            .find('\n')
            .map_or(self.text.len(), |i| start + i);
        let line = self.text[..start].matches('\n').count() + 1;
        let shown = self.text[line_start..line_end].trim_end_matches('\r');
        let column = self.text[line_start..start].chars().count() + 1;
        let width = self.text[start..end.min(line_end)].chars().count().max(1);
        // Tabs stay tabs under the line, so that the carets align in any terminal.
        let indent: String = self.text[line_start..start]
            .chars()
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let gutter = " ".repeat(line.to_string().len());
        let carets = "^".repeat(width);
        let snippet = format!("{gutter} |\n{line} | {shown}\n{gutter} | {indent}{carets}");
        SceneError::Description {
            path: self.path.clone(),
            line,
            column,
            message: message.into(),
            snippet,
            help,
        }
    }

    /// The nearest character boundary at or before byte `at`.
    fn boundary(&self, at: usize) -> usize {
        let mut at = at.min(self.text.len());
        while !self.text.is_char_boundary(at) {
            at -= 1;
        }
        at
    }

    /// A path in the file, relative to the file's folder.
    pub fn relative(&self, path: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(path)
    }
}

/// `did you mean …?`, or the list if it is short, or nothing.
pub(super) fn did_you_mean(word: &str, candidates: &[&str]) -> Option<String> {
    if let Some(near) = gonio_brdf::registry::suggest(word, candidates.iter().copied()) {
        return Some(format!("did you mean `{near}`?"));
    }
    (!candidates.is_empty() && candidates.len() <= 24)
        .then(|| format!("known here: {}", candidates.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source {
            path: "a/b.toml".into(),
            text: text.into(),
        }
    }

    #[test]
    fn the_line_is_shown_with_carets() {
        let s = source("one\n\tkéy = 3\r\nlast");
        let at = s.text.find('=').unwrap();
        let error = s.error(at..at + 3, "bad", Some("try".into()));
        let text = error.to_string();
        assert_eq!(text, "a/b.toml:2:6: bad\n  |\n2 | \tkéy = 3\n  | \t    ^^^");
        assert_eq!(error.help().unwrap(), "try");
        // Past the end, and across lines: the first line alone.
        assert!(
            s.error(900..901, "end", None)
                .to_string()
                .contains("3 | last\n  |     ^")
        );
        assert!(
            s.error(0..9, "many", None)
                .to_string()
                .ends_with("1 | one\n  | ^^^")
        );
    }

    #[test]
    fn paths_are_relative_to_the_file() {
        assert_eq!(source("").relative("c/d.ply"), Path::new("a/c/d.ply"));
        assert_eq!(source("").relative("/c/d.ply"), Path::new("/c/d.ply"));
    }
}
