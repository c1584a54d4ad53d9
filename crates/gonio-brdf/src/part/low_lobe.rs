//! What Löw's two models have in common: a diffuse part beside a lobe A (1 + B x)^−C with Fresnel's equations.

use super::colour::{add, cast, mean, only_where, scale};
use super::fresnel::dielectric;
use super::inverse_power::InversePower;
use crate::model::components;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::cosine_hemisphere_density;
use std::f64::consts::FRAC_1_PI;

/// The constants of f = kd/π + A S(x) F·(a factor of the two directions).
#[derive(Debug, Clone, Copy)]
pub struct LowLobe<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// A ≥ 0.
    pub specular: [R; N],
    /// S.
    pub falloff: InversePower<R>,
    /// Index of refraction in F, above 1.
    pub ior: R,
}

/// `diffuse`.
pub(crate) const DIFFUSE: ParameterInfo = ParameterInfo::colour(
    "diffuse",
    (0.0, 1.0),
    Some([0.5; 3]),
    "diffuse reflectance kd",
);
/// `specular`, with its default.
pub(crate) const fn specular(default: f64) -> ParameterInfo {
    ParameterInfo::colour(
        "specular",
        (0.0, 1e4),
        Some([default; 3]),
        "scale A of the lobe: nothing normalises it",
    )
}
/// `b`.
pub(crate) const B: ParameterInfo = ParameterInfo::number(
    "b",
    "",
    (0.01, 1e7),
    Some(1000.0),
    "B: the larger, the narrower the lobe's middle, about 1/√B wide",
);
/// `c`.
pub(crate) const C: ParameterInfo = ParameterInfo::number(
    "c",
    "",
    (0.0, 3.0),
    Some(1.2),
    "C: the smaller, the longer the lobe's tail",
);
/// `ior`.
pub(crate) const IOR: ParameterInfo = ParameterInfo::number(
    "ior",
    "",
    (1.01, 100.0),
    Some(1.5),
    "index of refraction in Fresnel's equations: fits to metals have large ones",
);

/// The largest component of kd + A·`gain`(S): a bound of the albedo, where `gain` bounds the lobe's albedo for A = F = 1.
pub(crate) fn albedo_bound(spec: &ModelSpec, gain: impl Fn(&InversePower<f64>) -> f64) -> f64 {
    let falloff = InversePower {
        b: spec.real("b"),
        c: spec.real("c"),
    };
    spec.largest_sum(&[("diffuse", 1.0), ("specular", gain(&falloff))])
}

impl<R: Real, const N: usize> LowLobe<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            specular: spec.colour("specular")?,
            falloff: InversePower {
                b: spec.real("b"),
                c: spec.real("c"),
            },
            ior: spec.real("ior"),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> LowLobe<S, N> {
        LowLobe {
            diffuse: cast(self.diffuse, f),
            specular: cast(self.specular, f),
            falloff: self.falloff.cast(f),
            ior: f(self.ior),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "diffuse" => self.diffuse = components(value),
            "specular" => self.specular = components(value),
            "b" => self.falloff.b = value[0],
            "c" => self.falloff.c = value[0],
            _ => self.ior = value[0],
        }
    }

    /// kd/π + A F(`cos`)·`lobe` where `up`, else 0.
    #[inline(always)]
    pub(crate) fn value(&self, up: R::Mask, cos: R, lobe: R) -> [R; N] {
        let diffuse = scale(self.diffuse, R::lit(FRAC_1_PI));
        let specular = scale(self.specular, dielectric(cos, self.ior) * lobe);
        only_where(up, add(diffuse, specular))
    }

    /// The density of drawing `wi` where `up`, else 0: by the cosine, or by the lobe with the density `lobe`.
    ///
    /// - `gain`: an estimate of the lobe's albedo over A F
    #[inline(always)]
    pub(crate) fn density(&self, up: R::Mask, wi: Vec3<R>, wo: Vec3<R>, gain: R, lobe: R) -> R {
        let diffuse = cosine_hemisphere_density(wi);
        let mixed = self.diffuse_probability(wo, gain).lerp(lobe, diffuse);
        R::select(up, mixed, R::zero())
    }

    /// The probability of drawing by the cosine.
    #[inline(always)]
    pub(crate) fn diffuse_probability(&self, wo: Vec3<R>, gain: R) -> R {
        // Both black: whatever is drawn has weight 0.
        let d = mean(self.diffuse) + R::lit(1e-20);
        d / (d + self.lobe_albedo(wo, gain))
    }

    /// Estimate of the albedo, mean over the colours.
    #[inline(always)]
    pub(crate) fn albedo(&self, wo: Vec3<R>, gain: R) -> R {
        mean(self.diffuse) + self.lobe_albedo(wo, gain)
    }

    #[inline(always)]
    fn lobe_albedo(&self, wo: Vec3<R>, gain: R) -> R {
        mean(self.specular) * dielectric(wo.z.saturate(), self.ior) * gain
    }
}
