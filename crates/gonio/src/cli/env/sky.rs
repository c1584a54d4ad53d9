//! `gonio env sky`.

use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::terminal::print;
use gonio_env::{Sky, SkyOptions};
use gonio_image::tonemap::ToneMap;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio env sky 2026-06-21T12:00+02:00@48.2,16.4,turbidity=3 -o noon.exr\n  \
    gonio env sky azimuth=250,elevation=4,turbidity=5 -o evening.exr -o evening.png --exposure -5\n\n\
    Keys: azimuth, elevation (degrees), turbidity (1 to 10), albedo (0 to 1, or r/g/b), sun, sky, ground (on or off).\n\
    North is -z, in the picture's centre; east is to its right. The same words after sky: are an environment:\n  \
    gonio render ball.toml --env sky:elevation=30")]
pub(in crate::cli) struct Arguments {
    /// DATE@LATITUDE,LONGITUDE or azimuth=DEG,elevation=DEG, then key=value,…
    sky: String,
    /// Where to write: .exr, .hdr or .png; may be repeated; without it, the sky is described alone
    #[arg(short, long = "output", value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Rows of the panorama, which is twice as wide
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = parse::whole(2_usize, 16384), allow_hyphen_values = true)]
    height: usize,
    /// Exposure of PNG files, in stops
    #[arg(long, value_name = "EV", default_value = "0", value_parser = parse::finite, allow_hyphen_values = true)]
    exposure: f32,
    /// Tone map of PNG files
    #[arg(long, value_name = "NAME", default_value = "pbr-neutral", value_parser = parse::tone_map(), allow_hyphen_values = true)]
    tonemap: ToneMap,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options: SkyOptions = arguments.sky.parse()?;
    for path in &arguments.output {
        destination::check(path)?;
    }
    let sky = Sky::new(options)?;
    if !arguments.output.is_empty() {
        let picture = sky.panorama(arguments.height);
        for path in &arguments.output {
            match destination::extension(path).as_str() {
                "png" => picture.write_png(path, arguments.tonemap, arguments.exposure)?,
                _ => picture.write(path)?,
            }
        }
    }
    print(&gonio_env::Environment::from_sky(sky).info().to_string())
}
