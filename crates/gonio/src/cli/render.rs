//! `gonio render`.

mod checkpoint;
mod denoise;
mod live;
pub(super) mod product;
mod range;
mod scene;

pub(super) use scene::load_scene;

use super::destination;
use super::environment::EnvironmentArguments;
use super::failure::Failure;
use super::parse;
use super::progress::{self, ProgressKind, Telling};
use super::summary::{Summary, faulty_shares};
use super::terminal::{note, print, print_json, warn};
use checkpoint::{Checkpoint, CheckpointArguments};
use gonio_env::Candidates;
use gonio_radiometry::sequence::SamplerKind;
use gonio_render::integrator::{
    Direct, EnvironmentSampling, LightChoice, Path as PathTracer, Roulette,
};
use gonio_render::part::Label;
use gonio_render::{
    Exposure, Identity, Integrator, Kept, Names, PixelFilter, Rejected, RenderOptions, Screen,
    Stop, Target,
};
use gonio_scene::{Camera, NO_GROUP, Scene};
use live::{Live, LiveArguments};
use product::{PictureArguments, is_part, write_all};
use range::Chosen;
use scene::Loaded;
use std::ops::{ControlFlow, Range};
use std::path::PathBuf;
use std::time::Duration;

/// Samples per pixel when nothing is said.
const DEFAULT_SAMPLES: u32 = 64;
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
    gonio render room.toml --spp 4096 --checkpoint room.checkpoint --resume\n  \
    gonio render room.toml --spp 4096 --part 0/8 -o part0.gonio\n\n\
    Ctrl-C ends the rendering after the pass, writes the pictures and the checkpoint, and exits with 4.")]
pub(super) struct Arguments {
    /// A scene: .toml, .gltf, .glb, .obj or .ply; without one, the embedded preview
    scene: Option<PathBuf>,
    /// Nothing but warnings and errors
    #[arg(short, long)]
    quiet: bool,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Where to write: .exr (radiance and layers), .hdr, .png, or .gonio (a part for 'gonio merge'); {part} stands for the K of --part; may be repeated [default: gonio.png and gonio.exr, or samples-FIRST-END.gonio for a part]
    #[arg(short, long = "output", value_name = "FILE", help_heading = "Picture")]
    output: Vec<PathBuf>,
    /// Size in pixels [default: the scene's, or 960x540]
    #[arg(long, value_name = "WxH", value_parser = parse::size, allow_hyphen_values = true, help_heading = "Picture")]
    size: Option<[u32; 2]>,
    /// The camera, by name or by number from 0
    #[arg(long, value_name = "CAMERA", help_heading = "Picture")]
    camera: Option<String>,
    /// Further layers of EXR files and parts: where the first surface is (position), what it is made of (material), light after at most one
    /// reflection (direct) and the rest (indirect), and the light of each group of lights (groups), for 'gonio relight'. Albedo, normal, depth, variance
    /// and the number of samples are there in any case
    #[arg(
        long,
        value_enum,
        value_name = "NAME,…",
        value_delimiter = ',',
        help_heading = "Picture"
    )]
    layers: Vec<LayerName>,
    /// A second picture in which fireflies weigh less, the layer 'reweighted' of EXR files: samples much brighter than the others count as far as others
    /// like them are near. It is too dark where such light is rare; R, G and B stay as they are. 384 bytes a pixel
    #[arg(long, help_heading = "Picture")]
    reweight_fireflies: bool,
    #[command(flatten, next_help_heading = "Picture")]
    picture: PictureArguments,
    #[command(flatten, next_help_heading = "Picture")]
    live: LiveArguments,
    /// Samples per pixel [default: 64, or as many as --time or --noise take]
    #[arg(long, value_name = "N", value_parser = parse::whole(1, u32::MAX), allow_hyphen_values = true, help_heading = "How long: ends at the first of these")]
    spp: Option<u32>,
    /// Stop after this time: 30s, 5m, 1h
    #[arg(long, value_name = "TIME", value_parser = parse::duration, allow_hyphen_values = true, help_heading = "How long: ends at the first of these")]
    time: Option<Duration>,
    /// Stop when 95 % of the pixels have a relative error below this: 2%
    #[arg(long, value_name = "ERROR", value_parser = parse::fraction, allow_hyphen_values = true, help_heading = "How long: ends at the first of these")]
    noise: Option<f64>,
    /// After 32 samples of every pixel takes them where they are needed. With --noise: in those pixels alone whose neighbourhood is noisier than
    /// asked for. Without: where a sample takes most from the mean squared error, until there are --spp in the mean
    #[arg(long, help_heading = "How long: ends at the first of these")]
    adaptive: bool,
    /// Take these samples alone, counted from 0, END not among them: a part of the picture, see 'gonio merge'
    #[arg(long, value_name = "FIRST:END", value_parser = range::samples, conflicts_with_all = ["part", "time", "noise", "adaptive"], help_heading = "Parts and interruptions")]
    samples: Option<Range<u32>>,
    /// Take part K of N of the samples of --spp, counted from 0; auto/N takes K from the job system: SLURM_ARRAY_TASK_ID, PBS_ARRAY_INDEX, HQ_TASK_ID or JOB_COMPLETION_INDEX
    #[arg(long, value_name = "K/N", value_parser = range::part, allow_hyphen_values = true, conflicts_with_all = ["time", "noise", "adaptive"], help_heading = "Parts and interruptions")]
    part: Option<range::Part>,
    #[command(flatten, next_help_heading = "Parts and interruptions")]
    checkpoint: CheckpointArguments,
    /// How progress is told: a bar (tty), lines of JSON on standard error (json), or lines for Open Job Description on standard output (openjd)
    #[arg(long, value_enum, value_name = "HOW", default_value_t = ProgressKind::Tty, help_heading = "Parts and interruptions")]
    progress: ProgressKind,
    /// Exit with 1 if a sample was negative or not finite
    #[arg(long)]
    strict: bool,
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
    /// Reflections before Russian roulette may end a path; it judges by the energy that the path carries
    #[arg(long, value_name = "N", default_value_t = PathTracer::default().roulette_after, value_parser = parse::whole(0, u32::MAX), allow_hyphen_values = true, help_heading = "Method")]
    roulette_after: u32,
    /// How Russian roulette judges a path: by the energy that it carries (throughput), or from the first surface on by the light that it is expected to find
    /// for the rays that it takes, which a small picture tells before (efficiency)
    #[arg(long, value_enum, value_name = "NAME", default_value_t = RouletteName::Throughput, help_heading = "Method")]
    roulette: RouletteName,
    /// How one of the lights is chosen at each reflection of the path integrator: by what it may send there (tree), by its power, or each with the same
    /// probability (uniform)
    #[arg(long, value_enum, value_name = "NAME", default_value_t = LightChoiceName::Tree, help_heading = "Method")]
    light_choice: LightChoiceName,
    /// Light samples at the first surface of each camera ray; powers of two are stratified best
    #[arg(long, value_name = "N", default_value_t = PathTracer::default().light_samples, value_parser = parse::whole(1, PathTracer::MOST), allow_hyphen_values = true, help_heading = "Method")]
    light_samples: u32,
    /// Candidates for each of those, of which one is kept by what it would reflect, and has the only shadow ray (resampled importance sampling); not with
    /// --env-sampling product
    #[arg(long, value_name = "N", default_value_t = PathTracer::default().light_candidates, value_parser = parse::whole(1, PathTracer::MOST), allow_hyphen_values = true, help_heading = "Method")]
    light_candidates: u32,
    /// Paths that go on from the first surface of each camera ray; powers of two are stratified best
    #[arg(long, value_name = "N", default_value_t = PathTracer::default().splitting, value_parser = parse::whole(1, PathTracer::MOST), allow_hyphen_values = true, help_heading = "Method")]
    splitting: u32,
    /// Where samples come from: Owen-scrambled Sobol' points of every pixel (sobol), or of the whole picture, so that the error after --spp samples is
    /// blue noise (blue-noise), or independent random numbers
    #[arg(long, value_enum, value_name = "NAME", default_value_t = SamplerName::Sobol, requires_if("blue-noise", "spp"), help_heading = "Method")]
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
enum LayerName {
    Position,
    Material,
    Direct,
    Indirect,
    Groups,
    All,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum IntegratorName {
    Path,
    Direct,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum RouletteName {
    Throughput,
    Efficiency,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum LightChoiceName {
    Tree,
    Power,
    Uniform,
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
    BlueNoise,
    Independent,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    progress::listen();
    arguments.picture.check(arguments.reweight_fireflies)?;
    if arguments.env_sampling == EnvSamplingName::Product && arguments.light_candidates > 1 {
        let message =
            "--light-candidates beside --env-sampling product, which has candidates of its own";
        return Err(Failure::usage(message)
            .with_help("leave one of the two out; --env-candidates is for the environment"));
    }
    let chosen = range::of(arguments, |name| std::env::var(name).ok())?;
    let outputs = outputs(arguments, &chosen)?;
    let range = chosen.samples.clone();
    let Loaded {
        scene,
        mut notes,
        hash,
        name,
    } = scene::load(arguments)?;
    notes.extend(note_on_groups(arguments, &scene));
    let camera = camera(arguments, &scene);
    let options = options(arguments, &scene, &range);
    let label = Label {
        identity: Identity::new(&hash, &camera, &options),
        scene: name,
        of: chosen.of,
        names: Names::of(&scene),
    };
    scene.warnings.iter().for_each(|text| warn(text));
    if !arguments.quiet {
        notes.iter().for_each(|text| note(text));
    }
    if outputs.iter().all(|path| is_part(path)) && all_are_there(&outputs, &label, &range) {
        return say_that_all_are_there(arguments, &outputs, &range);
    }
    let path = arguments.checkpoint.checkpoint.as_ref();
    let mut checkpoint =
        path.map(|p| Checkpoint::new(chosen.name(p), &arguments.checkpoint, &label));
    let earlier = match &checkpoint {
        Some(checkpoint) => checkpoint.resume(&range)?,
        None => None,
    };
    let mut exposure = match earlier {
        Some(exposure) => exposure,
        None => {
            let (width, height) = (options.width, options.height);
            Exposure::keeping(options.keep, width, height, range.start)?
        }
    };
    let size = [options.width, options.height];
    let mut live = Live::new(&arguments.live, &arguments.picture, &label.scene, size)?;
    let mut telling = Telling::new(arguments.progress, options.target, arguments.quiet);
    let mut work = || {
        gonio_render::expose(
            &scene,
            &camera,
            &options,
            &mut exposure,
            |progress, exposure| {
                telling.update(progress, &exposure.film);
                live.update(&exposure.film);
                if let Some(checkpoint) = &mut checkpoint {
                    checkpoint.keep(exposure);
                }
                if progress::stop_requested() {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            },
        )
    };
    let stop = match arguments.threads {
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
    telling.finish();
    let stop = stop?;
    live.show(&exposure.film);
    // A part is whole or not there.
    let complete = stop != Stop::Interrupted;
    let wanted = outputs.iter().filter(|path| complete || !is_part(path));
    let (written, mut failure) = write_all(wanted, &label, &exposure, &arguments.picture);
    if let Some(checkpoint) = &checkpoint {
        // A part that is written has all that its checkpoint had.
        let in_a_part = written.iter().any(|path| is_part(path));
        let kept = match in_a_part {
            true => checkpoint.remove(),
            false => checkpoint.write(&exposure),
        };
        failure = failure.or(kept.err());
    }
    let film = &exposure.film;
    let summary = Summary {
        outputs: written,
        width: options.width,
        height: options.height,
        samples_per_pixel: film.samples_per_pixel(),
        mean_samples_per_pixel: film.samples() as f64 / film.pixels().len() as f64,
        samples: [exposure.samples.start, exposure.samples.end],
        seconds: exposure.elapsed.as_secs_f64(),
        rays: exposure.rays.total(),
        noise: Some(film.noise()).filter(|n| n.is_finite()),
        stopped_by: stop,
        seed: options.seed,
        scene_hash: &hash,
        rejected_samples: film.rejected(),
        warnings: &scene.warnings,
        notes: &notes,
    };
    let faults = [
        summary.rejected(&scene),
        faulty_shares(summary.rejected_samples),
    ];
    faults.iter().flatten().for_each(|text| warn(text));
    if arguments.json {
        print_json(&summary)?;
    } else if !arguments.quiet {
        print(&summary.in_words())?;
    }
    if let Some(failure) = failure {
        return Err(failure);
    }
    if !complete {
        return Err(interrupted(&exposure, checkpoint.as_ref()));
    }
    strict(arguments.strict, film.rejected())
}

impl Arguments {
    /// Fails if there is an option among them that a rendering in parts has of its own, or none of the samples for a part.
    pub(super) fn check_for_parts(&self, parts: u32) -> Result<(), Failure> {
        let given = [
            ("--output", !self.output.is_empty()),
            ("--samples", self.samples.is_some()),
            ("--part", self.part.is_some()),
            ("--checkpoint", self.checkpoint.checkpoint.is_some()),
            ("--time", self.time.is_some()),
            ("--noise", self.noise.is_some()),
            ("--adaptive", self.adaptive),
            ("--threads", self.threads.is_some()),
        ];
        if let Some((name, _)) = given.iter().find(|(_, given)| *given) {
            return Err(
                Failure::usage(format!("{name} is not for a rendering in parts")).with_help(
                    "how many samples there are is --spp; the rest follows from --parts and --cpus",
                ),
            );
        }
        let samples = self.spp.unwrap_or(DEFAULT_SAMPLES);
        if samples < parts {
            return Err(Failure::usage(format!(
                "{parts} parts of {samples} samples per pixel: some would have none"
            ))
            .with_help("more samples: -- --spp N"));
        }
        Ok(())
    }
}

/// Fails if samples were kept out of a picture that must have all.
pub(super) fn strict(wanted: bool, rejected: &Rejected) -> Result<(), Failure> {
    match rejected.count {
        0 => Ok(()),
        _ if !wanted => Ok(()),
        1 => Err("one sample was negative or not finite".to_owned()),
        n => Err(format!("{n} samples were negative or not finite")),
    }
    .map_err(|text| {
        Failure::verification(text).with_help(
            "--strict asks for none; 'gonio brdf check' finds what is wrong with a function",
        )
    })
}

fn all_are_there(outputs: &[PathBuf], label: &Label, range: &Range<u32>) -> bool {
    outputs.iter().all(|path| {
        let there = checkpoint::is_there(path, label, range);
        if let Err(Some(why)) = &there {
            note(why);
        }
        there.is_ok()
    })
}

fn say_that_all_are_there(
    arguments: &Arguments,
    outputs: &[PathBuf],
    range: &Range<u32>,
) -> Result<(), Failure> {
    if arguments.json {
        return print_json(&serde_json::json!({
            "outputs": outputs,
            "samples": [range.start, range.end],
            "already_there": true,
        }));
    }
    if arguments.quiet {
        return Ok(());
    }
    let lines = outputs.iter().map(|path| {
        let path = path.display();
        format!(
            "{path} has the samples {}:{} of this picture already\n",
            range.start, range.end
        )
    });
    print(&lines.collect::<String>())
}

/// The failure that says how to go on.
fn interrupted(exposure: &Exposure, checkpoint: Option<&Checkpoint>) -> Failure {
    let Range { start, end } = exposure.samples;
    let taken = end - start;
    match checkpoint {
        Some(checkpoint) => {
            let path = checkpoint.path().display();
            Failure::interrupted(format!(
                "interrupted after {taken} samples per pixel; {path} holds them"
            ))
            .with_help("the same command with --resume goes on from there")
        }
        None => Failure::interrupted(format!(
            "interrupted after {taken} samples per pixel; the pictures are written, parts are not"
        ))
        .with_help(match start {
            0 => format!("the same command with --spp {end} gives the same pictures; --checkpoint lets one go on"),
            _ => "with --checkpoint FILE a rendering can go on".into(),
        }),
    }
}

/// The output files, known to be writable in kind and place before any time is spent.
fn outputs(arguments: &Arguments, chosen: &Chosen) -> Result<Vec<PathBuf>, Failure> {
    let Range { start, end } = chosen.samples;
    let paths = match arguments.output.is_empty() {
        false => arguments.output.iter().map(|p| chosen.name(p)).collect(),
        true if arguments.samples.is_some() || arguments.part.is_some() => {
            vec![format!("samples-{start}-{end}.gonio").into()]
        }
        true => vec!["gonio.png".into(), "gonio.exr".into()],
    };
    for path in &paths {
        destination::check_product(path)?;
    }
    if let Some(path) = &arguments.checkpoint.checkpoint {
        destination::writable(&chosen.name(path))?;
    }
    Ok(paths)
}

fn camera(arguments: &Arguments, scene: &Scene) -> Camera {
    let [width, height] = size(arguments, scene);
    scene.camera_or_framing(width as f32 / height as f32)
}

fn size(arguments: &Arguments, scene: &Scene) -> [u32; 2] {
    arguments.size.or(scene.film_size).unwrap_or([960, 540])
}

fn options(arguments: &Arguments, scene: &Scene, range: &Range<u32>) -> RenderOptions {
    let [width, height] = size(arguments, scene);
    RenderOptions {
        width,
        height,
        target: Target {
            samples: match arguments.adaptive {
                true => range.end.min(range::spp(arguments)),
                false => range.end,
            },
            time: arguments.time,
            noise: arguments.noise,
            adaptive: arguments.adaptive,
        },
        integrator: match arguments.integrator {
            IntegratorName::Direct => Integrator::Direct(Direct {
                environment: environment_sampling(arguments),
                ..Direct::default()
            }),
            IntegratorName::Path => Integrator::Path(PathTracer {
                max_bounces: arguments.max_bounces,
                environment: environment_sampling(arguments),
                roulette_after: arguments.roulette_after,
                light_choice: match arguments.light_choice {
                    LightChoiceName::Tree => LightChoice::Tree,
                    LightChoiceName::Power => LightChoice::Power,
                    LightChoiceName::Uniform => LightChoice::Uniform,
                },
                light_samples: arguments.light_samples,
                light_candidates: arguments.light_candidates,
                splitting: arguments.splitting,
                roulette: match arguments.roulette {
                    RouletteName::Throughput => Roulette::Throughput,
                    RouletteName::Efficiency => Roulette::Efficiency,
                },
            }),
        },
        sampler: match arguments.sampler {
            SamplerName::Sobol | SamplerName::BlueNoise => SamplerKind::Sobol,
            SamplerName::Independent => SamplerKind::Independent,
        },
        screen: match (arguments.sampler, arguments.spp) {
            (SamplerName::BlueNoise, Some(samples)) => Screen::blue_noise(samples),
            _ => Screen::INDEPENDENT,
        },
        filter: arguments.filter,
        seed: arguments.seed,
        keep: kept(arguments, scene),
    }
}

fn kept(arguments: &Arguments, scene: &Scene) -> Kept {
    let asked = |name| {
        let layers = &arguments.layers;
        layers.contains(&name) || layers.contains(&LayerName::All)
    };
    Kept {
        position: asked(LayerName::Position),
        material: asked(LayerName::Material),
        direct: asked(LayerName::Direct),
        indirect: asked(LayerName::Indirect),
        groups: match asked(LayerName::Groups) {
            true => scene.lights.groups().len() as u32,
            false => 0,
        },
        reweighted: arguments.reweight_fireflies,
    }
}

/// What to know where groups of lights are asked for that the scene doesn't have.
fn note_on_groups(arguments: &Arguments, scene: &Scene) -> Option<String> {
    let asked = arguments.layers.contains(&LayerName::Groups);
    let single = matches!(scene.lights.groups(), [only] if only == NO_GROUP);
    (asked && single).then(|| {
        format!(
            "no light of the scene is in a group: the layer group.{NO_GROUP} is the whole picture; \
             group = \"NAME\" in the scene file puts lights, materials that shine and the environment into groups"
        )
    })
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
