//! [`Vertex`], a surface point ready to reflect, and the steps every integrator makes there.

use super::{RayCounts, dimension, product, scaled};
use gonio_brdf::{Brdf, Model, Sample};
use gonio_num::{Frame, Vec3};
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{
    Interior, LightSample, LightTarget, Ray, Receiver, Scene, Shading, SurfacePoint,
};
use std::borrow::Cow;

/// A point on a surface with its reflection function, seen from one direction.
#[derive(Debug, Clone)]
pub struct Vertex<'a> {
    /// The point.
    pub point: SurfacePoint,
    /// Local frame: normal +z on the viewer's side for a function that only reflects, on the outer side for one that transmits.
    pub frame: Frame<f32>,
    /// The reflection function.
    pub model: Cow<'a, Model<f32, 3>>,
    /// Whether the reflection function transmits.
    pub transmits: bool,
    /// Direction to the viewer, local.
    pub wo: Vec3<f32>,
    /// Direction to the viewer, world.
    pub wo_world: Vec3<f32>,
    /// Whether the surface bounds a body, where bodies absorb.
    pub bounds_a_body: bool,
    /// Approximate reflectance, for the auxiliary layer.
    pub albedo: [f32; 3],
    /// Index of the material.
    pub material: u32,
    /// Distance that the ray travelled to the point.
    pub distance: f32,
    /// Whether light from an angle counts with its cosine, as it does in nature.
    pub foreshortens: bool,
}

/// Follows `ray` to the first surface that stops it; a surface of opacity α stops it with probability α. Where it passes one that bounds a
/// body it enters or leaves the body. Nothing if the ray goes on to infinity.
///
/// - `interior`: the bodies that it starts in, then those that it arrives in
/// - `weight`: is multiplied by what the bodies on the way leave of the radiance
/// - `segment`: how many reflections the path has made, so that each part of it draws numbers of its own
pub(super) fn arrive<'a>(
    scene: &'a Scene,
    ray: &Ray,
    interior: &mut Interior,
    weight: &mut [f32; 3],
    segment: u32,
    stream: &mut SampleStream,
    counts: &mut RayCounts,
) -> Option<Vertex<'a>> {
    let wo_world = -ray.direction;
    let mut ray = *ray;
    let mut travelled = 0.0;
    for passed in 0..dimension::MOST_PASSED {
        counts.nearest += 1;
        let Some(point) = scene.intersect(&ray) else {
            if !interior.is_outside() {
                *weight = interior.absorb(*weight, ray.t_max);
            }
            return None;
        };
        let shading = scene.shade(&point, wo_world);
        let bounds_a_body = scene.bounds_a_body(&shading);
        if bounds_a_body {
            let body = scene.body(&point, &shading.model);
            let inner = wo_world.dot(point.ng) < 0.0;
            *weight = interior.arrive(&body, inner, *weight, point.t);
        } else if !interior.is_outside() {
            *weight = interior.absorb(*weight, point.t);
        }
        if shading.alpha < 1.0 && passed + 1 < dimension::MOST_PASSED {
            stream.seek(dimension::of_opacity(segment, passed));
            if stream.next_1d() >= shading.alpha {
                if bounds_a_body {
                    let inwards = ray.direction.dot(point.ng) < 0.0;
                    interior.cross(&scene.body(&point, &shading.model), inwards);
                }
                travelled += point.t;
                let t_max = ray.t_max - point.t;
                ray = point.spawn_ray(ray.direction);
                ray.t_max = t_max;
                continue;
            }
        }
        let mut vertex = Vertex::new(scene, point, wo_world, shading);
        vertex.distance = travelled + point.t;
        return Some(vertex);
    }
    None
}

/// Radiance of the environment from direction `d` at the point `p`; black without one.
pub(super) fn environment_radiance(scene: &Scene, p: Vec3<f32>, d: Vec3<f32>) -> [f32; 3] {
    scene
        .lights
        .environment()
        .map_or([0.0; 3], |e| e.radiance_from(p, d))
}

impl<'a> Vertex<'a> {
    /// The vertex at `point`, as a ray that comes straight from the viewer finds it.
    pub(super) fn new(
        scene: &Scene,
        point: SurfacePoint,
        wo_world: Vec3<f32>,
        shading: Shading<'a>,
    ) -> Self {
        Self {
            frame: shading.frame,
            wo: shading.frame.to_local(wo_world),
            wo_world,
            bounds_a_body: scene.bounds_a_body(&shading),
            model: shading.model,
            transmits: shading.transmits,
            albedo: shading.albedo,
            material: scene.geometry.instances()[point.instance as usize].material,
            distance: point.t,
            foreshortens: true,
            point,
        }
    }

    /// The same, at which f stands for f·|cosθi|.
    pub(super) fn without_cosine(self) -> Self {
        Self {
            foreshortens: false,
            ..self
        }
    }
}

impl Vertex<'_> {
    /// f(ωi→ωr)·|cosθi| and the density of [`Vertex::sample`] for the world direction `wi`. Zero where [`Vertex::admits`] says no.
    pub(super) fn eval_cos(&self, wi: Vec3<f32>) -> ([f32; 3], f32) {
        let local = self.frame.to_local(wi);
        if !self.admits(wi, local) {
            return ([0.0; 3], 0.0);
        }
        if !self.foreshortens {
            return self.model.eval_and_pdf(local, self.wo);
        }
        self.model.eval_cos_and_pdf(local, self.wo)
    }

    /// Draws a direction by the reflection function: world direction, weight f·|cosθi| / pdf, density.
    pub(super) fn sample(&self, u: [f32; 3]) -> Option<Sample<f32, 3>> {
        let mut sample = self.model.sample(self.wo, u);
        if sample.pdf <= 0.0 {
            return None;
        }
        let local = sample.wi;
        sample.wi = self.frame.to_world(local);
        if !self.foreshortens {
            sample.weight = scaled(sample.weight, 1.0 / local.z.abs());
        }
        self.admits(sample.wi, local).then_some(sample)
    }

    /// Whether the reflection function may scatter light from `wi` to the viewer, as far as sides are concerned. Interpolated and mapped
    /// normals could otherwise let light through a surface, or past it.
    ///
    /// A function that only reflects needs `wi` and the viewer on the same side of the true surface. For one that transmits it is the
    /// true surface that decides whether light passes, and `wi` has to lie on the same side of the frame.
    pub(super) fn admits(&self, wi: Vec3<f32>, local: Vec3<f32>) -> bool {
        if self.transmits {
            wi.dot(self.point.ng) * local.z > 0.0
        } else {
            self.same_side(wi)
        }
    }

    /// Whether `wi` and the viewer are on the same side of the true surface.
    fn same_side(&self, wi: Vec3<f32>) -> bool {
        wi.dot(self.point.ng) * self.wo_world.dot(self.point.ng) > 0.0
    }

    /// The normal of the frame, on the viewer's side.
    pub(super) fn facing_normal(&self) -> Vec3<f32> {
        if self.wo.z < 0.0 {
            -self.frame.n
        } else {
            self.frame.n
        }
    }

    /// The point as one that lights are chosen for.
    #[inline(always)]
    pub(super) fn receiver(&self) -> Receiver {
        Receiver {
            p: self.point.p,
            error: self.point.error,
            normal: if self.transmits {
                Vec3::zero()
            } else {
                self.facing_normal()
            },
        }
    }

    /// Leads from the bodies on the viewer's side to those on the side of `wi`.
    pub(super) fn cross(&self, scene: &Scene, interior: &mut Interior, wi: Vec3<f32>) {
        if self.bounds_a_body && !self.same_side(wi) {
            let inwards = wi.dot(self.point.ng) < 0.0;
            interior.cross(&scene.body(&self.point, &self.model), inwards);
        }
    }

    /// Takes the scaling of radiance by a refracting boundary out of the weight of light from `wi` again, n(ωi)²/n(ωr)²: then weights
    /// are shares of energy (Veach 1997, §5.2).
    pub(super) fn unscale(&self, weight: &mut [f32; 3], wi: Vec3<f32>) {
        if !self.transmits || self.same_side(wi) {
            return;
        }
        let inwards = wi.dot(self.point.ng) < 0.0;
        for (w, n) in weight.iter_mut().zip(self.model.relative_ior()) {
            *w *= if inwards { n * n } else { 1.0 / (n * n) };
        }
    }

    /// Light from `sample` scattered toward the viewer, times the weight that `weight` gives it for the density with which
    /// the reflection function would draw the same direction.
    ///
    /// - `interior`: the bodies on the viewer's side
    pub(super) fn reflect_light(
        &self,
        scene: &Scene,
        sample: &LightSample,
        interior: &Interior,
        counts: &mut RayCounts,
        weight: impl Fn(f32) -> f32,
    ) -> [f32; 3] {
        let contribution = self.reflect_unblocked(sample, weight);
        let (wi, target) = (sample.wi, sample.target);
        self.unblocked(scene, wi, target, contribution, interior, counts)
    }

    /// [`Vertex::reflect_light`] if nothing stands in between.
    pub(super) fn reflect_unblocked(
        &self,
        sample: &LightSample,
        weight: impl Fn(f32) -> f32,
    ) -> [f32; 3] {
        let (f_cos, density) = self.eval_cos(sample.wi);
        if f_cos == [0.0; 3] {
            return [0.0; 3];
        }
        let factor = weight(density) / sample.pdf;
        scaled(product(f_cos, sample.radiance), factor)
    }

    /// What is left of `contribution`, which comes from `target` in the direction `wi`, by what stands in between.
    ///
    /// - `interior`: the bodies on the viewer's side
    #[inline(always)]
    pub(super) fn unblocked(
        &self,
        scene: &Scene,
        wi: Vec3<f32>,
        target: LightTarget,
        contribution: [f32; 3],
        interior: &Interior,
        counts: &mut RayCounts,
    ) -> [f32; 3] {
        if contribution == [0.0; 3] {
            return contribution;
        }
        counts.shadow += 1;
        let mut beyond;
        let interior = if self.bounds_a_body {
            beyond = *interior;
            self.cross(scene, &mut beyond, wi);
            &beyond
        } else {
            interior
        };
        let left = scene.transmittance(&self.point, wi, target, interior);
        product(contribution, left)
    }
}
