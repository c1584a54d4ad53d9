//! `gonio env`: one file a subcommand.

mod capture;
mod convert;
mod info;
mod sky;

use super::failure::Failure;

#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  gonio env info sunset.hdr\n  gonio env convert sunset.hdr sunset.ktx2 --to cube --size 256 --mips"
)]
pub(super) enum Command {
    /// Photographs of a mirrored ball to a panorama with what is known about each texel
    Capture(Box<capture::Arguments>),
    /// Layout, size, mean radiance, irradiance on six axes, peak, dynamic range, faults
    Info(info::Arguments),
    /// Another layout, size, orientation or file format, with the flux kept
    Convert(Box<convert::Arguments>),
    /// Sun and sky over a place at a time, as a panorama
    Sky(sky::Arguments),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Capture(arguments) => capture::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Convert(arguments) => convert::run(*arguments),
        Command::Sky(arguments) => sky::run(&arguments),
    }
}
