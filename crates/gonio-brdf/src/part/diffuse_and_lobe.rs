//! What Phong's and Blinn's models have in common: a diffuse part beside a power of a cosine.

use super::colour::{add, cast, mean, only_where, scale};
use crate::model::components;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::Real;
use std::f64::consts::FRAC_1_PI;

/// The constants of f = kd/π + ks·c·(a cosine to the power p).
#[derive(Debug, Clone, Copy)]
pub struct DiffuseAndLobe<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// ks, [0, 1].
    pub specular: [R; N],
    /// p, [0, 2·10⁵].
    pub exponent: R,
    /// Whether c normalises the lobe; otherwise c = 1.
    pub normalised: bool,
}

/// `diffuse`.
pub(crate) const DIFFUSE: ParameterInfo = ParameterInfo::colour(
    "diffuse",
    (0.0, 1.0),
    Some([0.5; 3]),
    "diffuse reflectance kd",
);
/// `specular`.
pub(crate) const SPECULAR: ParameterInfo = ParameterInfo::colour(
    "specular",
    (0.0, 1.0),
    Some([0.5; 3]),
    "scale ks of the lobe",
);
/// `exponent`.
pub(crate) const fn exponent(default: f64) -> ParameterInfo {
    ParameterInfo::number(
        "exponent",
        "",
        (0.0, 2e5),
        Some(default),
        "exponent p: the larger, the narrower the lobe",
    )
}
/// `normalisation`.
pub(crate) const fn normalisation(meaning: &'static str) -> ParameterInfo {
    ParameterInfo::choice(
        "normalisation",
        &["energy", "published"],
        Some("energy"),
        meaning,
    )
}

impl<R: Real, const N: usize> DiffuseAndLobe<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            specular: spec.colour("specular")?,
            exponent: spec.real("exponent"),
            normalised: spec.word("normalisation") == "energy",
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> DiffuseAndLobe<S, N> {
        DiffuseAndLobe {
            diffuse: cast(self.diffuse, f),
            specular: cast(self.specular, f),
            exponent: f(self.exponent),
            normalised: self.normalised,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "diffuse" => self.diffuse = components(value),
            "specular" => self.specular = components(value),
            _ => self.exponent = value[0],
        }
    }

    /// kd/π + ks·`lobe` where `up`, else 0.
    #[inline(always)]
    pub(crate) fn value(&self, up: R::Mask, lobe: R) -> [R; N] {
        let diffuse = scale(self.diffuse, R::lit(FRAC_1_PI));
        only_where(up, add(diffuse, scale(self.specular, lobe)))
    }

    /// pd·`diffuse` + (1 − pd)·`lobe` where `up`, else 0: the densities of the two parts, mixed with the probability pd of
    /// [`DiffuseAndLobe::diffuse_probability`].
    #[inline(always)]
    pub(crate) fn density(&self, up: R::Mask, lobe_gain: R, diffuse: R, lobe: R) -> R {
        let mixed = self.diffuse_probability(lobe_gain).lerp(lobe, diffuse);
        R::select(up, mixed, R::zero())
    }

    /// Probability pd of the diffuse part, where the lobe's albedo at normal incidence is ks·`lobe_gain`.
    #[inline(always)]
    pub(crate) fn diffuse_probability(&self, lobe_gain: R) -> R {
        let (d, s) = (mean(self.diffuse), mean(self.specular) * lobe_gain);
        // Both black: whatever is drawn has weight 0.
        (d + R::lit(1e-20)) / (d + s + R::lit(1e-20))
    }

    /// Albedo at normal incidence, mean over the colours.
    #[inline(always)]
    pub(crate) fn albedo(&self, lobe_gain: R) -> R {
        mean(self.diffuse) + mean(self.specular) * lobe_gain
    }
}
