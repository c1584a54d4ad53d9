//! A pane of glass so thin that what passes goes on in its direction.

use crate::part::colour::{cast, grey, mean, scale};
use crate::part::dielectric;
use crate::part::fresnel;
use crate::part::geometry::mirrored;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Mask, Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "thin-dielectric",
    summary: "a thin pane of glass, as of a window: reflection and straight passage, both of its faces taken together",
    paper: "Stokes 1862, \"On the Intensity of the Light Reflected from or Transmitted through a Pile of Plates\"; \
            Born & Wolf, Principles of Optics, §1.5",
    parameters: &[
        ParameterInfo::number(
            "ior",
            "",
            (0.25, 4.0),
            Some(1.5),
            "index of refraction of the pane over that of its surroundings",
        ),
        dielectric::REFLECTANCE,
        ParameterInfo::colour(
            "transmittance",
            (0.0, 1.0),
            Some([1.0; 3]),
            "scale of what passes the pane; 1 is clear",
        ),
    ],
    positional: Some("ior"),
    aliases: &[],
    recordable: true,
    declares: |spec| Declares {
        relative_ior: Some([1.0; 3]),
        ..dielectric::declares(spec)
    },
};

/// With F the Fresnel reflectance of one face, the light that goes to and fro between the two faces adds up to
///
/// - the mirror direction with ρ 2F/(1 + F)
/// - straight through with τ (1 − F)/(1 + F)
///
/// both Dirac deltas, which `eval` and `pdf` cannot see. The shift of what passes a pane of some thickness, and interference,
/// are ignored; both sides of the pane have the same index.
#[derive(Debug, Clone, Copy)]
pub struct ThinDielectric<R: Real, const N: usize> {
    /// Index of the pane over that around it.
    pub ior: R,
    /// ρ, [0, 1].
    pub reflectance: [R; N],
    /// τ, [0, 1].
    pub transmittance: [R; N],
}

impl<R: Real, const N: usize> ThinDielectric<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            ior: spec.real("ior"),
            reflectance: spec.colour("reflectance")?,
            transmittance: spec.colour("transmittance")?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> ThinDielectric<S, N> {
        ThinDielectric {
            ior: f(self.ior),
            reflectance: cast(self.reflectance, f),
            transmittance: cast(self.transmittance, f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "ior" => self.ior = value[0],
            "reflectance" => self.reflectance = super::components(value),
            _ => self.transmittance = super::components(value),
        }
    }

    /// 2F/(1 + F), the share that both faces together reflect.
    #[inline(always)]
    fn reflected(&self, wo: Vec3<R>) -> R {
        let f = fresnel::dielectric(wo.z.abs().min(R::one()), self.ior);
        R::lit(2.0) * f / (R::one() + f)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for ThinDielectric<R, N> {
    #[inline(always)]
    fn eval(&self, _wi: Vec3<R>, _wo: Vec3<R>) -> [R; N] {
        grey(R::zero())
    }

    #[inline(always)]
    fn pdf(&self, _wi: Vec3<R>, _wo: Vec3<R>) -> R {
        R::zero()
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let r = self.reflected(wo);
        let (up, through) = (r * mean(self.reflectance) + R::lit(1e-20), R::one() - r);
        let p = up / (up + through * mean(self.transmittance));
        let q = R::one() - p;
        let delta = R::Mask::splat(true);
        let drawn = Sample::select(
            u[2].lt(p),
            Sample {
                wi: mirrored(wo),
                weight: scale(self.reflectance, r / p),
                pdf: p,
                delta,
            },
            Sample {
                wi: -wo,
                weight: scale(self.transmittance, through / q.max(R::lit(1e-20))),
                pdf: q,
                delta,
            },
        );
        let valid = wo.z.abs().gt(R::zero()) & drawn.pdf.gt(R::zero());
        Sample::select(valid, drawn, Sample::none())
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        self.reflected(wo)
            .lerp(mean(self.transmittance), mean(self.reflectance))
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        true
    }
}
