//! `gonio env info`.

use crate::cli::environment::PanoramaArguments;
use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json};

#[derive(clap::Args)]
#[command(after_help = "Example:\n  gonio env info sunset.hdr")]
pub(in crate::cli) struct Arguments {
    /// A panorama (EXR, HDR, PNG, JPEG, TIFF, KTX2, DDS), a folder of six faces, a name with {face} in it, uniform:RADIANCE, or sky:WORDS
    environment: String,
    #[command(flatten)]
    reading: PanoramaArguments,
    /// Print it as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let info = arguments.reading.parse(&arguments.environment)?.info();
    if arguments.json {
        print_json(&info)
    } else {
        print(&info.to_string())
    }
}
