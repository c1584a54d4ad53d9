//! [`Lights`], all lights of a scene, and the choice among them.

use super::batch::Together;
use super::choice::{Choice, flux};
use super::emitter::Emitter;
use super::group::{Grouped, LightGroups};
use super::punctual::illuminate;
use super::sampler::{LightChoice, LightSampler};
use super::{Light, LightSample, LightTarget, WHOLE};
use crate::{Geometry, Material, SurfacePoint};
use gonio_env::{Environment, Guide};
use gonio_num::Vec3;
use std::sync::Arc;

/// All lights of a scene. [`Lights::by`] says how one of them is chosen for a point.
#[derive(Debug)]
pub struct Lights {
    pub(super) lights: Vec<Light>,
    /// One for each light that is a surface.
    pub(super) emitters: Vec<Option<Emitter>>,
    /// In the places of [`LightChoice`].
    choices: [Choice; 3],
    pub(super) together: Together,
    environment: Option<u32>,
    pub(super) geometry: Arc<Geometry>,
    /// As the scene says it, for another environment.
    given_groups: LightGroups,
    groups: Grouped,
}

/// One light of a scene, for sums over all lights.
#[derive(Debug, Clone, Copy)]
pub struct LightRef<'a> {
    pub(super) lights: &'a Lights,
    pub(super) index: u32,
}

impl Lights {
    /// The lights of a scene: `punctual` in their order, then the instances with an emissive material, then the environment.
    ///
    /// Black lights, and surfaces without area, are kept in their places but never chosen.
    pub(crate) fn new(
        geometry: Arc<Geometry>,
        materials: &[Material],
        punctual: Vec<Light>,
        environment: Option<Environment>,
        given_groups: LightGroups,
    ) -> Self {
        let mut group_of: Vec<Option<&str>> = vec![None; punctual.len()];
        for (group, given) in group_of.iter_mut().zip(&given_groups.punctual) {
            *group = given.as_deref();
        }
        let mut lights = punctual;
        let mut emitters: Vec<Option<Emitter>> = lights.iter().map(|_| None).collect();
        for (index, instance) in geometry.instances().iter().enumerate() {
            if instance.area_light.is_none() {
                continue;
            }
            let (index, material) = (index as u32, &materials[instance.material as usize]);
            lights.push(Light::Area {
                instance: index,
                radiance: material.emission.mean(),
                two_sided: material.double_sided,
            });
            emitters.push(Some(Emitter::new(&geometry, index, material)));
            group_of.push(material.emission.group.as_deref());
        }
        for (instances, name) in &given_groups.instances {
            for instance in instances.clone() {
                if let Some(light) = geometry.instances()[instance as usize].area_light {
                    group_of[light as usize] = Some(name);
                }
            }
        }
        let environment = environment.map(|e| {
            lights.push(Light::Environment(e));
            emitters.push(None);
            group_of.push(given_groups.environment.as_deref());
            lights.len() as u32 - 1
        });
        let choices = Choice::each(&geometry, &lights, &emitters);
        let together = Together::new(&lights, &emitters);
        let groups = Grouped::new(group_of.into_iter());
        Self {
            lights,
            emitters,
            choices,
            together,
            environment,
            geometry,
            given_groups,
            groups,
        }
    }

    /// The names of the groups of lights, each once; lights that are in none are in `default` together. Empty without lights.
    pub fn groups(&self) -> &[String] {
        &self.groups.names
    }

    /// The place among [`Lights::groups`] of a light's group; nothing if there is no such light.
    pub fn group(&self, light: u32) -> Option<u32> {
        self.groups.of.get(light as usize).copied()
    }

    pub(crate) fn given_groups(&self) -> &LightGroups {
        &self.given_groups
    }

    /// The index of the environment among the lights, if there is one.
    pub fn environment_index(&self) -> Option<u32> {
        self.environment
    }

    /// Number of lights, black ones included.
    pub fn len(&self) -> usize {
        self.lights.len()
    }

    /// Whether there is no light that shines.
    pub fn is_empty(&self) -> bool {
        self.choices[0].is_none()
    }

    /// The lights in their order.
    pub fn iter(&self) -> impl Iterator<Item = &Light> {
        self.lights.iter()
    }

    /// The environment, if there is one.
    pub fn environment(&self) -> Option<&Environment> {
        match self.lights.get(self.environment? as usize) {
            Some(Light::Environment(e)) => Some(e),
            _ => None,
        }
    }

    /// The lights one by one, to sum over.
    pub fn each(&self) -> impl Iterator<Item = LightRef<'_>> {
        (0..self.lights.len() as u32).map(|index| LightRef {
            lights: self,
            index,
        })
    }

    /// The lights, of which one is chosen in this way.
    #[inline]
    pub fn by(&self, choice: LightChoice) -> LightSampler<'_> {
        LightSampler {
            lights: self,
            choice: &self.choices[choice as usize],
        }
    }

    /// The radiant flux \[W] that a light emits, in each channel: 4π I of a point light, ∫ I dω of a spot light's cone, π A L of
    /// each side of an area light. Nothing for a light that is infinitely far away, or that does not exist.
    pub fn power(&self, light: u32) -> Option<[f64; 3]> {
        let (rgb, factor) = flux(self.lights.get(light as usize)?, &self.geometry)?;
        Some(rgb.map(|c| factor * f64::from(c)))
    }

    /// A direction towards a given light, or triangle of it; its pdf is without the probability of the choice.
    pub(super) fn sample_one(
        &self,
        guide: Guide,
        (index, primitive): (u32, u32),
        (from, error): (Vec3<f32>, f32),
        u_select: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let light = &self.lights[index as usize];
        let found = match (light, &self.emitters[index as usize]) {
            (Light::Environment(e), _) => {
                let s = e.sample_from_by(guide, from, u);
                LightSample {
                    wi: s.wi,
                    target: LightTarget::Infinite,
                    radiance: s.radiance,
                    pdf: s.pdf,
                    delta: false,
                    light: index,
                }
            }
            (_, Some(emitter)) => {
                let seen = emitter.sample(&self.geometry, (from, error), primitive, u_select, u)?;
                LightSample {
                    wi: seen.wi,
                    target: LightTarget::Point(seen.p),
                    radiance: seen.radiance,
                    pdf: seen.pdf,
                    delta: false,
                    light: index,
                }
            }
            _ => illuminate(light, index, from)?,
        };
        let lit = found.radiance.iter().any(|&r| r > 0.0);
        (lit && found.pdf > 0.0 && found.pdf.is_finite()).then_some(found)
    }
}

impl<'a> LightRef<'a> {
    /// The light.
    pub fn light(&self) -> &'a Light {
        &self.lights.lights[self.index as usize]
    }

    /// Its index.
    pub fn index(&self) -> u32 {
        self.index
    }

    /// Whether a single direction leads to it, so that one sample is the whole sum.
    pub fn is_delta(&self) -> bool {
        self.light().is_delta()
    }

    /// A direction towards this light. The pdf is that of the direction alone \[sr⁻¹], 1 for a delta light.
    ///
    /// - `u_select`, `u`: uniform in \[0, 1), independent; unused for a delta light
    pub fn sample(&self, from: &SurfacePoint, u_select: f32, u: [f32; 2]) -> Option<LightSample> {
        self.sample_by(Guide::Luminance, from, u_select, u)
    }

    /// As [`LightRef::sample`], with the environment sampled by `guide`.
    pub fn sample_by(
        &self,
        guide: Guide,
        from: &SurfacePoint,
        u_select: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let from = (from.p, from.error);
        let which = (self.index, WHOLE);
        self.lights.sample_one(guide, which, from, u_select, u)
    }

    /// The density \[sr⁻¹] with which [`LightRef::sample`] at `from` chooses the direction to `hit`; 0 if `hit` is no point of
    /// this light or does not shine towards `from`.
    pub fn pdf_area(&self, from: Vec3<f32>, hit: &SurfacePoint, wi: Vec3<f32>) -> f32 {
        let lights = self.lights;
        let instance = lights.geometry.instances().get(hit.instance as usize);
        match (
            instance.and_then(|i| i.area_light),
            &lights.emitters[self.index as usize],
        ) {
            (Some(index), Some(emitter))
                if index == self.index && emitter.radiance(hit, wi).iter().any(|&r| r > 0.0) =>
            {
                emitter.pdf(&lights.geometry, from, hit, true)
            }
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
