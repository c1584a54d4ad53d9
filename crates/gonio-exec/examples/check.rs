//! Checks the function that a program evaluates:
//!
//! ```sh
//! cargo run -p gonio-exec --example check -- 'python3 examples/exec/ggx.py 0.5'
//! ```

use gonio_exec::{Process, Remote, USUAL_LIMIT};
use gonio_verify::{Checker, Effort, Settings, Subject};
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let command = arguments.next().ok_or("name a command")?;
    let effort = match arguments.next().as_deref() {
        Some("standard") => Effort::Standard,
        Some("thorough") => Effort::Thorough,
        _ => Effort::Quick,
    };
    let process = Process::start(&command, USUAL_LIMIT)?;
    let hello = process.hello().clone();
    let remote = Remote::new(process);
    let subject = Subject::batched(hello.description(), &remote);
    let report = Checker::new(&subject, &hello.expectation, effort)
        .settings(Settings::new(effort).with_precision(hello.precision))
        .run(hello.description());
    // The conversation's own error says more than the check's.
    remote.finish()?;
    println!("{}", report?);
    Ok(())
}
