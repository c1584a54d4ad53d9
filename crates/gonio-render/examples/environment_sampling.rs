//! What each `--env-sampling` is worth in whole pictures: efficiency 1 / (CPU time × mean squared error), relative to `luminance`.
//!
//! `cargo run --release -p gonio-render --example environment_sampling [SCALE]`
//!
//! Scenes of this repository are rendered on one thread, each sampling in turn, with several seeds, and compared with a reference of many
//! samples, half by luminance and half by the product. The error of a pixel is relative to its value, (x − r)² / (r² + (mean/10)²), so that
//! a bright sky does not count alone. SCALE multiplies the samples; 1 takes some minutes.

use gonio_brdf::ModelSpec;
use gonio_env::{Candidates, Environment, Layout};
use gonio_image::Image;
use gonio_render::integrator::{EnvironmentSampling, Path};
use gonio_render::{Film, Integrator, RenderOptions, Target, render};
use gonio_scene::{LoadOptions, Scene};
use std::error::Error;
use std::ops::ControlFlow;
use std::time::Instant;

const SIZE: [u32; 2] = [80, 45];
const SAMPLES: u32 = 16;
const SEEDS: u64 = 12;
const REFERENCE: u32 = 2048;

fn product(n: u32) -> EnvironmentSampling {
    EnvironmentSampling::Product(Candidates {
        light: n,
        reflection: n,
    })
}

fn asset(path: &str) -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../..")
        .join(path)
}

/// The preview, its object of another material, in another light.
fn preview(object: Option<&str>, light: Option<Environment>) -> Result<Scene, Box<dyn Error>> {
    let mut scene = Scene::load(asset("assets/preview/scene.toml"), &LoadOptions::default())?;
    if let Some(text) = object {
        scene.replace_material("object", &ModelSpec::parse(text)?)?;
        scene.replace_material("ground", &ModelSpec::parse("lambertian:reflectance=0.3")?)?;
    }
    if light.is_some() {
        scene.set_environment(light);
    }
    Ok(scene)
}

fn scenes() -> Result<Vec<(&'static str, Scene)>, Box<dyn Error>> {
    let mut even = Image::read(&asset("assets/preview/sunset.hdr"))?;
    for p in &mut even.pixels {
        *p = p.map(|c| c.min(2.0));
    }
    let even = Environment::from_image(even, Layout::LatLong)?;
    let sky = "sky:azimuth=150,elevation=35,turbidity=3";
    let sky = Environment::parse(sky, &gonio_env::LoadOptions::default())?;
    let mut spheres = Scene::load(asset("scenes/spheres.toml"), &LoadOptions::default())?;
    spheres.set_environment(Some(sky));
    let chalk = Some("lambertian:reflectance=0.7");
    Ok(vec![
        ("gold, sunset", preview(None, None)?),
        ("chalk, sunset", preview(chalk, None)?),
        (
            "gold, sunset without its sun",
            preview(None, Some(even.clone()))?,
        ),
        ("chalk, sunset without its sun", preview(chalk, Some(even))?),
        ("five spheres, clear sky and sun", spheres),
    ])
}

/// CPU seconds of this process where the system tells them, else seconds on the clock.
fn cpu_seconds(start: Instant) -> f64 {
    let of_system = || {
        let stat = std::fs::read_to_string("/proc/self/schedstat").ok()?;
        stat.split_whitespace().next()?.parse::<f64>().ok()
    };
    of_system().map_or_else(|| start.elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}

fn picture(scene: &Scene, environment: EnvironmentSampling, samples: u32, seed: u64) -> Film {
    let camera = scene.camera_or_framing(SIZE[0] as f32 / SIZE[1] as f32);
    let options = RenderOptions {
        width: SIZE[0],
        height: SIZE[1],
        target: Target {
            samples,
            time: None,
            noise: None,
            adaptive: false,
        },
        integrator: Integrator::Path(Path {
            environment,
            ..Path::default()
        }),
        seed,
        ..RenderOptions::default()
    };
    let (film, _) = render(scene, &camera, &options, |_, _| ControlFlow::Continue(()))
        .expect("options in range");
    film
}

/// Mean relative squared error.
fn error(film: &Film, reference: &[[f64; 3]], mean: f64) -> f64 {
    let mut sum = 0.0;
    for (pixel, truth) in film.pixels().iter().zip(reference) {
        for (x, r) in pixel.mean().iter().zip(truth) {
            sum += (x - r) * (x - r) / (r * r + 0.01 * mean * mean);
        }
    }
    sum / (3 * reference.len()) as f64
}

fn main() -> Result<(), Box<dyn Error>> {
    let scale: f64 = std::env::args().nth(1).map_or(Ok(1.0), |s| s.parse())?;
    let start = Instant::now();
    let samplings = [
        ("luminance", EnvironmentSampling::Luminance),
        ("compensated", EnvironmentSampling::Compensated),
        ("cosine", EnvironmentSampling::Cosine),
        ("product 1+1", product(1)),
        ("product 4+4", product(4)),
        ("product 8+8", product(8)),
    ];
    print!("| scene |");
    for (name, _) in samplings {
        print!(" {name} |");
    }
    println!("\n|---|{}", "---|".repeat(samplings.len()));
    // One thread, this one: its CPU time is the process's.
    let alone = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread()
        .build()?;
    let scenes = scenes()?;
    alone.install(|| {
        for (name, scene) in &scenes {
            let count = ((f64::from(REFERENCE) * scale) as u32).max(1);
            let halves = [
                picture(scene, EnvironmentSampling::Luminance, count, 1 << 40),
                picture(scene, product(4), count, 1 << 41),
            ];
            let reference: Vec<[f64; 3]> = halves[0]
                .pixels()
                .iter()
                .zip(halves[1].pixels())
                .map(|(a, b)| {
                    let (a, b) = (a.mean(), b.mean());
                    [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]))
                })
                .collect();
            let mean = reference.iter().flatten().sum::<f64>() / (3 * reference.len()) as f64;
            let mut worth = vec![Vec::new(); samplings.len()];
            for seed in 0..((SEEDS as f64 * scale) as u64).max(2) {
                for (k, (_, sampling)) in samplings.iter().enumerate() {
                    let before = cpu_seconds(start);
                    let film = picture(scene, *sampling, SAMPLES, seed);
                    let seconds = cpu_seconds(start) - before;
                    worth[k].push((error(&film, &reference, mean), seconds));
                }
            }
            // Errors are averaged; of times the least is what the others did not disturb.
            let of = |runs: &[(f64, f64)]| {
                let error = runs.iter().map(|r| r.0).sum::<f64>() / runs.len() as f64;
                let time = runs.iter().map(|r| r.1).fold(f64::INFINITY, f64::min);
                (error, time)
            };
            let plain = of(&worth[0]);
            print!("| {name} |");
            for runs in &worth {
                let (error, time) = of(runs);
                let (e, t) = (plain.0 / error, time / plain.1);
                print!(" {:.2} ({e:.2} / {t:.2}) |", e / t);
            }
            println!();
        }
    });
    Ok(())
}
