//! [`Vertex`], a surface point ready to reflect, and the steps every integrator makes there.

use super::{RayCounts, dimension, product, scaled};
use gonio_brdf::{Brdf, Model, Sample};
use gonio_num::{Frame, Vec3};
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{LightSample, LightTarget, Ray, Scene, SurfacePoint};
use std::borrow::Cow;

/// A point on a surface with its reflection function, seen from one direction.
#[derive(Debug, Clone)]
pub struct Vertex<'a> {
    /// The point.
    pub point: SurfacePoint,
    /// Local frame, facing the viewer: normal +z.
    pub frame: Frame<f32>,
    /// The reflection function.
    pub model: Cow<'a, Model<f32, 3>>,
    /// Direction to the viewer, local.
    pub wo: Vec3<f32>,
    /// Direction to the viewer, world.
    pub wo_world: Vec3<f32>,
    /// Approximate reflectance, for the auxiliary layer.
    pub albedo: [f32; 3],
    /// Index of the material.
    pub material: u32,
    /// Distance that the ray travelled to the point.
    pub distance: f32,
}

/// Follows `ray` to the first surface that stops it; a surface of opacity α stops it with probability α. Nothing if the
/// ray goes on to infinity.
///
/// - `segment`: how many reflections the path has made, so that each part of it draws numbers of its own
pub(super) fn arrive<'a>(
    scene: &'a Scene,
    ray: &Ray,
    segment: u32,
    stream: &mut SampleStream,
    counts: &mut RayCounts,
) -> Option<Vertex<'a>> {
    let wo_world = -ray.direction;
    let mut ray = *ray;
    let mut travelled = 0.0;
    for passed in 0..dimension::MOST_PASSED {
        counts.nearest += 1;
        let point = scene.intersect(&ray)?;
        let shading = scene.shade(&point, wo_world);
        if shading.alpha < 1.0 && passed + 1 < dimension::MOST_PASSED {
            stream.seek(dimension::of_opacity(segment, passed));
            if stream.next_1d() >= shading.alpha {
                travelled += point.t;
                let t_max = ray.t_max - point.t;
                ray = point.spawn_ray(ray.direction);
                ray.t_max = t_max;
                continue;
            }
        }
        return Some(Vertex {
            frame: shading.frame,
            wo: shading.frame.to_local(wo_world),
            wo_world,
            model: shading.model,
            albedo: shading.albedo,
            material: scene.geometry.instances()[point.instance as usize].material,
            distance: travelled + point.t,
            point,
        });
    }
    None
}

/// Radiance of the environment from direction `d`; black without one.
pub(super) fn environment_radiance(scene: &Scene, d: Vec3<f32>) -> [f32; 3] {
    scene
        .lights
        .environment()
        .map_or([0.0; 3], |e| e.radiance(d))
}

impl Vertex<'_> {
    /// f(ωi→ωr)·|cosθi| and the density of [`Vertex::sample`] for the world direction `wi`. Zero where `wi` and the
    /// viewer are on different sides of the true surface, which an interpolated normal could otherwise let light through.
    pub(super) fn eval_cos(&self, wi: Vec3<f32>) -> ([f32; 3], f32) {
        if !self.same_side(wi) {
            return ([0.0; 3], 0.0);
        }
        let local = self.frame.to_local(wi);
        self.model.eval_cos_and_pdf(local, self.wo)
    }

    /// Draws a direction by the reflection function: world direction, weight f·|cosθi| / pdf, density.
    pub(super) fn sample(&self, u: [f32; 3]) -> Option<Sample<f32, 3>> {
        let mut sample = self.model.sample(self.wo, u);
        if sample.pdf <= 0.0 {
            return None;
        }
        sample.wi = self.frame.to_world(sample.wi);
        self.same_side(sample.wi).then_some(sample)
    }

    fn same_side(&self, wi: Vec3<f32>) -> bool {
        wi.dot(self.point.ng) * self.wo_world.dot(self.point.ng) > 0.0
    }

    /// Light from `sample` reflected toward the viewer, times the weight that `weight` gives it for the density with which
    /// the reflection function would draw the same direction.
    pub(super) fn reflect_light(
        &self,
        scene: &Scene,
        sample: &LightSample,
        counts: &mut RayCounts,
        weight: impl Fn(f32) -> f32,
    ) -> [f32; 3] {
        let (f_cos, density) = self.eval_cos(sample.wi);
        if f_cos == [0.0; 3] {
            return [0.0; 3];
        }
        let contribution = scaled(
            product(f_cos, sample.radiance),
            weight(density) / sample.pdf,
        );
        if contribution == [0.0; 3] {
            return contribution;
        }
        let ray = match sample.target {
            LightTarget::Point(target) => self.point.spawn_ray_to(target),
            LightTarget::Infinite => self.point.spawn_ray(sample.wi),
        };
        counts.shadow += 1;
        scaled(contribution, scene.transmittance(&ray))
    }
}
