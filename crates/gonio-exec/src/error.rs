//! What can go wrong with a process.

use std::fmt;
use std::time::Duration;

/// A process that can't be used, and what it said on its standard error before.
#[derive(Debug, thiserror::Error)]
#[error("{command}: {fault}")]
pub struct ExecError {
    /// The command line.
    pub command: String,
    /// What went wrong.
    #[source]
    pub fault: Fault,
    /// The last lines that the process wrote to its standard error, without control characters.
    pub stderr: Vec<String>,
}

/// What went wrong with a process.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// The command line names no program.
    #[error("the command line is empty, expected a program and its arguments")]
    EmptyCommand,
    /// A quote of the command line has no end.
    #[error("a quote isn't closed, or a backslash ends the line")]
    OpenQuote,
    /// The program can't be started.
    #[error("can't start `{program}`: {source}")]
    Start {
        /// The first word of the command line.
        program: String,
        /// The operating system's reason.
        source: std::io::Error,
    },
    /// No answer in time.
    #[error("no answer to {question} within {} s ({received} bytes of one came)", limit.as_secs_f64())]
    Timeout {
        /// What was asked.
        question: Question,
        /// The time it had.
        limit: Duration,
        /// Bytes that came.
        received: usize,
    },
    /// The process ended.
    #[error("it ended ({status}) where it owed an answer to {question}")]
    Ended {
        /// What was asked.
        question: Question,
        /// The exit status in words.
        status: String,
    },
    /// The process runs on, but reads or writes no more.
    #[error("it closed its standard {stream} where it owed an answer to {question}")]
    Closed {
        /// What was asked.
        question: Question,
        /// `input` or `output`.
        stream: &'static str,
    },
    /// It wrote before it was asked, or more than it was asked for.
    #[error("it wrote {found} without being asked, {when}")]
    Unasked {
        /// An excerpt of what it wrote.
        found: String,
        /// When that was.
        when: String,
    },
    /// An answer that isn't one.
    #[error("{question} was answered by {found}, expected {expected}")]
    NotAnAnswer {
        /// What was asked.
        question: Question,
        /// An excerpt of what came.
        found: String,
        /// What the protocol asks for.
        expected: String,
    },
    /// An answer of another length than the question's.
    #[error("{question} was answered with {found} values of `{what}`, expected {expected}")]
    Length {
        /// What was asked.
        question: Question,
        /// The array concerned.
        what: &'static str,
        /// Values that came.
        found: usize,
        /// Values that were asked for.
        expected: usize,
    },
    /// A hello that says something impossible.
    #[error("its hello says {found}, expected {expected}")]
    Hello {
        /// What it says.
        found: String,
        /// What is possible.
        expected: String,
    },
}

/// A question that a process was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Question {
    /// Its number, from 0.
    pub id: u32,
    /// What is asked for.
    pub ask: Ask,
}

impl fmt::Display for Question {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.ask {
            Ask::Hello => f.write_str("hello"),
            ask => write!(f, "question {} ({})", self.id, ask.name()),
        }
    }
}

/// The kinds of questions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ask {
    /// Who are you?
    Hello,
    /// f(wi, wo).
    Eval,
    /// The density of drawing wi.
    Pdf,
    /// Draw wi.
    Sample,
}

impl Ask {
    /// The word in the protocol.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hello => "hello",
            Self::Eval => "eval",
            Self::Pdf => "pdf",
            Self::Sample => "sample",
        }
    }
}

impl ExecError {
    /// What to do about it.
    pub fn help(&self) -> String {
        match &self.fault {
            Fault::EmptyCommand | Fault::OpenQuote => {
                "give the command as one argument: --exec 'python3 mine.py --roughness 0.3'".into()
            }
            Fault::Start { source, .. } if source.kind() == std::io::ErrorKind::NotFound => {
                "check the program's name and the PATH; a shell isn't involved: for pipes and variables write sh -c '…'"
                    .into()
            }
            Fault::Start { .. } => "check the path and the permissions".into(),
            Fault::Timeout { .. } => {
                "flush the output after each answer; if it only is slow, give --exec-timeout more seconds".into()
            }
            Fault::Ended { .. } => match self.stderr.is_empty() {
                true => "run the program alone: it has to answer lines of standard input until they end".into(),
                false => "its last words on standard error stand above".into(),
            },
            Fault::Closed { .. } => "keep both standard streams open until the input ends".into(),
            Fault::Unasked { .. } | Fault::NotAnAnswer { .. } => {
                "only answers may go to standard output; print everything else to standard error".into()
            }
            Fault::Length { .. } => "give one value for each entry of the question, in its order".into(),
            Fault::Hello { .. } => "the book's page \"Functions in other programs\" lists what a hello may say".into(),
        }
    }
}

/// The first bytes of what came, for a message: text in backquotes, or bytes in hexadecimal.
pub(crate) fn excerpt(bytes: &[u8]) -> String {
    const MOST: usize = 60;
    let line = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
    let cut = &line[..line.len().min(MOST)];
    let more = if cut.len() < bytes.trim_ascii_end().len() {
        "…"
    } else {
        ""
    };
    // A cut may fall inside a character.
    let text = match std::str::from_utf8(cut) {
        Ok(text) => Some(text),
        Err(e) if e.error_len().is_none() => std::str::from_utf8(&cut[..e.valid_up_to()]).ok(),
        Err(_) => None,
    };
    match text.filter(|t| t.chars().all(|c| !c.is_control() || c == '\t' || c == '\r')) {
        Some("") if more.is_empty() => "an empty line".into(),
        Some(text) => format!("`{}{more}`", text.trim_end()),
        None => {
            let hex: Vec<String> = bytes.iter().take(12).map(|b| format!("{b:02x}")).collect();
            format!(
                "the bytes {}{}",
                hex.join(" "),
                if bytes.len() > 12 { "…" } else { "" }
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_are_short_and_harmless() {
        assert_eq!(excerpt(b"hello\nworld\n"), "`hello…`");
        assert_eq!(excerpt(b"hello\n"), "`hello`");
        assert_eq!(excerpt(b"\n"), "an empty line");
        assert_eq!(excerpt(b"\x1b[31m"), "the bytes 1b 5b 33 31 6d");
        assert_eq!(
            excerpt(&[0xff; 100]),
            format!("the bytes {}…", ["ff"; 12].join(" "))
        );
        let long = excerpt("θ".repeat(1000).as_bytes());
        assert_eq!(long, format!("`{}…`", "θ".repeat(30)));
        let cut = excerpt(format!("a{}", "θ".repeat(1000)).as_bytes());
        assert_eq!(cut, format!("`a{}…`", "θ".repeat(29)));
    }
}
