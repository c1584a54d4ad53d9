//! Path tracing: the reflection equation, applied again to the light that other surfaces reflect (Kajiya 1986).

use super::shares::Shares;
use super::vertex::{Vertex, arrive};
use super::worth::Judge;
use super::{
    EnvironmentSampling, RayCounts, dimension, light_at, power_heuristic, product, scaled, sum,
};
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{Interior, Light, LightChoice, LightSample, Scene};

/// Options of the path tracer.
///
/// At each reflection lights are sampled, and directions are drawn by the reflection function; multiple importance
/// sampling (Veach 1997, power heuristic, of as many samples as there are) joins the two estimates of direct light. Passing through a surface
/// counts as a reflection.
///
/// At the first surface both may be done several times (splitting: Arvo and Kirk 1990, "Particle Transport and Image Synthesis"), which shares
/// the cost of the way from the camera to there. At all others it is done once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Path {
    /// Reflections that light may make on its way from a light to the camera; 0 shows lights alone.
    pub max_bounces: u32,
    /// Reflections before Russian roulette may end a path. Roulette leaves the expected image as it is. It judges a path by the
    /// energy that it carries, not by its radiance, which is scaled inside a body of glass.
    pub roulette_after: u32,
    /// How light from the environment is sampled.
    pub environment: EnvironmentSampling,
    /// How the light is chosen that a light sample is of.
    pub light_choice: LightChoice,
    /// Light samples at the first surface, 1 to [`Path::MOST`]. Powers of two are stratified best.
    pub light_samples: u32,
    /// Candidates for each light sample at the first surface, 1 to [`Path::MOST`]: one is kept with a probability proportional to what it would
    /// reflect if nothing stood in between, and only its shadow ray is followed (resampled importance sampling: Talbot, Cline and Egbert 2005).
    /// Powers of two are stratified best. Not with [`EnvironmentSampling::Product`], which resamples by itself.
    pub light_candidates: u32,
    /// Directions drawn at the first surface, with a path each, 1 to [`Path::MOST`]; a surface that reflects into single directions alone
    /// has one. Powers of two are stratified best.
    pub splitting: u32,
    /// How roulette judges a path.
    pub roulette: Roulette,
}

/// How Russian roulette judges a path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Roulette {
    /// By the energy that it carries.
    #[default]
    Throughput,
    /// By what it is expected to bring for the rays that it will take, compared with the whole picture, from the first surface on
    /// (Veach 1997, §10.4; Rath et al. 2022, "EARS: Efficiency-aware Russian roulette and splitting"). It is learned from a small picture with
    /// fixed seeds. Only pictures are: single rays are judged by their energy.
    Efficiency,
}

impl Default for Path {
    /// 64 reflections at most, roulette after 4, lights chosen by a tree, nothing split.
    fn default() -> Self {
        Self {
            max_bounces: 64,
            roulette_after: 4,
            environment: EnvironmentSampling::Luminance,
            light_choice: LightChoice::Tree,
            light_samples: 1,
            light_candidates: 1,
            splitting: 1,
            roulette: Roulette::Throughput,
        }
    }
}

/// How many samples each way of finding direct light has at a surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Strategies {
    pub lights: u32,
    /// Of each light sample.
    pub candidates: u32,
    pub directions: u32,
}

/// How much a candidate counts: what it would reflect, in all channels.
#[inline(always)]
pub(super) fn weight([r, g, b]: [f32; 3]) -> f32 {
    r + g + b
}

impl Strategies {
    /// Light samples that are drawn, kept or not.
    #[inline(always)]
    pub fn drawn(self) -> u32 {
        self.lights * self.candidates
    }

    /// The density of all samples of lights together, where one has this. However many candidates there are, each sample has one shadow ray.
    #[inline(always)]
    pub fn of_lights(self, pdf: f32) -> f32 {
        self.lights as f32 * pdf
    }

    /// The density of all directions together, where one has this.
    #[inline(always)]
    pub fn of_directions(self, pdf: f32) -> f32 {
        self.directions as f32 * pdf
    }
}

/// A path on its way.
pub(super) struct Walk<'j> {
    interior: Interior,
    pub throughput: [f32; 3],
    /// What takes the scaling of radiance by n² out of the throughput, for roulette.
    pub unscaling: [f32; 3],
    /// The light so far.
    pub total: [f32; 3],
    judge: Option<Judge<'j>>,
}

impl<'j> Walk<'j> {
    pub fn new(interior: &Interior, judge: Option<Judge<'j>>) -> Self {
        Self {
            interior: *interior,
            throughput: [1.0; 3],
            unscaling: [1.0; 3],
            total: [0.0; 3],
            judge,
        }
    }
}

impl Path {
    /// The largest number of samples that one may split into.
    pub const MOST: u32 = 64;

    /// The samples after `bounce` reflections.
    ///
    /// - `delta`: whether the surface reflects into single directions alone
    #[inline(always)]
    pub(super) fn strategies(&self, bounce: u32, delta: bool) -> Strategies {
        let within = |n: u32| n.clamp(1, Self::MOST);
        let first = bounce == 0;
        Strategies {
            lights: if first { within(self.light_samples) } else { 1 },
            candidates: if first {
                within(self.light_candidates)
            } else {
                1
            },
            directions: if first && !delta {
                within(self.splitting)
            } else {
                1
            },
        }
    }

    /// The probability that a path that carries this much goes on. One of several from the first surface is judged as if it were the only one:
    /// it carries its share alone because the others carry theirs.
    #[inline(always)]
    pub(super) fn survival(&self, [r, g, b]: [f32; 3]) -> f32 {
        let paths = self.strategies(0, false).directions;
        (r.max(g).max(b) * paths as f32).min(0.95)
    }

    /// The reflection after which roulette may end a path first.
    ///
    /// - `judged`: whether it is known what paths are worth
    #[inline(always)]
    pub(super) fn first_roulette(&self, judged: bool) -> u32 {
        if judged { 0 } else { self.roulette_after }
    }

    /// Radiance that `vertex` reflects toward its viewer, which is in the bodies of `interior`.
    #[allow(clippy::too_many_arguments, reason = "a ray with all that it needs")]
    pub(super) fn reflected<'a>(
        &self,
        scene: &'a Scene,
        vertex: Vertex<'a>,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
        judge: Option<Judge<'_>>,
    ) -> [f32; 3] {
        if self.max_bounces == 0 {
            return [0.0; 3];
        }
        let mut walk = Walk::new(interior, judge);
        self.direct(scene, &vertex, 0, &mut walk, stream, counts, shares);
        let paths = self.strategies(0, vertex.model.is_delta()).directions;
        let mut part = stream.split(paths, 0);
        self.go_on(scene, &vertex, &mut walk, &mut part, counts, shares);
        let mut total = walk.total;
        for which in 1..paths {
            let mut walk = Walk::new(interior, judge);
            let mut part = stream.split(paths, which);
            // Summed as waves do, path by path.
            let mut apart = vec![[0.0; 3]; shares.values.len()];
            let mut own = Shares {
                split: shares.split,
                values: &mut apart,
            };
            self.go_on(scene, &vertex, &mut walk, &mut part, counts, &mut own);
            total = sum(total, walk.total);
            for (all, own) in shares.values.iter_mut().zip(apart) {
                *all = sum(*all, own);
            }
        }
        total
    }

    /// Follows one path from the first surface.
    fn go_on<'a>(
        &self,
        scene: &'a Scene,
        first: &Vertex<'a>,
        walk: &mut Walk<'_>,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
    ) {
        let mut current = self.step(scene, first, 0, walk, stream, counts, shares);
        for bounce in 1..self.max_bounces {
            let Some(vertex) = &current else {
                break;
            };
            self.direct(scene, vertex, bounce, walk, stream, counts, shares);
            current = self.step(scene, vertex, bounce, walk, stream, counts, shares);
        }
    }

    /// Draws a direction, goes there, and takes in what shines there. Nothing where the path ends.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "the state of a path")]
    pub(super) fn step<'a>(
        &self,
        scene: &'a Scene,
        vertex: &Vertex<'a>,
        bounce: u32,
        walk: &mut Walk<'_>,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
    ) -> Option<Vertex<'a>> {
        let strategies = self.strategies(bounce, vertex.model.is_delta());
        let base = dimension::of_bounce(bounce);
        stream.seek(base + dimension::DIRECTION);
        let drawn = vertex.sample(stream.next_3d())?;
        let share = 1.0 / strategies.directions as f32;
        walk.throughput = scaled(product(walk.throughput, drawn.weight), share);
        if walk.throughput == [0.0; 3] {
            return None;
        }
        vertex.unscale(&mut walk.unscaling, drawn.wi);
        vertex.cross(scene, &mut walk.interior, drawn.wi);
        let ray = vertex.point.spawn_ray(drawn.wi);
        let weight = |light_density: f32| {
            if drawn.delta {
                1.0
            } else {
                let own = strategies.of_directions(drawn.pdf);
                power_heuristic(own, strategies.of_lights(light_density))
            }
        };
        let from = vertex.receiver();
        let lights = scene.lights.by(self.light_choice);
        let next = arrive(
            scene,
            &ray,
            &mut walk.interior,
            &mut walk.throughput,
            bounce + 1,
            stream,
            counts,
        );
        let Some(next) = next else {
            if self.environment.takes_all(drawn.delta) {
                return None;
            }
            let guide = self.environment.guide(vertex);
            let (radiance, density) =
                lights.environment_radiance_and_pdf_by(guide, from.p, drawn.wi);
            let arrived = scaled(product(walk.throughput, radiance), weight(density));
            walk.total = sum(walk.total, arrived);
            shares.add(scene.lights.environment_index(), bounce + 1, arrived);
            return None;
        };
        let radiance = scene.emitted(&next.point, next.wo_world);
        if radiance != [0.0; 3] {
            let density = lights.pdf_area(&from, &next.point, drawn.wi);
            let arrived = scaled(product(walk.throughput, radiance), weight(density));
            walk.total = sum(walk.total, arrived);
            shares.add(light_at(scene, &next.point), bounce + 1, arrived);
        }
        if bounce >= self.first_roulette(walk.judge.is_some()) {
            let carried = product(walk.throughput, walk.unscaling);
            let survival = match &walk.judge {
                None => self.survival(carried),
                Some(judge) => {
                    let at = ray.origin + ray.direction * next.distance;
                    judge.survival(at, self.max_bounces - bounce - 1, carried)
                }
            };
            stream.seek(base + dimension::ROULETTE);
            if stream.next_1d() >= survival {
                return None;
            }
            walk.throughput = scaled(walk.throughput, 1.0 / survival);
        }
        Some(next)
    }

    /// Adds light that comes straight from the lights, with the weight that joins it to the directions drawn by the reflection function.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "the state of a path")]
    pub(super) fn direct(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        bounce: u32,
        walk: &mut Walk<'_>,
        stream: &SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
    ) {
        if vertex.model.is_delta() {
            return;
        }
        let strategies = self.strategies(bounce, false);
        for which in 0..strategies.lights {
            let interior = &walk.interior;
            let (light, direct) = if strategies.candidates == 1 {
                let mut part = stream.split(strategies.lights, which);
                self.sample_light(
                    scene, vertex, bounce, strategies, interior, &mut part, counts,
                )
            } else {
                let by = (strategies, which);
                self.resample_lights(scene, vertex, bounce, by, interior, stream, counts)
            };
            let arrived = product(walk.throughput, direct);
            walk.total = sum(walk.total, arrived);
            shares.add(light, bounce + 1, arrived);
        }
    }

    /// [`Path::sample_light`] of several candidates: the one that is kept stands for all.
    ///
    /// With c_k what candidate k would reflect by itself, its share of all that are drawn, and w_k the sum of its channels, candidate j is kept with the
    /// probability w_j / Σ w_k, and c_j Σ w_k / w_j is reflected if nothing stands in between. The expectation is that of Σ c_k, each with its own
    /// shadow ray (Talbot, Cline and Egbert 2005, "Importance Resampling for Global Illumination", eq. 5).
    #[allow(clippy::too_many_arguments, reason = "the state of a path")]
    fn resample_lights(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        bounce: u32,
        (strategies, which): (Strategies, u32),
        interior: &Interior,
        stream: &SampleStream,
        counts: &mut RayCounts,
    ) -> (Option<u32>, [f32; 3]) {
        let (at, guide) = (vertex.receiver(), self.environment.guide(vertex));
        let lights = scene.lights.by(self.light_choice);
        let (mut kept, mut all) = (None, 0.0);
        for candidate in 0..strategies.candidates {
            let number = which * strategies.candidates + candidate;
            let mut part = stream.split(strategies.drawn(), number);
            part.seek(dimension::of_bounce(bounce));
            let [u, v, choice] = part.next_3d();
            let Some(mut light) = lights.sample_by(guide, &at, choice, [u, v]) else {
                continue;
            };
            light.pdf = strategies.of_lights(light.pdf);
            let reflected = vertex.reflect_unblocked(&light, |density| {
                joined(&light, strategies.of_directions(density))
            });
            let own = weight(reflected);
            all += own;
            part.seek(dimension::of_bounce(bounce) + dimension::RESAMPLING);
            if part.next_1d() * all < own {
                kept = Some((light, reflected, own));
            }
        }
        let Some((light, reflected, own)) = kept else {
            return (None, [0.0; 3]);
        };
        let standing = scaled(reflected, all / (strategies.candidates as f32 * own));
        let (wi, target) = (light.wi, light.target);
        let left = vertex.unblocked(scene, wi, target, standing, interior, counts);
        (Some(light.light), left)
    }

    /// Light that comes straight from one of the lights, and which, scattered toward the viewer: one of several samples.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "the state of a path")]
    fn sample_light(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        bounce: u32,
        strategies: Strategies,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
    ) -> (Option<u32>, [f32; 3]) {
        stream.seek(dimension::of_bounce(bounce));
        let [u, v, choice] = stream.next_3d();
        let lights = scene.lights.by(self.light_choice);
        let at = vertex.receiver();
        if let EnvironmentSampling::Product(candidates) = self.environment
            && let Some((chosen, probability)) = lights.choose(&at, choice)
            && let Light::Environment(environment) = chosen.light()
        {
            let direct = vertex.reflect_product(
                scene,
                (environment, candidates),
                bounce,
                interior,
                stream,
                counts,
            );
            let share = 1.0 / strategies.of_lights(probability);
            return (Some(chosen.index()), scaled(direct, share));
        }
        let guide = self.environment.guide(vertex);
        let Some(mut light) = lights.sample_by(guide, &at, choice, [u, v]) else {
            return (None, [0.0; 3]);
        };
        light.pdf = strategies.of_lights(light.pdf);
        let reflected = vertex.reflect_light(scene, &light, interior, counts, |density| {
            joined(&light, strategies.of_directions(density))
        });
        (Some(light.light), reflected)
    }
}

/// The weight of a light sample beside the directions that the reflection function draws with this density.
#[inline(always)]
fn joined(light: &LightSample, density: f32) -> f32 {
    if light.delta {
        1.0
    } else {
        power_heuristic(light.pdf, density)
    }
}
