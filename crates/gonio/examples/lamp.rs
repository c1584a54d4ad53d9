//! The irradiance under a rectangular lamp: sampled in a scene put together in code, and in closed form.
//!
//! `cargo run --release --example lamp`

use gonio::brdf::ModelSpec;
use gonio::num::{Affine3, Vec3};
use gonio::radiometry::quantity::{Irradiance, ProjectedSolidAngle, Radiance};
use gonio::radiometry::solid_angle::projected;
use gonio::render::sensor::{self, Reading, SensorOptions};
use gonio::scene::{Material, SceneBuilder, Shape};
use std::error::Error;
use std::f32::consts::FRAC_PI_2;

/// Half the lamp's sides \[m], its height \[m] and its radiance \[W m⁻² sr⁻¹].
const HALF: [f64; 2] = [1.0, 0.5];
const HEIGHT: f64 = 2.0;
const RADIANCE: f64 = 10.0;

fn main() -> Result<(), Box<dyn Error>> {
    let (sampled, exact) = (sampled(1 << 16)?, closed_form());
    let error = sampled.standard_error.map_or(0.0, |e| e[0]);
    println!(
        "sampled      {:.6} ± {error:.6} {}",
        sampled.value[0], sampled.unit
    );
    println!("closed form  {exact:.6}");
    Ok(())
}

/// E = L Ω⊥: the lamp is four rectangles with a corner above the point.
pub fn closed_form() -> Irradiance<f64> {
    let quarter = projected::rectangle_parallel_at_corner(HALF[0], HALF[1], HEIGHT);
    Radiance::new(RADIANCE) * ProjectedSolidAngle::new(4.0 * quarter)
}

/// The reading of a sensor below the middle of the lamp.
pub fn sampled(samples: u64) -> Result<Reading, Box<dyn Error>> {
    let mut builder = SceneBuilder::new("lamp");
    let mut lamp = Material::new("lamp", &ModelSpec::parse("lambertian:reflectance=0")?)?;
    lamp.emission.radiance = [RADIANCE as f32; 3];
    let lamp = builder.material(lamp);
    let rectangle = builder.shape(Shape::Rectangle);
    // The rectangle looks along +z: turn it to face down.
    let size = Vec3::new(HALF[0], HALF[1], 1.0).to_f32();
    let placed = Affine3::scale(size)
        .then(&Affine3::rotation(Vec3::new(1.0, 0.0, 0.0), FRAC_PI_2))
        .then(&Affine3::translation(Vec3::new(0.0, HEIGHT as f32, 0.0)));
    builder.instance(rectangle, placed, lamp);
    let scene = builder.build()?;
    let options = SensorOptions {
        samples,
        ..SensorOptions::default()
    };
    let (point, normal) = (Vec3::zero(), Vec3::new(0.0, 1.0, 0.0));
    Ok(sensor::irradiance(&scene, point, normal, &options)?)
}
