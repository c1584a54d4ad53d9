//! Path tracing in waves: the estimates of [`Path`], many at a time (Laine, Karras and Aila 2013, "Megakernels Considered Harmful").
//!
//! All paths of a wave go one segment further together. Between the segments they are ordered by the material that they met, so that each
//! reflection function is evaluated for all of its points at once, on lanes, and so are lights, sequences and frames. The numbers are
//! those of the one path at a time of `path.rs`, to the bit: a test holds the two together.

mod direct;
mod paths;
mod scatter;
mod surface;

use super::{
    EnvironmentSampling, Integrator, Path, RayCounts, dimension, power_heuristic, product, scaled,
    sum,
};
use crate::film::{FilmSample, FirstSurface};
use direct::Direct;
use gonio_env::Guide;
use gonio_radiometry::sequence::{SampleStreams, SamplerKind};
use gonio_scene::{Hit, Ray, Scene};
use paths::Paths;
use scatter::Scatter;
use surface::Vertices;

/// Samples in a wave: their numbers stay in the second cache.
pub(crate) const WAVE: usize = 1024;

/// Everything that a wave needs.
pub(crate) struct Wavefront<'a> {
    scene: &'a Scene,
    path: Path,
    guide: Guide,
    paths: Paths,
    next: Paths,
    hits: Vec<Hit>,
    /// The paths that met a surface and go on, by material.
    order: Vec<u32>,
    /// Paths at each material, and which materials have any; all zero between uses.
    population: Vec<u32>,
    vertices: Vertices<'a>,
    direct: Direct,
    scatter: Scatter,
    survival: Vec<f32>,
    /// Light that the first surface emits, or the environment where there is none.
    emitted: Vec<[f32; 3]>,
    /// Room for an order to be made in.
    spare: Vec<u32>,
}

/// Points of one material.
#[derive(Debug, Clone)]
struct Group {
    material: u32,
    range: std::ops::Range<usize>,
}

impl<'a> Wavefront<'a> {
    /// Nothing where paths need what waves don't have: surfaces that are partly transparent, bodies that absorb, and the environment
    /// sampled by the surface that it lights.
    pub fn new(scene: &'a Scene, integrator: &Integrator, kind: SamplerKind) -> Option<Self> {
        let Integrator::Path(path) = integrator else {
            return None;
        };
        let guide = match path.environment {
            EnvironmentSampling::Luminance => Guide::Luminance,
            EnvironmentSampling::Compensated => Guide::Compensated,
            EnvironmentSampling::Cosine | EnvironmentSampling::Product(_) => return None,
        };
        if scene.has_transparency() || scene.has_absorption() {
            return None;
        }
        Some(Self {
            scene,
            path: *path,
            guide,
            paths: Paths::new(kind),
            next: Paths::new(kind),
            hits: Vec::new(),
            order: Vec::new(),
            population: vec![0; scene.materials.len()],
            vertices: Vertices::new(scene),
            direct: Direct::default(),
            scatter: Scatter::default(),
            survival: Vec::new(),
            emitted: Vec::new(),
            spare: Vec::new(),
        })
    }

    /// [`Integrator::radiance`] of many rays, in empty space.
    ///
    /// - `samples`: one a ray, written
    pub fn radiance(
        &mut self,
        rays: &[Ray],
        streams: &SampleStreams,
        samples: &mut Vec<FilmSample>,
        counts: &mut RayCounts,
    ) {
        samples.clear();
        let black = FilmSample {
            radiance: [0.0; 3],
            first: None,
        };
        samples.resize(rays.len(), black);
        self.begin(rays, streams);
        for segment in 0..=self.path.max_bounces {
            if self.paths.len() == 0 {
                break;
            }
            self.follow(segment, samples, counts);
            if segment == self.path.max_bounces && segment > 0 {
                break;
            }
            if segment > self.path.roulette_after {
                self.roulette(segment - 1);
            }
            self.sort();
            let rays = [&self.paths.origin, &self.paths.direction];
            self.vertices.find(rays, &self.order, &self.hits);
            if segment == 0 {
                self.note_first_surfaces(samples);
                if self.path.max_bounces == 0 {
                    break;
                }
            }
            self.vertices
                .streams
                .gather(&self.paths.streams, &self.order);
            self.direct
                .draw(self.scene, self.guide, &self.vertices, segment);
            self.direct.reflect(self.scene, &self.vertices, counts);
            for (i, contribution) in self.direct.contributions() {
                let k = self.order[i] as usize;
                let light = product(self.paths.throughput(k), contribution);
                let sample = &mut samples[self.paths.id[k] as usize];
                sample.radiance = sum(sample.radiance, light);
            }
            self.scatter.draw(&self.vertices, segment);
            let unscales = self.vertices.transmit();
            self.scatter.go_on(
                &self.vertices,
                unscales,
                &self.paths,
                &self.order,
                &mut self.next,
            );
            std::mem::swap(&mut self.paths, &mut self.next);
        }
        for (sample, emitted) in samples.iter_mut().zip(&self.emitted) {
            sample.radiance = sum(*emitted, sample.radiance);
        }
    }

    fn begin(&mut self, rays: &[Ray], streams: &SampleStreams) {
        self.emitted.clear();
        self.emitted.resize(rays.len(), [0.0; 3]);
        let paths = &mut self.paths;
        paths.begin(rays.len());
        for (i, ray) in rays.iter().enumerate() {
            paths.id.push(i as u32);
            paths.streams.push_from(streams, i);
            paths.origin.set(i, ray.origin);
            paths.direction.set(i, ray.direction);
            for column in &mut paths.throughput {
                column.push(1.0);
            }
            paths.pdf.push(f32::INFINITY);
        }
        paths.end();
    }

    /// Follows all rays to what they meet, and takes in the light that comes from there. Afterwards `order` has the paths that met a
    /// surface.
    fn follow(&mut self, segment: u32, samples: &mut [FilmSample], counts: &mut RayCounts) {
        let (scene, paths) = (self.scene, &self.paths);
        counts.nearest += paths.len() as u64;
        self.hits.clear();
        self.order.clear();
        let nothing = Hit {
            t: f32::INFINITY,
            instance: 0,
            primitive: 0,
            u: 0.0,
            v: 0.0,
        };
        for i in 0..paths.len() {
            let ray = paths.ray(i);
            let hit = scene.geometry.intersect(&ray);
            self.hits.push(hit.unwrap_or(nothing));
            let (radiance, density) = match hit {
                None if segment == 0 => {
                    let environment = scene.lights.environment();
                    let seen = environment
                        .map_or([0.0; 3], |e| e.radiance_from(ray.origin, ray.direction));
                    (seen, 0.0)
                }
                None => scene.lights.environment_radiance_and_pdf_by(
                    self.guide,
                    paths.from.get(i),
                    ray.direction,
                ),
                Some(hit) => {
                    self.order.push(i as u32);
                    let instance = &scene.geometry.instances()[hit.instance as usize];
                    if !scene.materials[instance.material as usize]
                        .emission
                        .is_lit()
                    {
                        continue;
                    }
                    let point = scene.geometry.surface(&ray, &hit);
                    let radiance = scene.emitted(&point, -ray.direction);
                    if radiance == [0.0; 3] {
                        continue;
                    }
                    let lights = &scene.lights;
                    (
                        radiance,
                        lights.pdf_area(paths.from.get(i), &point, ray.direction),
                    )
                }
            };
            if segment == 0 {
                self.emitted[i] = radiance;
                continue;
            }
            // From ∞ the weight is 1, whatever the other density.
            let weight = power_heuristic(paths.pdf[i], density);
            let light = scaled(product(paths.throughput(i), radiance), weight);
            let sample = &mut samples[paths.id[i] as usize];
            sample.radiance = sum(sample.radiance, light);
        }
    }

    /// Ends paths that carry little, and lets the others carry their share; as `path.rs` does after reflection `bounce`.
    fn roulette(&mut self, bounce: u32) {
        let paths = &mut self.paths;
        self.survival.resize(paths.len(), 0.0);
        let at = dimension::of_bounce(bounce) + dimension::ROULETTE;
        paths.streams.draw(at, [&mut self.survival]);
        self.order.retain(|&k| {
            let k = k as usize;
            let [r, g, b] = product(paths.throughput(k), paths.unscaling(k));
            let survival = r.max(g).max(b).min(0.95);
            if self.survival[k] >= survival {
                return false;
            }
            for column in &mut paths.throughput {
                column[k] *= 1.0 / survival;
            }
            true
        });
    }

    /// Puts `order` in the order of materials, paths of one in their own order, and tells the vertices of the groups.
    fn sort(&mut self) {
        let scene = self.scene;
        let material_of = |hit: &Hit| scene.geometry.instances()[hit.instance as usize].material;
        let groups = &mut self.vertices.groups;
        groups.clear();
        for &k in &self.order {
            let material = material_of(&self.hits[k as usize]);
            let population = &mut self.population[material as usize];
            if *population == 0 {
                groups.push(Group {
                    material,
                    range: 0..0,
                });
            }
            *population += 1;
        }
        groups.sort_unstable_by_key(|g| g.material);
        let mut at = 0;
        for group in groups.iter_mut() {
            // From here on the number is where the material's next path goes.
            let population = &mut self.population[group.material as usize];
            let end = at + *population as usize;
            group.range = at..end;
            *population = at as u32;
            at = end;
        }
        std::mem::swap(&mut self.order, &mut self.spare);
        self.order.resize(self.spare.len(), 0);
        for &k in &self.spare {
            let next = &mut self.population[material_of(&self.hits[k as usize]) as usize];
            self.order[*next as usize] = k;
            *next += 1;
        }
        for group in groups.iter() {
            self.population[group.material as usize] = 0;
        }
    }

    fn note_first_surfaces(&self, samples: &mut [FilmSample]) {
        for group in &self.vertices.groups {
            for i in group.range.clone() {
                let k = self.order[i] as usize;
                samples[self.paths.id[k] as usize].first = Some(FirstSurface {
                    albedo: self.vertices.albedo(group, i),
                    normal: self.vertices.facing_normal(i).to_array(),
                    depth: self.hits[k].t,
                    material: group.material,
                });
            }
        }
    }
}
