//! A rough gold sphere under the built-in panorama, put together in code, as a picture.
//!
//! `cargo run --release --example sphere`

use gonio::brdf::ModelSpec;
use gonio::image::tonemap::ToneMap;
use gonio::num::{Affine3, Vec3};
use gonio::render::{Film, RenderOptions, Target, render};
use gonio::scene::{Camera, Material, SceneBuilder, Shape};
use std::error::Error;
use std::ops::ControlFlow;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let film = sphere(512, 64)?;
    let path = Path::new("sphere.png");
    film.image().write_png(path, ToneMap::PbrNeutral, 0.0)?;
    println!(
        "wrote {}, noise {:.1} %",
        path.display(),
        100.0 * film.noise()
    );
    Ok(())
}

/// A square picture of `size` × `size` pixels.
pub fn sphere(size: u32, samples: u32) -> Result<Film, Box<dyn Error>> {
    let mut builder = SceneBuilder::new("sphere");
    let gold = ModelSpec::parse("torrance-sparrow:metal=gold,roughness=0.4")?;
    let gold = builder.material(Material::new("gold", &gold)?);
    let sphere = builder.shape(Shape::Sphere);
    builder.instance(sphere, Affine3::identity(), gold);
    builder.environment(gonio::preview::panorama()?);
    let scene = builder.build()?;

    let up = Vec3::new(0.0, 1.0, 0.0);
    let camera = Camera::look_at(Vec3::new(0.0, 1.0, 5.0), Vec3::zero(), up, 28.0)?;
    let options = RenderOptions {
        width: size,
        height: size,
        target: Target {
            samples,
            time: None,
            noise: None,
            adaptive: false,
        },
        ..RenderOptions::default()
    };
    let (film, _) = render(&scene, &camera, &options, |progress, _| {
        eprint!("\r{} of {} samples", progress.samples, progress.of);
        ControlFlow::Continue(())
    })?;
    eprintln!();
    Ok(film)
}
