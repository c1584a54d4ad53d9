//! [`LightSampler`], a light drawn from all lights of a scene, and a direction towards it.

use super::choice::Choice;
use super::{LightRef, LightSample, Lights, Receiver, WHOLE};
use crate::SurfacePoint;
use gonio_env::Guide;
use gonio_num::Vec3;

/// How one of a scene's lights is chosen for a point. Every choice has the same expectation.
///
/// A light is a point, spot or directional light, an instance that shines, or the environment; black ones are never chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum LightChoice {
    /// By what it may send to the point: those that have a place by a tree of bounds on that (Conty Estévez and Kulla 2018, "Importance Sampling
    /// of Many Lights with Adaptive Tree Splitting"), emissive meshes triangle by triangle; the others, and the tree among them, half by their
    /// power and half evenly. pbrt-v4 calls it `bvh`.
    #[default]
    Tree,
    /// By its power Φᵢ, with the probability Φᵢ/ΣΦ at every point; at least 2⁻³², so that no light that shines is impossible. Power of a light
    /// that is infinitely far away is what passes through the bounding sphere of the scene. pbrt-v4: `power`. Among more than 2²⁴ lights
    /// as [`LightChoice::Uniform`].
    Power,
    /// Each of the n lights that shine with the probability 1/n, as Mitsuba 3 does; pbrt-v4: `uniform`.
    Uniform,
}

/// The lights of a scene, one of which is chosen in a given way: [`Lights::by`].
#[derive(Debug, Clone, Copy)]
pub struct LightSampler<'a> {
    pub(super) lights: &'a Lights,
    pub(super) choice: &'a Choice,
}

impl<'a> LightSampler<'a> {
    /// Chooses a light and a direction towards it.
    ///
    /// - `u_select`, `u`: uniform in \[0, 1), independent
    ///
    /// Nothing if there is no light, or if none comes from the direction chosen; the estimate is then zero.
    pub fn sample(&self, from: &Receiver, u_select: f32, u: [f32; 2]) -> Option<LightSample> {
        self.sample_by(Guide::Luminance, from, u_select, u)
    }

    /// As [`LightSampler::sample`], with the environment sampled by `guide`.
    #[inline]
    pub fn sample_by(
        &self,
        guide: Guide,
        from: &Receiver,
        u_select: f32,
        u: [f32; 2],
    ) -> Option<LightSample> {
        let chosen = self.choice.choose(from, u_select)?;
        let which = (chosen.light, chosen.primitive);
        let from = (from.p, from.error);
        let mut sample = (self.lights).sample_one(guide, which, from, chosen.rest, u)?;
        sample.pdf *= chosen.probability;
        (sample.pdf > 0.0).then_some(sample)
    }

    /// Chooses a light: which, and with what probability. Nothing if none shines, or if none may light the point.
    #[inline]
    pub fn choose(&self, from: &Receiver, u_select: f32) -> Option<(LightRef<'a>, f32)> {
        let chosen = self.choice.choose(from, u_select)?;
        let (lights, index) = (self.lights, chosen.light);
        Some((LightRef { lights, index }, chosen.probability))
    }

    /// Whether it matters for the choice of a light which way a point faces.
    pub fn asks_for_normals(&self) -> bool {
        self.choice.asks_for_normals()
    }

    /// The density \[sr⁻¹] with which [`LightSampler::sample`] at `from` chooses the direction `wi` by way of the emissive instance
    /// that `hit` lies on; 0 if that shines not, or not towards `from`.
    pub fn pdf_area(&self, from: &Receiver, hit: &SurfacePoint, wi: Vec3<f32>) -> f32 {
        let instance = self.lights.geometry.instances().get(hit.instance as usize);
        let Some(index) = instance.and_then(|i| i.area_light) else {
            return 0.0;
        };
        let Some(Some(emitter)) = self.lights.emitters.get(index as usize) else {
            return 0.0;
        };
        let dark = emitter.radiance(hit, wi).iter().all(|&r| r <= 0.0);
        if dark {
            return 0.0;
        }
        let whole = !self.choice.parts(index);
        let primitive = if whole { WHOLE } else { hit.primitive };
        let probability = self.choice.probability(from, index, primitive);
        probability * emitter.pdf(&self.lights.geometry, from.p, hit, whole)
    }

    /// The density \[sr⁻¹] with which [`LightSampler::sample`] at `from` chooses the direction `wi` by way of the environment.
    pub fn pdf_environment(&self, from: Vec3<f32>, wi: Vec3<f32>) -> f32 {
        let probability = self.environment_probability();
        self.lights
            .environment()
            .map_or(0.0, |e| probability * e.pdf_from(from, wi))
    }

    /// The environment's radiance \[W m⁻² sr⁻¹] from `wi` at `from`, together with [`LightSampler::pdf_environment`], for less than both
    /// cost; zeros without an environment.
    pub fn environment_radiance_and_pdf(&self, from: Vec3<f32>, wi: Vec3<f32>) -> ([f32; 3], f32) {
        self.environment_radiance_and_pdf_by(Guide::Luminance, from, wi)
    }

    /// As [`LightSampler::environment_radiance_and_pdf`], with the density of [`LightSampler::sample_by`].
    #[inline]
    pub fn environment_radiance_and_pdf_by(
        &self,
        guide: Guide,
        from: Vec3<f32>,
        wi: Vec3<f32>,
    ) -> ([f32; 3], f32) {
        self.lights.environment().map_or(([0.0; 3], 0.0), |e| {
            let (radiance, pdf) = e.radiance_and_pdf_from_by(guide, from, wi);
            (radiance, self.environment_probability() * pdf)
        })
    }

    /// The probability with which the environment is chosen, at any point; 0 without one.
    pub fn environment_probability(&self) -> f32 {
        self.lights
            .environment_index()
            .map_or(0.0, |index| self.choice.probability_of_infinite(index))
    }

    /// The probability with which a light is chosen at a point. Of a mesh that is chosen triangle by triangle, their sum: that takes time.
    pub fn probability(&self, from: &Receiver, light: u32) -> f32 {
        self.choice.probability_of_light(from, light)
    }
}

#[cfg(test)]
mod tests;
