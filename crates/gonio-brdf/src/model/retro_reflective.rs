//! A retro-reflective lobe: microfacets that send light back to where it came from.

use super::Composite;
use super::torrance_sparrow::{self, TorranceSparrow};
use crate::part::geometry::mirrored;
use crate::{Brdf, BrdfError, Declares, Model, ModelInfo, ModelSpec, Number, Sample};
use gonio_num::{Real, Vec3};
use std::marker::PhantomData;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "retro-reflective",
    summary: "a lobe back towards the light, as of traffic signs and safety cloth: a microfacet lobe with one direction mirrored",
    paper: "Belcour, Pacanowski, Delahaie, Laville-Geay & Eupherte 2014, \"BRDF Measurements and Analysis of Retroreflective \
            Materials\"; Neumann, Neumann & Szirmay-Kalos 1999 for the mirrored direction",
    // Those of the lobe that is turned back.
    parameters: torrance_sparrow::INFO.parameters,
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

/// As of the lobe that is turned back: mirroring keeps solid angles and cosines, so albedos are the same.
fn declares(spec: &ModelSpec) -> Declares {
    (torrance_sparrow::INFO.declares)(spec)
}

/// f(ωi, ωr) = F(θ′) G(ωi′, ωr) D(b)/(4 cosθi cosθr) + f_ms, with ωi′ the mirror image of ωi about the normal, b the half vector of ωi′
/// and ωr (the "back vector"), and cosθ′ = ωr·b: `torrance-sparrow` at (ωi′, ωr), whose parameters it has.
///
/// The lobe is around ωi = ωr. Beads and corner cubes return light towards its source, up to an error angle that the roughness
/// stands for. As mirroring both directions changes nothing, f(ωi, ωr) = f(ωr, ωi); and as it keeps cosines, the albedo is that of
/// the mirrored lobe, at most 1. Real materials are a sum of this, a mirror-like lobe and a diffuse part:
/// `sum(lambertian:0.1, scaled(0.5, retro-reflective:roughness=0.2), ggx:f0=0.04)`.
///
/// Sampling: that of the mirrored lobe.
#[derive(Debug, Clone)]
pub struct RetroReflective<R: Real, const N: usize, P = Model<R, N>> {
    /// The lobe that is turned back.
    lobe: Box<P>,
    colours: PhantomData<[R; N]>,
}

impl<R: Number, const N: usize> RetroReflective<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            lobe: Box::new(Model::TorranceSparrow(TorranceSparrow::from_spec(spec)?)),
            colours: PhantomData,
        })
    }

    /// Whether the lobe's formula can be written down.
    pub(crate) fn is_recordable(&self) -> bool {
        self.lobe.is_recordable()
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        if let Model::TorranceSparrow(lobe) = &mut *self.lobe {
            lobe.set(parameter, value);
        }
    }
}

impl<R: Real, const N: usize> Composite<R, N> for RetroReflective<R, N> {
    type With<S: Number, P: Brdf<S, N>> = RetroReflective<S, N, P>;

    fn with<'a, S: Number, P: Brdf<S, N>>(
        &'a self,
        _number: &impl Fn(R) -> S,
        part: &impl Fn(&'a Model<R, N>) -> P,
    ) -> RetroReflective<S, N, P>
    where
        R: 'a,
    {
        RetroReflective {
            lobe: Box::new(part(&self.lobe)),
            colours: PhantomData,
        }
    }
}

impl<R: Real, const N: usize, P: Brdf<R, N>> Brdf<R, N> for RetroReflective<R, N, P> {
    #[inline]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        self.lobe.eval(mirrored(wi), wo)
    }

    #[inline]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.lobe.pdf(mirrored(wi), wo)
    }

    #[inline]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        self.lobe.eval_and_pdf(mirrored(wi), wo)
    }

    #[inline]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let s = self.lobe.sample(wo, u);
        Sample {
            wi: mirrored(s.wi),
            ..s
        }
    }

    #[inline]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        self.lobe.albedo_estimate(wo)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::warp::around_axis;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn light_returns_to_where_it_came_from() {
        let m = model("retro-reflective:roughness=0.3,f0=0.5");
        let wo = around_axis(0.1, 0.6, 0.8);
        let back = m.eval(wo, wo)[0];
        assert!(back > 100.0 * m.eval(mirrored(wo), wo)[0]);
        // By hand: where light and viewer are together the back vector is the normal: D = 1/(π α²), cosθ′ = cosθ, and the correlated
        // G = 1/√(1 + α² tan²θ).
        let m = model("retro-reflective:alpha=0.5,f0=0.5,interreflection=none");
        let fresnel = 0.5 + 0.5 * 0.2f64.powi(5);
        let masking = 1.0 / (1.0 + 0.25 * 0.5625f64).sqrt();
        let expected = fresnel * masking / (std::f64::consts::PI * 0.25) / (4.0 * 0.64);
        assert!((m.eval(wo, wo)[0] - expected).abs() < 1e-12);
    }

    #[test]
    fn most_draws_go_back() {
        let m = model("retro-reflective:alpha=0.05,interreflection=none");
        let wo = around_axis(0.1, 0.6, 0.8);
        for k in 1..20 {
            let u = [0.61, 0.37].map(|x| (f64::from(k) * x).fract() * 0.99);
            // u < 0.99 keeps slopes below 10 α = 0.5: the direction turns by twice the angle at most.
            assert!(m.sample(wo, [u[0], u[1], 0.5]).wi.dot(wo) > 0.5);
        }
    }
}
