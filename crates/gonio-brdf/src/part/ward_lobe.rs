//! What Ward's model and its successors have in common: a diffuse part beside a Gaussian lobe of the half vector's slopes.

use super::colour::{add, cast, mean, only_where, scale};
use super::distribution::Distribution;
use super::geometry::{Half, above, mirrored_about};
use super::slopes::Slopes;
use crate::model::components;
use crate::{BrdfError, ModelSpec, ParameterInfo};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// The constants of f = kd/π + ks·exp(−(h.x²/αx² + h.y²/αy²)/h.z²)/(4π αx αy)·(a factor of the two directions).
#[derive(Debug, Clone, Copy)]
pub struct WardLobe<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// ks, [0, 1].
    pub specular: [R; N],
    /// αx, αy and their axes.
    pub slopes: Slopes<R>,
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
    "scale ks of the lobe: its albedo at normal incidence on a smooth surface",
);

/// A pair of directions and their half vector, in the frame of (αx, αy).
pub(crate) struct Pair<R: Real> {
    pub(crate) wi: Vec3<R>,
    pub(crate) wo: Vec3<R>,
    pub(crate) half: Half<R>,
    /// Density of slopes at the half vector as Beckmann's D, exp(…)/(π αx αy h.z⁴).
    d: R,
}

impl<R: Real, const N: usize> WardLobe<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            specular: spec.colour("specular")?,
            slopes: Slopes::from_spec(spec)?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> WardLobe<S, N> {
        WardLobe {
            diffuse: cast(self.diffuse, f),
            specular: cast(self.specular, f),
            slopes: self.slopes.cast(f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "diffuse" => self.diffuse = components(value),
            "specular" => self.specular = components(value),
            _ => self.slopes.set(parameter, value[0]),
        }
    }

    #[inline(always)]
    fn distribution(&self) -> Distribution<R> {
        Distribution::beckmann(self.slopes.alpha_x, self.slopes.alpha_y)
    }

    #[inline(always)]
    pub(crate) fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> Pair<R> {
        let (wi, wo) = (self.slopes.in_axes(wi), self.slopes.in_axes(wo));
        let half = Half::new(wi, wo);
        Pair {
            wi,
            wo,
            half,
            d: self.distribution().density_of(&half),
        }
    }

    /// kd/π + ks·exp(…)/(4π αx αy)·`factor` above the horizon.
    #[inline(always)]
    pub(crate) fn value(&self, pair: &Pair<R>, factor: R) -> [R; N] {
        let z2 = pair.half.h().z * pair.half.h().z;
        let lobe = R::lit(0.25) * pair.d * (z2 * z2) * factor;
        let diffuse = scale(self.diffuse, R::lit(FRAC_1_PI));
        only_where(
            above(pair.wi, pair.wo),
            add(diffuse, scale(self.specular, lobe)),
        )
    }

    /// The density of drawing the light's direction: a half vector with density D h.z, or the cosine.
    ///
    /// - `gain`: an estimate of the lobe's albedo for ks = 1
    #[inline(always)]
    pub(crate) fn density(&self, pair: &Pair<R>, gain: R) -> R {
        let lobe = R::lit(0.25) * pair.d * pair.half.h().z / pair.half.cos.max(R::lit(1e-15));
        let diffuse = cosine_hemisphere_density(pair.wi);
        let mixed = self.diffuse_probability(gain).lerp(lobe, diffuse);
        R::select(above(pair.wi, pair.wo), mixed, R::zero())
    }

    /// The light's direction for the viewer's, in the local frame.
    #[inline(always)]
    pub(crate) fn draw(&self, wo: Vec3<R>, gain: R, u: [R; 3]) -> Vec3<R> {
        let local = self.slopes.in_axes(wo);
        let h = self.distribution().sample_normal(u[0], u[1]);
        let diffuse = cosine_hemisphere([u[0], u[1]]);
        let probability = self.diffuse_probability(gain);
        let wi = Vec3::select(u[2].lt(probability), diffuse, mirrored_about(local, h));
        self.slopes.from_axes(wi)
    }

    #[inline(always)]
    fn diffuse_probability(&self, gain: R) -> R {
        let (d, s) = (mean(self.diffuse), mean(self.specular) * gain);
        // Both black: whatever is drawn has weight 0.
        (d + R::lit(1e-20)) / (d + s + R::lit(1e-20))
    }

    /// Albedo, mean over the colours.
    #[inline(always)]
    pub(crate) fn albedo(&self, gain: R) -> R {
        mean(self.diffuse) + mean(self.specular) * gain
    }

    /// h·ωr as it typically is for a viewer at cosine `mu`: √(μ² + α²/2), α the larger slope scale.
    #[inline(always)]
    pub(crate) fn typical_cosine(&self, mu: R) -> R {
        let alpha = self.slopes.alpha_x.max(self.slopes.alpha_y);
        (mu * mu + R::lit(0.5) * alpha * alpha).sqrt()
    }
}
