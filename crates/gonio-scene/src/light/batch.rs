//! [`LightSamples`], directions to lights from many points.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::choice::Chosen as Drawn;
use super::emitter::{Form, Rectangle, Sphere, Toward};
use super::{Light, LightTarget, Lights, WHOLE};
use crate::Surfaces;
use gonio_env::{EnvSamples, Guide};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Vec3, Vectors, vectors::whole_steps};

/// Directions to lights, as [`LightSample`](super::LightSample) has them, as a structure of arrays.
#[derive(Debug, Clone, Default)]
pub struct LightSamples {
    /// Towards the light; world, unit.
    pub wi: Vectors,
    /// Where the shadow ray ends, where `infinite` is false.
    pub target: Vectors,
    /// Whether the light is infinitely far away.
    pub infinite: Vec<bool>,
    /// Radiance, or irradiance of a delta light.
    pub radiance: [Vec<f32>; 3],
    /// Density of `wi`; 0: there is no sample.
    pub pdf: Vec<f32>,
    /// Whether the light is a delta light.
    pub delta: Vec<bool>,
    /// Index of the light that was chosen.
    pub light: Vec<u32>,
    drawn: Vec<Drawn>,
    /// Points by how their light is sampled on lanes.
    chosen: [Vec<Chosen>; 3],
    from: Vectors,
    u: [Vec<f32>; 2],
    environment: EnvSamples,
}

/// A point and the light that was chosen for it.
#[derive(Debug, Clone, Copy)]
struct Chosen {
    point: u32,
    light: u32,
    probability: f32,
}

/// What `chosen` is by.
const ENVIRONMENT: usize = 0;
const SPHERE: usize = 1;
const RECTANGLE: usize = 2;

impl LightSamples {
    fn resize(&mut self, count: usize) {
        self.wi.resize(count);
        self.target.resize(count);
        let room = whole_steps(count);
        for column in self.radiance.iter_mut().chain([&mut self.pdf]) {
            column.resize(room, 0.0);
        }
        self.infinite.resize(room, false);
        self.delta.resize(room, false);
        self.light.resize(room, 0);
        for chosen in &mut self.chosen {
            chosen.clear();
        }
    }

    /// Puts a sample at `i`, if it carries anything.
    #[inline(always)]
    fn set(&mut self, i: usize, wi: Vec3<f32>, radiance: [f32; 3], pdf: f32, probability: f32) {
        let lit = radiance.iter().any(|&r| r > 0.0) && pdf > 0.0 && pdf.is_finite();
        self.pdf[i] = if lit { pdf * probability } else { 0.0 };
        self.wi.set(i, wi);
        self.delta[i] = false;
        for (column, value) in self.radiance.iter_mut().zip(radiance) {
            column[i] = value;
        }
    }
}

impl Lights {
    /// [`Lights::sample_by`] from many points, the same to the bit.
    ///
    /// - `normals`: as [`Receiver::normal`](super::Receiver::normal); may be empty unless [`Lights::ask_for_normals`]
    /// - `choice`, `u`: one number a point, uniform in \[0, 1), independent
    ///
    /// # Panics
    /// If there are fewer numbers than points.
    pub fn sample_many(
        &self,
        guide: Guide,
        from: &Surfaces,
        normals: &Vectors,
        choice: &[f32],
        u: [&[f32]; 2],
        samples: &mut LightSamples,
    ) {
        let count = from.p.len();
        samples.resize(count);
        let mut drawn = std::mem::take(&mut samples.drawn);
        self.choice.choose_many(from, normals, choice, &mut drawn);
        for (i, drawn) in drawn.iter().enumerate() {
            let (light, probability) = (drawn.light, drawn.probability);
            if probability <= 0.0 {
                samples.pdf[i] = 0.0;
                continue;
            }
            samples.light[i] = light;
            let kind = match (&self.lights[light as usize], &self.emitters[light as usize]) {
                (Light::Environment(_), _) => Some(ENVIRONMENT),
                (_, Some(emitter)) if emitter.even_radiance().is_some() => match emitter.form {
                    Form::Sphere(_) => Some(SPHERE),
                    Form::Rectangle(_) => Some(RECTANGLE),
                    Form::Any => None,
                },
                _ => None,
            };
            if let Some(kind) = kind {
                samples.chosen[kind].push(Chosen {
                    point: i as u32,
                    light,
                    probability,
                });
            } else {
                let place = (from.p.get(i), from.error[i]);
                self.sample_singly(
                    guide,
                    (light, drawn.primitive),
                    place,
                    (drawn.rest, probability),
                    [u[0][i], u[1][i]],
                    i,
                    samples,
                );
            }
        }
        samples.drawn = drawn;
        self.sample_environment(guide, from, u, samples);
        let spheres = std::mem::take(&mut samples.chosen[SPHERE]);
        self.sample_surfaces::<OfSphere>(guide, &spheres, from, u, samples);
        samples.chosen[SPHERE] = spheres;
        let rectangles = std::mem::take(&mut samples.chosen[RECTANGLE]);
        self.sample_surfaces::<OfRectangle>(guide, &rectangles, from, u, samples);
        samples.chosen[RECTANGLE] = rectangles;
    }

    #[allow(
        clippy::too_many_arguments,
        reason = "a point with all that is known of it"
    )]
    fn sample_singly(
        &self,
        guide: Guide,
        which: (u32, u32),
        from: (Vec3<f32>, f32),
        (rest, probability): (f32, f32),
        u: [f32; 2],
        i: usize,
        samples: &mut LightSamples,
    ) {
        let Some(found) = self.sample_one(guide, which, from, rest, u) else {
            samples.pdf[i] = 0.0;
            return;
        };
        samples.set(i, found.wi, found.radiance, found.pdf, probability);
        samples.delta[i] = found.delta;
        samples.infinite[i] = matches!(found.target, LightTarget::Infinite);
        if let LightTarget::Point(target) = found.target {
            samples.target.set(i, target);
        }
    }

    /// The points whose light is the environment.
    fn sample_environment(
        &self,
        guide: Guide,
        from: &Surfaces,
        u: [&[f32]; 2],
        samples: &mut LightSamples,
    ) {
        let chosen = std::mem::take(&mut samples.chosen[ENVIRONMENT]);
        if let (Some(environment), false) = (self.environment(), chosen.is_empty()) {
            let mut found = std::mem::take(&mut samples.environment);
            samples.from.resize(chosen.len());
            for (column, u) in samples.u.iter_mut().zip(u) {
                column.clear();
                column.extend(chosen.iter().map(|c| u[c.point as usize]));
            }
            for (k, c) in chosen.iter().enumerate() {
                samples.from.set(k, from.p.get(c.point as usize));
            }
            let u = [&samples.u[0][..], &samples.u[1]];
            environment.sample_many(guide, &samples.from, u, &mut found);
            for (k, c) in chosen.iter().enumerate() {
                let i = c.point as usize;
                let radiance = [0, 1, 2].map(|c| found.radiance[c][k]);
                samples.set(i, found.wi.get(k), radiance, found.pdf[k], c.probability);
                samples.infinite[i] = true;
            }
            samples.environment = found;
        }
        samples.chosen[ENVIRONMENT] = chosen;
    }

    /// The points whose light is a surface that lanes know.
    fn sample_surfaces<S: OnLanes>(
        &self,
        guide: Guide,
        chosen: &[Chosen],
        from: &Surfaces,
        u: [&[f32]; 2],
        samples: &mut LightSamples,
    ) {
        if chosen.is_empty() {
            return;
        }
        dispatch(SampleSurfaces::<S> {
            lights: self,
            chosen,
            from,
            u,
            samples,
            kind: std::marker::PhantomData,
        });
        if !S::MAY_HOLD_THE_EYE {
            return;
        }
        // From within, and just off the surface, another formula holds.
        for c in chosen {
            let i = c.point as usize;
            if samples.pdf[i].is_nan() {
                let place = (from.p.get(i), from.error[i]);
                // The number that chose the light has no part in a sphere.
                let rest = (0.0, c.probability);
                let which = (c.light, WHOLE);
                self.sample_singly(guide, which, place, rest, [u[0][i], u[1][i]], i, samples);
            }
        }
    }
}

/// A kind of surface that lanes know.
trait OnLanes {
    /// Whether points without a sample are sampled in another way.
    const MAY_HOLD_THE_EYE: bool;
    fn toward<const L: usize>(
        forms: [&Form; L],
        eye: Vec3<DoubleLanes<L>>,
        error: DoubleLanes<L>,
        u: [Lanes<L>; 2],
    ) -> Toward<DoubleLanes<L>>;
}

struct OfSphere;
struct OfRectangle;

#[inline(always)]
fn put<const L: usize>(v: &mut Vec3<DoubleLanes<L>>, lane: usize, one: Vec3<f64>) {
    v.x.0[lane] = one.x;
    v.y.0[lane] = one.y;
    v.z.0[lane] = one.z;
}

impl OnLanes for OfSphere {
    const MAY_HOLD_THE_EYE: bool = true;
    #[inline(always)]
    fn toward<const L: usize>(
        forms: [&Form; L],
        eye: Vec3<DoubleLanes<L>>,
        _: DoubleLanes<L>,
        u: [Lanes<L>; 2],
    ) -> Toward<DoubleLanes<L>> {
        let one = DoubleLanes([1.0; L]);
        let mut sphere = Sphere {
            centre: Vec3::splat(one),
            radius: one,
        };
        for lane in 0..L {
            if let Form::Sphere(s) = forms[lane] {
                put(&mut sphere.centre, lane, s.centre);
                sphere.radius.0[lane] = s.radius;
            }
        }
        sphere.toward(eye, u)
    }
}

impl OnLanes for OfRectangle {
    const MAY_HOLD_THE_EYE: bool = false;
    #[inline(always)]
    fn toward<const L: usize>(
        forms: [&Form; L],
        eye: Vec3<DoubleLanes<L>>,
        error: DoubleLanes<L>,
        u: [Lanes<L>; 2],
    ) -> Toward<DoubleLanes<L>> {
        let one = Vec3::splat(DoubleLanes([1.0; L]));
        let mut rectangle = Rectangle {
            corner: one,
            edge_x: one,
            edge_y: one,
            ng: Vec3::splat(Lanes([0.0; L])),
        };
        for lane in 0..L {
            if let Form::Rectangle(r) = forms[lane] {
                put(&mut rectangle.corner, lane, r.corner);
                put(&mut rectangle.edge_x, lane, r.edge_x);
                put(&mut rectangle.edge_y, lane, r.edge_y);
                rectangle.ng.x.0[lane] = r.ng.x;
                rectangle.ng.y.0[lane] = r.ng.y;
                rectangle.ng.z.0[lane] = r.ng.z;
            }
        }
        rectangle.toward(eye, error, u)
    }
}

struct SampleSurfaces<'a, S> {
    lights: &'a Lights,
    chosen: &'a [Chosen],
    from: &'a Surfaces,
    u: [&'a [f32]; 2],
    samples: &'a mut LightSamples,
    kind: std::marker::PhantomData<S>,
}

impl<S: OnLanes> Kernel for SampleSurfaces<'_, S> {
    type Output = ();

    /// Where nothing was found the density is NaN if another formula is to be tried, else 0.
    #[inline(always)]
    fn run<const L: usize>(self) {
        const NONE: Form = Form::Any;
        let mut done = 0;
        while done < self.chosen.len() {
            let left = (self.chosen.len() - done).min(L);
            let mut forms = [&NONE; L];
            let mut eye = Vec3::splat(Lanes([0.0; L]));
            let mut error = Lanes([0.0; L]);
            let mut u = [Lanes([0.5; L]); 2];
            for lane in 0..left {
                let Chosen { point, light, .. } = self.chosen[done + lane];
                if let Some(emitter) = &self.lights.emitters[light as usize] {
                    forms[lane] = &emitter.form;
                }
                let i = point as usize;
                let p = self.from.p.get(i);
                (eye.x.0[lane], eye.y.0[lane], eye.z.0[lane]) = (p.x, p.y, p.z);
                error.0[lane] = self.from.error[i];
                u[0].0[lane] = self.u[0][i];
                u[1].0[lane] = self.u[1][i];
            }
            let toward = S::toward(forms, eye.to_double(), error.to_double(), u);
            let (wi, p) = (toward.wi.to_single(), toward.p.to_single());
            let outward = toward.ng.dot(wi);
            for lane in 0..left {
                let Chosen {
                    point,
                    light,
                    probability,
                } = self.chosen[done + lane];
                let i = point as usize;
                if !toward.found.0[lane] {
                    self.samples.pdf[i] = if S::MAY_HOLD_THE_EYE { f32::NAN } else { 0.0 };
                    continue;
                }
                let emitter = self.lights.emitters[light as usize].as_ref();
                let (radiance, two_sided) = emitter
                    .and_then(|e| e.even_radiance())
                    .unwrap_or(([0.0; 3], false));
                let dark = !two_sided && outward.0[lane] >= 0.0;
                let radiance = if dark { [0.0; 3] } else { radiance };
                let pdf = toward.pdf.0[lane];
                self.samples
                    .set(i, wi.extract(lane), radiance, pdf, probability);
                self.samples.infinite[i] = false;
                self.samples.target.set(i, p.extract(lane));
            }
            done += L;
        }
    }
}
