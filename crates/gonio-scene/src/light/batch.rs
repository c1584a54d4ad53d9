//! [`LightSamples`], directions to lights from many points.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use super::choice::Chosen as Drawn;
use super::emitter::{Emitter, Form, Rectangle, Sphere, Toward};
use super::tree::Walks;
use super::{Light, LightSampler, LightTarget, Lights, WHOLE};
use crate::Surfaces;
use gonio_env::{EnvSamples, Guide};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::{LaneMask, Lanes};
use gonio_num::{DoubleLanes, Real, Vec3, Vectors, vectors::whole_steps};

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
    walks: Walks,
    /// Points by how their light is sampled on lanes, one list for each of [`Together::ways`].
    chosen: Vec<Vec<Chosen>>,
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

/// How lights are sampled on lanes, and which lights by which way.
#[derive(Debug, Default)]
pub(super) struct Together {
    ways: Vec<Way>,
    /// For each light an index of `ways`, or [`SINGLY`].
    of: Vec<u8>,
}

/// One by one.
const SINGLY: u8 = u8::MAX;
/// Surfaces of one kind up to which each has a way of its own: then what depends on the surface alone is worked out once for all points.
const MOST_APART: usize = 16;

/// What lanes do together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Environment,
    /// Spheres: this light, or several.
    Sphere(Option<u32>),
    /// Rectangles: this light, or several.
    Rectangle(Option<u32>),
}

impl Together {
    pub fn new(lights: &[Light], emitters: &[Option<Emitter>]) -> Self {
        let kind_of = |light: usize| match (&lights[light], &emitters[light]) {
            (Light::Environment(_), _) => Some(Way::Environment),
            (_, Some(emitter)) if emitter.even_radiance().is_some() => match emitter.form {
                Form::Sphere(_) => Some(Way::Sphere(None)),
                Form::Rectangle(_) => Some(Way::Rectangle(None)),
                Form::Any => None,
            },
            _ => None,
        };
        let kinds: Vec<Option<Way>> = (0..lights.len()).map(kind_of).collect();
        let count = |kind: Way| kinds.iter().filter(|k| **k == Some(kind)).count();
        let apart = [Way::Sphere(None), Way::Rectangle(None)].map(|kind| count(kind) <= MOST_APART);
        let mut ways = Vec::new();
        let of = kinds.iter().enumerate().map(|(light, kind)| {
            let own = Some(light as u32);
            let way = match (*kind)? {
                Way::Sphere(_) if apart[0] => Way::Sphere(own),
                Way::Rectangle(_) if apart[1] => Way::Rectangle(own),
                several => several,
            };
            let place = ways.iter().position(|w| *w == way).unwrap_or_else(|| {
                ways.push(way);
                ways.len() - 1
            });
            Some(place as u8)
        });
        let of = of
            .map(|place: Option<u8>| place.unwrap_or(SINGLY))
            .collect();
        Self { ways, of }
    }
}

/// Whether a sample carries anything.
#[inline(always)]
fn is_lit([r, g, b]: [f32; 3], pdf: f32) -> bool {
    ((r > 0.0) | (g > 0.0) | (b > 0.0)) & (pdf > 0.0) & (pdf < f32::INFINITY)
}

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
    }

    /// Puts a sample at `i`, if it carries anything.
    #[inline(always)]
    fn set(&mut self, i: usize, wi: Vec3<f32>, radiance: [f32; 3], pdf: f32, probability: f32) {
        let lit = is_lit(radiance, pdf);
        self.pdf[i] = if lit { pdf * probability } else { 0.0 };
        self.wi.set(i, wi);
        self.delta[i] = false;
        for (column, value) in self.radiance.iter_mut().zip(radiance) {
            column[i] = value;
        }
    }
}

impl LightSampler<'_> {
    /// [`LightSampler::sample_by`] from many points, the same to the bit.
    ///
    /// - `normals`: as [`Receiver::normal`](super::Receiver::normal); may be empty unless [`LightSampler::asks_for_normals`]
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
        let lights = self.lights;
        let count = from.p.len();
        samples.resize(count);
        let ways = &lights.together.ways;
        samples.chosen.resize_with(ways.len(), Vec::new);
        samples.chosen.iter_mut().for_each(Vec::clear);
        let mut drawn = std::mem::take(&mut samples.drawn);
        (self.choice).choose_many(from, normals, choice, &mut samples.walks, &mut drawn);
        for (i, drawn) in drawn.iter().enumerate() {
            let (light, probability) = (drawn.light, drawn.probability);
            if probability <= 0.0 {
                samples.pdf[i] = 0.0;
                continue;
            }
            samples.light[i] = light;
            let way = lights.together.of[light as usize];
            if way == SINGLY {
                let place = (from.p.get(i), from.error[i]);
                lights.sample_singly(
                    guide,
                    (light, drawn.primitive),
                    place,
                    (drawn.rest, probability),
                    [u[0][i], u[1][i]],
                    i,
                    samples,
                );
            } else {
                samples.chosen[way as usize].push(Chosen {
                    point: i as u32,
                    light,
                    probability,
                });
            }
        }
        samples.drawn = drawn;
        for (k, way) in ways.iter().enumerate() {
            let chosen = std::mem::take(&mut samples.chosen[k]);
            if !chosen.is_empty() {
                match *way {
                    Way::Environment => {
                        lights.sample_environment(guide, &chosen, from, u, samples);
                    }
                    Way::Sphere(one) => {
                        let which = (&chosen[..], one.is_some());
                        lights.sample_surfaces::<OfSphere>(guide, which, from, u, samples);
                    }
                    Way::Rectangle(one) => {
                        let which = (&chosen[..], one.is_some());
                        lights.sample_surfaces::<OfRectangle>(guide, which, from, u, samples);
                    }
                }
            }
            samples.chosen[k] = chosen;
        }
    }
}

impl Lights {
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
        chosen: &[Chosen],
        from: &Surfaces,
        u: [&[f32]; 2],
        samples: &mut LightSamples,
    ) {
        let Some(environment) = self.environment() else {
            return;
        };
        let mut found = std::mem::take(&mut samples.environment);
        if chosen.len() == from.p.len() {
            // All points: nothing needs to be gathered.
            environment.sample_many(guide, &from.p, u, &mut found);
            std::mem::swap(&mut samples.wi, &mut found.wi);
            std::mem::swap(&mut samples.radiance, &mut found.radiance);
            let [r, g, b] = &samples.radiance;
            for (i, c) in chosen.iter().enumerate() {
                let lit = is_lit([r[i], g[i], b[i]], found.pdf[i]);
                samples.pdf[i] = if lit {
                    found.pdf[i] * c.probability
                } else {
                    0.0
                };
            }
            samples.infinite[..chosen.len()].fill(true);
            samples.delta[..chosen.len()].fill(false);
        } else {
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
        }
        samples.environment = found;
    }

    /// The points whose light is a surface that lanes know.
    ///
    /// - `alike`: whether the light is the same for all
    fn sample_surfaces<S: OnLanes>(
        &self,
        guide: Guide,
        (chosen, alike): (&[Chosen], bool),
        from: &Surfaces,
        u: [&[f32]; 2],
        samples: &mut LightSamples,
    ) {
        dispatch(SampleSurfaces::<S> {
            lights: self,
            chosen,
            alike,
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
    /// Such surfaces, one in each lane.
    type Forms<const L: usize>: Copy;
    fn forms<const L: usize>(forms: [&Form; L]) -> Self::Forms<L>;
    fn toward<const L: usize>(
        forms: Self::Forms<L>,
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
    type Forms<const L: usize> = Sphere<DoubleLanes<L>>;

    #[inline(always)]
    fn forms<const L: usize>(forms: [&Form; L]) -> Self::Forms<L> {
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
        sphere
    }

    #[inline(always)]
    fn toward<const L: usize>(
        sphere: Self::Forms<L>,
        eye: Vec3<DoubleLanes<L>>,
        _: DoubleLanes<L>,
        u: [Lanes<L>; 2],
    ) -> Toward<DoubleLanes<L>> {
        sphere.toward(eye, u)
    }
}

impl OnLanes for OfRectangle {
    const MAY_HOLD_THE_EYE: bool = false;
    type Forms<const L: usize> = Rectangle<DoubleLanes<L>>;

    #[inline(always)]
    fn forms<const L: usize>(forms: [&Form; L]) -> Self::Forms<L> {
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
        rectangle
    }

    #[inline(always)]
    fn toward<const L: usize>(
        rectangle: Self::Forms<L>,
        eye: Vec3<DoubleLanes<L>>,
        error: DoubleLanes<L>,
        u: [Lanes<L>; 2],
    ) -> Toward<DoubleLanes<L>> {
        rectangle.toward(eye, error, u)
    }
}

struct SampleSurfaces<'a, S> {
    lights: &'a Lights,
    /// In the order of the points.
    chosen: &'a [Chosen],
    /// Whether the light is the same for all.
    alike: bool,
    from: &'a Surfaces,
    u: [&'a [f32]; 2],
    samples: &'a mut LightSamples,
    kind: std::marker::PhantomData<S>,
}

/// Some lights of one kind, one in each lane, as directions to them are drawn.
struct Sources<S: OnLanes, const L: usize> {
    forms: S::Forms<L>,
    radiance: [Lanes<L>; 3],
    two_sided: LaneMask<L>,
}

impl<S: OnLanes, const L: usize> Sources<S, L> {
    #[inline(always)]
    fn of(lights: &Lights, light: &[u32; L]) -> Self {
        const NONE: Form = Form::Any;
        let mut forms = [&NONE; L];
        let mut radiance = [Lanes([0.0; L]); 3];
        let mut two_sided = LaneMask([false; L]);
        for lane in 0..L {
            let Some(emitter) = &lights.emitters[light[lane] as usize] else {
                continue;
            };
            forms[lane] = &emitter.form;
            if let Some((even, both)) = emitter.even_radiance() {
                for c in 0..3 {
                    radiance[c].0[lane] = even[c];
                }
                two_sided.0[lane] = both;
            }
        }
        Self {
            forms: S::forms(forms),
            radiance,
            two_sided,
        }
    }
}

impl<S: OnLanes> Kernel for SampleSurfaces<'_, S> {
    type Output = ();

    #[inline(always)]
    fn run<const L: usize>(mut self) {
        let mut done = 0;
        let mut sources = self.sources::<L>(done);
        loop {
            self.some(done, &sources);
            done += L;
            if done >= self.chosen.len() {
                return;
            }
            if !self.alike {
                sources = self.sources(done);
            }
        }
    }
}

impl<S: OnLanes> SampleSurfaces<'_, S> {
    /// The lights of the points from `done` on; past the end the first of them again.
    #[inline(always)]
    fn sources<const L: usize>(&self, done: usize) -> Sources<S, L> {
        let mut light = [self.chosen[done].light; L];
        for (light, c) in light.iter_mut().zip(&self.chosen[done..]) {
            *light = c.light;
        }
        Sources::of(self.lights, &light)
    }

    /// Directions from up to `L` points, those from `done` on. Where nothing was found the density is NaN if another formula is to be tried,
    /// else 0.
    #[inline(always)]
    fn some<const L: usize>(&mut self, done: usize, sources: &Sources<S, L>) {
        let left = (self.chosen.len() - done).min(L);
        let chosen = &self.chosen[done..done + left];
        // Neighbours are read and written together.
        let first = chosen[0].point as usize;
        let dense = left == L && chosen[L - 1].point as usize == first + L - 1;
        let (mut eye, mut error, mut u, mut probability);
        probability = Lanes([0.0; L]);
        for (lane, c) in chosen.iter().enumerate() {
            probability.0[lane] = c.probability;
        }
        if dense {
            eye = self.from.p.load::<L>(first);
            error = Lanes::load(&self.from.error[first..]);
            u = [
                Lanes::load_or(&self.u[0][first..], 0.5),
                Lanes::load_or(&self.u[1][first..], 0.5),
            ];
        } else {
            eye = Vec3::splat(Lanes([0.0; L]));
            error = Lanes([0.0; L]);
            u = [Lanes([0.5; L]); 2];
            for (lane, c) in chosen.iter().enumerate() {
                let i = c.point as usize;
                let p = self.from.p.get(i);
                (eye.x.0[lane], eye.y.0[lane], eye.z.0[lane]) = (p.x, p.y, p.z);
                error.0[lane] = self.from.error[i];
                u[0].0[lane] = self.u[0][i];
                u[1].0[lane] = self.u[1][i];
            }
        }
        let toward = S::toward(sources.forms, eye.to_double(), error.to_double(), u);
        let (wi, p) = (toward.wi.to_single(), toward.p.to_single());
        let zero = Lanes([0.0; L]);
        let dark = !sources.two_sided & !toward.ng.dot(wi).lt(zero);
        let mut radiance = sources.radiance;
        let mut lit = LaneMask([false; L]);
        for channel in &mut radiance {
            *channel = Lanes::select(dark, zero, *channel);
            lit = lit | zero.lt(*channel);
        }
        let found = toward.found;
        let pdf = toward.pdf;
        lit = lit & found & zero.lt(pdf) & pdf.lt(Lanes::splat(f32::INFINITY));
        let missed = Lanes::splat(if S::MAY_HOLD_THE_EYE { f32::NAN } else { 0.0 });
        let pdf = Lanes::select(found, Lanes::select(lit, pdf * probability, zero), missed);
        let samples = &mut *self.samples;
        if dense {
            pdf.store(&mut samples.pdf[first..]);
            samples.wi.store(first, wi);
            samples.target.store(first, p);
            for (column, channel) in samples.radiance.iter_mut().zip(radiance) {
                channel.store(&mut column[first..]);
            }
            samples.infinite[first..first + L].fill(false);
            samples.delta[first..first + L].fill(false);
            return;
        }
        // Written and read again in memory: a lane that is chosen at run time is slow to reach in a register.
        let mut columns = [[0.0; L]; 10];
        let found = [wi.x, wi.y, wi.z, p.x, p.y, p.z];
        for (column, lanes) in columns.iter_mut().zip(found) {
            lanes.store(column);
        }
        for (column, lanes) in columns[6..].iter_mut().zip(radiance) {
            lanes.store(column);
        }
        pdf.store(&mut columns[9]);
        let wi = samples.wi.axes_mut();
        let target = samples.target.axes_mut();
        let radiance = &mut samples.radiance;
        for (to, column) in wi.into_iter().zip(&columns) {
            scatter(to, chosen, column);
        }
        for (to, column) in target.into_iter().zip(&columns[3..]) {
            scatter(to, chosen, column);
        }
        for (to, column) in radiance.iter_mut().zip(&columns[6..]) {
            scatter(to, chosen, column);
        }
        scatter(&mut samples.pdf, chosen, &columns[9]);
        for c in chosen {
            samples.infinite[c.point as usize] = false;
            samples.delta[c.point as usize] = false;
        }
    }
}

/// Puts what belongs to each point in its place.
#[inline(always)]
fn scatter(to: &mut [f32], chosen: &[Chosen], from: &[f32]) {
    for (c, &value) in chosen.iter().zip(from) {
        to[c.point as usize] = value;
    }
}
