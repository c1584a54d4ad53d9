//! `gonio brdf plot`.

mod lit;
mod subject;

use crate::cli::destination;
use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::terminal::note;
use gonio_plot::{Channel, Figure, Function, MOST_FUNCTIONS, Options, PlotError, ScaleKind};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::path::PathBuf;
use std::time::Duration;
use subject::Subject;

pub(super) const HELP: &str = "Examples:\n  gonio brdf plot ggx:metal=gold,roughness=0.3 -o gold.svg\n  \
    gonio brdf plot oren-nayar lambertian --kind cartesian --theta 60 -o rough.svg\n  \
    gonio brdf plot disney openpbr gltf --kind albedo -o albedo.png\n  \
    gonio brdf plot gold-paint.binary ward@gold-paint --kind difference -o fit.svg\n  \
    gonio brdf plot ggx:roughness=0.1 ggx:roughness=0.5 --kind sphere --light panorama -o balls.png\n\n\
    Light comes from the left, at each --theta from the normal. An SVG says in words what it shows, too.";

/// The extensions of plots.
const EXTENSIONS: [&str; 2] = ["svg", "png"];

#[derive(clap::Args)]
pub(in crate::cli) struct Arguments {
    /// Up to eight functions: NAME, NAME:key=value,…, or a measured file
    #[arg(required = true, value_name = "FUNCTION")]
    pub(in crate::cli) functions: Vec<String>,
    /// What is shown
    #[arg(long, value_enum, default_value_t = Kind::Polar)]
    kind: Kind,
    /// The file to write: .svg or .png
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Angles of incidence in degrees, as in 0,30,60 [default: what suits the kind]
    #[arg(long, value_name = "DEG,…", value_delimiter = ',', value_parser = number, allow_hyphen_values = true)]
    theta: Vec<f64>,
    /// Azimuth of the plane of incidence in degrees, for what isn't isotropic
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = number, allow_hyphen_values = true)]
    phi: f64,
    /// φd of a slice in degrees
    #[arg(long, value_name = "DEG", default_value = "90", value_parser = number, allow_hyphen_values = true)]
    phi_d: f64,
    /// Light of a sphere: point, panorama (the embedded one), a panorama's file, or uniform:RADIANCE
    #[arg(long, value_name = "LIGHT", default_value = "point")]
    light: String,
    /// Which number a colour becomes: luminance, red, green, blue, or rgb for all three
    #[arg(long, value_name = "CHANNEL", default_value = "luminance", value_parser = parse::words(&Channel::ALL))]
    channel: Channel,
    /// How a value becomes a length or a colour: auto, linear, cube-root or log
    #[arg(long, value_name = "SCALE", default_value = "auto", value_parser = parse::words(&ScaleKind::ALL))]
    scale: ScaleKind,
    /// Multiply f by |cos θr|: the shape of the reflected intensity
    #[arg(long)]
    cosine: bool,
    /// Width and height in pixels [default: what suits the kind]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    size: Option<[u32; 2]>,
    /// Pixels of a PNG for each one of --size
    #[arg(long, value_name = "N", default_value = "2", value_parser = parse::whole(1_u32, 8))]
    density: u32,
    /// The words at the top [default: the function's name]
    #[arg(long, value_name = "TEXT")]
    title: Option<String>,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Kind {
    /// The lobes in the plane of incidence
    Polar,
    /// f against the angle of reflection
    Cartesian,
    /// The fraction of light that leaves again, against the angle
    Albedo,
    /// A picture of f by half and difference angle, as MERL's materials are shown
    Slice,
    /// The lobe in space, for the first --theta
    Lobe3d,
    /// A lit ball
    Sphere,
    /// By how much the second of two differs from the first
    Difference,
}

/// A finite number.
fn number(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
    number.ok_or_else(|| "expected a finite number".into())
}

pub(super) fn run(arguments: Arguments) -> Result<(), Failure> {
    // Before any time is spent.
    destination::check_extension(&arguments.output, &EXTENSIONS, "plots")?;
    destination::writable(&arguments.output)?;
    let count = arguments.functions.len();
    if count > MOST_FUNCTIONS {
        let message = format!("{count} functions were given, expected at most {MOST_FUNCTIONS}");
        return Err(Failure::usage(message).with_help("draw them in several plots"));
    }
    let subjects: Vec<Subject> = arguments
        .functions
        .iter()
        .map(|text| Subject::open(text))
        .collect::<Result<_, _>>()?;
    let options = Options {
        size: arguments.size,
        title: arguments.title.clone(),
        theta_deg: arguments.theta.clone(),
        phi_deg: arguments.phi,
        channel: arguments.channel,
        scale: arguments.scale,
        cosine: arguments.cosine,
        phi_d_deg: arguments.phi_d,
    };
    let bar = bar();
    let figure = draw(&arguments, &subjects, &options, &bar);
    bar.finish_and_clear();
    // A shader that stopped ending is drawn as if it had no value there.
    if let Some(error) = subjects.iter().find_map(|s| s.model.failure()) {
        return Err(error.into());
    }
    write(&figure?, &arguments)
}

fn draw(
    arguments: &Arguments,
    subjects: &[Subject],
    options: &Options,
    bar: &ProgressBar,
) -> Result<Figure, Failure> {
    if arguments.kind == Kind::Sphere && arguments.light != "point" {
        return lit::sphere(subjects, options, &arguments.light, bar);
    }
    let functions: Vec<Function> = subjects.iter().map(Subject::function).collect();
    let figure = match arguments.kind {
        Kind::Polar => gonio_plot::polar(&functions, options),
        Kind::Cartesian => gonio_plot::cartesian(&functions, options),
        Kind::Albedo => gonio_plot::albedo(&functions, options),
        Kind::Slice => gonio_plot::slice(&functions, options),
        Kind::Lobe3d => gonio_plot::lobe3d(&functions, options),
        Kind::Sphere => gonio_plot::sphere(&functions, options),
        Kind::Difference => gonio_plot::difference(&functions, options),
    };
    Ok(figure?)
}

fn write(figure: &Figure, arguments: &Arguments) -> Result<(), Failure> {
    let png;
    let bytes = if destination::extension(&arguments.output) == "png" {
        png = figure.png(f64::from(arguments.density))?;
        &png
    } else {
        figure.svg().as_bytes()
    };
    gonio_image::write_file(&arguments.output, bytes)?;
    for words in figure.notes() {
        note(words);
    }
    Ok(())
}

/// A sign of life on standard error, when that is a terminal and the work takes a second.
fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{spinner:.cyan} drawing, {elapsed}  {msg}") {
        bar.set_style(style);
    }
    let started = bar.downgrade();
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs(1));
        if let Some(bar) = started.upgrade()
            && !bar.is_finished()
        {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
    });
    bar
}

impl From<PlotError> for Failure {
    fn from(error: PlotError) -> Self {
        let help = match &error {
            PlotError::Count { .. } => "--help says what each kind shows",
            PlotError::Option { .. } => "--help explains each option",
            PlotError::Nothing { .. } => "choose another --kind",
            PlotError::Drawing(_) => "write an .svg, or choose a smaller --size or --density",
        };
        Self::usage(error.to_string()).with_help(help)
    }
}
