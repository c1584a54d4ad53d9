//! [`take_pass`]: a range of samples of every pixel.

use crate::film::{self, Film, PixelSums, Rejected};
use crate::{RayCounts, RenderOptions};
use gonio_num::Vec3;
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{Camera, Interior, Scene};
use rayon::prelude::*;

/// Adds the samples `range` to every pixel.
pub(crate) fn take_pass(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    film: &mut Film,
    range: std::ops::Range<u32>,
) -> RayCounts {
    let rows: Vec<&mut [PixelSums]> = film.rows_mut().collect();
    let parts: Vec<(RayCounts, Rejected)> = rows
        .into_par_iter()
        .enumerate()
        .map(|(y, row)| {
            let mut counts = RayCounts::default();
            let mut rejected = Rejected::default();
            let mut around = Surroundings::of(scene);
            for (x, sums) in row.iter_mut().enumerate() {
                let pixel = [x as u32, y as u32];
                for k in range.clone() {
                    let sample = take_sample(camera, options, pixel, k, &mut around, &mut counts);
                    film::add(sums, sample, pixel, k, &mut rejected);
                }
            }
            (counts, rejected)
        })
        .collect();
    let mut counts = RayCounts::default();
    for (c, rejected) in parts {
        counts += c;
        film.note_rejected(rejected);
    }
    counts
}

/// Sample `k` of `pixel`: a function of (seed, pixel, k) alone.
fn take_sample(
    camera: &Camera,
    options: &RenderOptions,
    pixel: [u32; 2],
    k: u32,
    around: &mut Surroundings<'_>,
    counts: &mut RayCounts,
) -> film::FilmSample {
    let (width, height) = (options.width, options.height);
    let index = pixel[1] * width + pixel[0];
    let mut stream = SampleStream::new(options.sampler, options.seed, index, k);
    let offset = options.filter.sample(stream.next_2d());
    let lens = stream.next_2d();
    let on_film = [
        (pixel[0] as f32 + offset[0]) / width as f32,
        (pixel[1] as f32 + offset[1]) / height as f32,
    ];
    let ray = camera.ray(on_film, width as f32 / height as f32, lens);
    let scene = around.scene;
    let interior = around.at(ray.origin);
    options
        .integrator
        .radiance(scene, &ray, interior, &mut stream, counts)
}

/// The bodies that rays start in. Most cameras start all rays at one point, so the last one is remembered.
struct Surroundings<'a> {
    scene: &'a Scene,
    last: (Vec3<f32>, Interior),
}

impl<'a> Surroundings<'a> {
    fn of(scene: &'a Scene) -> Self {
        // NaN is equal to no point.
        let nowhere = Vec3::splat(f32::NAN);
        Self {
            scene,
            last: (nowhere, Interior::OUTSIDE),
        }
    }

    /// [`Scene::interior_at`].
    fn at(&mut self, p: Vec3<f32>) -> &Interior {
        if self.scene.has_absorption() && self.last.0 != p {
            self.last = (p, self.scene.interior_at(p));
        }
        &self.last.1
    }
}
