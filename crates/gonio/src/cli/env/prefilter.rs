//! `gonio env prefilter`.

use super::steps::Steps;
use crate::cli::destination;
use crate::cli::environment::{PanoramaArguments, replaced};
use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json, warn};
use gonio_ibl::bundle::{self, Options, Report};
use gonio_ibl::harmonics::Window;
use gonio_ibl::{DEFAULT_TOLERANCE, Family, Method, Target};
use gonio_image::TexelFormat;
use std::fmt::Write as _;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio env prefilter sunset.hdr -o sunset --for filament\n  \
    gonio env prefilter sunset.hdr -o sunset --for custom --kernel beckmann --bands 5")]
pub(in crate::cli) struct Arguments {
    /// A panorama (EXR, HDR, PNG, JPEG), or uniform:RADIANCE
    environment: String,
    /// The folder to write to; it is made if its parent is there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// The renderer that reads the files: gltf, three, filament, unreal, unity or custom
    #[arg(long = "for", value_name = "TARGET", default_value = "gltf")]
    target: String,
    /// Texels along an edge of the sharpest level, a power of two
    #[arg(long, value_name = "N", default_value = "256")]
    size: usize,
    /// Kernel of the levels: ggx, charlie, phong, or any isotropic model with a roughness
    #[arg(long, value_name = "KERNEL", default_value = "ggx")]
    kernel: String,
    /// Also write a chain of levels of the sheen Charlie
    #[arg(long)]
    sheen: bool,
    /// By importance sampling with N filtered samples instead of the quadrature over cells
    #[arg(long, value_name = "N", conflicts_with_all = ["reference", "tolerance"])]
    samples: Option<usize>,
    /// By exact quadrature, every texel of the panorama for every texel of every level: slow
    #[arg(long)]
    reference: bool,
    /// How coarse cells may be: smaller is more exact and slower, 0.02 to 4
    #[arg(long, value_name = "X", conflicts_with = "reference", default_value_t = DEFAULT_TOLERANCE)]
    tolerance: f64,
    /// Texels of each level to compare with exact quadrature; 0 for none
    #[arg(long, value_name = "N", default_value = "16")]
    check: usize,
    /// Texels along an edge of the diffuse map, a power of two
    #[arg(long, value_name = "N", default_value = "32")]
    diffuse_size: usize,
    /// Bands of the spherical harmonics, 1 to 10
    #[arg(long, value_name = "N", default_value = "3")]
    bands: usize,
    /// Window of the harmonics: none, hann, lanczos or laplacian
    #[arg(long, value_name = "WINDOW", default_value = "none")]
    window: String,
    /// Columns and rows of the table of reflectances
    #[arg(long, value_name = "N", default_value = "128")]
    dfg_size: usize,
    /// Model of the table, without roughness and Fresnel reflectance
    #[arg(long, value_name = "MODEL", default_value = "ggx")]
    dfg_model: String,
    /// Texels of the cubes: half, float, rgb9e5 or bc6h
    #[arg(long, value_name = "FORMAT", default_value = "half")]
    format: String,
    #[command(flatten)]
    reading: PanoramaArguments,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let options = Options {
        target: arguments.target.parse::<Target>()?,
        size: arguments.size,
        family: Family::parse(&arguments.kernel)?,
        sheen: arguments.sheen,
        method: match (arguments.reference, arguments.samples) {
            (true, _) => Method::Exact,
            (false, Some(samples)) => Method::Sampling(samples),
            (false, None) => Method::Tree(arguments.tolerance),
        },
        check: arguments.check,
        diffuse_size: arguments.diffuse_size,
        bands: arguments.bands,
        irradiance: false,
        window: arguments.window.parse::<Window>()?,
        table_size: arguments.dfg_size,
        table_model: arguments.dfg_model.clone(),
        format: format(&arguments.format)?,
    };
    bundle::check(&options)?;
    let folder = &arguments.output;
    if folder.is_dir() {
        destination::writable(&folder.join("report.json"))?;
    } else {
        destination::writable(folder)?;
    }
    let environment = arguments.reading.parse(&arguments.environment)?;
    replaced(&environment).iter().for_each(|w| warn(w));
    if !folder.is_dir() {
        std::fs::create_dir(folder)
            .map_err(|e| Failure::io(&folder.display().to_string(), "make the folder", &e))?;
    }
    let steps = Steps::new(bundle::steps(&options));
    let report = bundle::write(&environment, &options, folder, &mut |step| steps.next(step))?;
    steps.finish();
    if report.clamped > 0 {
        warn(&format!(
            "{} samples were too large for --format {} and became its largest number; --format float holds them",
            report.clamped, arguments.format
        ));
    }
    if arguments.json {
        print_json(&report)
    } else {
        print(&text(&report))
    }
}

fn format(name: &str) -> Result<TexelFormat, Failure> {
    let found = TexelFormat::ALL.into_iter().find(|f| f.name() == name);
    found.ok_or_else(|| {
        Failure::usage(format!("--format {name}: no such format of texels"))
            .with_help("formats are half, float, rgb9e5 and bc6h")
    })
}

fn text(report: &Report) -> String {
    let mut text =
        String::from("map            level  size  roughness   time s   mean error   largest\n");
    for l in &report.levels {
        let error = match &l.error {
            Some(e) => format!("{:>9.4} %  {:>7.3} %", 100.0 * e.mean, 100.0 * e.largest),
            None => "        –          –".into(),
        };
        let _ = writeln!(
            text,
            "{:<14} {:>5} {:>5} {:>10.4} {:>8.3}  {error}",
            l.map, l.level, l.size, l.roughness, l.seconds
        );
    }
    let _ = writeln!(
        text,
        "\nerrors: relative to exact quadrature, over some texels of each level"
    );
    let _ = writeln!(text, "harmonics: {}", report.harmonics);
    let r = &report.residual;
    let _ = writeln!(
        text,
        "window: changes the harmonics by {:.2} % at most, {:.2} % rms; smallest value {:+.3} of the mean before, {:+.3} after",
        100.0 * r.largest,
        100.0 * r.rms,
        r.smallest_before,
        r.smallest_after
    );
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    let _ = writeln!(text, "written and read again: {}", report.files.join(", "));
    text
}
