//! Path tracing in waves: the estimates of [`Path`], many at a time (Laine, Karras and Aila 2013, "Megakernels Considered Harmful").
//!
//! All paths of a wave go one segment further together. Between the segments they are ordered by the material that they met, so that each
//! reflection function is evaluated for all of its points at once, on lanes, and so are lights, sequences and frames. The numbers are
//! those of the one path at a time of `path.rs`, to the bit: a test holds the two together.

mod direct;
mod paths;
mod scatter;
mod surface;

use super::shares::{Shares, Split};
use super::{
    EnvironmentSampling, Integrator, Path, RayCounts, dimension, light_at, power_heuristic,
    product, scaled, sum,
};
use crate::film::{FilmSample, FirstSurface};
use direct::Direct;
use gonio_brdf::Model;
use gonio_env::{EnvSamples, Guide};
use gonio_num::Vectors;
use gonio_radiometry::sequence::SampleStreams;
use gonio_scene::{Hit, Scene};
use paths::Paths;
use scatter::Scatter;
use surface::Vertices;

/// Samples in a wave: their numbers stay in the second cache.
pub(crate) const WAVE: usize = 1024;

/// What the waves of all threads share: how a scene's paths are put in order.
pub(crate) struct Plan<'a> {
    scene: &'a Scene,
    path: Path,
    /// How the light of each sample is told apart.
    split: &'a Split,
    guide: Guide,
    /// For each material its reflection function, if that is the same all over the surface.
    models: Vec<Option<&'a Model<f32, 3>>>,
    /// The bucket of each instance: instances of one material are neighbours.
    bucket: Vec<u32>,
    /// The material of each bucket.
    material: Vec<u32>,
    /// Whether each instance emits light.
    shines: Vec<bool>,
}

/// Instances up to which each has a bucket of its own; of more, those of one material share one.
const MOST_BUCKETS: usize = 1 << 16;

impl<'a> Plan<'a> {
    /// Nothing where paths need what waves don't have: surfaces that are partly transparent, bodies that absorb, and the environment
    /// sampled by the surface that it lights.
    pub fn new(scene: &'a Scene, integrator: &Integrator, split: &'a Split) -> Option<Self> {
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
        let instances = scene.geometry.instances();
        let (bucket, material) = if instances.len() <= MOST_BUCKETS {
            let mut order: Vec<u32> = (0..instances.len() as u32).collect();
            order.sort_by_key(|&i| instances[i as usize].material);
            let mut bucket = vec![0; order.len()];
            for (place, &i) in order.iter().enumerate() {
                bucket[i as usize] = place as u32;
            }
            let material = order.iter().map(|&i| instances[i as usize].material);
            (bucket, material.collect())
        } else {
            let bucket = instances.iter().map(|i| i.material).collect();
            (bucket, (0..scene.materials.len() as u32).collect())
        };
        Some(Self {
            scene,
            path: *path,
            split,
            guide,
            models: scene.materials.iter().map(|m| m.even_model()).collect(),
            bucket,
            material,
            shines: (instances.iter())
                .map(|i| scene.materials[i.material as usize].emission.is_lit())
                .collect(),
        })
    }
}

/// The waves of one thread.
pub(crate) struct Wavefront<'a> {
    plan: &'a Plan<'a>,
    paths: Paths,
    next: Paths,
    hits: Vec<Hit>,
    /// The paths that met a surface and go on, by material.
    order: Vec<u32>,
    /// Paths in each bucket; all zero between uses.
    population: Vec<u32>,
    /// Buckets that have any.
    occupied: Vec<u32>,
    vertices: Vertices<'a>,
    direct: Direct,
    scatter: Scatter,
    survival: Vec<f32>,
    /// Light that the first surface emits, or the environment where there is none.
    emitted: Vec<[f32; 3]>,
    /// The paths that met nothing, and what they see.
    missed: Vec<u32>,
    around: EnvSamples,
    from: Vectors,
    /// The samples of the paths in `order`.
    ids: Vec<u32>,
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
    pub fn new(plan: &'a Plan<'a>) -> Self {
        Self {
            plan,
            paths: Paths::new(),
            next: Paths::new(),
            hits: Vec::new(),
            order: Vec::new(),
            population: vec![0; plan.material.len()],
            occupied: Vec::new(),
            vertices: Vertices::new(plan),
            direct: Direct::default(),
            scatter: Scatter::default(),
            survival: Vec::new(),
            emitted: Vec::new(),
            missed: Vec::new(),
            around: EnvSamples::default(),
            from: Vectors::default(),
            ids: Vec::new(),
            spare: Vec::new(),
        }
    }

    /// [`Integrator::radiance`] of many rays, in empty space.
    ///
    /// - `rays`: origins and directions
    /// - `light`: of each ray, written
    pub fn radiance(
        &mut self,
        rays: [&Vectors; 2],
        streams: &SampleStreams,
        light: &mut Gathered<'_>,
        counts: &mut RayCounts,
    ) {
        light.begin(streams.len());
        self.begin(rays);
        for segment in 0..=self.plan.path.max_bounces {
            if self.paths.len() == 0 {
                break;
            }
            self.follow(segment, light, counts);
            if segment == self.plan.path.max_bounces && segment > 0 {
                break;
            }
            if segment > self.plan.path.roulette_after {
                self.roulette(streams, segment - 1);
            }
            self.sort();
            let rays = [&self.paths.origin, &self.paths.direction];
            self.vertices.find(rays, &self.order, &self.hits);
            if segment == 0 {
                self.note_first_surfaces(&mut light.samples);
                if self.plan.path.max_bounces == 0 {
                    break;
                }
            }
            self.ids.clear();
            let ids = self.order.iter().map(|&k| self.paths.id[k as usize]);
            self.ids.extend(ids);
            self.vertices.streams.gather(streams, &self.ids);
            self.direct
                .draw(self.plan.scene, self.plan.guide, &self.vertices, segment);
            self.direct.reflect(self.plan.scene, &self.vertices, counts);
            for (i, contribution) in self.direct.contributions() {
                let k = self.order[i] as usize;
                let arrived = product(self.paths.throughput(k), contribution);
                let from = Some(self.direct.light(i));
                light.add(self.paths.id[k], from, segment + 1, arrived);
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
        for (sample, emitted) in light.samples.iter_mut().zip(&self.emitted) {
            sample.radiance = sum(*emitted, sample.radiance);
        }
    }

    fn begin(&mut self, rays: [&Vectors; 2]) {
        let count = rays[0].len();
        self.emitted.clear();
        self.emitted.resize(count, [0.0; 3]);
        let paths = &mut self.paths;
        paths.begin(count, false, false);
        for (i, id) in paths.id.iter_mut().enumerate() {
            *id = i as u32;
        }
        paths.origin.copy_from(rays[0]);
        paths.direction.copy_from(rays[1]);
        for column in &mut paths.throughput {
            column.fill(1.0);
        }
        paths.pdf.fill(f32::INFINITY);
        paths.end(count);
    }

    /// Follows all rays to what they meet, and takes in the light that comes from there. Afterwards `order` has the paths that met a
    /// surface.
    fn follow(&mut self, segment: u32, light: &mut Gathered<'_>, counts: &mut RayCounts) {
        let (scene, paths) = (self.plan.scene, &self.paths);
        counts.nearest += paths.len() as u64;
        self.order.clear();
        self.missed.clear();
        let rays = [&paths.origin, &paths.direction];
        scene.geometry.intersect_many(rays, &mut self.hits);
        for (i, hit) in self.hits.iter().enumerate() {
            if hit.t == f32::INFINITY {
                self.missed.push(i as u32);
                continue;
            }
            self.order.push(i as u32);
            if !self.plan.shines[hit.instance as usize] {
                continue;
            }
            let ray = paths.ray(i);
            let point = scene.geometry.surface(&ray, hit);
            let radiance = scene.emitted(&point, -ray.direction);
            if segment == 0 {
                self.emitted[i] = radiance;
                light.tell_apart(paths.id[i], light_at(scene, &point), 0, radiance);
            } else if radiance != [0.0; 3] {
                let from = paths.receiver(i);
                let density = (scene.lights).pdf_area(&from, &point, ray.direction);
                let arrived = weighted(paths, i, radiance, density);
                light.add(paths.id[i], light_at(scene, &point), segment, arrived);
            }
        }
        self.look_around(segment, light);
    }

    /// Takes in the environment's light where a ray met nothing.
    fn look_around(&mut self, segment: u32, light: &mut Gathered<'_>) {
        let (lights, paths) = (&self.plan.scene.lights, &self.paths);
        let (Some(environment), false) = (lights.environment(), self.missed.is_empty()) else {
            return;
        };
        if segment == 0 {
            for &k in &self.missed {
                let ray = paths.ray(k as usize);
                let seen = environment.radiance_from(ray.origin, ray.direction);
                self.emitted[k as usize] = seen;
                let from = lights.environment_index();
                light.tell_apart(paths.id[k as usize], from, 0, seen);
            }
            return;
        }
        let around = &mut self.around;
        around.wi.resize(self.missed.len());
        self.from.resize(self.missed.len());
        for (i, &k) in self.missed.iter().enumerate() {
            around.wi.set(i, paths.direction.get(k as usize));
            self.from.set(i, paths.from.get(k as usize));
        }
        environment.look_up_many(self.plan.guide, &self.from, around);
        let probability = lights.environment_probability();
        for (i, &k) in self.missed.iter().enumerate() {
            let radiance = [0, 1, 2].map(|c| around.radiance[c][i]);
            let density = probability * around.pdf[i];
            let arrived = weighted(paths, k as usize, radiance, density);
            let from = lights.environment_index();
            light.add(paths.id[k as usize], from, segment, arrived);
        }
    }

    /// Ends paths that carry little, and lets the others carry their share; as `path.rs` does after reflection `bounce`.
    fn roulette(&mut self, streams: &SampleStreams, bounce: u32) {
        let paths = &mut self.paths;
        self.survival.resize(paths.len(), 0.0);
        let at = dimension::of_bounce(bounce) + dimension::ROULETTE;
        self.vertices.streams.gather(streams, &paths.id);
        self.vertices.streams.draw(at, [&mut self.survival]);
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

    /// Puts `order` in the order of materials and instances, paths at one in their own order, and tells the vertices the groups.
    fn sort(&mut self) {
        let plan = self.plan;
        let (hits, population) = (&self.hits, &mut self.population);
        let bucket_of = |k: u32| plan.bucket[hits[k as usize].instance as usize] as usize;
        self.occupied.clear();
        for &k in &self.order {
            let bucket = bucket_of(k);
            if population[bucket] == 0 {
                self.occupied.push(bucket as u32);
            }
            population[bucket] += 1;
        }
        self.occupied.sort_unstable();
        let groups = &mut self.vertices.groups;
        groups.clear();
        let mut at = 0;
        for &bucket in &self.occupied {
            let material = plan.material[bucket as usize];
            // From here on the number is where the bucket's next path goes.
            let population = &mut population[bucket as usize];
            let end = at + *population as usize;
            *population = at as u32;
            match groups.last_mut() {
                Some(last) if last.material == material => last.range.end = end,
                _ => groups.push(Group {
                    material,
                    range: at..end,
                }),
            }
            at = end;
        }
        std::mem::swap(&mut self.order, &mut self.spare);
        self.order.resize(self.spare.len(), 0);
        for &k in &self.spare {
            let next = &mut population[bucket_of(k)];
            self.order[*next as usize] = k;
            *next += 1;
        }
        for &bucket in &self.occupied {
            population[bucket as usize] = 0;
        }
    }

    fn note_first_surfaces(&self, samples: &mut [FilmSample]) {
        for group in &self.vertices.groups {
            for i in group.range.clone() {
                let k = self.order[i] as usize;
                samples[self.paths.id[k] as usize].first = Some(FirstSurface {
                    albedo: self.vertices.albedo(group, i),
                    normal: self.vertices.facing_normal(i).to_array(),
                    position: self.vertices.surfaces.p.get(i).to_array(),
                    depth: self.hits[k].t,
                    material: group.material,
                });
            }
        }
    }
}

/// Light that path `i` met, with the weight against a light sample of this density.
#[inline(always)]
fn weighted(paths: &Paths, i: usize, radiance: [f32; 3], density: f32) -> [f32; 3] {
    // From ∞ the weight is 1, whatever the other density.
    let weight = power_heuristic(paths.pdf[i], density);
    scaled(product(paths.throughput(i), radiance), weight)
}

/// The samples of a wave as their light comes together.
#[derive(Debug)]
pub(crate) struct Gathered<'a> {
    split: &'a Split,
    /// One a ray.
    pub samples: Vec<FilmSample>,
    /// As many a ray as are told apart.
    shares: Vec<[f32; 3]>,
}

impl<'a> Gathered<'a> {
    pub fn new(plan: &Plan<'a>) -> Self {
        Self {
            split: plan.split,
            samples: Vec::new(),
            shares: Vec::new(),
        }
    }

    fn begin(&mut self, count: usize) {
        let black = FilmSample {
            radiance: [0.0; 3],
            first: None,
        };
        self.samples.clear();
        self.samples.resize(count, black);
        self.shares.clear();
        self.shares.resize(count * self.split.count(), [0.0; 3]);
    }

    /// The shares of sample `i`.
    pub fn shares(&self, i: usize) -> &[[f32; 3]] {
        let each = self.split.count();
        &self.shares[i * each..(i + 1) * each]
    }

    /// Adds light to the sample `id`, as [`Shares::add`] does to its shares.
    #[inline(always)]
    fn add(&mut self, id: u32, light: Option<u32>, reflections: u32, arrived: [f32; 3]) {
        let sample = &mut self.samples[id as usize];
        sample.radiance = sum(sample.radiance, arrived);
        self.tell_apart(id, light, reflections, arrived);
    }

    /// [`Shares::add`] alone.
    #[inline(always)]
    fn tell_apart(&mut self, id: u32, light: Option<u32>, reflections: u32, arrived: [f32; 3]) {
        let each = self.split.count();
        if each == 0 {
            return;
        }
        let first = id as usize * each;
        let mut shares = Shares {
            split: self.split,
            values: &mut self.shares[first..first + each],
        };
        shares.add(light, reflections, arrived);
    }
}
