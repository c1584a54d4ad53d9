//! `gonio env convert`.

mod output;

use crate::cli::failure::Failure;
use crate::cli::parse;
use crate::cli::terminal::{note, print, print_json, significant, warn};
use gonio_env::{
    Convention, Conversion, Filter, Kept, Layout, LoadOptions, Panorama, rotation_deg,
};
use gonio_image::TexelFormat;
use gonio_image::tonemap::ToneMap;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use output::{Form, Made};
use serde_json::json;
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[derive(clap::Args)]
#[command(after_help = "\
Examples:
  gonio env convert sunset.hdr sunset.ktx2 --to cube --size 256 --mips
  gonio env convert sunset.hdr square.exr --to equal-area-octahedral --convention pbrt
  gonio env convert sunset.hdr faces --to cube-faces          faces/px.exr … faces/nz.exr
  gonio env convert sunset.hdr 'sky_{face}.png' --to cube-faces --exposure -1
  gonio env convert cube.dds panorama.exr --rotate 90,0,0

Layouts: lat-long, cube, cube-cross, cube-cross-vertical, cube-strip, cube-strip-vertical, cube-faces, octahedral,
equal-area-octahedral, angular, mirror-ball, dual-paraboloid.
Conventions: gonio, pbrt, mitsuba, blender, gltf, opengl, unreal; the book says what each means.
A KTX2 or DDS file holds a cube, with --mips its smaller levels, or one picture.
Memory: 12 bytes for each texel of IN and some rows; a KTX2 or DDS file takes 12 more for each texel of OUT, then up to 54 without IN.")]
pub(in crate::cli) struct Arguments {
    /// A panorama (EXR, HDR, PNG, JPEG, TIFF, KTX2, DDS), a folder with px.exr … nz.exr, or a name with {face} in it
    from: PathBuf,
    /// The file to write, by its extension EXR, HDR, PNG, KTX2 or DDS; for --to cube-faces a folder, or a name with {face} in it
    to: PathBuf,
    /// Layout to write [default: cube for .ktx2 and .dds, else lat-long]
    #[arg(long = "to", value_name = "LAYOUT")]
    layout: Option<String>,
    /// Rows of the picture, or of a face of a cube [default: about as many texels as IN has]
    #[arg(long, value_name = "N", value_parser = parse::whole(1_u32, 32_768))]
    size: Option<u32>,
    /// Turn the environment, in degrees: counter-clockwise seen from above, what is in front upwards, counter-clockwise as one
    /// looks forward; roll comes first, yaw last
    #[arg(long, value_name = "YAW,PITCH,ROLL", value_parser = rotation, allow_hyphen_values = true, default_value = "0,0,0")]
    rotate: Rotation,
    /// Whose axes and orientation OUT has [default: opengl for cubes in .ktx2 and .dds, else gonio]
    #[arg(long, value_name = "NAME")]
    convention: Option<String>,
    /// Layout of IN [default: found by its content and shape]
    #[arg(long = "from", value_name = "LAYOUT")]
    from_layout: Option<String>,
    /// Whose axes and orientation IN has [default: opengl for cubes in .ktx2 and .dds, else gonio]
    #[arg(long, value_name = "NAME")]
    from_convention: Option<String>,
    /// How texels are made: area keeps irradiance; bilinear and nearest look up their centres
    #[arg(long, value_name = "NAME", value_parser = parse::words(&FILTERS), default_value = "area")]
    filter: Filter,
    /// Write the smaller levels of a cube, too (.ktx2 and .dds)
    #[arg(long)]
    mips: bool,
    /// How .ktx2, .dds and .exr store texels: half, float, rgb9e5 or bc6h [default: half for .ktx2 and .dds, float for .exr]
    #[arg(long, value_name = "FORMAT", value_parser = parse::words(&TEXELS))]
    texels: Option<TexelFormat>,
    /// Multiply a PNG by 2^EV; any other file keeps radiance
    #[arg(long, value_name = "EV", value_parser = parse::finite, allow_hyphen_values = true, default_value = "0")]
    exposure: f32,
    /// Tone map of a PNG: linear clamps at 1
    #[arg(long, value_name = "NAME", value_parser = parse::tone_map(), default_value = "linear")]
    tonemap: ToneMap,
    /// Write PNGs of 16 bits
    #[arg(long)]
    png16: bool,
    /// Replace NaN, infinite and negative texels by the mean of their neighbours instead of refusing IN
    #[arg(long)]
    repair: bool,
    /// Print the report as JSON
    #[arg(long)]
    json: bool,
}

static FILTERS: [(Filter, &str); 3] = [
    (Filter::Area, "area"),
    (Filter::Bilinear, "bilinear"),
    (Filter::Nearest, "nearest"),
];
static TEXELS: [(TexelFormat, &str); 4] = [
    (TexelFormat::Half, "half"),
    (TexelFormat::Float, "float"),
    (TexelFormat::Rgb9e5, "rgb9e5"),
    (TexelFormat::Bc6h, "bc6h"),
];

/// Yaw, pitch and roll in degrees.
#[derive(Clone, Copy)]
struct Rotation([f64; 3]);

fn rotation(text: &str) -> Result<Rotation, String> {
    let numbers: Option<Vec<f64>> = text
        .split(',')
        .map(|n| n.trim().parse::<f64>().ok().filter(|n| n.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[yaw]) => Ok(Rotation([yaw, 0.0, 0.0])),
        Some(&[yaw, pitch, roll]) => Ok(Rotation([yaw, pitch, roll])),
        _ => Err("expected yaw,pitch,roll in degrees, such as 90,0,0, or yaw alone".into()),
    }
}

fn convention(word: &Option<String>) -> Result<Option<Convention>, Failure> {
    Ok(word.as_ref().map(|w| w.parse()).transpose()?)
}

pub(super) fn run(arguments: Arguments) -> Result<(), Failure> {
    let form = Form::of(&arguments)?;
    let own = if form.is_texture() && form.layout.arrangement().is_some() {
        Convention::OpenGl
    } else {
        Convention::Gonio
    };
    let turned = convention(&arguments.convention)?.unwrap_or(own);
    let options = LoadOptions {
        layout: match &arguments.from_layout {
            Some(word) => Some(word.parse()?),
            None => None,
        },
        convention: convention(&arguments.from_convention)?,
        repair: arguments.repair,
        ..LoadOptions::default()
    };
    form.check(&arguments)?;
    let start = Instant::now();
    let bar = Bar::new();
    let panorama = Panorama::load(&arguments.from, &options).map_err(rephrased)?;
    match panorama.replaced_texels() {
        0 => {}
        1 => warn("one unsound texel was replaced by the mean of its neighbours"),
        n => warn(&format!(
            "{n} unsound texels were replaced by the means of their neighbours"
        )),
    }
    let read = Described::of(&panorama);
    bar.step("converting");
    let [yaw, pitch, roll] = arguments.rotate.0;
    let conversion = Conversion {
        layout: form.layout,
        convention: turned,
        size: arguments.size.map(|n| n as usize),
        rotation: rotation_deg(yaw, pitch, roll),
        filter: arguments.filter,
        progress: &|share| bar.update(share),
    };
    let made = form.make(panorama, &conversion, &arguments);
    bar.finish();
    let Made {
        written,
        kept,
        files,
        above,
    } = made?;
    form.warn_of(above, &arguments);
    if arguments.filter == Filter::Area && kept.worst() > 0.01 {
        note(&format!(
            "irradiance changed by {:.1} %: texels of {} are coarse beside the light's detail; a larger --size keeps more",
            100.0 * kept.worst(),
            arguments.to.display()
        ));
    }
    let seconds = start.elapsed().as_secs_f64();
    if arguments.json {
        return print_json(&json!({
            "from": read.in_json(&arguments.from.display().to_string()),
            "to": written.in_json(&arguments.to.display().to_string()),
            "files": files,
            "irradiance": kept,
            "ratio": kept.ratios(),
            "worst": kept.worst(),
            "seconds": seconds,
        }));
    }
    print(&format!(
        "{}  {}\n{}  {}\n{}{:.2} s",
        arguments.from.display(),
        read.in_words(),
        arguments.to.display(),
        written.in_words(),
        table(&kept),
        seconds
    ))
}

/// A bar on standard error, when that is a terminal. It shows whether anything goes on where no share is known.
struct Bar(ProgressBar);

impl Bar {
    fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
        let style = "{spinner} {msg:10} {bar:18.cyan/dim} {percent:>3} %  {elapsed}";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("━━─"));
        }
        bar.set_message("reading");
        bar.enable_steady_tick(Duration::from_millis(250));
        Self(bar)
    }

    fn step(&self, name: &'static str) {
        self.0.set_message(name);
    }

    fn update(&self, share: f64) {
        self.0.set_position((share * 1000.0) as u64);
    }

    fn finish(&self) {
        self.0.finish_and_clear();
    }
}

/// What a panorama is, kept while it is used up.
struct Described {
    layout: Layout,
    convention: Convention,
    width: usize,
    height: usize,
}

impl Described {
    fn of(panorama: &Panorama) -> Self {
        Self {
            layout: panorama.layout(),
            convention: panorama.view().convention(),
            width: panorama.image().width,
            height: panorama.image().height,
        }
    }

    fn in_words(&self) -> String {
        format!(
            "{}, {} × {}, as {} turns it",
            self.layout, self.width, self.height, self.convention
        )
    }

    fn in_json(&self, file: &str) -> serde_json::Value {
        json!({
            "file": file,
            "layout": self.layout,
            "convention": self.convention,
            "width": self.width,
            "height": self.height,
        })
    }
}

/// Irradiance on six axes before and after, and their ratio.
fn table(kept: &Kept) -> String {
    let mut text = format!(
        "\nirradiance  {:>12}  {:>12}   ratio  W m⁻², luminance\n",
        "before", "after"
    );
    let luminance = |e: [f64; 3]| 0.2126 * e[0] + 0.7152 * e[1] + 0.0722 * e[2];
    let axes = ["+x", "-x", "+y", "-y", "+z", "-z"];
    for (k, ratio) in kept.ratios().into_iter().enumerate() {
        text += &format!(
            "{:10}  {:>12}  {:>12}   {}\n",
            axes[k],
            significant(luminance(kept.before[k])),
            significant(luminance(kept.after[k])),
            match ratio {
                Some(ratio) => format!("{ratio:.5}"),
                None => "none: no light comes from there".into(),
            }
        );
    }
    text
}

/// What the library recommends, in this command's options.
pub(super) fn rephrased(error: gonio_env::EnvError) -> Failure {
    let failure = Failure::from(error);
    failure.rephrase(&[
        ("--env-layout", "--from"),
        (
            "`--env-sanitize` makes NaN and negative 0, infinite the largest finite value; ",
            "",
        ),
    ])
}
