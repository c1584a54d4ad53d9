//! Times each part of prefiltering a panorama for Filament: `prefilter PANORAMA FOLDER [CHECK]`.
//!
//! Writes what `gonio env prefilter PANORAMA -o FOLDER --for filament --format float` does. CHECK texels of each level are compared with exact
//! quadrature.

use gonio_env::Environment;
use gonio_ibl::bundle::{Options, write};
use gonio_ibl::{Dfg, Harmonics, Target};
use gonio_image::TexelFormat;
use std::path::Path;
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, panorama, folder, rest @ ..] = &arguments[..] else {
        return Err("usage: prefilter PANORAMA FOLDER [CHECK]".into());
    };
    let check = rest.first().map_or(Ok(0), |n| n.parse())?;
    let start = Instant::now();
    let environment = Environment::load(panorama, None)?;
    println!("load {:.3}", start.elapsed().as_secs_f64());
    let options = Options {
        target: Target::Filament,
        format: TexelFormat::Float,
        check,
        ..Options::default()
    };
    let report = write(&environment, &options, Path::new(folder), &mut |_| ())?;
    println!("all {:.3}", start.elapsed().as_secs_f64());
    for l in &report.levels {
        println!("level {} {:.3} {:?}", l.level, l.seconds, l.error);
    }
    let start = Instant::now();
    Harmonics::of_radiance(&environment, 3)?;
    println!("harmonics {:.3}", start.elapsed().as_secs_f64());
    let start = Instant::now();
    Dfg::new("ggx", 128, 128)?;
    println!("table {:.3}", start.elapsed().as_secs_f64());
    Ok(())
}
