//! Questions and answers, one at a time, whatever comes.

use crate::binary::{self, Width};
use crate::child::{Child, Event, GRACE, in_words};
use crate::command::CommandLine;
use crate::error::{Ask, ExecError, Fault, Question, excerpt};
use crate::hello::Hello;
use crate::json;
use std::time::{Duration, Instant};

/// The version of the protocol, told in the first question.
pub const PROTOCOL: u32 = 1;

/// A conversation with a running process.
pub(crate) struct Conversation {
    line: CommandLine,
    child: Child,
    limit: Duration,
    /// Size of a number in batches; `None`: lines of JSON.
    width: Option<Width>,
    /// Number of the last question.
    id: u32,
    /// The question that was answered last.
    answered: Option<Question>,
    /// Bytes that came and belong to no answer yet.
    pending: Vec<u8>,
}

impl Conversation {
    pub(crate) fn new(line: CommandLine, child: Child, limit: Duration) -> Self {
        Self {
            line,
            child,
            limit,
            width: None,
            id: 0,
            answered: None,
            pending: Vec::new(),
        }
    }

    pub(crate) fn line(&self) -> &CommandLine {
        &self.line
    }

    pub(crate) fn width(&self) -> Option<Width> {
        self.width
    }

    /// Asks the process who it is.
    pub(crate) fn greet(&mut self) -> Result<Hello, Fault> {
        let question = Question {
            id: 0,
            ask: Ask::Hello,
        };
        let line = self.ask(question, 0, json::hello(PROTOCOL))?;
        let hello = Hello::parse(&line)?;
        self.width = Width::of(hello.batches);
        Ok(hello)
    }

    /// Closes the process's input, waits for its end, and looks for what it wrote unasked.
    pub(crate) fn finish(&mut self) -> Result<(), Fault> {
        self.child.finish();
        // What it wrote is in the pipe.
        let deadline = Instant::now() + Duration::from_millis(300);
        while self.pending.is_empty() {
            match self.child.wait(deadline) {
                Event::Bytes(bytes) => self.pending.extend(bytes),
                Event::InputClosed => {}
                Event::OutputClosed | Event::Late => break,
            }
        }
        self.unasked()
    }

    pub(crate) fn next(&mut self, ask: Ask) -> Question {
        self.id = self.id.wrapping_add(1);
        Question { id: self.id, ask }
    }

    /// Sends a question of `count` entries and waits for the bytes of the answer: a line without its end, or a binary answer
    /// of the right length whose header is checked.
    pub(crate) fn ask(
        &mut self,
        question: Question,
        count: usize,
        asked: Vec<u8>,
    ) -> Result<Vec<u8>, Fault> {
        self.collect();
        self.unasked()?;
        let mut deadline = Instant::now() + self.limit;
        let mut input_closed = false;
        self.child.send(asked);
        let width = match question.ask {
            Ask::Hello => None,
            _ => self.width,
        };
        // How much of the pending bytes was already looked through for the end of the line.
        let mut seen = 0;
        loop {
            match width {
                None => {
                    let end = self.pending[seen..].iter().position(|b| *b == b'\n');
                    if let Some(end) = end {
                        let rest = self.pending.split_off(seen + end + 1);
                        let mut line = std::mem::replace(&mut self.pending, rest);
                        line.pop();
                        self.answered = Some(question);
                        return Ok(line);
                    }
                    seen = self.pending.len();
                    let longest = json::longest(question.ask, count);
                    if seen > longest {
                        return Err(Fault::NotAnAnswer {
                            question,
                            found: format!(
                                "a line of more than {longest} bytes, {}",
                                excerpt(&self.pending)
                            ),
                            expected: "a shorter one".into(),
                        });
                    }
                }
                Some(width) => {
                    binary::check_header(question, count, &self.pending)?;
                    let length = binary::length(question, count, width);
                    if self.pending.len() >= length {
                        let rest = self.pending.split_off(length);
                        let answer = std::mem::replace(&mut self.pending, rest);
                        self.answered = Some(question);
                        return Ok(answer);
                    }
                }
            }
            match self.child.wait(deadline) {
                Event::Bytes(bytes) => self.pending.extend(bytes),
                Event::Late if input_closed => return Err(self.gone(question, "input")),
                Event::Late => {
                    return Err(Fault::Timeout {
                        question,
                        limit: self.limit,
                        received: self.pending.len(),
                    });
                }
                Event::OutputClosed => return Err(self.gone(question, "output")),
                // What it wrote before may still come, and says more.
                Event::InputClosed => {
                    input_closed = true;
                    deadline = deadline.min(Instant::now() + GRACE);
                }
            }
        }
    }

    /// Takes what has come already.
    fn collect(&mut self) {
        if let Event::Bytes(bytes) = self.child.wait(Instant::now()) {
            self.pending.extend(bytes);
        }
    }

    /// Fails if bytes came that nobody asked for: earlier answers may then belong to other questions than it seemed.
    fn unasked(&self) -> Result<(), Fault> {
        if self.pending.is_empty() {
            return Ok(());
        }
        Err(Fault::Unasked {
            found: excerpt(&self.pending),
            when: match self.answered {
                None => "before hello".into(),
                Some(question) => format!("after its answer to {question}"),
            },
        })
    }

    /// Why a stream was closed.
    fn gone(&mut self, question: Question, stream: &'static str) -> Fault {
        match self.child.status() {
            Some(status) => Fault::Ended {
                question,
                status: in_words(status),
            },
            None => Fault::Closed { question, stream },
        }
    }

    /// The error of a fault, after which there is no conversation.
    pub(crate) fn failed(&mut self, fault: Fault) -> ExecError {
        self.child.kill();
        ExecError {
            command: self.line.text().into(),
            fault,
            stderr: self.child.last_words(),
        }
    }
}
