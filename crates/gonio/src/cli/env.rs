//! `gonio env`.

use super::environment::PanoramaArguments;
use super::failure::Failure;
use super::terminal::{print, print_json};

#[derive(clap::Subcommand)]
#[command(after_help = "Example:\n  gonio env info sunset.hdr")]
pub(super) enum Command {
    /// Layout, size, mean radiance, irradiance on six axes, peak, dynamic range, faults
    #[command(after_help = "Example:\n  gonio env info sunset.hdr")]
    Info {
        /// A panorama (EXR, HDR, PNG, JPEG), or uniform:RADIANCE
        environment: String,
        #[command(flatten)]
        reading: PanoramaArguments,
        /// Print it as JSON
        #[arg(long)]
        json: bool,
    },
}

pub(super) fn run(command: Command) -> Result<(), Failure> {
    let Command::Info {
        environment,
        reading,
        json,
    } = command;
    let info = reading.parse(&environment)?.info();
    if json {
        print_json(&info)
    } else {
        print(&info.to_string())
    }
}
