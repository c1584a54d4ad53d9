//! Path tracing: the reflection equation, applied again to the light that other surfaces reflect (Kajiya 1986).

use super::shares::Shares;
use super::vertex::{Vertex, arrive};
use super::{
    EnvironmentSampling, RayCounts, dimension, light_at, power_heuristic, product, scaled, sum,
};
use gonio_env::Guide;
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{Interior, Light, Scene};

/// Options of the path tracer.
///
/// At each reflection one light is sampled and one direction is drawn by the reflection function; multiple importance
/// sampling (Veach 1997, power heuristic) joins the two estimates of direct light. Passing through a surface counts as a reflection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Path {
    /// Reflections that light may make on its way from a light to the camera; 0 shows lights alone.
    pub max_bounces: u32,
    /// Reflections before Russian roulette may end a path. Roulette leaves the expected image as it is. It judges a path by the
    /// energy that it carries, not by its radiance, which is scaled inside a body of glass.
    pub roulette_after: u32,
    /// How light from the environment is sampled.
    pub environment: EnvironmentSampling,
}

impl Default for Path {
    /// 64 reflections at most, roulette after 4.
    fn default() -> Self {
        Self {
            max_bounces: 64,
            roulette_after: 4,
            environment: EnvironmentSampling::Luminance,
        }
    }
}

impl Path {
    /// Radiance that `vertex` reflects toward its viewer, which is in the bodies of `interior`.
    pub(super) fn reflected<'a>(
        &self,
        scene: &'a Scene,
        vertex: Vertex<'a>,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
    ) -> [f32; 3] {
        let mut interior = *interior;
        let mut total = [0.0; 3];
        let mut throughput = [1.0; 3];
        // What takes the scaling of radiance by n² out of the throughput, for roulette.
        let mut unscaling = [1.0; 3];
        // In one place from arrival to departure: a vertex may be large.
        let mut current = Some(vertex);
        for bounce in 0..self.max_bounces {
            let Some(vertex) = &current else {
                break;
            };
            let base = dimension::of_bounce(bounce);
            let guide = self.environment.guide(vertex);
            if !vertex.model.is_delta() {
                let (light, direct) =
                    self.direct(scene, vertex, guide, bounce, &interior, stream, counts);
                let arrived = product(throughput, direct);
                total = sum(total, arrived);
                shares.add(light, bounce + 1, arrived);
            }

            stream.seek(base + dimension::DIRECTION);
            let Some(drawn) = vertex.sample(stream.next_3d()) else {
                break;
            };
            throughput = product(throughput, drawn.weight);
            if throughput == [0.0; 3] {
                break;
            }
            vertex.unscale(&mut unscaling, drawn.wi);
            vertex.cross(scene, &mut interior, drawn.wi);
            let ray = vertex.point.spawn_ray(drawn.wi);
            let weight = |light_density: f32| {
                if drawn.delta {
                    1.0
                } else {
                    power_heuristic(drawn.pdf, light_density)
                }
            };
            let from = vertex.receiver();
            current = arrive(
                scene,
                &ray,
                &mut interior,
                &mut throughput,
                bounce + 1,
                stream,
                counts,
            );
            let Some(next) = &current else {
                if self.environment.takes_all(drawn.delta) {
                    break;
                }
                let (radiance, density) =
                    (scene.lights).environment_radiance_and_pdf_by(guide, from.p, drawn.wi);
                let arrived = scaled(product(throughput, radiance), weight(density));
                total = sum(total, arrived);
                shares.add(scene.lights.environment_index(), bounce + 1, arrived);
                break;
            };
            let radiance = scene.emitted(&next.point, next.wo_world);
            if radiance != [0.0; 3] {
                let density = scene.lights.pdf_area(&from, &next.point, drawn.wi);
                let arrived = scaled(product(throughput, radiance), weight(density));
                total = sum(total, arrived);
                shares.add(light_at(scene, &next.point), bounce + 1, arrived);
            }

            if bounce >= self.roulette_after {
                let [r, g, b] = product(throughput, unscaling);
                let survival = r.max(g).max(b).min(0.95);
                stream.seek(base + dimension::ROULETTE);
                if stream.next_1d() >= survival {
                    break;
                }
                throughput = scaled(throughput, 1.0 / survival);
            }
        }
        total
    }

    /// Light that comes straight from one of the lights, and which: scattered toward the viewer, with the weight that joins it to the
    /// direction drawn by the reflection function.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "the state of a path")]
    fn direct(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        guide: Guide,
        bounce: u32,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
    ) -> (Option<u32>, [f32; 3]) {
        stream.seek(dimension::of_bounce(bounce));
        let choice = stream.next_1d();
        let position = stream.next_2d();
        let lights = &scene.lights;
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
            return (Some(chosen.index()), scaled(direct, 1.0 / probability));
        }
        let Some(light) = lights.sample_by(guide, &at, choice, position) else {
            return (None, [0.0; 3]);
        };
        let reflected = vertex.reflect_light(scene, &light, interior, counts, |density| {
            if light.delta {
                1.0
            } else {
                power_heuristic(light.pdf, density)
            }
        });
        (Some(light.light), reflected)
    }
}
