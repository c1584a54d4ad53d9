//! A process that evaluates a reflection function.

use crate::binary;
use crate::child::{Child, Killer};
use crate::command::CommandLine;
use crate::conversation::Conversation;
use crate::error::{Ask, ExecError, Fault};
use crate::hello::Hello;
use crate::json;
use gonio_num::Vec3;
use gonio_verify::SubjectSample;
use std::time::Duration;

/// Entries of a question at most.
pub const MOST_ENTRIES: usize = 4096;
/// The time that an answer may take, unless told otherwise.
pub const USUAL_LIMIT: Duration = Duration::from_secs(60);

/// A process that evaluates a reflection function, in a conversation over its standard input and output.
///
/// Questions are asked one at a time. Whatever the process does (end, stay silent, answer something else, flood its standard
/// error, ignore that its input ended), each call returns within the time limit and some seconds, and when this value is
/// dropped the process has ended.
pub struct Process {
    talk: Conversation,
    hello: Hello,
}

impl Process {
    /// Starts the process and asks it who it is. Each answer may take `limit`.
    ///
    /// # Errors
    /// If it can't be started, or doesn't answer as the protocol says.
    pub fn start(command: &str, limit: Duration) -> Result<Self, ExecError> {
        Self::start_with(command, limit, |_| ())
    }

    /// [`Process::start`] that hands out a way to end the process before the first question, which it may answer late or never.
    ///
    /// # Errors
    /// As [`Process::start`].
    pub fn start_with(
        command: &str,
        limit: Duration,
        started: impl FnOnce(Killer),
    ) -> Result<Self, ExecError> {
        let failed = |fault| ExecError {
            command: command.trim().into(),
            fault,
            stderr: Vec::new(),
        };
        let line = CommandLine::parse(command).map_err(failed)?;
        let child = Child::start(&line).map_err(|source| {
            failed(Fault::Start {
                program: line.program().into(),
                source,
            })
        })?;
        started(child.killer());
        let mut talk = Conversation::new(line, child, limit);
        match talk.greet() {
            Ok(hello) => Ok(Self { talk, hello }),
            Err(fault) => Err(talk.failed(fault)),
        }
    }

    /// What the process says of itself.
    pub fn hello(&self) -> &Hello {
        &self.hello
    }

    /// The command line.
    pub fn command(&self) -> &CommandLine {
        self.talk.line()
    }

    /// f(wi, wo) for each pair; the slices are equally long.
    ///
    /// # Errors
    /// If there is no right answer. The process has ended then.
    pub fn eval(
        &mut self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        f: &mut [[f64; 3]],
    ) -> Result<(), ExecError> {
        let chunks = wi.chunks(MOST_ENTRIES).zip(wo.chunks(MOST_ENTRIES));
        for ((wi, wo), out) in chunks.zip(f.chunks_mut(MOST_ENTRIES)) {
            let question = self.talk.next(Ask::Eval);
            let width = self.talk.width();
            let asked = match width {
                Some(width) => binary::pairs(question, wi, wo, width),
                None => json::pairs(question, wi, wo),
            };
            let answered = self.talk.ask(question, out.len(), asked).and_then(|bytes| {
                match width {
                    Some(width) => binary::evaluated(&bytes, width, out),
                    None => json::evaluated(question, &bytes, out)?,
                }
                Ok(())
            });
            answered.map_err(|fault| self.talk.failed(fault))?;
        }
        Ok(())
    }

    /// The density of drawing wi given wo, for each pair; the slices are equally long.
    ///
    /// # Errors
    /// If there is no right answer. The process has ended then.
    pub fn pdf(
        &mut self,
        wi: &[Vec3<f64>],
        wo: &[Vec3<f64>],
        pdf: &mut [f64],
    ) -> Result<(), ExecError> {
        let chunks = wi.chunks(MOST_ENTRIES).zip(wo.chunks(MOST_ENTRIES));
        for ((wi, wo), out) in chunks.zip(pdf.chunks_mut(MOST_ENTRIES)) {
            let question = self.talk.next(Ask::Pdf);
            let width = self.talk.width();
            let asked = match width {
                Some(width) => binary::pairs(question, wi, wo, width),
                None => json::pairs(question, wi, wo),
            };
            let answered = self.talk.ask(question, out.len(), asked).and_then(|bytes| {
                match width {
                    Some(width) => binary::densities(&bytes, width, out),
                    None => json::densities(question, &bytes, out)?,
                }
                Ok(())
            });
            answered.map_err(|fault| self.talk.failed(fault))?;
        }
        Ok(())
    }

    /// Draws wi given wo and three numbers in [0, 1), for each; the slices are equally long.
    ///
    /// # Errors
    /// If there is no right answer. The process has ended then.
    pub fn sample(
        &mut self,
        wo: &[Vec3<f64>],
        u: &[[f64; 3]],
        samples: &mut [Option<SubjectSample>],
    ) -> Result<(), ExecError> {
        let chunks = wo.chunks(MOST_ENTRIES).zip(u.chunks(MOST_ENTRIES));
        for ((wo, u), out) in chunks.zip(samples.chunks_mut(MOST_ENTRIES)) {
            let question = self.talk.next(Ask::Sample);
            let width = self.talk.width();
            let asked = match width {
                Some(width) => binary::draws(question, wo, u, width),
                None => json::draws(question, wo, u),
            };
            let answered =
                self.talk
                    .ask(question, out.len(), asked)
                    .and_then(|bytes| match width {
                        Some(width) => binary::samples(question, &bytes, width, out),
                        None => json::samples(question, &bytes, out),
                    });
            answered.map_err(|fault| self.talk.failed(fault))?;
        }
        Ok(())
    }

    /// Ends the conversation: closes the process's input, and ends the process if it doesn't by itself.
    ///
    /// # Errors
    /// If it has written what it wasn't asked for: earlier answers may then not be those to the questions that they seemed
    /// to answer.
    pub fn finish(mut self) -> Result<(), ExecError> {
        self.talk.finish().map_err(|fault| self.talk.failed(fault))
    }
}

impl std::fmt::Debug for Process {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Process")
            .field("line", self.talk.line())
            .field("hello", &self.hello)
            .finish_non_exhaustive()
    }
}
