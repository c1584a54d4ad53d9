//! [`EnvSamples`], directions towards an environment and what comes from there, many at a time.

// Loops over an index are what vectorises.
#![allow(clippy::needless_range_loop)]

use crate::environment::{Picture, Source};
use crate::lookup::Taps;
use crate::sampling::{Begun, Guide, Inversion, SphereTable};
use crate::{Environment, Layout};
use gonio_num::dispatch::{Kernel, dispatch};
use gonio_num::lanes::Lanes;
use gonio_num::{DoubleLanes, Real, Vec3, Vectors, vectors::whole_steps};

/// [`EnvSample`](crate::EnvSample)s as a structure of arrays.
#[derive(Debug, Clone, Default)]
pub struct EnvSamples {
    /// Towards the light; world, unit.
    pub wi: Vectors,
    /// Radiance from there \[W m⁻² sr⁻¹].
    pub radiance: [Vec<f32>; 3],
    /// Density of `wi` \[sr⁻¹].
    pub pdf: Vec<f32>,
}

impl EnvSamples {
    /// Makes it `count` samples.
    pub fn resize(&mut self, count: usize) {
        self.wi.resize(count);
        for column in self.radiance.iter_mut().chain([&mut self.pdf]) {
            column.resize(whole_steps(count), 0.0);
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.wi.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.wi.is_empty()
    }

    fn set(&mut self, i: usize, radiance: [f32; 3], pdf: f32) {
        for (column, value) in self.radiance.iter_mut().zip(radiance) {
            column[i] = value;
        }
        self.pdf[i] = pdf;
    }
}

impl Environment {
    /// [`Environment::sample_from_by`] at many points, the same to the bit.
    ///
    /// - `from`: the points, which matter not without a [`Proxy`](crate::Proxy)
    /// - `u`: one pair a point, uniform in [0, 1)
    ///
    /// # Panics
    /// If there are fewer numbers than points.
    pub fn sample_many(
        &self,
        guide: Guide,
        from: &Vectors,
        u: [&[f32]; 2],
        samples: &mut EnvSamples,
    ) {
        let count = from.len();
        samples.resize(count);
        if let Some((picture, table)) = self.on_lanes(guide) {
            if let Some(inversion) = table.inversion() {
                dispatch(Sample {
                    environment: self,
                    inversion,
                    u: u.map(|u| &u[..count]),
                    samples,
                });
            } else {
                for i in 0..count {
                    let d = table.sample([u[0][i], u[1][i]]);
                    samples.wi.set(i, self.to_world(d));
                }
            }
            self.look_up(guide, picture, samples);
            return;
        }
        for i in 0..count {
            let sample = self.sample_from_by(guide, from.get(i), [u[0][i], u[1][i]]);
            samples.wi.set(i, sample.wi);
            samples.set(i, sample.radiance, sample.pdf);
        }
    }

    /// [`Environment::radiance_and_pdf_from_by`] at many points, the same to the bit.
    ///
    /// - `from`: the points
    /// - `samples`: of which the directions are given
    ///
    /// # Panics
    /// If there are fewer points than directions.
    pub fn look_up_many(&self, guide: Guide, from: &Vectors, samples: &mut EnvSamples) {
        samples.resize(samples.len());
        if let Some((picture, _)) = self.on_lanes(guide) {
            self.look_up(guide, picture, samples);
            return;
        }
        for i in 0..samples.len() {
            let d = samples.wi.get(i);
            let (radiance, pdf) = self.radiance_and_pdf_from_by(guide, from.get(i), d);
            samples.set(i, radiance, pdf);
        }
    }

    /// The picture, and the table that directions are drawn from, where lanes can do it.
    fn on_lanes(&self, guide: Guide) -> Option<(&Picture, &SphereTable)> {
        let Source::Picture(picture) = &self.source else {
            return None;
        };
        if self.proxy.is_some() {
            return None;
        }
        let table = match guide {
            Guide::Luminance => picture.table.as_ref(),
            Guide::Compensated => picture.compensated(),
            Guide::Cosine(_) => None,
        };
        Some((picture, table?))
    }

    fn look_up(&self, guide: Guide, picture: &Picture, samples: &mut EnvSamples) {
        let by_luminance = picture
            .density_of_luminance
            .filter(|_| guide == Guide::Luminance);
        let table = match guide {
            Guide::Compensated => picture.compensated(),
            _ => picture.table.as_ref(),
        };
        let (Some(table), environment) = (table, self) else {
            return;
        };
        dispatch(LookUp {
            environment,
            picture,
            by_luminance,
            table,
            samples,
        });
    }
}

/// Steps of lanes that wait for memory together.
const STEPS: usize = 4;

struct Sample<'a> {
    environment: &'a Environment,
    inversion: Inversion<'a>,
    u: [&'a [f32]; 2],
    samples: &'a mut EnvSamples,
}

impl Kernel for Sample<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let (inversion, count) = (self.inversion, self.samples.wi.len());
        let mut begun = [Begun::<L>::NONE; STEPS];
        let mut first = 0;
        while first < count {
            let steps = (count - first).div_ceil(L).min(STEPS);
            for step in 0..steps {
                let at = first + step * L;
                let u = [
                    Lanes::<L>::load_or(&self.u[0][at..], 0.5),
                    Lanes::<L>::load_or(&self.u[1][at..], 0.5),
                ];
                begun[step] = inversion.begin(u);
            }
            let mut touched = 0;
            for step in 0..steps {
                touched ^= inversion.touch(&begun[step]);
            }
            std::hint::black_box(touched);
            for step in 0..steps {
                let d = inversion.end(&begun[step]);
                self.samples
                    .wi
                    .store(first + step * L, self.environment.to_world(d));
            }
            first += STEPS * L;
        }
    }
}

struct LookUp<'a> {
    environment: &'a Environment,
    picture: &'a Picture,
    /// The density over the luminance, where they are proportional.
    by_luminance: Option<f64>,
    table: &'a SphereTable,
    samples: &'a mut EnvSamples,
}

impl Kernel for LookUp<'_> {
    type Output = ();
    #[inline(always)]
    fn run<const L: usize>(self) {
        let (environment, map) = (self.environment, &self.picture.map);
        let count = self.samples.wi.len();
        let mut taps = [Taps::<L>::NONE; STEPS];
        let mut first = 0;
        while first < count {
            let steps = (count - first).div_ceil(L).min(STEPS);
            for step in 0..steps {
                let d = environment.to_local(self.samples.wi.load::<L>(first + step * L));
                taps[step] = map.taps(d);
            }
            let mut touched = 0;
            for step in 0..steps {
                touched ^= map.touch(&taps[step]);
            }
            std::hint::black_box(touched);
            for step in 0..steps {
                let at = first + step * L;
                let radiance = map.radiances(&taps[step]);
                let pdf = match self.by_luminance {
                    Some(factor) => luminance(radiance, factor),
                    None => {
                        let d = environment.to_local(self.samples.wi.load::<L>(at));
                        self.density(d, &taps[step])
                    }
                };
                pdf.store(&mut self.samples.pdf[at..]);
                for c in 0..3 {
                    let scaled = radiance[c] * Lanes::splat(environment.scale[c]);
                    scaled.store(&mut self.samples.radiance[c][at..]);
                }
            }
            first += STEPS * L;
        }
    }
}

impl LookUp<'_> {
    /// - `taps`: those of the picture
    #[inline(always)]
    fn density<const L: usize>(&self, d: Vec3<Lanes<L>>, taps: &Taps<L>) -> Lanes<L> {
        let (map, size) = (&self.picture.map, self.table.size());
        if map.layout == Layout::LatLong && [map.width, map.height] == size {
            return self.table.densities(taps);
        }
        let taps = Taps::new(Layout::LatLong.uv(d), size, false);
        self.table.densities(&taps)
    }
}

/// The luminance times a factor.
#[inline(always)]
fn luminance<const L: usize>(rgb: [Lanes<L>; 3], factor: f64) -> Lanes<L> {
    let luminance = DoubleLanes::lit(0.2126) * rgb[0].to_double()
        + DoubleLanes::lit(0.7152) * rgb[1].to_double()
        + DoubleLanes::lit(0.0722) * rgb[2].to_double();
    (luminance * DoubleLanes::lit(factor)).to_single()
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_image::Image;
    use gonio_radiometry::sequence::Rng;

    fn picture(layout: Layout, width: usize, height: usize) -> Environment {
        let image = Image::from_fn(width, height, |x, y| {
            let bright = if (x, y) == (width / 3, height / 4) {
                500.0
            } else {
                1.0
            };
            [0.2 + (x % 7) as f32, 0.5, (y % 5) as f32].map(|c| c * bright)
        });
        Environment::from_image(image, layout)
            .unwrap()
            .rotated_deg(37.0)
            .scaled([0.5, 1.0, 2.0])
    }

    /// Every kind of environment, drawn and looked up at points one by one and all together.
    #[test]
    fn many_are_what_each_is() {
        let environments = [
            picture(Layout::LatLong, 64, 32),
            picture(Layout::LatLong, 256, 128),
            picture(Layout::LatLong, 1, 1),
            picture(Layout::MirrorBall, 32, 32),
            picture(Layout::LatLong, 64, 32).with_sampling_method(crate::SamplingMethod::Alias),
            Environment::uniform([1.0, 2.0, 3.0]),
        ];
        let mut rng = Rng::from_name("many_are_what_each_is");
        for environment in &environments {
            for guide in [Guide::Luminance, Guide::Compensated] {
                let count = 77;
                let mut from = Vectors::default();
                from.resize(count);
                let mut draw = || (0..count).map(|_| rng.next_f32()).collect::<Vec<f32>>();
                let (u, v) = (draw(), draw());
                let mut samples = EnvSamples::default();
                environment.sample_many(guide, &from, [&u, &v], &mut samples);
                let mut looked_up = samples.clone();
                environment.look_up_many(guide, &from, &mut looked_up);
                for i in 0..count {
                    let one = environment.sample_by(guide, [u[i], v[i]]);
                    assert_eq!(samples.wi.get(i), one.wi, "{guide:?} {i}");
                    for samples in [&samples, &looked_up] {
                        let radiance = [0, 1, 2].map(|c| samples.radiance[c][i]);
                        assert_eq!(radiance, one.radiance, "{guide:?} {i}");
                        assert_eq!(samples.pdf[i], one.pdf, "{guide:?} {i}");
                    }
                }
            }
        }
    }
}
