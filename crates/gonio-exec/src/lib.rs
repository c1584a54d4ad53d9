//! Reflection functions that another process evaluates.
//!
//! [`Process::start`] runs a command and talks with it over its standard input and output, in the protocol of the book's page
//! "Functions in other programs": `eval`, `pdf` and `sample` in batches, as lines of JSON or as little-endian numbers.
//! [`Remote`] hands it to [`gonio_verify`], which then checks it as it checks any other reflection function.
//!
//! A process can do anything. Each call returns within the time limit; an error says what was asked, what came, and what was
//! expected, and carries the last lines of the process's standard error.

mod binary;
mod child;
mod command;
mod conversation;
mod error;
mod hello;
mod json;
mod process;
mod remote;

pub use child::Killer;
pub use command::CommandLine;
pub use conversation::PROTOCOL;
pub use error::{Ask, ExecError, Fault, Question};
pub use hello::{Batches, Hello};
pub use process::{MOST_ENTRIES, Process, USUAL_LIMIT};
pub use remote::Remote;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
