//! Path tracing in waves: the estimates of [`Path`], many at a time (Laine, Karras and Aila 2013, "Megakernels Considered Harmful").
//!
//! All paths of a wave go one segment further together. Between the segments they are ordered by the material that they met, so that each
//! reflection function is evaluated for all of its points at once, on lanes, and so are lights, sequences and frames. The numbers are
//! those of the one path at a time of `path.rs`, to the bit: a test holds the two together.

mod direct;
mod gathered;
mod kept;
mod paths;
mod scatter;
mod surface;

use super::shares::Split;
use super::worth::{Judge, Worth};
use super::{EnvironmentSampling, Integrator, Path, RayCounts, dimension, light_at, product, sum};
use crate::film::{FilmSample, FirstSurface};
use direct::Direct;
pub(crate) use gathered::Gathered;
use gonio_brdf::Model;
use gonio_env::{EnvSamples, Guide};
use gonio_num::Vectors;
use gonio_radiometry::sequence::{SampleStreams, SamplerKind};
use gonio_scene::{Hit, LightSampler, Material, Scene, SurfacePoint, Surfaces};
use paths::Paths;
use scatter::Scatter;
use surface::Vertices;

/// Paths in a wave: their numbers stay in the second cache.
const WAVE: usize = 1024;

/// What the waves of all threads share: how a scene's paths are put in order.
pub(crate) struct Plan<'a> {
    scene: &'a Scene,
    path: Path,
    /// Paths that go on from the first surface of each sample.
    paths: usize,
    /// How the light of each sample is told apart.
    split: &'a Split,
    /// What roulette knows of the scene.
    worth: Option<&'a Worth>,
    guide: Guide,
    /// For each material its reflection function, if that is the same all over the surface.
    models: Vec<Option<&'a Model<f32, 3>>>,
    /// What a ray meets: each instance, and nothing.
    met: Vec<Met>,
    /// The material of each bucket.
    material: Vec<u32>,
}

/// What is known of an instance that a ray meets.
#[derive(Debug, Clone, Copy)]
struct Met {
    /// Instances of one material are neighbours.
    bucket: u32,
    shines: Shines,
}

/// How a surface emits light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shines {
    Not,
    /// All over in the same way, so that its texture coordinates don't matter.
    Evenly,
    Unevenly,
}

impl Shines {
    fn of(material: &Material) -> Self {
        let emission = &material.emission;
        match emission.is_lit() {
            false => Self::Not,
            true if emission.is_even() && material.opacity.is_opaque() => Self::Evenly,
            true => Self::Unevenly,
        }
    }
}

/// Instances up to which each has a bucket of its own; of more, those of one material share one.
const MOST_BUCKETS: usize = 1 << 16;

impl<'a> Plan<'a> {
    /// Nothing where paths need what waves don't have: surfaces that are partly transparent, bodies that absorb, and the environment
    /// sampled by the surface that it lights.
    pub fn new(
        scene: &'a Scene,
        integrator: &Integrator,
        split: &'a Split,
        worth: Option<&'a Worth>,
    ) -> Option<Self> {
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
        let paths = path.strategies(0, false).directions as usize;
        Some(Self {
            scene,
            path: *path,
            paths,
            split,
            worth,
            guide,
            models: scene.materials.iter().map(|m| m.even_model()).collect(),
            met: (instances.iter().zip(bucket))
                .map(|(i, bucket)| Met {
                    bucket,
                    shines: Shines::of(&scene.materials[i.material as usize]),
                })
                .chain([Met {
                    bucket: u32::MAX,
                    shines: Shines::Not,
                }])
                .collect(),
            material,
        })
    }
}

impl<'a> Plan<'a> {
    /// What roulette knows of the scene.
    pub fn worth(&self) -> Option<&'a Worth> {
        self.worth
    }

    /// What a ray met.
    #[inline(always)]
    fn met(&self, hit: &Hit) -> Met {
        self.met[(hit.instance as usize).min(self.met.len() - 1)]
    }

    /// The lights, as one of them is chosen.
    fn lights(&self) -> LightSampler<'a> {
        self.scene.lights.by(self.path.light_choice)
    }

    /// Samples in a wave.
    pub fn wave(&self) -> usize {
        WAVE / self.paths
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
    /// The bucket of what each path met.
    bucket: Vec<u32>,
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
    /// The paths that met a surface that shines evenly, and the points there.
    lit: Vec<u32>,
    sources: Surfaces,
    /// The paths that met nothing, and what they see.
    missed: Vec<u32>,
    around: EnvSamples,
    from: Vectors,
    /// The streams of the paths in `order`.
    ids: Vec<u32>,
    /// The numbers of each light sample at the first surfaces, and of each path from there.
    lighting: SampleStreams,
    going: SampleStreams,
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
            bucket: Vec::new(),
            population: vec![0; plan.material.len()],
            occupied: Vec::new(),
            vertices: Vertices::new(plan),
            direct: Direct::default(),
            scatter: Scatter::default(),
            survival: Vec::new(),
            emitted: Vec::new(),
            lit: Vec::new(),
            sources: Surfaces::default(),
            missed: Vec::new(),
            around: EnvSamples::default(),
            from: Vectors::default(),
            ids: Vec::new(),
            lighting: SampleStreams::new(SamplerKind::default()),
            going: SampleStreams::new(SamplerKind::default()),
            spare: Vec::new(),
        }
    }

    /// [`Integrator::radiance`] of many rays, in empty space.
    ///
    /// - `rays`: origins and directions
    /// - `light`: of each ray, written
    /// - `importance`: of each ray, where roulette knows the scene: [`Worth::importance`]
    pub fn radiance(
        &mut self,
        rays: [&Vectors; 2],
        streams: &SampleStreams,
        importance: &[f32],
        light: &mut Gathered<'_>,
        counts: &mut RayCounts,
    ) {
        light.begin(streams.len());
        self.begin(rays);
        let most = self.plan.path.max_bounces;
        for segment in 0..=most {
            if self.paths.len() == 0 {
                break;
            }
            self.follow(segment, light, counts);
            if segment == most && segment > 0 {
                break;
            }
            let judged = self.plan.worth.is_some();
            if segment > self.plan.path.first_roulette(judged) {
                self.roulette(segment - 1, importance);
            }
            self.sort();
            let rays = [&self.paths.origin, &self.paths.direction];
            self.vertices.find(rays, &self.order, &self.hits);
            if segment == 0 {
                self.note_first_surfaces(&mut light.samples);
                if most == 0 {
                    break;
                }
                self.split(streams);
            }
            self.reflect(segment, light, counts);
            self.scatter(segment);
        }
        light.end();
        for (sample, emitted) in light.samples.iter_mut().zip(&self.emitted) {
            sample.radiance = sum(*emitted, sample.radiance);
        }
    }

    /// Gives each light sample at the first surfaces its numbers, and each path that goes on from there.
    fn split(&mut self, streams: &SampleStreams) {
        let strategies = self.plan.path.strategies(0, false);
        self.lighting.split(streams, strategies.drawn());
        self.going.split(streams, strategies.directions);
        if strategies.directions == 1 {
            return;
        }
        for (group, reflects) in self.vertices.each_group() {
            for i in group.range.clone() {
                if reflects.is_delta(i - group.range.start) {
                    let id = self.paths.id[self.order[i] as usize] as usize;
                    self.going.set(id, &streams.get(id / self.plan.paths));
                }
            }
        }
    }

    /// Takes in light that comes straight from lights.
    fn reflect(&mut self, segment: u32, light: &mut Gathered<'_>, counts: &mut RayCounts) {
        let plan = self.plan;
        let strategies = plan.path.strategies(segment, false);
        for which in 0..strategies.lights {
            for candidate in 0..strategies.candidates {
                let ids = self.order.iter().map(|&k| self.paths.id[k as usize]);
                self.ids.clear();
                if segment == 0 {
                    let each = strategies.drawn();
                    let number = which * strategies.candidates + candidate;
                    let first = ids.map(|id| id / plan.paths as u32 * each);
                    self.ids.extend(first.map(|first| first + number));
                    self.vertices.streams.gather(&self.lighting, &self.ids);
                } else {
                    self.ids.extend(ids);
                    self.vertices.streams.gather(&self.going, &self.ids);
                }
                let direct = &mut self.direct;
                direct.draw(plan.lights(), plan.guide, &self.vertices, segment);
                direct.reflect(&self.vertices, strategies);
                if strategies.candidates > 1 {
                    direct.consider(candidate, &self.vertices, segment);
                }
            }
            let direct = &mut self.direct;
            if strategies.candidates > 1 {
                direct.decide(strategies.candidates);
            }
            direct.follow(plan.scene, &self.vertices, counts);
            for (i, contribution) in direct.contributions() {
                let k = self.order[i] as usize;
                let arrived = product(self.paths.throughput(k), contribution);
                let from = Some(direct.light(i));
                light.add(self.paths.id[k], from, segment + 1, arrived);
            }
        }
    }

    /// Lets the paths go on, from the first surface several of each.
    fn scatter(&mut self, segment: u32) {
        let paths = match segment {
            0 => self.plan.paths,
            _ => 1,
        };
        let unscales = self.vertices.transmit() || !self.paths.unscaling[0].is_empty();
        (self.next).begin(paths * self.order.len(), unscales);
        let mut place = 0;
        for which in 0..paths as u32 {
            // After that lights have drawn from the same.
            if segment == 0 {
                let ids = self.order.iter().map(|&k| self.paths.id[k as usize]);
                self.ids.clear();
                self.ids.extend(ids.map(|id| id + which));
                self.vertices.streams.gather(&self.going, &self.ids);
            }
            self.scatter.draw(&self.vertices, segment);
            let part = Part {
                which,
                of: paths as u32,
            };
            place = self.scatter.go_on(
                &self.vertices,
                (&self.paths, &self.order),
                part,
                (&mut self.next, place),
            );
        }
        self.next.end(place);
        std::mem::swap(&mut self.paths, &mut self.next);
    }

    fn begin(&mut self, rays: [&Vectors; 2]) {
        let count = rays[0].len();
        self.emitted.clear();
        self.emitted.resize(count, [0.0; 3]);
        let paths = &mut self.paths;
        paths.begin(count, false);
        for (i, id) in paths.id.iter_mut().enumerate() {
            *id = (i * self.plan.paths) as u32;
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
        let scene = self.plan.scene;
        counts.nearest += self.paths.len() as u64;
        let rays = [&self.paths.origin, &self.paths.direction];
        scene.geometry.intersect_many(rays, &mut self.hits);
        let (plan, hits) = (self.plan, &self.hits[..]);
        let lists = [
            &mut self.order,
            &mut self.missed,
            &mut self.lit,
            &mut self.bucket,
        ];
        for list in lists {
            list.resize(hits.len(), 0);
        }
        // Into each list without a branch, which no processor would predict.
        let [mut some, mut none, mut lit] = [0; 3];
        let mut unevenly = false;
        for (i, hit) in hits.iter().enumerate() {
            let met = plan.met(hit);
            let is_met = hit.t < f32::INFINITY;
            self.bucket[i] = met.bucket;
            self.order[some] = i as u32;
            some += usize::from(is_met);
            self.missed[none] = i as u32;
            none += usize::from(!is_met);
            self.lit[lit] = i as u32;
            lit += usize::from(met.shines == Shines::Evenly);
            unevenly |= met.shines == Shines::Unevenly;
        }
        self.order.truncate(some);
        self.missed.truncate(none);
        self.lit.truncate(lit);
        if unevenly {
            for i in 0..self.hits.len() {
                let hit = &self.hits[i];
                if plan.met(hit).shines == Shines::Unevenly {
                    let point = scene.geometry.surface(&self.paths.ray(i), hit);
                    self.take_in(segment, i, &point, light);
                }
            }
        }
        // Neighbours on one instance are found together.
        let hits = &self.hits;
        self.lit
            .sort_unstable_by_key(|&i| hits[i as usize].instance);
        let mut sources = std::mem::take(&mut self.sources);
        let rays = [&self.paths.origin, &self.paths.direction];
        (scene.geometry).surfaces(rays, &self.lit, hits, &mut sources);
        for k in 0..self.lit.len() {
            let i = self.lit[k] as usize;
            let point = sources.point(k, &self.hits[i]);
            self.take_in(segment, i, &point, light);
        }
        self.sources = sources;
        self.look_around(segment, light);
    }

    /// Takes in the light that a surface emits towards path `i`, which has met it.
    fn take_in(&mut self, segment: u32, i: usize, point: &SurfacePoint, light: &mut Gathered<'_>) {
        let (scene, paths) = (self.plan.scene, &self.paths);
        let direction = paths.direction.get(i);
        let radiance = scene.emitted(point, -direction);
        if segment == 0 {
            self.emitted[i] = radiance;
            light.tell_apart(paths.id[i], light_at(scene, point), 0, radiance);
        } else if radiance != [0.0; 3] {
            let from = self.vertices.receiver(paths.vertex[i] as usize);
            let strategies = self.plan.path.strategies(segment - 1, false);
            let density = self.plan.lights().pdf_area(&from, point, direction);
            let density = strategies.of_lights(density);
            let arrived = paths.weighted(i, radiance, density);
            light.add(paths.id[i], light_at(scene, point), segment, arrived);
        }
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
            let vertex = paths.vertex[k as usize] as usize;
            self.from.set(i, self.vertices.surfaces.p.get(vertex));
        }
        environment.look_up_many(self.plan.guide, &self.from, around);
        let probability = self.plan.lights().environment_probability();
        let strategies = self.plan.path.strategies(segment - 1, false);
        for (i, &k) in self.missed.iter().enumerate() {
            let radiance = [0, 1, 2].map(|c| around.radiance[c][i]);
            let density = strategies.of_lights(probability * around.pdf[i]);
            let arrived = paths.weighted(k as usize, radiance, density);
            let from = lights.environment_index();
            light.add(paths.id[k as usize], from, segment, arrived);
        }
    }

    /// Ends paths that carry little, and lets the others carry their share; as `path.rs` does after reflection `bounce`.
    fn roulette(&mut self, bounce: u32, importance: &[f32]) {
        let (plan, paths) = (self.plan, &mut self.paths);
        let path = &plan.path;
        self.survival.resize(paths.len(), 0.0);
        let at = dimension::of_bounce(bounce) + dimension::ROULETTE;
        self.vertices.streams.gather(&self.going, &paths.id);
        self.vertices.streams.draw(at, [&mut self.survival]);
        self.order.retain(|&k| {
            let k = k as usize;
            let carried = product(paths.throughput(k), paths.unscaling(k));
            let survival = match plan.worth {
                None => path.survival(carried),
                Some(worth) => {
                    let importance = importance[paths.id[k] as usize / plan.paths];
                    let judge = Judge { worth, importance };
                    let at = paths.origin.get(k) + paths.direction.get(k) * self.hits[k].t;
                    judge.survival(at, path.max_bounces - bounce - 1, carried)
                }
            };
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
        let (buckets, population) = (&self.bucket, &mut self.population);
        let bucket_of = |k: u32| buckets[k as usize] as usize;
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
                samples[self.paths.id[k] as usize / self.plan.paths].first = Some(FirstSurface {
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

/// One of several paths that a point goes on with.
#[derive(Debug, Clone, Copy)]
struct Part {
    which: u32,
    of: u32,
}
