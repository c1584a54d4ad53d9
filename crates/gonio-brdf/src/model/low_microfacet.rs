//! The microfacet model of Löw et al., whose lobe has a free scale.

use crate::part::geometry::{Half, above, mirrored_about};
use crate::part::inverse_power::versine;
use crate::part::low_lobe::{B, C, DIFFUSE, IOR, LowLobe, albedo_bound, specular};
use crate::part::masking::v_cavity;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::cosine_hemisphere;
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "low-microfacet",
    summary: "Löw's microfacets: diffuse and a lobe with a free scale, width and tail, to be fitted to measurements",
    paper: "Löw, Kronander, Ynnerman & Unger 2012, \"BRDF Models for Accurate and Efficient Rendering of Glossy Surfaces\", eqs 13 \
            and 15; with the 1/π of the fits in its supplement",
    parameters: &[DIFFUSE, specular(30.0), B, C, IOR],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

/// With D = S/∫ S h.z dh the lobe is 4A/π ∫ S h.z dh times F D G/(4 cosθi cosθr), whose albedo is at most 1: grooves hide what they
/// hide.
fn declares(spec: &ModelSpec) -> Declares {
    Declares::physical(albedo_bound(spec, |falloff| {
        4.0 * FRAC_1_PI * falloff.cosine_integral()
    }))
}

/// f = kd/π + A S(h) F(θ′) G(ωi, ωr)/(π cosθi cosθr),
///
/// S = (1 + B (1 − cosθh))^−C, F by Fresnel's equations for an index of refraction, and G of V-shaped grooves,
/// min(1, 2 h.z cosθi/cosθ′, 2 h.z cosθr/cosθ′). Reciprocal.
///
/// A is what a fit says: S is not normalised, so the lobe may reflect more than arrives. With it normalised this is
/// `torrance-sparrow:distribution=abc,masking=v-cavity,interreflection=none`, α² = 2/B, times 4A/π ∫ S h.z dh.
///
/// Sampling: half vectors by S, without h.z, mixed with the cosine by estimates of the albedo.
#[derive(Debug, Clone, Copy)]
pub struct LowMicrofacet<R: Real, const N: usize> {
    /// kd, A, S and the index of refraction.
    pub constants: LowLobe<R, N>,
}

/// What value and density share.
struct Pair<R: Real> {
    up: R::Mask,
    half: Half<R>,
    /// S of the half vector; 0 below the horizon.
    s: R,
}

impl<R: Real, const N: usize> LowMicrofacet<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let constants = LowLobe::from_spec(spec)?;
        Ok(Self { constants })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> LowMicrofacet<S, N> {
        let constants = self.constants.cast(f);
        LowMicrofacet { constants }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    #[inline(always)]
    fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> Pair<R> {
        let half = Half::new(wi, wo);
        Pair {
            up: above(wi, wo),
            half,
            s: self.constants.falloff.value(versine(half.h())),
        }
    }

    #[inline(always)]
    fn value(&self, pair: &Pair<R>, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let hidden = R::lit(4.0 * FRAC_1_PI) * v_cavity(wi, wo, &pair.half);
        self.constants
            .value(pair.up, pair.half.cos, pair.s * hidden)
    }

    #[inline(always)]
    fn density(&self, pair: &Pair<R>, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let falloff = &self.constants.falloff;
        let lobe = R::lit(0.25) * falloff.half_density(pair.s) / pair.half.cos.max(R::lit(1e-15));
        self.constants.density(pair.up, wi, wo, self.gain(), lobe)
    }

    /// The lobe's albedo over A F on a smooth surface: 4/π ∫ S dh.
    #[inline(always)]
    fn gain(&self) -> R {
        R::lit(8.0) * self.constants.falloff.integral(R::one())
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for LowMicrofacet<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        self.value(&self.pair(wi, wo), wi, wo)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.density(&self.pair(wi, wo), wi, wo)
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let pair = self.pair(wi, wo);
        (self.value(&pair, wi, wo), self.density(&pair, wi, wo))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let h = self.constants.falloff.sample_half(u[0], u[1]);
        let diffuse = u[2].lt(self.constants.diffuse_probability(wo, self.gain()));
        let wi = Vec3::select(
            diffuse,
            cosine_hemisphere([u[0], u[1]]),
            mirrored_about(wo, h),
        );
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        self.constants.albedo(wo, self.gain())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use gonio_radiometry::warp::around_axis;
    use std::f64::consts::PI;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn by_hand() {
        // At normal incidence S = G = 1 and F = 0.04.
        let up = Vec3::new(0.0, 0.0, 1.0);
        let m = model("low-microfacet:diffuse=0.5,specular=50,ior=1.5");
        assert!((m.eval(up, up)[0] - (0.5 + 50.0 * 0.04) / PI).abs() < 1e-13);
        // ωi and ωr at 60° from the normal and 90° of azimuth apart: |ωi + ωr|² = 2.5, so h.z = 1/√2.5, cosθ′ = √2.5/2,
        // G = min(1, 2 (1/√2.5)(1/2)/(√2.5/2)) = 0.8. C = 1: S = 1/(1 + 3 (1 − h.z)).
        let s = 0.75f64.sqrt();
        let (wi, wo) = (Vec3::new(s, 0.0, 0.5), Vec3::new(0.0, s, 0.5));
        let m = model("low-microfacet:diffuse=0,specular=2,b=3,c=1,ior=2");
        let cos = 2.5f64.sqrt() / 2.0;
        // Cook & Torrance's form of Fresnel's equations, g = √(n² + c² − 1).
        let g = (4.0 + cos * cos - 1.0).sqrt();
        let other = (cos * (g + cos) - 1.0) / (cos * (g - cos) + 1.0);
        let fresnel = 0.5 * ((g - cos) / (g + cos)).powi(2) * (1.0 + other * other);
        let expected = 2.0 / (1.0 + 3.0 * (1.0 - 0.4f64.sqrt())) * 0.8 * fresnel / (PI * 0.25);
        assert!((m.eval(wi, wo)[0] - expected).abs() < 1e-13);
    }

    /// Times a factor it is `torrance-sparrow` with the distribution of the same paper.
    #[test]
    fn normalised_it_is_torrance_sparrow() {
        let (alpha, c) = (0.2f64, 1.4);
        let b = 2.0 / (alpha * alpha);
        let m = model(&format!(
            "low-microfacet:diffuse=0,specular=7,b={b},c={c},ior=1.5"
        ));
        let t = model(&format!(
            "torrance-sparrow:distribution=abc,masking=v-cavity,interreflection=none,alpha={alpha},c={c},ior=1.5"
        ));
        let ratio = |theta: f64, phi: f64| {
            let wi = around_axis(phi, theta.sin(), theta.cos());
            let wo = Vec3::new(-0.6, 0.0, 0.8);
            m.eval(wi, wo)[0] / t.eval(wi, wo)[0]
        };
        let first = ratio(0.0, 0.0);
        for (theta, phi) in [(0.6, 0.02), (1.2, 0.3), (1.5, 0.9)] {
            assert!((ratio(theta, phi) / first - 1.0).abs() < 1e-12);
        }
    }
}
