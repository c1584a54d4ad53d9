//! `gonio render`.

use super::failure::{Failure, chain};
use super::progress::{self, Bar};
use super::{parse, print, print_json};
use crate::preview;
use gonio_brdf::ModelSpec;
use gonio_env::{Environment, Layout};
use gonio_image::tonemap::ToneMap;
use gonio_radiometry::sequence::SamplerKind;
use gonio_render::integrator::{Direct, Path as PathTracer};
use gonio_render::{Film, Integrator, PixelFilter, Progress, RenderOptions, Stop, Target};
use gonio_scene::{Camera, LoadOptions, Scene};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Samples per pixel when time or noise is what ends the rendering.
const NO_LIMIT: u32 = 1 << 20;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio render\n  \
    gonio render helmet.gltf --env sunset.hdr --spp 256 -o helmet.exr -o helmet.png\n  \
    gonio render --material ggx:metal=copper,roughness=0.4 --time 30s")]
pub(super) struct Arguments {
    /// A scene: .toml, .gltf, .glb, .obj or .ply; without one, the embedded preview
    scene: Option<PathBuf>,
    /// Where to write: .exr (radiance and layers), .hdr or .png; may be repeated [default: gonio.png and gonio.exr]
    #[arg(short, long = "output", value_name = "FILE")]
    output: Vec<PathBuf>,
    /// Samples per pixel [default: 64, or as many as --time or --noise take]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,
    /// Stop after this time: 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = parse::duration)]
    time: Option<Duration>,
    /// Stop when 95 % of the pixels have a relative error below this: 2%
    #[arg(long, value_name = "ERROR", value_parser = parse::fraction)]
    noise: Option<f64>,
    /// Size of the image [default: the scene's, or 960x540]
    #[arg(long, value_name = "WxH", value_parser = parse::size)]
    size: Option<[u32; 2]>,
    /// How the reflection equation is solved
    #[arg(long, value_enum, default_value_t = IntegratorName::Path)]
    integrator: IntegratorName,
    /// Reflections that light may make, for the path integrator
    #[arg(long, value_name = "N", default_value_t = 64)]
    max_bounces: u32,
    /// Where samples come from
    #[arg(long, value_enum, default_value_t = SamplerName::Sobol)]
    sampler: SamplerName,
    /// Pixel filter: box, tent or blackman-harris
    #[arg(long, default_value = "blackman-harris")]
    filter: PixelFilter,
    /// Seed of the samples; the same seed gives the same image, bit for bit
    #[arg(long, value_name = "S", default_value_t = 0)]
    seed: u64,
    /// Threads [default: one a processor]; the image does not depend on it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=4096))]
    threads: Option<u16>,
    #[command(flatten)]
    environment: EnvironmentArguments,
    /// Replace materials: [MATERIAL=]MODEL:key=value,…; without MATERIAL, all of them (in the preview, the object's)
    #[arg(long, value_name = "SPEC")]
    material: Vec<String>,
    /// The camera, by name or by number from 0
    #[arg(long, value_name = "CAMERA")]
    camera: Option<String>,
    /// Exposure of PNG files, in stops
    #[arg(long, value_name = "EV", default_value = "0", value_parser = parse::finite, allow_hyphen_values = true)]
    exposure: f32,
    /// Tone map of PNG files: linear, aces, agx or pbr-neutral [default: pbr-neutral]
    #[arg(long)]
    tonemap: Option<ToneMap>,
    /// No progress bar and no summary
    #[arg(short, long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
}

/// The environment, as `render` and `measure` take it.
#[derive(clap::Args)]
pub(super) struct EnvironmentArguments {
    /// Light from infinitely far away: a panorama (.hdr, .exr), or uniform:RADIANCE
    #[arg(long, value_name = "FILE")]
    pub env: Option<String>,
    /// Turn the environment about the vertical, counter-clockwise seen from above
    #[arg(long, value_name = "DEG", default_value = "0", value_parser = parse::finite, allow_hyphen_values = true)]
    pub env_rotate: f32,
    #[command(flatten)]
    pub reading: PanoramaArguments,
}

impl EnvironmentArguments {
    /// The environment that was asked for, if any.
    pub fn load(&self) -> Result<Option<Environment>, Failure> {
        let Some(text) = &self.env else {
            return Ok(None);
        };
        let environment = self.reading.parse(text)?;
        Ok(Some(environment.rotated_deg(self.env_rotate)))
    }
}

/// How a panorama is read.
#[derive(clap::Args)]
pub(super) struct PanoramaArguments {
    /// Layout of the panorama: lat-long, angular or mirror-ball [default: found from its shape]
    #[arg(long, value_name = "LAYOUT")]
    env_layout: Option<Layout>,
    /// Replace NaN, infinite and negative texels of the panorama instead of refusing it
    #[arg(long)]
    env_sanitize: bool,
}

impl PanoramaArguments {
    /// The environment that `text` names: a file, or uniform:RADIANCE.
    pub fn parse(&self, text: &str) -> Result<Environment, Failure> {
        let options = gonio_env::LoadOptions {
            layout: self.env_layout,
            sanitize: self.env_sanitize,
            ..Default::default()
        };
        Environment::parse(text, &options).map_err(|e| {
            let help = e
                .help()
                .unwrap_or("'gonio env info --help' says what is read".into());
            Failure::input(chain(&e)).with_help(help)
        })
    }
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum IntegratorName {
    /// Many reflections
    Path,
    /// The reflection equation alone: one reflection
    Direct,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum SamplerName {
    /// Owen-scrambled Sobol' points
    Sobol,
    /// Independent random numbers
    Independent,
}

/// The tone map of PNG files unless another is asked for.
const TONE_MAP: ToneMap = ToneMap::PbrNeutral;

/// What a rendering did, for people and for programs.
#[derive(serde::Serialize)]
struct Summary<'a> {
    outputs: &'a [PathBuf],
    width: u32,
    height: u32,
    samples_per_pixel: u32,
    seconds: f64,
    rays: u64,
    noise: Option<f64>,
    stopped_by: Stop,
    seed: u64,
    rejected_samples: &'a gonio_render::Rejected,
    warnings: &'a [String],
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let outputs = outputs(arguments)?;
    let scene = scene(arguments)?;
    let camera = camera(arguments, &scene);
    let options = options(arguments, &scene);
    if !arguments.quiet {
        for warning in &scene.warnings {
            eprintln!("warning: {warning}");
        }
    }
    let bar = Bar::new(options.target, arguments.quiet);
    progress::stop_requested();
    let mut last = None;
    let mut work = || {
        gonio_render::render(
            &scene,
            &camera,
            &options,
            |progress: &Progress, _: &Film| {
                bar.update(progress);
                last = Some(*progress);
                if progress::stop_requested() {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            },
        )
    };
    let rendered = match arguments.threads {
        None => work(),
        Some(threads) => rayon::ThreadPoolBuilder::new()
            .num_threads(threads.into())
            .build()
            .map_err(|e| Failure::usage(format!("{threads} threads can't be started: {e}")))?
            .install(work),
    };
    bar.finish();
    let (film, stop) = rendered.map_err(|e| Failure::usage(chain(&e)))?;
    for path in &outputs {
        write(arguments, &options, &film, path)?;
    }
    let progress = last.ok_or_else(|| Failure::usage("nothing was rendered"))?;
    report(
        arguments, &options, &scene, &film, &outputs, &progress, stop,
    )?;
    if stop == Stop::Interrupted {
        return Err(Failure::interrupted(format!(
            "interrupted after {} samples per pixel; what there was is written",
            progress.samples
        )));
    }
    Ok(())
}

/// The output files, known to be writable in kind and place before any time is spent.
fn outputs(arguments: &Arguments) -> Result<Vec<PathBuf>, Failure> {
    if arguments.output.is_empty() {
        return Ok(vec!["gonio.png".into(), "gonio.exr".into()]);
    }
    for path in &arguments.output {
        check_output(path)?;
    }
    Ok(arguments.output.clone())
}

/// Fails unless `path` has a picture's extension and lies in a folder that exists.
pub(super) fn check_output(path: &Path) -> Result<(), Failure> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default()
        .to_lowercase();
    if !["png", "exr", "hdr"].contains(&extension.as_str()) {
        return Err(Failure::usage(format!(
            "{}: no picture format is known by the extension '{extension}'",
            path.display()
        ))
        .with_help("end the name in .exr, .hdr or .png"));
    }
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if !folder.is_dir() {
        return Err(Failure::input(format!(
            "{}: the folder {} does not exist",
            path.display(),
            folder.display()
        ))
        .with_help(format!("make it: mkdir -p '{}'", folder.display())));
    }
    Ok(())
}

fn scene(arguments: &Arguments) -> Result<Scene, Failure> {
    let load = LoadOptions {
        camera: arguments.camera.clone(),
        ..LoadOptions::default()
    };
    let mut scene = match &arguments.scene {
        Some(path) => Scene::load(path, &load).map_err(|e| Failure::input(chain(&e)))?,
        None => preview::scene().map_err(|e| Failure::input(chain(&e)))?,
    };
    for text in &arguments.material {
        let (target, spec) = match text.split_once(['=', ':']) {
            Some((name, rest)) if text.as_bytes()[name.len()] == b'=' => (name, rest),
            _ if arguments.scene.is_none() => (preview::OBJECT, text.as_str()),
            _ => ("*", text.as_str()),
        };
        let spec = ModelSpec::parse(spec).map_err(|e| {
            Failure::usage(format!("--material '{text}': {}", chain(&e))).with_help(
                "'gonio brdf list' names the models, 'gonio brdf show NAME' their parameters",
            )
        })?;
        scene
            .replace_material(target, &spec)
            .map_err(|e| Failure::usage(format!("--material '{text}': {}", chain(&e))))?;
    }
    if let Some(environment) = arguments.environment.load()? {
        scene.set_environment(Some(environment));
    } else if arguments.environment.env_rotate != 0.0 {
        let turned = scene
            .lights
            .environment()
            .map(|e| e.clone().rotated_deg(arguments.environment.env_rotate));
        scene.set_environment(turned);
    }
    if scene.lights.is_empty() {
        let panorama = preview::panorama().map_err(|e| Failure::input(chain(&e)))?;
        scene.set_environment(Some(panorama.rotated_deg(arguments.environment.env_rotate)));
    }
    Ok(scene)
}

fn camera(arguments: &Arguments, scene: &Scene) -> Camera {
    let [width, height] = size(arguments, scene);
    scene.camera_or_framing(width as f32 / height as f32)
}

fn size(arguments: &Arguments, scene: &Scene) -> [u32; 2] {
    arguments.size.or(scene.film_size).unwrap_or([960, 540])
}

fn options(arguments: &Arguments, scene: &Scene) -> RenderOptions {
    let open_ended = arguments.time.is_some() || arguments.noise.is_some();
    let [width, height] = size(arguments, scene);
    RenderOptions {
        width,
        height,
        target: Target {
            samples: arguments
                .spp
                .unwrap_or(if open_ended { NO_LIMIT } else { 64 }),
            time: arguments.time,
            noise: arguments.noise,
        },
        integrator: match arguments.integrator {
            IntegratorName::Direct => Integrator::Direct(Direct),
            IntegratorName::Path => Integrator::Path(PathTracer {
                max_bounces: arguments.max_bounces,
                ..PathTracer::default()
            }),
        },
        sampler: match arguments.sampler {
            SamplerName::Sobol => SamplerKind::Sobol,
            SamplerName::Independent => SamplerKind::Independent,
        },
        filter: arguments.filter,
        seed: arguments.seed,
    }
}

fn write(
    arguments: &Arguments,
    options: &RenderOptions,
    film: &Film,
    path: &Path,
) -> Result<(), Failure> {
    let written = match path
        .extension()
        .and_then(|e| e.to_str())
        .map(str::to_lowercase)
        .as_deref()
    {
        Some("exr") => film
            .layers(metadata(arguments, options, film))
            .write_exr(path),
        Some("png") => {
            let tonemap = arguments.tonemap.unwrap_or(TONE_MAP);
            film.image().write_png(path, tonemap, arguments.exposure)
        }
        _ => film.image().write(path),
    };
    written.map_err(|e| Failure::input(chain(&e)))
}

/// How the image came to be, as text attributes of the file.
fn metadata(arguments: &Arguments, options: &RenderOptions, film: &Film) -> Vec<(String, String)> {
    let scene = match &arguments.scene {
        Some(path) => path.display().to_string(),
        None => "preview".into(),
    };
    [
        ("generator", format!("gonio {}", env!("CARGO_PKG_VERSION"))),
        ("gonio.scene", scene),
        ("gonio.integrator", options.integrator.name().into()),
        (
            "gonio.samplesPerPixel",
            film.samples_per_pixel().to_string(),
        ),
        ("gonio.seed", options.seed.to_string()),
        ("gonio.filter", options.filter.name().into()),
        ("gonio.unit", "W m^-2 sr^-1 in linear Rec.709 RGB".into()),
        ("gonio.clamping", "none".into()),
        ("gonio.rejectedSamples", film.rejected().count.to_string()),
    ]
    .map(|(key, value)| (key.to_owned(), value))
    .into()
}

fn report(
    arguments: &Arguments,
    options: &RenderOptions,
    scene: &Scene,
    film: &Film,
    outputs: &[PathBuf],
    progress: &Progress,
    stop: Stop,
) -> Result<(), Failure> {
    let rejected = film.rejected();
    if let Some(first) = &rejected.first {
        let material = first
            .material
            .and_then(|m| scene.materials.get(m as usize))
            .map_or("no surface", |m| m.name.as_str());
        eprintln!(
            "warning: {} samples were negative or not finite and count as black; the first: pixel {}, {}, sample {}, \
             material '{material}', radiance {:?}",
            rejected.count, first.pixel[0], first.pixel[1], first.sample, first.radiance
        );
    }
    if arguments.json {
        return print_json(&Summary {
            outputs,
            width: options.width,
            height: options.height,
            samples_per_pixel: progress.samples,
            seconds: progress.elapsed.as_secs_f64(),
            rays: progress.rays.total(),
            noise: Some(progress.noise).filter(|n| n.is_finite()),
            stopped_by: stop,
            seed: options.seed,
            rejected_samples: rejected,
            warnings: &scene.warnings,
        });
    }
    if arguments.quiet {
        return Ok(());
    }
    let seconds = progress.elapsed.as_secs_f64();
    print(&format!(
        "{}×{} pixels, {} samples each, {} rays in {seconds:.1} s ({}rays/s), noise {}",
        options.width,
        options.height,
        progress.samples,
        progress::quantity(progress.rays.total() as f64).trim_end(),
        progress::quantity(progress.rays.total() as f64 / seconds.max(1e-9)),
        progress::percent(progress.noise),
    ));
    for path in outputs {
        print(&format!("wrote {}", path.display()));
    }
    Ok(())
}
