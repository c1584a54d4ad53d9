//! A perfect mirror (T14).

use crate::part::colour::{cast, grey, mean, mul, only_where};
use crate::part::fresnel::{self, Fresnel};
use crate::part::geometry::mirrored;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Mask, Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "mirror",
    summary: "a perfect mirror: a Dirac delta around the mirror direction",
    paper: "Cook & Torrance 1982, \"A Reflectance Model for Computer Graphics\"; Born & Wolf for Fresnel's equations",
    parameters: &[
        ParameterInfo::colour(
            "reflectance",
            (0.0, 1.0),
            Some([1.0; 3]),
            "scale of the reflection, times Fresnel reflectance",
        ),
        fresnel::parameter("none"),
        fresnel::F0,
        fresnel::F82,
        fresnel::IOR,
        fresnel::ETA,
        fresnel::K,
        fresnel::METAL,
        fresnel::FILM_THICKNESS,
        fresnel::FILM_IOR,
    ],
    positional: Some("reflectance"),
    aliases: &[],
    recordable: true,
    declares: |spec| Declares::physical(spec.largest("reflectance")),
};

/// f = ρ F(θr) δ(cosθi − cosθr)/cosθr · δ((φi − φr + π) mod 2π).
///
/// `eval` and `pdf` cannot see a delta and are 0; `sample` gives the mirror direction with weight ρ F, pdf 1 and `delta` true.
#[derive(Debug, Clone, Copy)]
pub struct Mirror<R: Real, const N: usize> {
    /// ρ, [0, 1].
    pub reflectance: [R; N],
    /// F.
    pub fresnel: Fresnel<R, N>,
}

impl<R: Real, const N: usize> Mirror<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
            fresnel: Fresnel::from_spec(spec)?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Mirror<S, N> {
        Mirror {
            reflectance: cast(self.reflectance, f),
            fresnel: self.fresnel.cast(f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        if parameter == "reflectance" {
            self.reflectance = super::components(value);
        } else {
            self.fresnel.set(parameter, value);
        }
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Mirror<R, N> {
    #[inline(always)]
    fn eval(&self, _wi: Vec3<R>, _wo: Vec3<R>) -> [R; N] {
        grey(R::zero())
    }

    #[inline(always)]
    fn pdf(&self, _wi: Vec3<R>, _wo: Vec3<R>) -> R {
        R::zero()
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, _u: [R; 3]) -> Sample<R, N> {
        let up = wo.z.gt(R::zero());
        let weight = mul(self.reflectance, self.fresnel.eval(wo.z.saturate()));
        Sample::select(
            up,
            Sample {
                wi: mirrored(wo),
                weight: only_where(up, weight),
                pdf: R::one(),
                delta: R::Mask::splat(true),
            },
            Sample::none(),
        )
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(mul(self.reflectance, self.fresnel.eval(wo.z.saturate())))
    }
}
