//! `gonio env`: one file a subcommand.

mod convert;
mod info;

use super::failure::Failure;

#[derive(clap::Subcommand)]
#[command(
    after_help = "Examples:\n  gonio env info sunset.hdr\n  gonio env convert sunset.hdr sunset.ktx2 --to cube --size 256 --mips"
)]
pub(super) enum Command {
    /// Layout, size, mean radiance, irradiance on six axes, peak, dynamic range, faults
    Info(info::Arguments),
    /// Another layout, size, orientation or file format, with the flux kept
    Convert(Box<convert::Arguments>),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Info(arguments) => info::run(&arguments),
        Command::Convert(arguments) => convert::run(*arguments),
    }
}
