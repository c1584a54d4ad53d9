//! The warm-to-cool shading of technical illustration (T20).

use crate::part::colour::{add, cast, mean, only_where, scale};
use crate::part::geometry::{above, mirror_cosine, mirrored};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Frame, Real, Vec3};
use gonio_radiometry::warp::{
    cosine_power_hemisphere, uniform_hemisphere, uniform_hemisphere_density,
};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "gooch",
    summary: "technical illustration: tones from cool to warm by the light's direction, and a highlight; not physical",
    paper: "Gooch, Gooch, Shirley & Cohen 1998, \"A Non-Photorealistic Lighting Model For Automatic Technical Illustration\", eq. 2",
    parameters: &[
        ParameterInfo::colour(
            "reflectance",
            (0.0, 1.0),
            Some([0.5; 3]),
            "the object's own colour kd",
        ),
        ParameterInfo::colour(
            "cool",
            (0.0, 1.0),
            Some([0.0, 0.0, 0.4]),
            "tone away from the light",
        ),
        ParameterInfo::colour(
            "warm",
            (0.0, 1.0),
            Some([0.4, 0.4, 0.0]),
            "tone towards the light",
        ),
        ParameterInfo::number(
            "cool_mix",
            "",
            (0.0, 1.0),
            Some(0.2),
            "how much of kd is added to the cool tone",
        ),
        ParameterInfo::number(
            "warm_mix",
            "",
            (0.0, 1.0),
            Some(0.6),
            "how much of kd is added to the warm tone",
        ),
        ParameterInfo::choice(
            "tones",
            &["published", "hemisphere"],
            Some("published"),
            "published: half way at the terminator; hemisphere: all cool there, the whole range on the lit side",
        ),
        ParameterInfo::colour(
            "specular",
            (0.0, 1.0),
            Some([0.5; 3]),
            "brightness ks of the highlight",
        ),
        ParameterInfo::number(
            "exponent",
            "",
            (0.0, 1e5),
            Some(50.0),
            "exponent p of the highlight: the larger, the narrower",
        ),
    ],
    positional: Some("reflectance"),
    aliases: &[],
    recordable: true,
    declares: |_| Declares {
        reciprocal: false,
        ..Declares::physical(f64::INFINITY)
    },
};

/// f = [t k_warm + (1 − t) k_cool]/(2π cosθi) + ks/π cosᵖα, k_warm = warm + β kd, k_cool = cool + α kd, and t one of
///
/// - published: (1 + cosθi)/2 (Gooch et al., eq. 2, where t runs on to 0 on the side that the light does not reach)
/// - hemisphere: cosθi
///
/// with α = `cool_mix`, β = `warm_mix`, and in the highlight α the angle between ωi and the mirror image of ωr.
///
/// The tone that one light makes does not fade with cosθi: the division takes back the cosine of irradiance (for cosθi ≥ 1e-3). With
/// 2π a uniform field shows the mean tone. Light that grazes the surface returns more than it brings, without a bound, and nothing is
/// reciprocal. What faces away from every light is black, as reflection functions see no light from below.
///
/// Sampling: the uniform hemisphere, mixed with the highlight's cosine power.
#[derive(Debug, Clone, Copy)]
pub struct Gooch<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub reflectance: [R; N],
    /// The cool tone without kd.
    pub cool: [R; N],
    /// The warm tone without kd.
    pub warm: [R; N],
    /// α, [0, 1].
    pub cool_mix: R,
    /// β, [0, 1].
    pub warm_mix: R,
    /// Whether t = cosθi.
    pub hemisphere: bool,
    /// ks, [0, 1].
    pub specular: [R; N],
    /// p ≥ 0.
    pub exponent: R,
}

impl<R: Real, const N: usize> Gooch<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
            cool: spec.colour("cool")?,
            warm: spec.colour("warm")?,
            cool_mix: spec.real("cool_mix"),
            warm_mix: spec.real("warm_mix"),
            hemisphere: spec.word("tones") == "hemisphere",
            specular: spec.colour("specular")?,
            exponent: spec.real("exponent"),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Gooch<S, N> {
        Gooch {
            reflectance: cast(self.reflectance, f),
            cool: cast(self.cool, f),
            warm: cast(self.warm, f),
            cool_mix: f(self.cool_mix),
            warm_mix: f(self.warm_mix),
            hemisphere: self.hemisphere,
            specular: cast(self.specular, f),
            exponent: f(self.exponent),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "reflectance" => self.reflectance = super::components(value),
            "cool" => self.cool = super::components(value),
            "warm" => self.warm = super::components(value),
            "cool_mix" => self.cool_mix = value[0],
            "warm_mix" => self.warm_mix = value[0],
            "specular" => self.specular = super::components(value),
            _ => self.exponent = value[0],
        }
    }

    /// t k_warm + (1 − t) k_cool for the light's cosine.
    #[inline(always)]
    fn tone(&self, cos: R) -> [R; N] {
        let t = if self.hemisphere {
            cos
        } else {
            R::lit(0.5) * (R::one() + cos)
        };
        let t = t.saturate();
        let own = t.lerp(self.cool_mix, self.warm_mix);
        let tones = add(scale(self.warm, t), scale(self.cool, R::one() - t));
        add(tones, scale(self.reflectance, own))
    }

    /// cosᵖα, 0 for α ≥ 90°.
    #[inline(always)]
    fn highlight(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let cos = mirror_cosine(wi, wo);
        let power = cos.clamp(R::zero(), R::one()).powf(self.exponent);
        R::select(cos.gt(R::zero()), power, R::zero())
    }

    /// Albedos for a viewer: of the tones, their mean over the hemisphere, and of the highlight.
    #[inline(always)]
    fn shares(&self) -> [R; 2] {
        let tones = mean(self.tone(R::lit(0.5)));
        let highlight = R::lit(2.0) * mean(self.specular) / (self.exponent + R::lit(2.0));
        [tones + R::lit(1e-20), highlight]
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Gooch<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let over = R::lit(0.5 * FRAC_1_PI) / wi.z.max(R::lit(1e-3));
        let highlight = self.highlight(wi, wo) * R::lit(FRAC_1_PI);
        let f = add(
            scale(self.tone(wi.z), over),
            scale(self.specular, highlight),
        );
        only_where(above(wi, wo), f)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let [tones, highlight] = self.shares();
        let lobe = self.highlight(wi, wo) * (self.exponent + R::one()) * R::lit(0.5 * FRAC_1_PI);
        let mixed = tones * uniform_hemisphere_density(wi) + highlight * lobe;
        R::select(above(wi, wo), mixed / (tones + highlight), R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let [tones, highlight] = self.shares();
        let lobe = cosine_power_hemisphere([u[0], u[1]], self.exponent);
        let lobe = Frame::from_normal(mirrored(wo)).to_world(lobe);
        let uniform = uniform_hemisphere([u[0], u[1]]);
        let draws_tone = (u[2] * (tones + highlight)).lt(tones);
        self.sample_of(Vec3::select(draws_tone, uniform, lobe), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        let [tones, highlight] = self.shares();
        tones + highlight
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use gonio_radiometry::warp::around_axis;

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn equation_2_by_hand() {
        let m = model("gooch:reflectance=1/0/0,specular=0");
        let wo = Vec3::new(0.0, 0.0, 1.0);
        for (cos, t, name) in [(0.6f64, 0.8, "published"), (0.6, 0.6, "hemisphere")] {
            let m = if name == "published" {
                m.clone()
            } else {
                model("gooch:reflectance=1/0/0,specular=0,tones=hemisphere")
            };
            let radiance = m.eval_cos(around_axis(0.1, (1.0 - cos * cos).sqrt(), cos), wo);
            let expected = [t * (0.4 + 0.6) + (1.0 - t) * 0.2, t * 0.4, (1.0 - t) * 0.4];
            for (l, e) in radiance.into_iter().zip(expected) {
                assert!((l - 0.5 * e * FRAC_1_PI).abs() < 1e-14, "{name}: {l} {e}");
            }
        }
        // The highlight at its peak is ks/π; grey, black tones.
        let m = model("gooch:reflectance=0,cool=0,warm=0,specular=0.7");
        assert!((m.eval(wo, wo)[0] - 0.7 * FRAC_1_PI).abs() < 1e-14);
    }
}
