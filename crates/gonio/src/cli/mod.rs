//! The `gonio` command: arguments in, one job done, an exit code out.
//!
//! Exit codes: 0 done, 1 a verification failed, 2 usage, 3 input, 4 interrupted.

mod brdf;
mod diff;
mod env;
mod failure;
mod measure;
mod parse;
mod progress;
mod render;

use clap::{Parser, Subcommand};
use failure::Failure;
use std::process::ExitCode;

#[derive(Parser)]
#[command(
    name = "gonio",
    version,
    about = "A reflectance laboratory and reference renderer",
    long_about = "A reflectance laboratory and reference renderer.\n\n\
        Bring a reflection function and light: gonio evaluates it, proves or refutes that it is physical, and renders it.",
    after_help = "Examples:\n  \
        gonio render                                    the preview: gonio.png and gonio.exr\n  \
        gonio brdf check all                            is every reflection function physical?\n  \
        gonio measure irradiance --env uniform:1        π W m⁻²",
    propagate_version = true,
    disable_help_subcommand = true
)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Render a scene, or the embedded preview
    Render(Box<render::Arguments>),
    /// List, show, evaluate and check reflection functions
    #[command(subcommand)]
    Brdf(brdf::Command),
    /// Look into environment maps
    #[command(subcommand)]
    Env(env::Command),
    /// Read irradiance, exitance, radiance or flux, with unit and standard error
    #[command(subcommand)]
    Measure(measure::Command),
    /// Compare two images: RMSE, relative MSE, PSNR, FLIP
    Diff(diff::Arguments),
}

/// Runs the command on the process's arguments.
pub fn main() -> ExitCode {
    let outcome = match Arguments::try_parse() {
        Ok(arguments) => run(arguments.command),
        Err(e) if !e.use_stderr() => {
            // Help and version. A closed pipe is no fault of the user's.
            let _ = e.print();
            return ExitCode::SUCCESS;
        }
        Err(e) => Err(failure::of_arguments(&e)),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Brdf(command) => brdf::run(command),
        Command::Env(command) => env::run(command),
        Command::Measure(command) => measure::run(command),
        Command::Diff(arguments) => diff::run(&arguments),
    }
}

/// Prints to standard output; a reader that closes the pipe early (`| head`) ends the output, not the command.
pub(crate) fn print(text: &str) {
    use std::io::Write;
    let mut out = std::io::stdout().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| {
        if text.ends_with('\n') {
            Ok(())
        } else {
            out.write_all(b"\n")
        }
    });
}

/// Prints a value as indented JSON.
pub(crate) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::input(format!("the result has no JSON form: {e}")))?;
    print(&text);
    Ok(())
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
