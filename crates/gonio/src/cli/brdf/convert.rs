//! `gonio brdf convert`.

use crate::cli::failure::Failure;
use crate::cli::progress::{on_stop_request, stop_requested};
use crate::cli::terminal::{print, print_json, significant, warn};
use gonio_brdf::BrdfError;
use gonio_brdf::measured::{ConversionReport, Source, TARGETS, Target, Worst, convert, format};
use gonio_num::{Real, Vec3};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::{Value, json};
use std::path::PathBuf;

#[derive(clap::Args)]
pub(in crate::cli) struct Arguments {
    /// A measured file of any format, or a model: NAME or NAME:key=value,…
    from: String,
    /// The file to write; its extension tells the format
    to: PathBuf,
    /// Format of the file: gonio, radiance, astm, pbrt, utia or merl [default: by its extension]
    #[arg(long, value_name = "NAME")]
    format: Option<String>,
    /// Layout of the values [default: the source's, or the format's usual one]
    #[arg(long, value_name = "LAYOUT", value_parser = layouts())]
    parameterization: Option<String>,
    /// Nodes along each axis, as in 90x45x36, or levels of a tensor tree; one number keeps the usual ratios
    #[arg(long, value_name = "N", value_parser = resolution)]
    resolution: Option<Resolution>,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

/// The names of the layouts.
fn layouts() -> Vec<&'static str> {
    TARGETS.iter().map(|s| s.name).collect()
}

#[derive(Clone)]
struct Resolution(Vec<usize>);

fn resolution(text: &str) -> Result<Resolution, String> {
    text.split(['x', '×'])
        .map(|n| n.trim().parse().ok().filter(|n| *n > 0))
        .collect::<Option<Vec<usize>>>()
        .map(Resolution)
        .ok_or_else(|| "expected whole numbers joined by x, as in 90x45x36".into())
}

pub(super) fn run(arguments: Arguments) -> Result<(), Failure> {
    let target = Target {
        format: arguments.format,
        parameterization: arguments.parameterization,
        resolution: arguments.resolution.map(|r| r.0),
    };
    // Before any time is spent.
    target.format_for(&arguments.to).map_err(usage)?;
    let source = Source::open(&arguments.from)?;
    for line in source.measured().map(|m| m.warnings()).unwrap_or_default() {
        warn(&format!("{}: {line}", arguments.from));
    }
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {percent} %  {eta} left") {
        bar.set_style(style.progress_chars("━━─"));
    }
    on_stop_request(&bar);
    let report = convert(&source, &arguments.to, &target, &mut |share| {
        bar.set_position((share * 1000.0) as u64);
        !stop_requested()
    });
    bar.finish_and_clear();
    let report = report.map_err(usage)?;
    if arguments.json {
        return print_json(&in_json(&arguments.from, &arguments.to, &report));
    }
    print(&in_words(&arguments.from, &arguments.to, &report))
}

/// What is asked for can't be: the help of this command says what can.
fn usage(error: BrdfError) -> Failure {
    match error {
        BrdfError::Unsupported { what } => Failure::usage(what)
            .with_help("'gonio brdf convert --help' lists the formats and layouts"),
        other => other.into(),
    }
}

fn angles(w: Vec3<f64>) -> [f64; 2] {
    let theta: f64 = Real::acos(w.z);
    let phi: f64 = Real::atan2(w.y, w.x);
    [theta.to_degrees(), phi.to_degrees()]
}

fn in_words(from: &str, to: &std::path::Path, r: &ConversionReport) -> String {
    let how = if r.copied { "copied" } else { "resampled" };
    let mut text = format!(
        "{from} → {}\n  format     {}, {} bytes, {how}\n  layout     {}: {}\n  channels   {}\n",
        to.display(),
        r.format,
        r.bytes,
        r.layout,
        r.size,
        summarized(&r.channels),
    );
    let d = &r.difference;
    text += &format!(
        "\nDifference of luminance over {} pairs of directions\n  RMS {} sr⁻¹, {} of the RMS value, {} weighted by both cosines\n",
        d.pairs,
        significant(d.rms),
        percent(d.relative_rms),
        percent(d.weighted_relative_rms),
    );
    if let Some(Worst {
        wi,
        wo,
        before,
        after,
    }) = d.worst
    {
        let ([ti, pi], [to, po]) = (angles(wi), angles(wo));
        text += &format!(
            "  worst: {} became {} sr⁻¹ at wi θ = {ti:.1}°, φ = {pi:.1}° and wo θ = {to:.1}°, φ = {po:.1}°\n",
            significant(before),
            significant(after)
        );
    }
    text += "\nAlbedo (red, green, blue)\n";
    for a in &r.albedo {
        let colour = |c: [f64; 3]| c.map(|x| format!("{x:.4}")).join("  ");
        text += &format!(
            "  θ = {:>2}°   {}  became  {}\n",
            a.theta_deg,
            colour(a.before),
            colour(a.after)
        );
    }
    for (title, lines) in [("Lost", &r.lost), ("Notes", &r.notes)] {
        if !lines.is_empty() {
            text += &format!("\n{title}\n");
            for line in lines {
                text += &format!("  {line}\n");
            }
        }
    }
    for (count, what) in [(r.negative, "negative"), (r.missing, "missing")] {
        if count > 0 {
            text += &format!("\n{count} {what} values of the source were replaced\n");
        }
    }
    text
}

/// A few names, or how many there are.
pub(super) fn summarized(names: &[String]) -> String {
    match names {
        [first, .., last] if names.len() > 6 => format!("{first} … {last} ({})", names.len()),
        _ => names.join(", "),
    }
}

fn percent(x: f64) -> String {
    format!("{:.3} %", 100.0 * x)
}

fn in_json(from: &str, to: &std::path::Path, r: &ConversionReport) -> Value {
    let worst = r.difference.worst.map(|w| {
        json!({
            "wi_deg": angles(w.wi),
            "wo_deg": angles(w.wo),
            "before_per_sr": w.before,
            "after_per_sr": w.after,
        })
    });
    json!({
        "from": from,
        "to": to.display().to_string(),
        "format": r.format,
        "bytes": r.bytes,
        "layout": r.layout,
        "size": r.size,
        "channels": r.channels,
        "copied": r.copied,
        "difference": {
            "pairs": r.difference.pairs,
            "rms_per_sr": r.difference.rms,
            "relative_rms": r.difference.relative_rms,
            "weighted_relative_rms": r.difference.weighted_relative_rms,
            "worst": worst,
        },
        "albedo": r.albedo.iter().map(|a| json!({
            "theta_deg": a.theta_deg,
            "before": a.before,
            "after": a.after,
        })).collect::<Vec<_>>(),
        "negative": r.negative,
        "missing": r.missing,
        "lost": r.lost,
        "notes": r.notes,
    })
}

/// The lines on formats and layouts that the help ends with.
pub(in crate::cli) fn help() -> String {
    let mut text = "Formats, by extension:\n".to_owned();
    for f in format::FORMATS {
        text += &format!("  .{:<9} {}\n", f.extension, f.summary);
    }
    text += "\nLayouts, and what --resolution counts:\n";
    for t in TARGETS {
        let usual: Vec<String> = t.usual.iter().map(usize::to_string).collect();
        let usual = if usual.is_empty() {
            String::new()
        } else {
            format!(", usually {}", usual.join("x"))
        };
        text += &format!("  {:<28} {}{usual}\n", t.name, t.counts);
    }
    text + "\nExamples:\n  gonio brdf convert gold.binary gold.gonio\n  gonio brdf convert ggx:roughness=0.3,metal=gold gold.binary\n  \
            gonio brdf convert blind.xml blind.gonio --parameterization spherical-anisotropic\n  \
            gonio brdf convert oren-nayar wall.xml --parameterization tensor-tree-3 --resolution 5\n\n\
            The file is read again and compared with what it was made of: the report says by how much it differs."
}
