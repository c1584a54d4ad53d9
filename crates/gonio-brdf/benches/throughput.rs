//! Prints how many values a second a batch of a model gives on one thread, for comparison with other programs.
//!
//! `cargo bench -p gonio-brdf --bench throughput -- 'ggx:alpha=0.2,metal=gold' 1048576`
//!
//! One line each for eval, pdf and sample: the name and 10⁶ values a second, the best of 15 runs over random directions (on the sphere
//! for a model that transmits), which are read from memory and written there.

use gonio_brdf::batch::{self, Directions, Samples};
use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};
use gonio_radiometry::{sequence::Rng, warp::around_axis};
use std::hint::black_box;
use std::time::Instant;

const RUNS: usize = 15;

fn main() -> Result<(), BrdfError> {
    // Cargo adds `--bench`.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let text = arguments.next().unwrap_or_else(|| "lambertian".into());
    let count = arguments
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(1 << 20);
    let model: Model<f32, 3> = ModelSpec::parse(&text)?.build()?;
    let mut rng = Rng::from_name("throughput");
    let through = model.transmits();
    let mut directions = || {
        let mut out = [(); 3].map(|()| Vec::with_capacity(count));
        for _ in 0..count {
            let mut z = rng.next_f32().max(1e-3);
            let turn = rng.next_f32();
            if through && rng.next_f32() < 0.5 {
                z = -z;
            }
            let w = around_axis(turn, (1.0 - z * z).sqrt(), z);
            for (out, x) in out.iter_mut().zip(w.to_array()) {
                out.push(x);
            }
        }
        out
    };
    let (wi, wo) = (directions(), directions());
    let u = [(); 3].map(|()| (0..count).map(|_| rng.next_f32()).collect::<Vec<_>>());
    let mut out = [(); 7].map(|()| vec![0.0f32; count]);
    let mut delta = vec![false; count];
    let [a, b, c, d, e, f, g] = &mut out;

    report("eval", count, || {
        batch::eval(&model, view(&wi), view(&wo), [a, b, c]);
    });
    report("pdf", count, || {
        batch::pdf(&model, view(&wi), view(&wo), a);
    });
    report("sample", count, || {
        let samples = Samples {
            wi: [a, b, c],
            weight: [d, e, f],
            pdf: g,
            delta: &mut delta,
        };
        batch::sample(&model, view(&wo), [&u[0], &u[1], &u[2]], samples);
    });
    black_box(&out);
    Ok(())
}

fn view(v: &[Vec<f32>; 3]) -> Directions<'_> {
    Directions {
        x: &v[0],
        y: &v[1],
        z: &v[2],
    }
}

fn report(name: &str, count: usize, mut run: impl FnMut()) {
    let mut rates: Vec<f64> = (0..=RUNS)
        .map(|_| {
            let start = Instant::now();
            run();
            count as f64 / start.elapsed().as_secs_f64() / 1e6
        })
        .skip(1)
        .collect();
    rates.sort_by(f64::total_cmp);
    println!("{name} {:.2}", rates[RUNS - 1]);
}
