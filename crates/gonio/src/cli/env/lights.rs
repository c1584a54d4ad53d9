//! `gonio env lights`.

use super::steps::write_json;
use crate::cli::destination;
use crate::cli::environment::PanoramaArguments;
use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json};
use gonio_ibl::lights::{Cut, Extraction, extract};
use gonio_image::write_file;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio env lights 16 sunset.hdr\n  \
    gonio env lights 64 sunset.hdr --method median -o lights.toml")]
pub(in crate::cli) struct Arguments {
    /// How many lights, 1 to 4096
    count: usize,
    /// A panorama (EXR, HDR, PNG, JPEG), or uniform:RADIANCE
    environment: String,
    /// How the panorama is cut: variance or median
    #[arg(long, value_name = "METHOD", default_value = "variance")]
    method: String,
    /// Write them as JSON, or as directional lights of a scene (.toml), and read the file again
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    reading: PanoramaArguments,
    /// Print it as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let cut = arguments.method.parse::<Cut>()?;
    if let Some(path) = &arguments.output {
        destination::check_extension(path, &["json", "toml"], "lights")?;
        destination::writable(path)?;
    }
    let environment = arguments.reading.parse(&arguments.environment)?;
    let found = extract(&environment, arguments.count, cut)?;
    if let Some(path) = &arguments.output {
        if destination::extension(path) == "json" {
            write_json(path, &found)?;
        } else {
            write_file(path, toml(&found).as_bytes())?;
            read_again(path, &found)?;
        }
    }
    if arguments.json {
        print_json(&found)
    } else {
        print(&text(&found))
    }
}

/// Lights as the native scene format has them: `direction` is the way the light goes.
fn toml(found: &Extraction) -> String {
    let mut text = format!(
        "# {} lights; irradiance within {:.2} % on average, {:.2} % at most\n",
        found.lights.len(),
        100.0 * found.mean_error,
        100.0 * found.largest_error
    );
    for l in &found.lights {
        let ([x, y, z], [r, g, b]) = (l.direction.map(|c| -c), l.irradiance);
        let _ = write!(
            text,
            "\n[[light]]\nkind = \"directional\"\ndirection = [{x}, {y}, {z}]\nirradiance = [{r}, {g}, {b}]\n"
        );
    }
    text
}

fn read_again(path: &std::path::Path, found: &Extraction) -> Result<(), Failure> {
    let name = path.display().to_string();
    let text =
        std::fs::read_to_string(path).map_err(|e| Failure::io(&name, "read it again", &e))?;
    if text == toml(found) {
        return Ok(());
    }
    Err(
        Failure::input(format!("{name}: read again, it is not what was written"))
            .with_help("the disk may be full or failing: write elsewhere"),
    )
}

fn text(found: &Extraction) -> String {
    let mut text = String::from(
        "towards the light                  irradiance R, G, B [W m⁻²]            solid angle sr\n",
    );
    for l in &found.lights {
        let (d, e) = (l.direction, l.irradiance);
        let _ = writeln!(
            text,
            "{:>9.5} {:>9.5} {:>9.5}   {:>11.5} {:>11.5} {:>11.5}   {:>12.6}",
            d[0], d[1], d[2], e[0], e[1], e[2], l.solid_angle
        );
    }
    let n = found.worst_normal;
    let _ = writeln!(
        text,
        "\nirradiance over normals: {:.2} % of the mean off on average, {:.2} % at most, at ({:.3}, {:.3}, {:.3})",
        100.0 * found.mean_error,
        100.0 * found.largest_error,
        n[0],
        n[1],
        n[2]
    );
    text
}
