//! `gonio diff`.

use super::destination;
use super::failure::{Failure, chain};
use super::terminal::{print, print_json, significant};
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
        destination::check(path)?;
    }
    let (a, b) = (Image::read(&arguments.a)?, Image::read(&arguments.b)?);
    let found = difference::compare(&a, &b).map_err(|e| {
        Failure::input(format!(
            "{} and {}: {}",
            arguments.a.display(),
            arguments.b.display(),
            chain(&e)
        ))
        .with_help("compare pictures of the same size, such as two renderings of one scene")
    })?;
    if let Some(path) = &arguments.heatmap {
        difference::heatmap(&found).write(path)?;
    }
    if arguments.json {
        print_json(&found)
    } else {
        print(&in_words(&found))
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
        "RMSE                {}\nrelative MSE        {}\nPSNR                {}, peak {}\n\
         FLIP                {:.6}, {flip}\nlargest difference  {at}",
        significant(found.rmse),
        significant(found.relative_mse),
        match found.psnr_db {
            db if db.is_finite() => format!("{db:.2} dB"),
            _ => "infinite".into(),
        },
        significant(found.peak),
        found.flip_mean
    )
}
