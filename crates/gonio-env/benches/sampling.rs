//! Methods and guides of sampling, and the product with a reflection function: time of a sample, and what a second of it is worth.
//!
//! `cargo bench -p gonio-env --bench sampling` prints two tables. Efficiency is 1 / (time × mean squared error) of the radiance that a
//! surface reflects, relative to luminance sampling joined with the reflection function's own: above 1 the same error takes less time.

use gonio_env::{Candidates, EnvSamples, Environment, Guide, Layout, Reflected, SamplingMethod};
use gonio_image::Image;
use gonio_num::{Frame, Vec3, Vectors};
use gonio_radiometry::sequence::Rng;
use gonio_radiometry::warp::{cosine_power_hemisphere, cosine_power_hemisphere_density};
use std::hint::black_box;
use std::time::{Duration, Instant};

fn panorama(sun: f32) -> Environment {
    let image = Image::from_fn(1024, 512, |x, y| {
        let in_sun = x.abs_diff(300) < 3 && y.abs_diff(150) < 3;
        let sky = 0.3 + (512 - y) as f32 / 512.0 + ((x / 64 + y / 64) % 2) as f32;
        [if in_sun { sun } else { sky }; 3]
    });
    Environment::from_image(image, Layout::LatLong).expect("a sound picture")
}

/// Seconds a call.
fn time(mut call: impl FnMut(&mut Rng)) -> f64 {
    let mut rng = Rng::from_name("time");
    for _ in 0..20_000 {
        call(&mut rng);
    }
    let start = Instant::now();
    let count = 200_000;
    for _ in 0..count {
        call(&mut rng);
    }
    start.elapsed().as_secs_f64() / f64::from(count)
}

/// Seconds a point of `sample_many` and of `look_up_many`, the medians over waves of 1024 points.
fn time_many(env: &Environment, guide: Guide) -> (f64, f64) {
    const WAVE: usize = 1024;
    let mut rng = Rng::from_name("time_many");
    let mut from = Vectors::default();
    from.resize(WAVE);
    let mut samples = EnvSamples::default();
    let (mut drawn, mut found) = (Vec::new(), Vec::new());
    for _ in 0..200 {
        let mut numbers = || (0..WAVE).map(|_| rng.next_f32()).collect::<Vec<f32>>();
        let (u, v) = (numbers(), numbers());
        let start = Instant::now();
        env.sample_many(guide, &from, [&u, &v], black_box(&mut samples));
        drawn.push(start.elapsed());
        let start = Instant::now();
        env.look_up_many(guide, &from, black_box(&mut samples));
        found.push(start.elapsed());
    }
    let median = |mut times: Vec<Duration>| {
        times.sort_unstable();
        times[times.len() / 2].as_secs_f64() / WAVE as f64
    };
    (median(drawn), median(found))
}

/// A lobe of cosine to a power about `axis`, reflecting all: f cosθ = its density, above the horizon of `n`.
struct Lobe {
    frame: Frame<f32>,
    n: Vec3<f32>,
    exponent: f32,
}

impl Lobe {
    fn judge(&self, wi: Vec3<f32>) -> Reflected {
        let pdf = cosine_power_hemisphere_density(self.frame.to_local(wi), self.exponent);
        let f = if self.n.dot(wi) > 0.0 { pdf } else { 0.0 };
        Reflected { f_cos: [f; 3], pdf }
    }

    fn draw(&self, u: [f32; 2]) -> Vec3<f32> {
        self.frame
            .to_world(cosine_power_hemisphere(u, self.exponent))
    }
}

fn balance(env: &Environment, guide: Guide, lobe: &Lobe, rng: &mut Rng) -> f64 {
    let s = env.sample_by(guide, [rng.next_f32(), rng.next_f32()]);
    let of_light = lobe.judge(s.wi);
    let mut sum = 0.0;
    if s.pdf > 0.0 {
        sum += s.radiance[1] * of_light.f_cos[1] / (s.pdf + of_light.pdf);
    }
    let d = lobe.draw([rng.next_f32(), rng.next_f32()]);
    let drawn = lobe.judge(d);
    if drawn.f_cos[1] > 0.0 {
        let (radiance, pdf) = (env.radiance(d), env.pdf_by(guide, d));
        sum += radiance[1] * drawn.f_cos[1] / (pdf + drawn.pdf);
    }
    f64::from(sum)
}

fn product(env: &Environment, candidates: Candidates, lobe: &Lobe, rng: &mut Rng) -> f64 {
    let draw = |u: [f32; 3]| {
        let d = lobe.draw([u[0], u[1]]);
        Some((d, lobe.judge(d)))
    };
    let numbers = || [rng.next_f32(), rng.next_f32(), rng.next_f32()];
    env.sample_product(Vec3::zero(), candidates, |d| lobe.judge(d), draw, numbers)
        .map_or(0.0, |s| f64::from(s.contribution[1]))
}

/// Mean squared error and seconds of one estimate.
fn worth(mut estimate: impl FnMut(&mut Rng) -> f64) -> (f64, f64) {
    let mut rng = Rng::from_name("worth");
    let (mut sum, mut squares, count) = (0.0, 0.0, 100_000);
    for _ in 0..count {
        let x = estimate(&mut rng);
        sum += x;
        squares += x * x;
    }
    let mean = sum / f64::from(count);
    let seconds = time(|rng| {
        black_box(estimate(rng));
    });
    (squares / f64::from(count) - mean * mean, seconds)
}

fn main() {
    let env = panorama(20_000.0);
    let n = Vec3::new(0.0, 1.0, 0.0);
    println!("nanoseconds a sample with its radiance and density, 1024 × 512\n");
    for method in [
        SamplingMethod::Inversion,
        SamplingMethod::Hierarchical,
        SamplingMethod::Alias,
    ] {
        let env = env.clone().with_sampling_method(method);
        let plain = time(|rng| {
            black_box(env.sample([rng.next_f32(), rng.next_f32()]));
        });
        println!("{:<16}{:8.0}", format!("{method:?}"), 1e9 * plain);
    }
    for (name, guide) in [
        ("compensated", Guide::Compensated),
        ("cosine", Guide::Cosine(n)),
    ] {
        let one = time(|rng| {
            black_box(env.sample_by(guide, [rng.next_f32(), rng.next_f32()]));
        });
        println!("{name:<16}{:8.0}", 1e9 * one);
    }
    for (name, guide) in [
        ("many, luminance", Guide::Luminance),
        ("many, compensated", Guide::Compensated),
    ] {
        let (drawn, found) = time_many(&env, guide);
        println!(
            "{name:<18}{:8.0}, of which looked up {:.0}",
            1e9 * drawn,
            1e9 * found
        );
    }
    // A shadow ray and the ray of the reflection function cost what no bench of this crate can see: both are given 500 ns each, so that
    // the joined strategies pay for two and the product for one.
    const RAY: f64 = 500e-9;
    println!("\nefficiency against luminance, rays of 500 ns\n");
    println!(
        "{:<26}{:>12}{:>9}{:>13}{:>13}{:>13}",
        "light, lobe", "compensated", "cosine", "product 1+1", "product 4+4", "product 16+16"
    );
    for (light, env) in [
        ("sun", panorama(20_000.0)),
        ("weak sun", panorama(200.0)),
        ("even", panorama(1.0)),
    ] {
        for (name, exponent) in [("diffuse", 1.0), ("glossy", 20.0), ("sharp", 400.0)] {
            let axis = if exponent > 1.0 {
                Vec3::new(-0.2, 0.7, 0.5).normalize()
            } else {
                n
            };
            let lobe = Lobe {
                frame: Frame::from_normal(axis),
                n,
                exponent,
            };
            let joined = |guide| {
                let (error, seconds) = worth(|rng| balance(&env, guide, &lobe, rng));
                1.0 / (error * (seconds + 2.0 * RAY))
            };
            let of_product = |k| {
                let by = Candidates {
                    light: k,
                    reflection: k,
                };
                let (error, seconds) = worth(|rng| product(&env, by, &lobe, rng));
                1.0 / (error * (seconds + RAY))
            };
            let plain = joined(Guide::Luminance);
            println!(
                "{:<26}{:>12.2}{:>9.2}{:>13.2}{:>13.2}{:>13.2}",
                format!("{light}, {name}"),
                joined(Guide::Compensated) / plain,
                joined(Guide::Cosine(n)) / plain,
                of_product(1) / plain,
                of_product(4) / plain,
                of_product(16) / plain,
            );
        }
    }
}
