//! The text of a shader: its language, its comments, and what must hold before it is parsed.

use crate::ShaderError;
use crate::error::SourcePlace;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The largest text that is read, in bytes: some hundred times what a reflection function needs, several times one with its tables.
pub const LARGEST_SOURCE: usize = 4 << 20;

/// Brackets in brackets that a text may have.
const DEEPEST: usize = 128;

/// Branches of one `if … else if …`, each of which is inside the one before it.
const MOST_BRANCHES: usize = 1000;

/// Words and signs between two semicolons, braces or commas, those around the brackets included.
const LONGEST_STATEMENT: usize = 20_000;

/// The language that a shader is written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// WebGPU's shading language.
    Wgsl,
    /// OpenGL's shading language, version 4.50 as Vulkan has it.
    Glsl,
    /// A file of Disney's BRDF Explorer: parameters, and a function in GLSL.
    Brdf,
}

impl Language {
    /// By the file's extension, `None` for one that says nothing.
    pub fn of_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "wgsl" => Some(Self::Wgsl),
            "glsl" | "frag" | "vert" | "comp" => Some(Self::Glsl),
            "brdf" => Some(Self::Brdf),
            _ => None,
        }
    }

    /// By the text: `::begin` is a line of a `.brdf` file, `fn` a word of WGSL.
    pub fn of_text(text: &str) -> Self {
        let starts = |word: &str| text.lines().any(|l| l.trim_start().starts_with(word));
        if starts("::begin") {
            Self::Brdf
        } else if starts("fn ") || starts("override ") {
            Self::Wgsl
        } else {
            Self::Glsl
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wgsl => "WGSL",
            Self::Glsl => "GLSL",
            Self::Brdf => "BRDF Explorer's format",
        }
    }
}

/// A text with its name.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    pub path: PathBuf,
    pub language: Language,
    /// The text as it was given.
    pub text: String,
    /// What is parsed: each line and column is where it is in the text.
    pub code: String,
}

impl Source {
    /// An error at a byte of [`Source::code`].
    pub fn error_at(&self, byte: usize, message: impl Into<String>) -> ShaderError {
        let mut byte = byte.min(self.code.len());
        while !self.code.is_char_boundary(byte) {
            byte -= 1;
        }
        let before = &self.code[..byte];
        let line = before.matches('\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        let mut error = ShaderError::new(&self.path, message);
        error.place = Some(SourcePlace {
            line,
            column: before[start..].chars().count() + 1,
            text: self.text.lines().nth(line - 1).unwrap_or("").to_owned(),
        });
        error
    }

    /// Refuses texts on which a recursive parser would run out of stack.
    pub fn check_nesting(&self, code: &str) -> Result<(), ShaderError> {
        /// What has been seen between two brackets.
        #[derive(Default)]
        struct Level {
            words: usize,
            branches: usize,
        }
        // The sum over all levels: an expression is no deeper than that.
        let mut words = 0usize;
        let mut levels = vec![Level::default()];
        let mut in_word = false;
        for (at, c) in code.char_indices() {
            let is_word = c.is_alphanumeric() || c == '_' || c == '.';
            let begins = is_word && !in_word;
            let counts = begins || !(is_word || c.is_whitespace());
            in_word = is_word;
            if matches!(c, ')' | ']' | '}') && levels.len() > 1 {
                words -= levels.pop().unwrap_or_default().words;
            }
            if let Some(here) = levels.last_mut() {
                here.words += usize::from(counts);
                words += usize::from(counts);
                here.branches += usize::from(begins && code[at..].starts_with("else"));
                if matches!(c, ';' | ',' | '{' | '}') {
                    words -= std::mem::take(&mut here.words);
                }
                if c == ';' {
                    here.branches = 0;
                }
                if here.branches > MOST_BRANCHES {
                    return Err(
                        self.error_at(at, format!("more than {MOST_BRANCHES} branches in a row"))
                    );
                }
            }
            if matches!(c, '(' | '[' | '{') {
                levels.push(Level::default());
            }
            if levels.len() > DEEPEST + 1 {
                return Err(self.error_at(at, format!("nested more than {DEEPEST} deep")));
            }
            if words > LONGEST_STATEMENT {
                return Err(self.error_at(
                    at,
                    format!(
                        "more than {LONGEST_STATEMENT} words and signs without a semicolon, brace or comma"
                    ),
                ));
            }
        }
        Ok(())
    }
}

/// A text without its comments.
#[derive(Debug, Clone)]
pub(crate) struct Commented {
    /// The text with blanks for comments: each line and column stays.
    pub code: String,
    /// The comments after `//`, by line from 0.
    pub comments: Vec<(usize, String)>,
}

/// Takes the comments out of a text. Block comments nest in WGSL.
pub(crate) fn without_comments(text: &str, nested: bool) -> Commented {
    let mut code = String::with_capacity(text.len());
    let mut comments = Vec::new();
    let (mut line, mut depth) = (0, 0usize);
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let mut taken = c.len_utf8();
        if c == '\n' {
            line += 1;
            code.push(c);
        } else if depth == 0 && rest.starts_with("//") {
            taken = rest.find('\n').unwrap_or(rest.len());
            comments.push((line, rest[2..taken].trim().to_owned()));
            blank(&mut code, &rest[..taken]);
        } else if rest.starts_with("/*") && (depth == 0 || nested) {
            depth += 1;
            taken = 2;
            code.push_str("  ");
        } else if depth > 0 && rest.starts_with("*/") {
            depth -= 1;
            taken = 2;
            code.push_str("  ");
        } else if depth > 0 {
            blank(&mut code, &rest[..taken]);
        } else {
            code.push(c);
        }
        rest = &rest[taken..];
    }
    Commented { code, comments }
}

/// As many bytes of blanks as the text has, so that columns of what follows stay.
fn blank(code: &mut String, text: &str) {
    code.extend(std::iter::repeat_n(' ', text.len()));
}

/// Replaces a range of bytes by blanks, keeping ends of lines.
pub(crate) fn erase(code: &mut String, range: Range<usize>) {
    let blanks: String = code[range.clone()]
        .bytes()
        .map(|b| if b == b'\n' { '\n' } else { ' ' })
        .collect();
    code.replace_range(range, &blanks);
}

/// The identifiers of a text, with the byte at which each begins.
pub(crate) fn identifiers(code: &str) -> impl Iterator<Item = (usize, &str)> {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at + code[at..].find(is_part)?;
        let len = code[start..]
            .find(|c| !is_part(c))
            .unwrap_or(code.len() - start);
        at = start + len;
        Some((start, &code[start..at]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_become_blanks_of_the_same_length() {
        let text = "a /* ü\n /* b */ c */ d // e 0..1\nf";
        let wgsl = without_comments(text, true);
        assert_eq!(wgsl.code.replace(' ', ""), "a\nd\nf");
        assert_eq!(wgsl.code.find('d'), text.find('d'));
        assert_eq!(wgsl.code.len(), text.len());
        assert_eq!(wgsl.comments, [(1, "e 0..1".to_owned())]);
        let glsl = without_comments(text, false);
        assert!(glsl.code.contains("c */ d"));
    }

    #[test]
    fn languages_are_told_by_extension_or_content() {
        let of = |name: &str| Language::of_extension(Path::new(name));
        assert_eq!(of("a.wgsl"), Some(Language::Wgsl));
        assert_eq!(of("a.FRAG"), Some(Language::Glsl));
        assert_eq!(of("a.brdf"), Some(Language::Brdf));
        assert_eq!(of("a.txt"), None);
        assert_eq!(
            Language::of_text("analytic\n::begin shader\n"),
            Language::Brdf
        );
        assert_eq!(Language::of_text("// x\nfn eval() {}"), Language::Wgsl);
        assert_eq!(Language::of_text("vec3 eval() {}"), Language::Glsl);
    }

    #[test]
    fn identifiers_have_their_places() {
        let found: Vec<_> = identifiers("a1 + (b_2)").collect();
        assert_eq!(found, [(0, "a1"), (6, "b_2")]);
    }
}
