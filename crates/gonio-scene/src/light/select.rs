//! [`Lights`], all lights of a scene, and the choice among them.

use super::emitter::Emitter;
use super::group::{Grouped, LightGroups};
use super::punctual::illuminate;
use super::{Light, LightSample, LightTarget, luminance};
use crate::{Geometry, Material, SurfacePoint};
use gonio_env::{Environment, Guide};
use gonio_num::Vec3;
use gonio_radiometry::warp::Discrete;
use std::f64::consts::PI;
use std::sync::Arc;

/// All lights of a scene.
///
/// One light is chosen with the probability pᵢ = ½ Φᵢ/ΣΦ + ½ 1/n, where Φᵢ is the power that it sends into the scene. Power
/// alone would starve a small lamp beside the subject of a scene under a large sky; the uniform half bounds the variance of any
/// light at twice what sampling by power, and at twice what sampling evenly, would give.
///
/// Power of a light that is infinitely far away is what passes through the bounding sphere of the scene, of radius R:
/// π R² E for parallel light, π R² ∫L dω for an environment.
#[derive(Debug)]
pub struct Lights {
    pub(super) lights: Vec<Light>,
    /// One for each light that is a surface.
    pub(super) emitters: Vec<Option<Emitter>>,
    /// None where there is nothing to choose from.
    choice: Option<Discrete>,
    environment: Option<u32>,
    geometry: Arc<Geometry>,
    /// As the scene says it, for another environment.
    given_groups: LightGroups,
    groups: Grouped,
}

/// One light of a scene, for sums over all lights.
#[derive(Debug, Clone, Copy)]
pub struct LightRef<'a> {
    lights: &'a Lights,
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
        let powers: Vec<f64> = lights.iter().map(|light| power(light, &geometry)).collect();
        let choice = Discrete::new(&probabilities(&powers)).ok();
        let groups = Grouped::new(group_of.into_iter());
        Self {
            lights,
            emitters,
            choice,
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
        self.choice.is_none()
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

    /// Chooses a light and a direction towards it.
    ///
    /// - `u_select`, `u`: uniform in \[0, 1), independent
    ///
    /// Nothing if there is no light, or if none comes from the direction chosen; the estimate is then zero. What `from` is made
    /// of and which way it faces has no influence.
    pub fn sample(&self, from: &SurfacePoint, u_select: f32, u: [f32; 2]) -> Option<LightSample> {
        self.sample_by(Guide::Luminance, from, u_select, u)
    }

    /// As [`Lights::sample`], with the environment sampled by `guide`.
    #[inline]
    pub fn sample_by(
        &self,
        guide: Guide,
        from: &SurfacePoint,
        u_select: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        self.sample_at(guide, from.p, from.error, u_select, u)
    }

    /// As [`Lights::sample_by`], from a point that is known to `error`, [`SurfacePoint::error`].
    #[inline]
    pub(super) fn sample_at(
        &self,
        guide: Guide,
        p: Vec3<f32>,
        error: f32,
        u_select: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let (light, probability, rest) = self.choose(u_select)?;
        let mut sample = self.sample_one(guide, light.index, (p, error), rest, u)?;
        sample.pdf *= probability;
        (sample.pdf > 0.0).then_some(sample)
    }

    /// Chooses a light: which, with what probability, and a number uniform in \[0, 1) again. Nothing if there is none that shines.
    #[inline]
    pub fn choose(&self, u_select: f32) -> Option<(LightRef<'_>, f32, f32)> {
        let (index, probability, rest) = self.choice.as_ref()?.sample(u_select);
        let index = index as u32;
        let lights = self;
        Some((LightRef { lights, index }, probability, rest))
    }

    /// The density \[sr⁻¹] with which [`Lights::sample`] at `from` chooses the direction `wi` by way of the emissive instance
    /// that `hit` lies on; 0 if that shines not, or not towards `from`.
    pub fn pdf_area(&self, from: Vec3<f32>, hit: &SurfacePoint, wi: Vec3<f32>) -> f32 {
        let instance = self.geometry.instances().get(hit.instance as usize);
        let Some(index) = instance.and_then(|i| i.area_light) else {
            return 0.0;
        };
        let Some(Some(emitter)) = self.emitters.get(index as usize) else {
            return 0.0;
        };
        let dark = emitter.radiance(hit, wi).iter().all(|&r| r <= 0.0);
        if dark {
            return 0.0;
        }
        self.probability(index) * emitter.pdf(&self.geometry, from, hit)
    }

    /// The radiant flux \[W] that a light emits, in each channel: 4π I of a point light, ∫ I dω of a spot light's cone, π A L of
    /// each side of an area light. Nothing for a light that is infinitely far away, or that does not exist.
    pub fn power(&self, light: u32) -> Option<[f64; 3]> {
        let times = |rgb: &[f32; 3], factor: f64| Some(rgb.map(|c| factor * f64::from(c)));
        match self.lights.get(light as usize)? {
            Light::Point { intensity, .. } => times(intensity, 4.0 * PI),
            Light::Spot {
                intensity, cone, ..
            } => times(intensity, cone.solid_angle()),
            Light::Area {
                instance,
                radiance,
                two_sided,
            } => {
                let sides = if *two_sided { 2.0 } else { 1.0 };
                times(
                    radiance,
                    sides * PI * f64::from(self.geometry.area(*instance)),
                )
            }
            Light::Directional { .. } | Light::Environment(_) => None,
        }
    }

    /// The density \[sr⁻¹] with which [`Lights::sample`] at `from` chooses the direction `wi` by way of the environment.
    pub fn pdf_environment(&self, from: Vec3<f32>, wi: Vec3<f32>) -> f32 {
        match (self.environment, self.environment()) {
            (Some(index), Some(e)) => self.probability(index) * e.pdf_from(from, wi),
            _ => 0.0,
        }
    }

    /// The environment's radiance \[W m⁻² sr⁻¹] from `wi` at `from`, together with [`Lights::pdf_environment`], for less than both
    /// cost; zeros without an environment.
    pub fn environment_radiance_and_pdf(&self, from: Vec3<f32>, wi: Vec3<f32>) -> ([f32; 3], f32) {
        self.environment_radiance_and_pdf_by(Guide::Luminance, from, wi)
    }

    /// As [`Lights::environment_radiance_and_pdf`], with the density of [`Lights::sample_by`].
    #[inline]
    pub fn environment_radiance_and_pdf_by(
        &self,
        guide: Guide,
        from: Vec3<f32>,
        wi: Vec3<f32>,
    ) -> ([f32; 3], f32) {
        match (self.environment, self.environment()) {
            (Some(index), Some(e)) => {
                let (radiance, pdf) = e.radiance_and_pdf_from_by(guide, from, wi);
                (radiance, self.probability(index) * pdf)
            }
            _ => ([0.0; 3], 0.0),
        }
    }

    /// The probability with which the environment is chosen; 0 without one.
    pub fn environment_probability(&self) -> f32 {
        self.environment
            .map_or(0.0, |index| self.probability(index))
    }

    /// The probability with which a light is chosen.
    pub fn probability(&self, light: u32) -> f32 {
        self.choice
            .as_ref()
            .map_or(0.0, |c| c.probability(light as usize))
    }

    /// A direction towards a given light; its pdf is without the probability of the choice.
    pub(super) fn sample_one(
        &self,
        guide: Guide,
        index: u32,
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
                let seen = emitter.sample(&self.geometry, (from, error), u_select, u)?;
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
        self.lights.sample_one(guide, self.index, from, u_select, u)
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
                emitter.pdf(&lights.geometry, from, hit)
            }
            _ => 0.0,
        }
    }
}

/// The power that a light sends into the scene, weighted by luminance \[W].
fn power(light: &Light, geometry: &Geometry) -> f64 {
    // A scene without extent still has lights to choose from.
    let radius = f64::from(geometry.bounds().radius()).max(1e-6);
    let cross_section = PI * radius * radius;
    match light {
        Light::Point { intensity, .. } => 4.0 * PI * luminance(*intensity),
        Light::Spot {
            intensity, cone, ..
        } => cone.solid_angle() * luminance(*intensity),
        Light::Directional { irradiance, .. } => cross_section * luminance(*irradiance),
        Light::Area {
            instance,
            radiance,
            two_sided,
        } => {
            let sides = if *two_sided { 2.0 } else { 1.0 };
            sides * PI * f64::from(geometry.area(*instance)) * luminance(*radiance)
        }
        Light::Environment(e) => cross_section * spherical_integral(e),
    }
}

/// ∫ L dω of the luminance over the sphere, by 256 stratified samples of the environment's own density.
fn spherical_integral(e: &Environment) -> f64 {
    const SIDE: u32 = 16;
    let mut sum = 0.0;
    for i in 0..SIDE * SIDE {
        let u = [i % SIDE, i / SIDE].map(|k| (k as f32 + 0.5) / SIDE as f32);
        let s = e.sample(u);
        if s.pdf > 0.0 {
            sum += luminance(s.radiance) / f64::from(s.pdf);
        }
    }
    sum / f64::from(SIDE * SIDE)
}

/// ½ Φᵢ/ΣΦ + ½ 1/n over the n lights with power; 0 for the others.
fn probabilities(powers: &[f64]) -> Vec<f32> {
    let shines = |p: f64| p > 0.0 && p.is_finite();
    let largest = powers
        .iter()
        .copied()
        .filter(|&p| shines(p))
        .fold(0.0, f64::max);
    let total: f64 = powers
        .iter()
        .filter(|&&p| shines(p))
        .map(|p| p / largest)
        .sum();
    let count = powers.iter().filter(|&&p| shines(p)).count() as f64;
    powers
        .iter()
        .map(|&p| {
            if shines(p) {
                (0.5 * (p / largest) / total + 0.5 / count) as f32
            } else {
                0.0
            }
        })
        .collect()
}

#[cfg(test)]
mod tests;
