//! Times of what `gonio env prefilter` does: the tree, levels, harmonics, the table.

use divan::Bencher;
use gonio_env::{Environment, Layout};
use gonio_ibl::lights::{Cut, extract};
use gonio_ibl::{DEFAULT_TOLERANCE, Dfg, Harmonics, Kernel, LightTree, Maps, Method, Target};
use gonio_image::Image;
use std::sync::OnceLock;

fn main() {
    divan::main();
}

/// 2048 × 1024 with a sun.
fn sky() -> &'static Environment {
    static SKY: OnceLock<Environment> = OnceLock::new();
    SKY.get_or_init(|| {
        let image = Image::from_fn(2048, 1024, |x, y| match (x, y) {
            (600..606, 300..306) => [6000.0; 3],
            _ => [
                0.2 + 0.1 * ((x / 16 + y / 16) % 2) as f32,
                0.4,
                1.0 - y as f32 / 1100.0,
            ],
        });
        Environment::from_image(image, Layout::LatLong).expect("a sound picture")
    })
}

#[divan::bench(sample_count = 5)]
fn tree(bencher: Bencher) {
    let sky = sky();
    bencher.bench(|| LightTree::new(sky, 0.01));
}

/// Levels of a cube of 256², as Filament wants them.
#[divan::bench(sample_count = 5, args = [1, 2, 3, 5, 8])]
fn level(bencher: Bencher, level: usize) {
    let kernel = Kernel::ggx(Target::Filament.roughness(level, 9)).expect("in range");
    let method = Method::Tree(DEFAULT_TOLERANCE);
    let maps = Maps::new(sky(), 0.0083, method);
    bencher.bench(|| maps.cube(&kernel, 256 >> level, Target::Filament, method));
}

#[divan::bench(sample_count = 10, args = [3, 10])]
fn harmonics(bencher: Bencher, bands: usize) {
    let sky = sky();
    bencher.bench(|| Harmonics::of_radiance(sky, bands));
}

#[divan::bench(sample_count = 10)]
fn table() -> Dfg {
    Dfg::new("ggx", 128, 128).expect("a model with a roughness")
}

#[divan::bench(sample_count = 5)]
fn lights(bencher: Bencher) {
    let sky = sky();
    bencher.bench(|| extract(sky, 64, Cut::Variance));
}
