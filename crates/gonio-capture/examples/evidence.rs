//! Prints the table of the book's page on capture: simulated photographs of a known panorama, captured, and their errors.
//!
//! `cargo run --release -p gonio-capture --example evidence [PHOTO [STEPS]]`; with a photograph it is captured instead and the steps timed, and explained
//! in the folder STEPS.

#[path = "../tests/evidence/mod.rs"]
mod evidence;

use gonio_capture::{Options, Photo, capture};
use std::path::Path;
use std::time::Instant;

fn main() {
    if let Some(photo) = std::env::args().nth(1) {
        let start = Instant::now();
        let photo = Photo::read(Path::new(&photo)).expect("a photograph");
        println!("read {:.2} s", start.elapsed().as_secs_f64());
        let options = Options {
            fill: true,
            explain: std::env::args().nth(2).map(Into::into),
            ..Options::default()
        };
        let mut steps = Vec::new();
        let found = capture(&[photo], &options, &mut |step, _| {
            steps.push((step.to_owned(), start.elapsed().as_secs_f64()));
        })
        .expect("a ball");
        for pair in steps.windows(2) {
            println!("{} {:.2} s", pair[0].0, pair[1].1 - pair[0].1);
        }
        println!(
            "all {:.2} s: {:?}",
            start.elapsed().as_secs_f64(),
            found.views[0].outline.ball
        );
        return;
    }
    println!(
        "| photographs | direction, median / 95 % | radiance, median / 95 % | irradiance, worst of 26 normals |"
    );
    println!("|---|---|---|---|");
    for (name, e) in evidence::table() {
        println!(
            "| {name} | {:.3}° / {:.3}° | {:.2} % / {:.1} % | {:.2} % |",
            e.direction[0],
            e.direction[1],
            100.0 * e.radiance[0],
            100.0 * e.radiance[1],
            100.0 * e.irradiance
        );
    }
}
