//! The `gonio` command: arguments in, one job done, an exit code out.
//!
//! Exit codes: 0 done, 1 a verification failed, 2 usage, 3 input, 4 interrupted.

mod brdf;
mod destination;
mod diff;
#[cfg(test)]
mod documents;
mod env;
mod environment;
mod explore;
mod failure;
mod farm;
mod info;
mod measure;
mod merge;
mod parse;
mod presets;
mod progress;
mod relight;
mod render;
mod summary;
mod terminal;
mod usage;

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
        gonio measure irradiance --env uniform:1        π W m⁻²\n  \
        gonio explore                                   reflection at your fingertips, in the browser\n\n\
        Exit codes: 0 done, 1 a verification failed, 2 usage, 3 input, 4 interrupted.",
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
    /// Put the parts of a picture together
    Merge(merge::Arguments),
    /// Mix the groups of lights of a picture again
    Relight(relight::Arguments),
    /// Write a rendering in parts as a job for a farm, a cluster or a cloud
    #[command(subcommand)]
    Farm(farm::Command),
    /// How a picture or a part of one came to be
    Info(info::Arguments),
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
    /// Explore reflection functions in the browser
    Explore(explore::Arguments),
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
        Err(e) => Err(usage::of_arguments::<Arguments>(&e)),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Render(arguments) => render::run(&arguments),
        Command::Merge(arguments) => merge::run(&arguments),
        Command::Relight(arguments) => relight::run(&arguments),
        Command::Farm(command) => farm::run(&command),
        Command::Info(arguments) => info::run(&arguments),
        Command::Brdf(command) => brdf::run(command),
        Command::Env(command) => env::run(command),
        Command::Measure(command) => measure::run(command),
        Command::Diff(arguments) => diff::run(&arguments),
        Command::Explore(arguments) => explore::run(&arguments),
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        super::Arguments::command().debug_assert();
    }
}
