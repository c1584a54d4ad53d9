//! `gonio diff`.

use super::failure::{Failure, chain};
use super::{print, print_json, render};
use gonio_image::Image;
use gonio_image::difference::{self, Difference, flip::FlipKind};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Example:\n  gonio diff a.exr b.exr --heatmap where.png")]
pub(super) struct Arguments {
    /// An image: EXR, HDR, PNG or JPEG
    a: PathBuf,
    /// The image it is compared with, of the same size: the reference
    b: PathBuf,
    /// Write the FLIP error of each pixel as a picture
    #[arg(long, value_name = "FILE.png")]
    heatmap: Option<PathBuf>,
    /// Print the figures as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if let Some(path) = &arguments.heatmap {
        render::check_output(path)?;
    }
    let read = |path: &PathBuf| Image::read(path).map_err(|e| Failure::input(chain(&e)));
    let (a, b) = (read(&arguments.a)?, read(&arguments.b)?);
    let found = difference::compare(&a, &b).map_err(|e| {
        Failure::input(format!(
            "{} and {}: {}",
            arguments.a.display(),
            arguments.b.display(),
            chain(&e)
        ))
    })?;
    if let Some(path) = &arguments.heatmap {
        difference::heatmap(&found)
            .write(path)
            .map_err(|e| Failure::input(chain(&e)))?;
    }
    if arguments.json {
        print_json(&found)
    } else {
        print(&in_words(&found));
        Ok(())
    }
}

fn in_words(found: &Difference) -> String {
    let flip = match found.flip {
        FlipKind::Ldr => "of display colours, clamped to [0, 1]".to_owned(),
        FlipKind::Hdr {
            start_ev,
            stop_ev,
            exposures,
        } => {
            format!("HDR, {exposures} exposures from {start_ev:+.1} to {stop_ev:+.1} EV")
        }
    };
    let largest = &found.largest;
    let at = match largest.difference {
        0.0 => "none: the pictures are equal".to_owned(),
        difference => format!(
            "{difference:.6} at column {}, row {}, {}: {} against {}",
            largest.x,
            largest.y,
            ["red", "green", "blue"][largest.channel],
            largest.a,
            largest.b
        ),
    };
    format!(
        "RMSE                {:.6}\nrelative MSE        {:.6e}\nPSNR                {:.2} dB, peak {}\n\
         FLIP                {:.6}, {flip}\nlargest difference  {at}",
        found.rmse, found.relative_mse, found.psnr_db, found.peak, found.flip_mean
    )
}
