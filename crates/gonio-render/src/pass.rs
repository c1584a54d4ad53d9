//! [`take_pass`]: a range of samples of every pixel.

use crate::film::{self, Film, FilmSample, PixelSums, Rejected};
use crate::integrator::wavefront::{WAVE, Wavefront};
use crate::{RayCounts, RenderOptions};
use gonio_num::Vec3;
use gonio_radiometry::sequence::{SampleStream, SampleStreams, SamplerKind};
use gonio_scene::{Camera, Interior, Ray, Scene};
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
        .map_init(
            || Wavefront::new(scene, &options.integrator, options.sampler).map(Row::of),
            |waves, (y, row)| match waves {
                Some(waves) => waves.take(camera, options, y as u32, row, range.clone()),
                None => take_row(scene, camera, options, y as u32, row, range.clone()),
            },
        )
        .collect();
    let mut counts = RayCounts::default();
    for (c, rejected) in parts {
        counts += c;
        film.note_rejected(rejected);
    }
    counts
}

/// The samples of a row, one after the other.
fn take_row(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    y: u32,
    row: &mut [PixelSums],
    range: std::ops::Range<u32>,
) -> (RayCounts, Rejected) {
    let mut counts = RayCounts::default();
    let mut rejected = Rejected::default();
    let mut around = Surroundings::of(scene);
    for (x, sums) in row.iter_mut().enumerate() {
        let pixel = [x as u32, y];
        for k in range.clone() {
            let (ray, mut stream) = camera_ray(camera, options, pixel, k);
            let interior = around.at(ray.origin);
            let integrator = &options.integrator;
            let sample = integrator.radiance(scene, &ray, interior, &mut stream, &mut counts);
            film::add(sums, sample, pixel, k, &mut rejected);
        }
    }
    (counts, rejected)
}

/// The samples of a row in waves.
struct Row<'a> {
    waves: Wavefront<'a>,
    places: Vec<(u32, u32)>,
    rays: Vec<Ray>,
    streams: SampleStreams,
    samples: Vec<FilmSample>,
}

impl<'a> Row<'a> {
    fn of(waves: Wavefront<'a>) -> Self {
        Self {
            waves,
            places: Vec::new(),
            rays: Vec::new(),
            streams: SampleStreams::new(SamplerKind::default()),
            samples: Vec::new(),
        }
    }

    fn take(
        &mut self,
        camera: &Camera,
        options: &RenderOptions,
        y: u32,
        row: &mut [PixelSums],
        range: std::ops::Range<u32>,
    ) -> (RayCounts, Rejected) {
        let mut counts = RayCounts::default();
        let mut rejected = Rejected::default();
        self.streams = SampleStreams::new(options.sampler);
        let places = (0..row.len() as u32).flat_map(|x| range.clone().map(move |k| (x, k)));
        let mut places = places.peekable();
        while places.peek().is_some() {
            self.places.clear();
            self.rays.clear();
            self.streams.clear();
            for (x, k) in places.by_ref().take(WAVE) {
                let (ray, stream) = camera_ray(camera, options, [x, y], k);
                self.places.push((x, k));
                self.rays.push(ray);
                self.streams.push(&stream);
            }
            let samples = &mut self.samples;
            self.waves
                .radiance(&self.rays, &self.streams, samples, &mut counts);
            for (sample, &(x, k)) in samples.iter().zip(&self.places) {
                let sums = &mut row[x as usize];
                film::add(sums, *sample, [x, y], k, &mut rejected);
            }
        }
        (counts, rejected)
    }
}

/// The ray of sample `k` of `pixel`, and the numbers that its path goes on with: functions of (seed, pixel, k) alone.
fn camera_ray(
    camera: &Camera,
    options: &RenderOptions,
    pixel: [u32; 2],
    k: u32,
) -> (Ray, SampleStream) {
    let (width, height) = (options.width, options.height);
    let index = pixel[1] * width + pixel[0];
    let mut stream = SampleStream::new(options.sampler, options.seed, index, k);
    let offset = options.filter.sample(stream.next_2d());
    let lens = stream.next_2d();
    let on_film = [
        (pixel[0] as f32 + offset[0]) / width as f32,
        (pixel[1] as f32 + offset[1]) / height as f32,
    ];
    let aspect = width as f32 / height as f32;
    (camera.ray(on_film, aspect, lens), stream)
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
