//! A command line, split into words as a shell splits it.

use crate::error::Fault;

/// The program and its arguments.
///
/// Words are split at spaces, and quotes and backslashes keep them together as in a POSIX shell. There is no shell: no
/// variables, pipes or wildcards, the same on each system, and nothing that a file's name could start by itself. Who wants a
/// shell names it: `sh -c '…'`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CommandLine {
    text: String,
    words: Vec<String>,
}

impl CommandLine {
    /// Splits `text`.
    ///
    /// # Errors
    /// [`Fault::EmptyCommand`], [`Fault::OpenQuote`].
    pub fn parse(text: &str) -> Result<Self, Fault> {
        let words = shlex::split(text).ok_or(Fault::OpenQuote)?;
        match words.first() {
            Some(program) if !program.is_empty() => Ok(Self {
                text: text.trim().into(),
                words,
            }),
            _ => Err(Fault::EmptyCommand),
        }
    }

    /// What was given.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The first word.
    pub fn program(&self) -> &str {
        &self.words[0]
    }

    /// The other words.
    pub fn arguments(&self) -> &[String] {
        &self.words[1..]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quotes_keep_words_together() {
        let line = CommandLine::parse(r#" python3 'my file.py' --name "a b" c\ d "#).unwrap();
        assert_eq!(line.program(), "python3");
        assert_eq!(line.arguments(), ["my file.py", "--name", "a b", "c d"]);
        assert_eq!(line.text(), r#"python3 'my file.py' --name "a b" c\ d"#);
    }

    #[test]
    fn bad_lines_are_refused() {
        for text in ["", "   ", "''", "# only a comment"] {
            assert!(
                matches!(CommandLine::parse(text), Err(Fault::EmptyCommand)),
                "{text}"
            );
        }
        for text in ["python3 'mine.py", "\"", "a\\"] {
            assert!(
                matches!(CommandLine::parse(text), Err(Fault::OpenQuote)),
                "{text}"
            );
        }
    }

    proptest! {
        /// A shell's metacharacters are only characters.
        #[test]
        fn any_words_survive_quoting(words in proptest::collection::vec("[^\0]{1,12}", 1..5)) {
            let quoted = shlex::try_join(words.iter().map(String::as_str)).unwrap();
            let line = CommandLine::parse(&quoted).unwrap();
            prop_assert_eq!(line.program(), &words[0]);
            prop_assert_eq!(line.arguments(), &words[1..]);
        }
    }
}
