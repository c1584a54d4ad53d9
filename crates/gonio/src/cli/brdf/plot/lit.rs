//! Balls under a panorama, by the renderer.

use super::subject::Subject;
use crate::cli::failure::Failure;
use crate::preview;
use gonio_env::Environment;
use gonio_image::tonemap::ToneMap;
use gonio_num::Affine3;
use gonio_plot::{Figure, Options, Picture};
use gonio_render::{RenderOptions, render};
use gonio_scene::{Material, SceneBuilder, Shape};
use indicatif::ProgressBar;
use std::ops::ControlFlow;

/// A ball of each subject, its frame's tangent along the circles of latitude, under `light`: `panorama` for the embedded one, a panorama's file, or
/// `uniform:RADIANCE`.
pub(super) fn sphere(
    subjects: &[Subject],
    options: &Options,
    light: &str,
    bar: &ProgressBar,
) -> Result<Figure, Failure> {
    let (environment, words) = if light == "panorama" {
        let words = "Under the embedded panorama, dawn on the Piazzetta in Venice";
        (preview::panorama()?, words.to_owned())
    } else {
        let environment = Environment::parse(light, &Default::default())?;
        (environment, format!("Under {light}"))
    };
    let side = gonio_plot::picture_side(subjects.len(), options).round() as u32;
    let mut pictures = Vec::new();
    for (k, subject) in subjects.iter().enumerate() {
        let mut builder = SceneBuilder::new("ball");
        let material = builder.material(Material::new("ball", &subject.spec)?);
        let shape = builder.shape(Shape::Sphere);
        builder.instance(shape, Affine3::identity(), material);
        builder.environment(environment.clone());
        let scene = builder.build()?;
        let film = RenderOptions {
            width: side,
            height: side,
            ..RenderOptions::default()
        };
        let (film, _) = render(
            &scene,
            &scene.camera_or_framing(1.0),
            &film,
            |progress, _| {
                let share = f64::from(progress.samples) / f64::from(progress.of);
                let done = 100.0 * (k as f64 + share) / subjects.len() as f64;
                bar.set_message(format!("{done:.0} %"));
                ControlFlow::Continue(())
            },
        )?;
        pictures.push(Picture {
            name: subject.name.clone(),
            size: [side, side],
            rgb: film.image().to_srgb8(ToneMap::PbrNeutral, 0.0),
        });
    }
    Ok(gonio_plot::pictures(&pictures, options, &words)?)
}
