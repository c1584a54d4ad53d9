//! Sheen of cloth as a linearly transformed cosine.

use crate::part::colour::{cast, mean, only_where, scale};
use crate::part::geometry::above;
use crate::part::sheen_lobe::{SheenLobe, reflectance};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "sheen-ltc",
    summary: "sheen of cloth: a layer of upright fibres with multiple scattering, as a linearly transformed cosine",
    paper: "Zeltner, Burley & Chiang 2022, \"Practical Multiple-Scattering Sheen Using Linearly Transformed Cosines\"; coefficients by \
            Stephen Hill's fit in MaterialX 1.39",
    parameters: &[
        ParameterInfo::colour(
            "color",
            (0.0, 1.0),
            Some([1.0; 3]),
            "scale of the reflected light",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.5),
            "how far the fibres lean from the normal: √ of the cross section of the fibres' microflakes; not below 0.01",
        ),
    ],
    positional: Some("color"),
    aliases: &[],
    recordable: true,
    declares: |spec| Declares {
        reciprocal: false,
        ..Declares::physical(0.75 * spec.largest("color"))
    },
};

/// f = c R(μr) D(ωi)/cosθi, D(ω) = a²cosθi/(π |M⁻¹ω|⁴), M⁻¹ = (a 0 b; 0 a 0; 0 0 1) in the frame of the viewer's azimuth.
///
/// R, a and b are functions of μr and the roughness, fitted to a layer of unit thickness and density that is filled with upright
/// fibres (an SGGX microflake medium of cross section σ = roughness², which absorbs nothing). A test walks through the layer at random: R
/// is within 0.02 of it and the mean direction within 0.04. R is at most 0.75: the rest passes through to what lies below.
///
/// Each viewer has a lobe of its own: the function is not reciprocal, as the layer is. To put it over something, scale that by
/// 1 − R.
///
/// Sampling: exact, a transformed cosine-distributed direction. Every draw has the weight c R.
#[derive(Debug, Clone, Copy)]
pub struct SheenLtc<R: Real, const N: usize> {
    /// c, [0, 1].
    pub color: [R; N],
    /// Roughness, [0, 1].
    pub roughness: R,
}

impl<R: Real, const N: usize> SheenLtc<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            color: spec.colour("color")?,
            roughness: spec.real("roughness"),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> SheenLtc<S, N> {
        SheenLtc {
            color: cast(self.color, f),
            roughness: f(self.roughness),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "color" => self.color = super::components(value),
            _ => self.roughness = value[0],
        }
    }

    /// f, from the density over cosθi.
    #[inline(always)]
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>, over_cos: R) -> [R; N] {
        let f = scale(self.color, reflectance(wo.z, self.roughness) * over_cos);
        only_where(above(wi, wo), f)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for SheenLtc<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let lobe = SheenLobe::new(wo, self.roughness);
        self.value(wi, wo, lobe.density_over_cos(wi))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let density = SheenLobe::new(wo, self.roughness).density_over_cos(wi) * wi.z;
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let over_cos = SheenLobe::new(wo, self.roughness).density_over_cos(wi);
        let density = R::select(above(wi, wo), over_cos * wi.z, R::zero());
        (self.value(wi, wo, over_cos), density)
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let wi = SheenLobe::new(wo, self.roughness).sample([u[0], u[1]]);
        self.sample_of(wi, wo)
    }

    /// The albedo, exactly.
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(self.color) * reflectance(wo.z, self.roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;

    #[test]
    fn every_draw_has_the_weight_of_the_reflectance() {
        let model: Model<f64, 3> = ModelSpec::parse("sheen-ltc:1/0.5/0.2,roughness=0.4")
            .unwrap()
            .build()
            .unwrap();
        let wo = Vec3::new(0.64, 0.48, 0.6);
        let r: f64 = reflectance(0.6, 0.4);
        for k in 1..50 {
            let u = [0.61, 0.37].map(|x| (f64::from(k) * x).fract());
            let s = model.sample(wo, [u[0], u[1], 0.0]);
            for (weight, c) in s.weight.into_iter().zip([1.0, 0.5, 0.2]) {
                assert!((weight - c * r).abs() < 1e-12, "{weight}");
            }
        }
    }
}
