//! Evaluations per second: single calls against batches over lanes.
//!
//! `cargo bench -p gonio-brdf --bench evaluate`; 4096 pairs of directions, which stay in the cache; one thread.

use divan::{Bencher, black_box, counter::ItemsCount};
use gonio_brdf::batch::{self, Directions, Samples};
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;

const COUNT: usize = 4096;
const MODELS: &[&str] = &[
    "lambertian",
    "oren-nayar",
    "eon",
    "burley",
    "lafortune",
    "ward",
    "ward-duer:normalisation=bounded",
    "ashikhmin-shirley",
    "ashikhmin-premoze",
    "bagher",
    "low-microfacet",
    "low-smooth",
    "sheen-charlie",
    "sheen-ltc",
    "retro-reflective:interreflection=none",
    "toon",
    "gooch",
    "ggx:interreflection=none",
    "ggx:metal=gold,interreflection=none",
    "ggx:metal=gold",
    "gltf:metallic=0.5",
];

fn main() {
    divan::main();
}

fn model(text: &str) -> Model<f32, 3> {
    ModelSpec::parse(text)
        .and_then(|spec| spec.build())
        .expect("invariant: the descriptions above are right")
}

fn vectors(name: &str) -> Vec<Vec3<f32>> {
    let mut rng = Rng::from_name(name);
    let draw = |_| {
        let (z, turn) = (0.05 + 0.95 * rng.next_f32(), rng.next_f32());
        gonio_radiometry::warp::around_axis(turn, (1.0 - z * z).sqrt(), z)
    };
    (0..COUNT).map(draw).collect()
}

fn split(v: &[Vec3<f32>]) -> [Vec<f32>; 3] {
    [0, 1, 2].map(|k| v.iter().map(|v| v[k]).collect())
}

fn view(v: &[Vec<f32>; 3]) -> Directions<'_> {
    Directions {
        x: &v[0],
        y: &v[1],
        z: &v[2],
    }
}

#[divan::bench(args = MODELS)]
fn eval_single(bencher: Bencher, text: &str) {
    let (model, wi, wo) = (model(text), vectors("wi"), vectors("wo"));
    let mut out = vec![[0.0; 3]; COUNT];
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let model = black_box(&model);
        for k in 0..COUNT {
            out[k] = model.eval(wi[k], wo[k]);
        }
        black_box(&mut out);
    });
}

#[divan::bench(args = MODELS)]
fn eval_batch(bencher: Bencher, text: &str) {
    let (model, wi, wo) = (model(text), split(&vectors("wi")), split(&vectors("wo")));
    let mut out = [0, 1, 2].map(|_| vec![0.0; COUNT]);
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let [r, g, b] = &mut out;
        batch::eval(black_box(&model), view(&wi), view(&wo), [r, g, b]);
        black_box(&mut out);
    });
}

#[divan::bench(args = MODELS)]
fn pdf_single(bencher: Bencher, text: &str) {
    let (model, wi, wo) = (model(text), vectors("wi"), vectors("wo"));
    let mut out = vec![0.0; COUNT];
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let model = black_box(&model);
        for k in 0..COUNT {
            out[k] = model.pdf(wi[k], wo[k]);
        }
        black_box(&mut out);
    });
}

#[divan::bench(args = MODELS)]
fn pdf_batch(bencher: Bencher, text: &str) {
    let (model, wi, wo) = (model(text), split(&vectors("wi")), split(&vectors("wo")));
    let mut out = vec![0.0; COUNT];
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        batch::pdf(black_box(&model), view(&wi), view(&wo), &mut out);
        black_box(&mut out);
    });
}

#[divan::bench(args = MODELS)]
fn sample_single(bencher: Bencher, text: &str) {
    let (model, wo, u) = (model(text), vectors("wo"), numbers());
    let mut out = vec![([0.0; 3], 0.0); COUNT];
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let model = black_box(&model);
        for k in 0..COUNT {
            let s = model.sample(wo[k], [u[0][k], u[1][k], u[2][k]]);
            out[k] = (s.weight, s.pdf + s.wi.x);
        }
        black_box(&mut out);
    });
}

#[divan::bench(args = MODELS)]
fn sample_batch(bencher: Bencher, text: &str) {
    let (model, wo, u) = (model(text), split(&vectors("wo")), numbers());
    let mut wi = [0, 1, 2].map(|_| vec![0.0; COUNT]);
    let mut weight = [0, 1, 2].map(|_| vec![0.0; COUNT]);
    let (mut pdf, mut delta) = (vec![0.0; COUNT], vec![false; COUNT]);
    bencher.counter(ItemsCount::new(COUNT)).bench_local(|| {
        let [x, y, z] = &mut wi;
        let [r, g, b] = &mut weight;
        let samples = Samples {
            wi: [x, y, z],
            weight: [r, g, b],
            pdf: &mut pdf,
            delta: &mut delta,
        };
        batch::sample(black_box(&model), view(&wo), [&u[0], &u[1], &u[2]], samples);
        black_box((&mut wi, &mut weight, &mut pdf));
    });
}

fn numbers() -> [Vec<f32>; 3] {
    let mut rng = Rng::from_name("u");
    [0, 1, 2].map(|_| (0..COUNT).map(|_| rng.next_f32()).collect())
}
