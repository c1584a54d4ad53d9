//! The reflection equation alone (T13): one reflection of the light that comes straight from the lights.
//!
//! Lr(ωr) = Σᵢ Lᵢ f cosθᵢ over point, spot and directional lights (12), plus ∫ Li f cosθi dωi over area lights and the
//! environment (13). Where a surface transmits, the light may come from its other side.

use super::shares::Shares;
use super::vertex::{Vertex, arrive};
use super::{
    EnvironmentSampling, RayCounts, dimension, light_at, power_heuristic, product, scaled, sum,
};
use gonio_num::Vec3;
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{Interior, Light, Scene};

/// Options of the direct integrator.
///
/// The sum over point lights is exact. Each area light and the environment is one integral, estimated from one sample of
/// that light and one direction drawn by the reflection function, joined by multiple importance sampling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Direct {
    /// How light from the environment is sampled.
    pub environment: EnvironmentSampling,
    /// Leaves the cosine out of the equation: ∫ Li f dωi. That is no light that a surface could reflect; it shows what the cosine does.
    pub without_cosine: bool,
}

impl Direct {
    /// Radiance that `vertex` reflects toward its viewer, which is in the bodies of `interior`.
    pub(super) fn reflected(
        &self,
        scene: &Scene,
        vertex: &Vertex<'_>,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
    ) -> [f32; 3] {
        let bare;
        let vertex = if self.without_cosine {
            bare = vertex.clone().without_cosine();
            &bare
        } else {
            vertex
        };
        let mut total = [0.0; 3];
        let guide = self.environment.guide(vertex);
        if !vertex.model.is_delta() {
            for light in scene.lights.each() {
                if let EnvironmentSampling::Product(candidates) = self.environment
                    && let Light::Environment(environment) = light.light()
                {
                    let by = (environment, candidates);
                    let direct = vertex.reflect_product(scene, by, 0, interior, stream, counts);
                    total = sum(total, direct);
                    shares.add(Some(light.index()), 1, direct);
                    continue;
                }
                stream.seek(dimension::LIGHTS + 3 * light.index());
                let [part, position @ ..] = stream.next_3d();
                let Some(sample) = light.sample_by(guide, &vertex.point, part, position) else {
                    continue;
                };
                let direct = vertex.reflect_light(scene, &sample, interior, counts, |density| {
                    if sample.delta {
                        1.0
                    } else {
                        power_heuristic(sample.pdf, density)
                    }
                });
                total = sum(total, direct);
                shares.add(Some(light.index()), 1, direct);
            }
        }

        stream.seek(dimension::of_bounce(0) + dimension::DIRECTION);
        let Some(drawn) = vertex.sample(stream.next_3d()) else {
            return total;
        };
        let weight = |light_density: f32| {
            if drawn.delta {
                1.0
            } else {
                power_heuristic(drawn.pdf, light_density)
            }
        };
        let ray = vertex.point.spawn_ray(drawn.wi);
        let mut interior = *interior;
        vertex.cross(scene, &mut interior, drawn.wi);
        let mut throughput = drawn.weight;
        let next = arrive(
            scene,
            &ray,
            &mut interior,
            &mut throughput,
            1,
            stream,
            counts,
        );
        let (light, radiance, density) = match next {
            None if self.environment.takes_all(drawn.delta) => return total,
            None => {
                let lights = &scene.lights;
                let (radiance, density) = lights.environment().map_or(([0.0; 3], 0.0), |e| {
                    e.radiance_and_pdf_from_by(guide, vertex.point.p, drawn.wi)
                });
                (lights.environment_index(), radiance, density)
            }
            Some(next) => (
                light_at(scene, &next.point),
                scene.emitted(&next.point, next.wo_world),
                density_of_light(scene, vertex, &next, drawn.wi),
            ),
        };
        let arrived = scaled(product(throughput, radiance), weight(density));
        shares.add(light, 1, arrived);
        sum(total, arrived)
    }
}

/// The density with which the light that `next` lies on, if it is one, is sampled in direction `wi` from `vertex`.
fn density_of_light(scene: &Scene, vertex: &Vertex<'_>, next: &Vertex<'_>, wi: Vec3<f32>) -> f32 {
    let instance = &scene.geometry.instances()[next.point.instance as usize];
    let light = instance
        .area_light
        .and_then(|i| scene.lights.each().nth(i as usize));
    light.map_or(0.0, |light| light.pdf_area(vertex.point.p, &next.point, wi))
}
