//! Checks and chores of this repository, run as `cargo xtask NAME`.

mod fuzz;
mod house;
mod licenses;
mod links;
mod peers;
mod web;

use std::process::{Command, ExitCode};

const HELP: &str = "\
Usage: cargo xtask <job>

  floors   no crate depends on a higher floor, or on another of its own
  files    no source file is longer than 600 lines
  links    documents link to files that exist; every page of the book is in its summary
  house    all of them
  fuzz     run each fuzz target for --seconds N (60); needs a C++ compiler
  bench peers [scenes] [error] [start] [rays]
           speed and error beside Mitsuba 3 and Embree 4, in one run; installs both with pip under target/peers
  web      the explorer as a site of static files in web/dist; needs Node 20 with npm";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let outcome = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["floors"] => house::floors(),
        ["files"] => house::files(),
        ["links"] => links::links(),
        ["house"] => house::floors()
            .and_then(|()| house::files())
            .and_then(|()| links::links()),
        ["fuzz"] => fuzz::run(60),
        ["fuzz", "--seconds", n] => match n.parse() {
            Ok(seconds) if seconds > 0 => fuzz::run(seconds),
            _ => Err(format!("`{n}` seconds: expected a whole number from 1")),
        },
        ["bench", "peers", ref parts @ ..] => peers::run(parts),
        ["web"] => web::run(),
        ["help" | "--help" | "-h"] => {
            println!("{HELP}");
            Ok(())
        }
        _ => Err(format!("unknown arguments {arguments:?}\n\n{HELP}")),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Runs a program and fails as it does.
fn call(command: &mut Command) -> Result<(), String> {
    let name = format!("{command:?}");
    match command.status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("{name}: {status}")),
        Err(e) => Err(format!("{name}: {e}")),
    }
}
