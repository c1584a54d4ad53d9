//! Time of the calls that a renderer makes for each ray, on a 1024 × 512 panorama with a small sun.
//!
//! `cargo bench -p gonio-env`

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use gonio_env::{Environment, Layout};
use gonio_image::Image;
use gonio_num::Vec3;

const CALLS: usize = 4096;

/// Those that are looked up as they are; the others become lat-long when they are read.
const LAYOUTS: [Layout; 3] = [Layout::LatLong, Layout::Angular, Layout::MirrorBall];

fn main() {
    divan::main();
}

fn panorama(layout: Layout) -> Environment {
    let (width, height) = if layout.is_disc() {
        (512, 512)
    } else {
        (1024, 512)
    };
    let image = Image::from_fn(width, height, |x, y| {
        let sun = x.abs_diff(300) < 3 && y.abs_diff(150) < 3;
        [if sun {
            20_000.0
        } else {
            0.2 + ((x * 7 + y * 13) % 101) as f32 * 0.01
        }; 3]
    });
    Environment::from_image(image, layout).expect("a sound picture")
}

/// Points spread evenly in an incoherent order: additive recurrence with the plastic number (Roberts 2018).
fn points() -> Vec<[f32; 2]> {
    let at = |k: usize, step: f64| (0.5 + k as f64 * step).fract() as f32;
    (1..=CALLS)
        .map(|k| {
            [
                at(k, 0.754_877_666_246_692_7),
                at(k, 0.569_840_290_998_053_2),
            ]
        })
        .collect()
}

fn directions() -> Vec<Vec3<f32>> {
    let uniform = Environment::uniform([1.0; 3]);
    points().into_iter().map(|u| uniform.sample(u).wi).collect()
}

#[divan::bench(args = LAYOUTS)]
fn sample(bencher: Bencher, layout: Layout) {
    let (env, points) = (panorama(layout), points());
    bencher.counter(ItemsCount::new(CALLS)).bench(|| {
        let mut sum = 0.0;
        for u in &points {
            let s = env.sample(black_box(*u));
            sum += s.pdf + s.radiance[0] + s.wi.x;
        }
        sum
    });
}

#[divan::bench(args = LAYOUTS)]
fn radiance(bencher: Bencher, layout: Layout) {
    let (env, directions) = (panorama(layout), directions());
    bencher.counter(ItemsCount::new(CALLS)).bench(|| {
        directions
            .iter()
            .map(|d| env.radiance(black_box(*d))[0])
            .sum::<f32>()
    });
}

#[divan::bench(args = LAYOUTS)]
fn radiance_and_pdf(bencher: Bencher, layout: Layout) {
    let (env, directions) = (panorama(layout), directions());
    bencher.counter(ItemsCount::new(CALLS)).bench(|| {
        directions
            .iter()
            .map(|d| env.radiance_and_pdf(black_box(*d)))
            .map(|(radiance, pdf)| radiance[0] + pdf)
            .sum::<f32>()
    });
}

#[divan::bench]
fn build_lat_long() -> Environment {
    panorama(Layout::LatLong)
}

#[divan::bench(sample_count = 10, sample_size = 1)]
fn info_lat_long(bencher: Bencher) {
    let env = panorama(Layout::LatLong);
    bencher.bench(|| env.info());
}
