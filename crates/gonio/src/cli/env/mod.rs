//! `gonio env`: one file a subcommand.

mod capture;
mod convert;
mod info;
mod irradiance;
mod lights;
mod prefilter;
mod sh;
mod sky;
mod steps;

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
    /// Irradiance on surfaces, as numbers or as a map; maps of Phong's lobe
    Irradiance(irradiance::Arguments),
    /// Directional lights that stand for an environment
    Lights(lights::Arguments),
    /// Everything a real-time renderer needs: prefiltered cubes, harmonics, tables
    Prefilter(Box<prefilter::Arguments>),
    /// Spherical harmonics, in the convention of a renderer
    Sh(sh::Arguments),
    /// Another layout, size, orientation or file format, with the flux kept
    Convert(Box<convert::Arguments>),
    /// Sun and sky over a place at a time, as a panorama
    Sky(sky::Arguments),
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Capture(arguments) => capture::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Irradiance(arguments) => irradiance::run(&arguments),
        Command::Lights(arguments) => lights::run(&arguments),
        Command::Prefilter(arguments) => prefilter::run(&arguments),
        Command::Sh(arguments) => sh::run(&arguments),
        Command::Convert(arguments) => convert::run(*arguments),
        Command::Sky(arguments) => sky::run(&arguments),
    }
}
