//! How much light a panorama sheds on a floor, a ceiling and four walls, in W m⁻².
//!
//! `cargo run --release --example panorama -- sky.hdr`

use gonio::env::Environment;
use gonio::num::Vec3;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let environment = match std::env::args().nth(1) {
        Some(file) => Environment::load(file, None)?,
        None => gonio::preview::panorama()?,
    };
    for (name, [r, g, b]) in irradiances(&environment) {
        println!("{name:8} {r:10.4} {g:10.4} {b:10.4} W m⁻²");
    }
    Ok(())
}

/// Irradiance (7) on surfaces that face these ways.
pub fn irradiances(environment: &Environment) -> [(&'static str, [f64; 3]); 6] {
    [
        ("floor", Vec3::new(0.0, 1.0, 0.0)),
        ("ceiling", Vec3::new(0.0, -1.0, 0.0)),
        ("front", Vec3::new(0.0, 0.0, -1.0)),
        ("back", Vec3::new(0.0, 0.0, 1.0)),
        ("left", Vec3::new(-1.0, 0.0, 0.0)),
        ("right", Vec3::new(1.0, 0.0, 0.0)),
    ]
    .map(|(name, normal)| (name, environment.irradiance(normal)))
}
