//! Prints the table of the book's page on capture: simulated photographs of a known panorama, captured, and their errors.
//!
//! `cargo run --release -p gonio-capture --example evidence`

#[path = "../tests/evidence/mod.rs"]
mod evidence;

fn main() {
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
