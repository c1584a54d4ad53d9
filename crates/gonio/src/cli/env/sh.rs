//! `gonio env sh`.

use super::steps::write_json;
use crate::cli::destination;
use crate::cli::environment::PanoramaArguments;
use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json};
use gonio_ibl::harmonics::{Residual, Window};
use gonio_ibl::{Harmonics, Target};
use serde::Serialize;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio env sh sunset.hdr --for filament\n  \
    gonio env sh sunset.hdr --bands 5 --irradiance --window laplacian")]
pub(in crate::cli) struct Arguments {
    /// A panorama (EXR, HDR, PNG, JPEG), or uniform:RADIANCE
    environment: String,
    /// Bands, 1 to 10
    #[arg(long, value_name = "N", default_value = "3")]
    bands: usize,
    /// Whose convention: gltf, three, filament, unreal, unity or custom
    #[arg(long = "for", value_name = "TARGET", default_value = "custom")]
    target: String,
    /// Of irradiance instead of radiance, for custom
    #[arg(long)]
    irradiance: bool,
    /// Damp high bands: none, hann, lanczos or laplacian
    #[arg(long, value_name = "WINDOW", default_value = "none")]
    window: String,
    /// Write JSON to a file, and read it again
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    reading: PanoramaArguments,
    /// Print it as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Serialize)]
struct Report {
    target: Target,
    meaning: String,
    bands: usize,
    irradiance: bool,
    order: &'static str,
    coefficients: Vec<[f64; 3]>,
    window: Window,
    residual: Residual,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let target = arguments.target.parse::<Target>()?;
    let window = arguments.window.parse::<Window>()?;
    if arguments.irradiance && target != Target::Custom {
        return Err(Failure::usage(format!(
            "--irradiance with --for {}: the convention says what its coefficients are",
            target.name()
        ))
        .with_help("leave --irradiance away, or ask --for custom"));
    }
    if let Some(path) = &arguments.output {
        destination::check_extension(path, &["json"], "coefficients")?;
        destination::writable(path)?;
    }
    Harmonics::check_bands(arguments.bands)?;
    let environment = arguments.reading.parse(&arguments.environment)?;
    let radiance = Harmonics::of_radiance(&environment, arguments.bands)?;
    let (windowed, residual) = window.apply(&radiance);
    let report = Report {
        target,
        meaning: target.harmonics_meaning().to_owned(),
        bands: arguments.bands,
        irradiance: arguments.irradiance || target.harmonics_are_irradiance(),
        order: "(l, m) at l² + l + m; m < 0 for sin |m|φ",
        coefficients: target.harmonics(&windowed, arguments.irradiance),
        window,
        residual,
    };
    if let Some(path) = &arguments.output {
        write_json(path, &report)?;
    }
    if arguments.json {
        print_json(&report)
    } else {
        print(&text(&report))
    }
}

fn text(report: &Report) -> String {
    let what = if report.irradiance {
        "irradiance"
    } else {
        "radiance"
    };
    let mut text = format!(
        "{what}: {}\n\n  l   m            R            G            B\n",
        report.meaning
    );
    for (i, c) in report.coefficients.iter().enumerate() {
        let l = i.isqrt();
        let m = i as i64 - (l * l + l) as i64;
        let _ = writeln!(
            text,
            "{l:>3} {m:>3} {:>12.6} {:>12.6} {:>12.6}",
            c[0], c[1], c[2]
        );
    }
    let r = &report.residual;
    let _ = writeln!(
        text,
        "\nsmallest radiance of these bands: {:+.4} of the mean{}",
        r.smallest_before,
        if r.smallest_before < 0.0 {
            ", so they ring below 0 (see --window)"
        } else {
            ""
        }
    );
    if report.window != Window::None {
        let _ = writeln!(
            text,
            "window: changes the radiance by {:.2} % of the mean at most, {:.2} % rms; smallest value then {:+.4}",
            100.0 * r.largest,
            100.0 * r.rms,
            r.smallest_after
        );
    }
    text
}
