//! Ward's model: diffuse and a Gaussian lobe, anisotropic.

use crate::part::slopes::{
    ALPHA, ALPHA_X, ALPHA_Y, ANISOTROPY, ROTATION_DEG, ROUGHNESS, isotropic,
};
use crate::part::ward_lobe::{DIFFUSE, Pair, SPECULAR, WardLobe};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "ward",
    summary: "diffuse, and a Gaussian lobe of the half vector's slopes, anisotropic, as fitted to measured metals and plastics",
    paper: "Ward 1992, \"Measuring and Modeling Anisotropic Reflection\", eq. 5a; Walter 2005, \"Notes on the Ward BRDF\" for the sampling",
    parameters: &[
        DIFFUSE,
        SPECULAR,
        ROUGHNESS,
        ALPHA,
        ANISOTROPY,
        ALPHA_X,
        ALPHA_Y,
        ROTATION_DEG,
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares: |spec| Declares {
        isotropic: isotropic(spec),
        ..Declares::physical(bound(spec, f64::INFINITY))
    },
};

/// kd + ks·`gain`, where the lobe is there.
pub(super) fn bound(spec: &ModelSpec, gain: f64) -> f64 {
    if spec.largest("specular") > 0.0 {
        spec.largest_sum(&[("diffuse", 1.0), ("specular", gain)])
    } else {
        spec.largest("diffuse")
    }
}

/// f = kd/π + ks/√(cosθi cosθr) exp(−tan²θh (cos²φh/αx² + sin²φh/αy²))/(4π αx αy).
///
/// α is the root mean square of the slope. The lobe's albedo is about ks cosθr on smooth surfaces: too dark at grazing angles;
/// and beyond cosθr ≈ α it grows without a bound. The successors mend one or both:
/// `ward-duer`.
///
/// Sampling: half vectors by the Gaussian, with their exact density (Walter 2005); the weight of a draw is
/// ks (h·ωr) h.z³ √(cosθi/cosθr).
#[derive(Debug, Clone, Copy)]
pub struct Ward<R: Real, const N: usize> {
    /// kd, ks and the slope scales.
    pub constants: WardLobe<R, N>,
}

impl<R: Real, const N: usize> Ward<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let constants = WardLobe::from_spec(spec)?;
        Ok(Self { constants })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Ward<S, N> {
        let constants = self.constants.cast(f);
        Ward { constants }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    /// 1/√(cosθi cosθr).
    #[inline(always)]
    fn factor(&self, pair: &Pair<R>) -> R {
        (pair.wi.z * pair.wo.z).max(R::lit(1e-29)).sqrt().recip()
    }

    /// The lobe's albedo for ks = 1, roughly: (h·ωr) √(cosθi/cosθr) at a typical h.
    #[inline(always)]
    fn gain(&self, wo: Vec3<R>) -> R {
        let (mu, typical) = (wo.z.max(R::lit(1e-6)), self.constants.typical_cosine(wo.z));
        typical * (typical / mu).sqrt()
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Ward<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let pair = self.constants.pair(wi, wo);
        self.constants.value(&pair, self.factor(&pair))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let pair = self.constants.pair(wi, wo);
        self.constants.density(&pair, self.gain(wo))
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let pair = self.constants.pair(wi, wo);
        (
            self.constants.value(&pair, self.factor(&pair)),
            self.constants.density(&pair, self.gain(wo)),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        self.sample_of(self.constants.draw(wo, self.gain(wo), u), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        self.constants.albedo(self.gain(wo))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Model;
    use std::f64::consts::{FRAC_1_PI, PI};

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn equation_5a_by_hand() {
        let m = model("ward:diffuse=0.3,specular=0.2,alpha_x=0.5,alpha_y=0.25");
        let up = Vec3::new(0.0, 0.0, 1.0);
        let peak = 0.3 * FRAC_1_PI + 0.2 / (4.0 * PI * 0.125);
        assert!((m.eval(up, up)[0] - peak).abs() < 1e-14);
        // ωi + ωr = (0.6, 0, 1.8): tan²θh = 1/9 along x, so exp(−4/9); cosθi cosθr = 0.8.
        let f = m.eval(Vec3::new(0.6, 0.0, 0.8), up)[0];
        let lobe = 0.2 / 0.8f64.sqrt() * (-4.0f64 / 9.0).exp() / (4.0 * PI * 0.125);
        assert!((f - 0.3 * FRAC_1_PI - lobe).abs() < 1e-14);
        // Along y: exp(−16/9).
        let f = m.eval(Vec3::new(0.0, 0.6, 0.8), up)[0];
        let lobe = 0.2 / 0.8f64.sqrt() * (-16.0f64 / 9.0).exp() / (4.0 * PI * 0.125);
        assert!((f - 0.3 * FRAC_1_PI - lobe).abs() < 1e-14);
    }

    /// The weight of each draw from the lobe is ks (h·ωr) h.z³ √(cosθi/cosθr).
    #[test]
    fn weights_are_walters() {
        let m = model("ward:diffuse=0,specular=0.8,alpha=0.3,anisotropy=0.4,rotation_deg=20");
        let wo = Vec3::new(0.48, 0.36, 0.8);
        for k in 0..50 {
            let u = [0.61, 0.37].map(|x| (f64::from(k) * x).fract());
            let s = m.sample(wo, [u[0], u[1], 0.5]);
            if s.pdf > 0.0 {
                let h = (s.wi + wo).normalize();
                let weight = 0.8 * h.dot(wo) * h.z.powi(3) * (s.wi.z / wo.z).sqrt();
                assert!((s.weight[0] - weight).abs() < 1e-12, "{k}");
            }
        }
    }
}
