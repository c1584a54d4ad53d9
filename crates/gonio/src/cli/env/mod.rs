//! `gonio env`: one file a subcommand.

mod info;

use super::failure::Failure;

#[derive(clap::Subcommand)]
#[command(after_help = "Example:\n  gonio env info sunset.hdr")]
pub(super) enum Command {
    /// Layout, size, mean radiance, irradiance on six axes, peak, dynamic range, faults
    Info(info::Arguments),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Info(arguments) => info::run(&arguments),
    }
}
