//! `gonio render`.

use super::destination;
use super::environment::EnvironmentArguments;
use super::failure::Failure;
use super::parse;
use super::progress::{self, Bar};
use super::summary::Summary;
use super::terminal::{note, print, print_json, warn};
use crate::preview;
use gonio_brdf::ModelSpec;
use gonio_env::Candidates;
use gonio_image::tonemap::ToneMap;
use gonio_radiometry::sequence::SamplerKind;
use gonio_render::integrator::{Direct, EnvironmentSampling, Path as PathTracer};
use gonio_render::{Film, Integrator, PixelFilter, Progress, RenderOptions, Stop, Target};
use gonio_scene::{Camera, LoadOptions, Scene, SceneError};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Samples per pixel when time or noise is what ends the rendering.
const NO_LIMIT: u32 = 1 << 20;

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio render\n  \
    gonio render helmet.gltf --env sunset.hdr --spp 256 -o helmet.exr -o helmet.png\n  \
    gonio render --material ggx:metal=copper,roughness=0.4 --time 30s\n  \
    gonio render --material glass:absorption=0.2/0.05/0.1 --spp 256\n\n\
    A small scene, ball.toml:\n  \
    [environment]\n  \
    uniform = 1.0\n\n  \
    [[material]]\n  \
    name = \"gold\"\n  \
    model = \"torrance-sparrow\"\n  \
    params = { metal = \"gold\", roughness = 0.3 }\n\n  \
    [[shape]]\n  \
    kind = \"sphere\"\n  \
    material = \"gold\"\n\n\
    Ctrl-C ends the rendering after the pass, writes the pictures, and exits with 4.")]
pub(super) struct Arguments {
    /// A scene: .toml, .gltf, .glb, .obj or .ply; without one, the embedded preview
    scene: Option<PathBuf>,
    /// Nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Where to write: .exr (radiance and layers), .hdr or .png; may be repeated [default: gonio.png and gonio.exr]
    #[arg(short, long = "output", value_name = "FILE", help_heading = "Picture")]
    output: Vec<PathBuf>,
    /// Size in pixels [default: the scene's, or 960x540]
    #[arg(long, value_name = "WxH", value_parser = parse::size, allow_hyphen_values = true, help_heading = "Picture")]
    size: Option<[u32; 2]>,
    /// The camera, by name or by number from 0
    #[arg(long, value_name = "CAMERA", help_heading = "Picture")]
    camera: Option<String>,
    /// Exposure of PNG files, in stops
    #[arg(long, value_name = "EV", default_value = "0", value_parser = parse::finite, allow_hyphen_values = true, help_heading = "Picture")]
    exposure: f32,
    /// Tone map of PNG files
    #[arg(long, value_name = "NAME", default_value = "pbr-neutral", value_parser = parse::tone_map(), help_heading = "Picture")]
    tonemap: ToneMap,
    /// Samples per pixel [default: 64, or as many as --time or --noise take]
    #[arg(long, value_name = "N", value_parser = parse::whole(1, u32::MAX), allow_hyphen_values = true, help_heading = "How long: ends at the first of these")]
    spp: Option<u32>,
    /// Stop after this time: 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = parse::duration, allow_hyphen_values = true, help_heading = "How long: ends at the first of these")]
    time: Option<Duration>,
    /// Stop when 95 % of the pixels have a relative error below this: 2%
    #[arg(long, value_name = "ERROR", value_parser = parse::fraction, allow_hyphen_values = true, help_heading = "How long: ends at the first of these")]
    noise: Option<f64>,
    /// Replace materials: [MATERIAL=]MODEL:key=value,…; without MATERIAL, all of them (in the preview, the object's)
    #[arg(long, value_name = "SPEC", help_heading = "Scene")]
    material: Vec<String>,
    #[command(flatten, next_help_heading = "Scene")]
    environment: EnvironmentArguments,
    /// How the reflection equation is solved: over many reflections (path), or over one (direct)
    #[arg(long, value_enum, value_name = "NAME", default_value_t = IntegratorName::Path, help_heading = "Method")]
    integrator: IntegratorName,
    /// How light from the environment is sampled: by luminance, by what exceeds its mean (compensated), by luminance × cosine, or by
    /// luminance × reflection × cosine (product)
    #[arg(long, value_enum, value_name = "NAME", default_value_t = EnvSamplingName::Luminance, help_heading = "Method")]
    env_sampling: EnvSamplingName,
    /// Candidates of the product, from the light and as many from the reflection function
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = parse::whole(1u32, 256), allow_hyphen_values = true, help_heading = "Method")]
    env_candidates: u32,
    /// Reflections that light may make, passages through surfaces included, for the path integrator
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = parse::whole(0, u32::MAX), allow_hyphen_values = true, help_heading = "Method")]
    max_bounces: u32,
    /// Where samples come from: Owen-scrambled Sobol' points, or independent random numbers
    #[arg(long, value_enum, value_name = "NAME", default_value_t = SamplerName::Sobol, help_heading = "Method")]
    sampler: SamplerName,
    /// What a pixel averages over
    #[arg(long, value_name = "NAME", default_value = "blackman-harris", value_parser = parse::pixel_filter(), help_heading = "Method")]
    filter: PixelFilter,
    /// Seed of the samples; the same seed gives the same picture, bit for bit
    #[arg(long, value_name = "S", default_value_t = 0, value_parser = parse::whole(0, u64::MAX), allow_hyphen_values = true, help_heading = "Method")]
    seed: u64,
    /// Threads [default: one a processor]; the picture does not depend on it
    #[arg(long, value_name = "N", value_parser = parse::whole(1_usize, 4096), allow_hyphen_values = true, help_heading = "Method")]
    threads: Option<usize>,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum IntegratorName {
    Path,
    Direct,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum EnvSamplingName {
    Luminance,
    Compensated,
    Cosine,
    Product,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum SamplerName {
    Sobol,
    Independent,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let outputs = outputs(arguments)?;
    let (scene, notes) = scene(arguments)?;
    let camera = camera(arguments, &scene);
    let options = options(arguments, &scene);
    scene.warnings.iter().for_each(|text| warn(text));
    if !arguments.quiet {
        notes.iter().for_each(|text| note(text));
    }
    let bar = Bar::new(options.target, arguments.quiet);
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
            .num_threads(threads)
            .build()
            .map_err(|e| {
                Failure::usage(format!("{threads} threads can't be started: {e}"))
                    .with_help("choose fewer --threads")
            })?
            .install(work),
    };
    bar.finish();
    let (film, stop) = rendered?;
    let progress = last.ok_or_else(|| Failure::usage("nothing was rendered"))?;
    // One that can't be written is no reason to lose the others.
    let (written, failures): (Vec<_>, Vec<_>) = outputs
        .iter()
        .map(|path| write(arguments, &options, &film, path).map(|()| path))
        .partition(Result::is_ok);
    let summary = Summary {
        outputs: written.into_iter().flatten().collect(),
        width: options.width,
        height: options.height,
        samples_per_pixel: progress.samples,
        seconds: progress.elapsed.as_secs_f64(),
        rays: progress.rays.total(),
        noise: Some(progress.noise).filter(|n| n.is_finite()),
        stopped_by: stop,
        seed: options.seed,
        rejected_samples: film.rejected(),
        warnings: &scene.warnings,
        notes: &notes,
    };
    if let Some(text) = summary.rejected(&scene) {
        warn(&text);
    }
    if arguments.json {
        print_json(&summary)?;
    } else if !arguments.quiet {
        print(&summary.in_words())?;
    }
    if let Some(failure) = failures.into_iter().find_map(Result::err) {
        return Err(failure);
    }
    if stop == Stop::Interrupted {
        return Err(Failure::interrupted(format!(
            "interrupted after {} samples per pixel; the pictures are written",
            progress.samples
        ))
        .with_help(format!(
            "the same command with --spp {} gives the same pictures",
            progress.samples
        )));
    }
    Ok(())
}

/// The output files, known to be writable in kind and place before any time is spent.
fn outputs(arguments: &Arguments) -> Result<Vec<PathBuf>, Failure> {
    let paths = match arguments.output.is_empty() {
        true => vec!["gonio.png".into(), "gonio.exr".into()],
        false => arguments.output.clone(),
    };
    for path in &paths {
        destination::check(path)?;
    }
    Ok(paths)
}

/// The scene as the arguments ask for it, and what was chosen where they and the file are silent.
fn scene(arguments: &Arguments) -> Result<(Scene, Vec<String>), Failure> {
    let mut notes = Vec::new();
    let load = LoadOptions {
        camera: arguments.camera.clone(),
        ..arguments.environment.for_scene()
    };
    let mut scene = match &arguments.scene {
        Some(path) => load_scene(path, &load)?,
        None => preview::load(load)?,
    };
    for text in &arguments.material {
        replace_material(&mut scene, text, arguments.scene.is_none())
            .map_err(|failure| failure.about(&format!("--material '{text}'")))?;
    }
    arguments.environment.apply(&mut scene)?;
    if scene.lights.iter().next().is_none() {
        let panorama = preview::panorama()?;
        scene.set_environment(Some(arguments.environment.turned(panorama)));
        notes.push(
            "the scene has no light: the built-in panorama lights it; --env chooses another".into(),
        );
    }
    if scene.cameras.is_empty() {
        notes.push("the scene has no camera: it is seen from where all of it is in view".into());
    }
    Ok((scene, notes))
}

/// Reads a scene; one without content is named by its file.
pub(super) fn load_scene(path: &Path, options: &LoadOptions) -> Result<Scene, Failure> {
    Scene::load(path, options).map_err(|e| match e {
        SceneError::Empty { .. } => Failure::from(e).about(&path.display().to_string()),
        other => other.into(),
    })
}

/// Follows one `--material`.
fn replace_material(scene: &mut Scene, text: &str, preview: bool) -> Result<(), Failure> {
    // Names of materials may hold any character, so the scene's own come first.
    let known = scene
        .material_names()
        .into_iter()
        .filter(|name| {
            text.strip_prefix(name)
                .is_some_and(|rest| rest.starts_with('='))
        })
        .max_by_key(|name| name.len())
        .map(str::len);
    let end = known.or_else(|| {
        text.find(['=', ':', '('])
            .filter(|i| text[*i..].starts_with('='))
    });
    let (target, spec) = match end {
        Some(end) => (&text[..end], &text[end + 1..]),
        None if preview => (preview::OBJECT, text),
        None => ("*", text),
    };
    let spec = ModelSpec::parse(spec)?;
    scene.replace_material(target, &spec)?;
    Ok(())
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
            IntegratorName::Direct => Integrator::Direct(Direct {
                environment: environment_sampling(arguments),
            }),
            IntegratorName::Path => Integrator::Path(PathTracer {
                max_bounces: arguments.max_bounces,
                environment: environment_sampling(arguments),
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

fn environment_sampling(arguments: &Arguments) -> EnvironmentSampling {
    match arguments.env_sampling {
        EnvSamplingName::Luminance => EnvironmentSampling::Luminance,
        EnvSamplingName::Compensated => EnvironmentSampling::Compensated,
        EnvSamplingName::Cosine => EnvironmentSampling::Cosine,
        EnvSamplingName::Product => EnvironmentSampling::Product(Candidates {
            light: arguments.env_candidates,
            reflection: arguments.env_candidates,
        }),
    }
}

fn write(
    arguments: &Arguments,
    options: &RenderOptions,
    film: &Film,
    path: &Path,
) -> Result<(), Failure> {
    match destination::extension(path).as_str() {
        "exr" => film
            .layers(metadata(arguments, options, film))
            .write_exr(path)?,
        "png" => {
            film.image()
                .write_png(path, arguments.tonemap, arguments.exposure)?;
        }
        _ => film.image().write(path)?,
    }
    Ok(())
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
