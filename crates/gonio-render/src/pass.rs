//! [`take_pass`]: a range of samples of every pixel, or as many more of some.

use crate::film::{Film, FilmRow, Place, Rejected};
use crate::integrator::dimension;
use crate::integrator::shares::{Shares, Split};
use crate::integrator::wavefront::{Gathered, Plan, Wavefront};
use crate::integrator::worth::{Judge, Worth};
use crate::{RayCounts, RenderOptions};
use gonio_num::{Vec3, Vectors};
use gonio_radiometry::sequence::{SampleStream, SampleStreams, SamplerKind};
use gonio_scene::{Camera, Interior, Ray, Scene};
use rayon::prelude::*;
use std::ops::Range;

/// Which samples a pass takes.
#[derive(Debug, Clone)]
pub(crate) enum Wanted<'a> {
    /// These of every pixel.
    All(Range<u32>),
    /// The next `count` of some pixels, up to and without the sample `end`.
    Of {
        /// For each pixel, row after row.
        pixels: &'a [bool],
        /// Index of the first sample that a pixel has.
        first: u32,
        count: u32,
        end: u32,
    },
}

impl Wanted<'_> {
    /// The samples of the pixel at `place` in the picture, which has `done` of them.
    fn of(&self, place: usize, done: u32) -> Range<u32> {
        match self {
            Self::All(range) => range.clone(),
            Self::Of { pixels, .. } if !pixels[place] => 0..0,
            Self::Of {
                first, count, end, ..
            } => {
                let next = first + done;
                next..next.saturating_add(*count).min(*end)
            }
        }
    }

    /// Those of each pixel of row `y`.
    pub fn of_row(&self, y: u32, row: &FilmRow<'_>) -> Vec<Range<u32>> {
        let before = y as usize * row.len();
        (0..row.len())
            .map(|x| self.of(before + x, row.samples(x)))
            .collect()
    }
}

/// Adds samples to the pixels.
pub(crate) fn take_pass(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    film: &mut Film,
    wanted: &Wanted<'_>,
    worth: Option<&Worth>,
) -> RayCounts {
    let split = Split::new(&film.kept(), &scene.lights);
    let plan = Plan::new(scene, &options.integrator, &split, worth);
    let parts: Vec<(RayCounts, Rejected)> = film
        .rows_mut()
        .into_par_iter()
        .enumerate()
        .map_init(
            || plan.as_ref().map(Row::new),
            |waves, (y, mut row)| match waves {
                Some(waves) => waves.take(camera, options, y as u32, &mut row, wanted),
                None => {
                    let shot = (scene, camera, options, &split, worth);
                    take_row(shot, y as u32, &mut row, wanted)
                }
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

/// What is taken, and how.
type Shooting<'a> = (
    &'a Scene,
    &'a Camera,
    &'a RenderOptions,
    &'a Split,
    Option<&'a Worth>,
);

/// The samples of a row, one after the other.
fn take_row(
    (scene, camera, options, split, worth): Shooting<'_>,
    y: u32,
    row: &mut FilmRow<'_>,
    wanted: &Wanted<'_>,
) -> (RayCounts, Rejected) {
    let mut counts = RayCounts::default();
    let mut rejected = Rejected::default();
    let mut around = Surroundings::of(scene);
    let mut values = vec![[0.0; 3]; split.count()];
    for (x, range) in (0..).zip(wanted.of_row(y, row)) {
        for index in range {
            let shot = camera_ray(camera, options, [x, y], index);
            let interior = around.at(shot.ray.origin);
            values.fill([0.0; 3]);
            let mut shares = Shares {
                split,
                values: &mut values,
            };
            let mut stream = shot.stream;
            let sample = options.integrator.radiance_in_shares(
                scene,
                &shot.ray,
                interior,
                &mut stream,
                &mut counts,
                &mut shares,
                worth.map(|worth| Judge::of(worth, options, [x, y])),
            );
            let place = Place {
                pixel: [x, y],
                index,
                off_centre: shot.off_centre,
            };
            row.add(&sample, &values, &place, &mut rejected);
        }
    }
    (counts, rejected)
}

/// The samples of a row in waves.
struct Row<'a> {
    waves: Wavefront<'a>,
    /// Samples in a wave.
    wave: usize,
    places: Vec<(u32, u32)>,
    streams: SampleStreams,
    offset: [Vec<f32>; 2],
    lens: [Vec<f32>; 2],
    off_centre: Vec<f32>,
    /// Of each sample's pixel, where roulette knows the scene.
    importance: Vec<f32>,
    worth: Option<&'a Worth>,
    origins: Vectors,
    directions: Vectors,
    light: Gathered<'a>,
}

impl<'a> Row<'a> {
    fn new(plan: &'a Plan<'a>) -> Self {
        Self {
            waves: Wavefront::new(plan),
            wave: plan.wave(),
            places: Vec::new(),
            streams: SampleStreams::new(SamplerKind::default()),
            offset: [const { Vec::new() }; 2],
            lens: [const { Vec::new() }; 2],
            off_centre: Vec::new(),
            importance: Vec::new(),
            worth: plan.worth(),
            origins: Vectors::default(),
            directions: Vectors::default(),
            light: Gathered::new(plan),
        }
    }

    fn take(
        &mut self,
        camera: &Camera,
        options: &RenderOptions,
        y: u32,
        row: &mut FilmRow<'_>,
        wanted: &Wanted<'_>,
    ) -> (RayCounts, Rejected) {
        let mut counts = RayCounts::default();
        let mut rejected = Rejected::default();
        self.streams = SampleStreams::new(options.sampler);
        let ranges = (0..).zip(wanted.of_row(y, row));
        let places = ranges.flat_map(|(x, range)| range.map(move |k| (x, k)));
        let mut places = places.peekable();
        while places.peek().is_some() {
            self.places.clear();
            self.places.extend(places.by_ref().take(self.wave));
            self.start(camera, options, y);
            let (light, rays) = (&mut self.light, [&self.origins, &self.directions]);
            let importance = &self.importance;
            (self.waves).radiance(rays, &self.streams, importance, light, &mut counts);
            let places = self.places.iter().zip(&self.off_centre);
            let places = places.map(|(&(x, index), &off_centre)| Place {
                pixel: [x, y],
                index,
                off_centre,
            });
            let (samples, shares) = light.samples_and_shares();
            row.add_many(samples, shares, places, &mut rejected);
        }
        (counts, rejected)
    }

    /// The camera's rays of the wave, as [`camera_ray`] has them one by one.
    fn start(&mut self, camera: &Camera, options: &RenderOptions, y: u32) {
        let (width, height) = (options.width, options.height);
        self.importance.clear();
        if let Some(worth) = self.worth {
            let of = |&(x, _): &(u32, u32)| worth.importance(options, [x, y]);
            self.importance.extend(self.places.iter().map(of));
        }
        self.streams.clear();
        for &(x, k) in &self.places {
            let (sequence, index) = options.screen.place(width, [x, y], k);
            let stream = SampleStream::new(options.sampler, options.seed, sequence, index);
            self.streams.push(&stream);
        }
        for column in (self.offset.iter_mut())
            .chain(&mut self.lens)
            .chain([&mut self.off_centre])
        {
            column.resize(self.places.len(), 0.0);
        }
        let [u, v] = &mut self.offset;
        self.streams.draw(dimension::FILM, [&mut *u, &mut *v]);
        for (i, &(x, _)) in self.places.iter().enumerate() {
            let [dx, dy] = options.filter.sample([u[i], v[i]]);
            self.off_centre[i] = off_centre([dx, dy]);
            u[i] = (x as f32 + dx) / width as f32;
            v[i] = (y as f32 + dy) / height as f32;
        }
        if camera.has_lens() {
            let [a, b] = &mut self.lens;
            self.streams.draw(dimension::LENS, [a, b]);
        }
        let film = [&self.offset[0][..], &self.offset[1]];
        let lens = [&self.lens[0][..], &self.lens[1]];
        let rays = [&mut self.origins, &mut self.directions];
        camera.rays(film, width as f32 / height as f32, lens, rays);
    }
}

/// A sample before its path.
struct Shot {
    ray: Ray,
    /// The numbers that its path goes on with.
    stream: SampleStream,
    off_centre: f32,
}

/// Sample `k` of `pixel`: a function of (seed, pixel, k) and the options alone.
fn camera_ray(camera: &Camera, options: &RenderOptions, pixel: [u32; 2], k: u32) -> Shot {
    let (width, height) = (options.width, options.height);
    let (sequence, index) = options.screen.place(width, pixel, k);
    let mut stream = SampleStream::new(options.sampler, options.seed, sequence, index);
    let offset = options.filter.sample(stream.next_2d());
    let lens = stream.next_2d();
    let on_film = [
        (pixel[0] as f32 + offset[0]) / width as f32,
        (pixel[1] as f32 + offset[1]) / height as f32,
    ];
    let aspect = width as f32 / height as f32;
    Shot {
        ray: camera.ray(on_film, aspect, lens),
        stream,
        off_centre: off_centre(offset),
    }
}

/// Squared distance from a pixel's middle, in pixels.
///
/// - `offset`: from its upper left corner
fn off_centre([x, y]: [f32; 2]) -> f32 {
    let (x, y) = (x - 0.5, y - 0.5);
    x * x + y * y
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Integrator;
    use crate::film::Kept;
    use crate::integrator::{EnvironmentSampling, LightChoice, Path, Roulette};
    use gonio_brdf::ModelSpec;
    use gonio_env::{Environment, Layout};
    use gonio_image::Image;
    use gonio_num::Affine3;
    use gonio_scene::{Light, Material, SceneBuilder, Shape, TriangleMesh};
    use std::sync::Arc;

    fn material(spec: &str) -> Material {
        Material::new(spec, &ModelSpec::parse(spec).unwrap()).unwrap()
    }

    fn placed(scale: [f32; 3], at: [f32; 3]) -> Affine3<f32> {
        Affine3::scale(scale.into()).then(&Affine3::translation(at.into()))
    }

    /// A pyramid with the given attributes.
    fn pyramid(normals: bool, colours: bool) -> Shape {
        let corners = [
            [-1.0, 0.0, -1.0],
            [1.0, 0.0, -1.0],
            [0.0, 0.0, 1.0],
            [0.0, 1.5, 0.0],
        ];
        let mut mesh = TriangleMesh {
            positions: corners.map(Into::into).to_vec(),
            indices: vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]],
            ..TriangleMesh::default()
        };
        if normals {
            mesh.normals = corners.map(|[x, y, z]| Vec3::new(x, y - 0.3, z)).to_vec();
            mesh.normals[1] = Vec3::zero();
        }
        if colours {
            mesh.colours = (0..4).map(|k| [0.2 * k as f32, 0.5, 0.9, 1.0]).collect();
        }
        Shape::Mesh(Arc::new(mesh))
    }

    /// One of each shape, each kind of light, and models of all sorts: that reflect, transmit, are discrete, made of others, and differ
    /// from point to point.
    fn everything(environment: Environment) -> (Scene, Camera) {
        let mut scene = SceneBuilder::new("everything");
        let floor = scene.shape(Shape::Rectangle);
        let grey = scene.material(material("lambertian:reflectance=0.5"));
        let level = Affine3::rotation(Vec3::new(1.0, 0.0, 0.0), -std::f32::consts::FRAC_PI_2);
        let wide = Affine3::scale(Vec3::splat(12.0)).then(&level);
        scene.instance(floor, wide, grey);
        let sphere = scene.shape(Shape::Sphere);
        for (k, spec) in [
            "ggx:metal=gold,alpha=0.3",
            "rough-dielectric:alpha=0.2",
            "smooth-dielectric",
            "mirror",
            "sum(lambertian:reflectance=0.3, ggx:alpha=0.1)",
            "coat(lambertian:reflectance=0.4)",
            "disney:base_color=0.7/0.2/0.1,clearcoat=0.5",
        ]
        .into_iter()
        .enumerate()
        {
            let m = scene.material(material(spec));
            let x = k as f32 - 3.0;
            scene.instance(
                sphere,
                placed([0.45, 0.6, 0.45], [x, 0.6, (k % 2) as f32]),
                m,
            );
        }
        let mut lamp = material("lambertian:reflectance=0.2");
        lamp.emission.radiance = [6.0, 5.0, 4.0];
        lamp.emission.group = Some("lamps".into());
        let lamp = scene.material(lamp);
        scene.instance(sphere, placed([0.3; 3], [-1.0, 2.5, 0.0]), lamp);
        scene.instance(floor, placed([0.5, 0.4, 1.0], [1.0, 2.0, -3.0]), lamp);
        let plain = scene.shape(pyramid(false, false));
        let smooth = scene.shape(pyramid(true, false));
        let coloured = scene.shape(pyramid(true, true));
        scene.instance(plain, placed([0.5; 3], [-2.0, 0.0, 2.5]), grey);
        scene.instance(smooth, placed([0.5, -0.5, 0.5], [0.0, 1.0, 2.5]), grey);
        scene.instance(plain, placed([0.2; 3], [3.0, 1.5, 2.0]), lamp);
        let mut varied = material("lambertian:reflectance=0.8");
        varied.bind_vertex_colour("reflectance").unwrap();
        let varied = scene.material(varied);
        scene.instance(coloured, placed([0.6; 3], [2.0, 0.0, 2.5]), varied);
        let point = Light::Point {
            position: Vec3::new(0.0, 3.0, 3.0),
            intensity: [4.0; 3],
        };
        scene.light_in(point, "key");
        // More lights than a node of their tree has children.
        for k in 0..9 {
            scene.light(Light::Point {
                position: Vec3::new(k as f32 - 4.0, 0.3, 1.5),
                intensity: [0.1; 3],
            });
        }
        scene.environment(environment);
        let up = Vec3::new(0.0, 1.0, 0.0);
        let eye = Vec3::new(0.0, 2.5, 8.0);
        let camera = Camera::look_at(eye, Vec3::new(0.0, 0.8, 0.0), up, 40.0).unwrap();
        (scene.build().unwrap(), camera)
    }

    fn panorama() -> Environment {
        let image = Image::from_fn(128, 64, |x, y| {
            let sun = if (x, y) == (30, 12) { 800.0 } else { 1.0 };
            [0.3, 0.4, 0.5].map(|c| c * sun)
        });
        Environment::from_image(image, Layout::LatLong).unwrap()
    }

    /// Waves are the one path at a time, to the bit: sums, counts of rays, and layers.
    #[test]
    fn waves_are_single_paths() {
        for (environment, guide, sampler, path) in [
            (
                panorama(),
                EnvironmentSampling::Luminance,
                SamplerKind::Sobol,
                Path::default(),
            ),
            (
                panorama(),
                EnvironmentSampling::Compensated,
                SamplerKind::Independent,
                Path {
                    max_bounces: 5,
                    roulette_after: 0,
                    ..Path::default()
                },
            ),
            (
                Environment::uniform([0.3, 0.2, 0.1]),
                EnvironmentSampling::Luminance,
                SamplerKind::Sobol,
                Path {
                    max_bounces: 0,
                    ..Path::default()
                },
            ),
            (
                panorama(),
                EnvironmentSampling::Compensated,
                SamplerKind::Sobol,
                Path {
                    max_bounces: 4,
                    roulette_after: 0,
                    light_samples: 4,
                    light_candidates: 3,
                    splitting: 3,
                    ..Path::default()
                },
            ),
            (
                panorama(),
                EnvironmentSampling::Luminance,
                SamplerKind::Sobol,
                Path {
                    max_bounces: 9,
                    splitting: 2,
                    roulette: Roulette::Efficiency,
                    ..Path::default()
                },
            ),
            (
                panorama(),
                EnvironmentSampling::Luminance,
                SamplerKind::Sobol,
                Path {
                    max_bounces: 5,
                    light_choice: LightChoice::Power,
                    light_samples: 2,
                    ..Path::default()
                },
            ),
            (
                panorama(),
                EnvironmentSampling::Compensated,
                SamplerKind::Independent,
                Path {
                    max_bounces: 5,
                    light_choice: LightChoice::Uniform,
                    splitting: 2,
                    ..Path::default()
                },
            ),
        ] {
            let (scene, camera) = everything(environment);
            let options = RenderOptions {
                width: 48,
                height: 32,
                sampler,
                seed: 5,
                integrator: Integrator::Path(Path {
                    environment: guide,
                    ..path
                }),
                ..RenderOptions::default()
            };
            let kept = Kept {
                position: true,
                material: true,
                direct: true,
                indirect: true,
                groups: scene.lights.groups().len() as u32,
                reweighted: true,
            };
            let split = Split::new(&kept, &scene.lights);
            let worth = Worth::learn(&scene, &camera, &options);
            let plan = Plan::new(&scene, &options.integrator, &split, worth.as_ref()).unwrap();
            let mut waves = Row::new(&plan);
            let wanted = Wanted::All(3..10);
            let mut lit = 0;
            assert_eq!(kept.groups, 3);
            for y in 0..options.height {
                let mut one = Film::keeping(kept, options.width, 1).unwrap();
                let mut many = one.clone();
                let shot = (&scene, &camera, &options, &split, worth.as_ref());
                let alone = take_row(shot, y, &mut one.rows_mut()[0], &wanted);
                let together = waves.take(&camera, &options, y, &mut many.rows_mut()[0], &wanted);
                assert_eq!(alone, together, "{guide:?}, row {y}");
                assert_eq!(one, many, "{guide:?}, row {y}");
                lit += one.pixels().iter().filter(|p| p.mean()[0] > 0.0).count();
            }
            // The test would not notice anything in the dark.
            assert!(lit > 500, "{lit}");
        }
    }
}
