//! The model of Löw et al. for smooth surfaces: a lobe over projected directions.

use crate::part::geometry::above;
use crate::part::low_lobe::{B, C, DIFFUSE, IOR, LowLobe, albedo_bound, specular};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{around_axis, cosine_hemisphere};
use std::f64::consts::{FRAC_1_PI, PI};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "low-smooth",
    summary: "Löw's lobe of smooth surfaces: diffuse and scattering that depends on the projected distance from the mirror direction",
    paper: "Löw, Kronander, Ynnerman & Unger 2012, \"BRDF Models for Accurate and Efficient Rendering of Glossy Surfaces\", eqs 10, 12 \
            and 14; after Church & Takacs 1991 and Harvey & Shack",
    parameters: &[DIFFUSE, specular(60.0), B, C, IOR],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

/// The lobe's albedo for A = F = 1 is ∫ S d²p over the disk of projected directions, cosθi dωi = d²p, largest where S has its middle in
/// the disk's: π ∫ S(x) dx with x the square of the radius.
fn declares(spec: &ModelSpec) -> Declares {
    Declares::physical(albedo_bound(spec, |falloff| PI * falloff.integral(1.0)))
}

/// f = kd/π + A F(θd)/(1 + B |D|²)ᶜ,
///
/// D = (ωi.x + ωr.x, ωi.y + ωr.y), the distance between ωi and the mirror image of ωr seen from above, and F by Fresnel's equations for an index of
/// refraction at cosθd = √(1 − |(ωi.x − ωr.x, ωi.y − ωr.y)|²/4), the angle of incidence where the heights are the same. Reciprocal.
///
/// This is how smooth surfaces scatter (Rayleigh–Rice) when the spectrum of their heights is that of the ABC model. There is no masking. A
/// is what a fit says: the lobe may reflect more than arrives, at most A π ∫ (1 + B x)^−C dx from 0 to 1.
///
/// Sampling: points around the mirror direction's by S, over a disk that covers all of the projected hemisphere, mixed with the cosine by
/// estimates of the albedo. The weight of a draw from the lobe alone is A F π ∫ S. Points outside the hemisphere are no draws.
#[derive(Debug, Clone, Copy)]
pub struct LowSmooth<R: Real, const N: usize> {
    /// kd, A, S and the index of refraction.
    pub constants: LowLobe<R, N>,
}

impl<R: Real, const N: usize> LowSmooth<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let constants = LowLobe::from_spec(spec)?;
        Ok(Self { constants })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> LowSmooth<S, N> {
        let constants = self.constants.cast(f);
        LowSmooth { constants }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    /// S.
    #[inline(always)]
    fn falloff(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (x, y) = (wi.x + wo.x, wi.y + wo.y);
        self.constants.falloff.value(x * x + y * y)
    }

    #[inline(always)]
    fn value(&self, s: R, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let (x, y) = (wi.x - wo.x, wi.y - wo.y);
        let cos = (R::one() - R::lit(0.25) * (x * x + y * y)).safe_sqrt();
        self.constants.value(above(wi, wo), cos, s)
    }

    #[inline(always)]
    fn density(&self, s: R, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let all = self.constants.falloff.integral(self.reach(wo));
        let lobe = R::lit(FRAC_1_PI) * s * wi.z / all;
        self.constants
            .density(above(wi, wo), wi, wo, self.gain(), lobe)
    }

    /// Square of the radius of a disk about the mirror direction of `wo` that covers the unit disk.
    #[inline(always)]
    fn reach(&self, wo: Vec3<R>) -> R {
        let sin = (wo.x * wo.x + wo.y * wo.y).safe_sqrt();
        (R::one() + sin).sq()
    }

    /// The largest albedo of the lobe over A F.
    #[inline(always)]
    fn gain(&self) -> R {
        R::lit(PI) * self.constants.falloff.integral(R::one())
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for LowSmooth<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        self.value(self.falloff(wi, wo), wi, wo)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.density(self.falloff(wi, wo), wi, wo)
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let s = self.falloff(wi, wo);
        (self.value(s, wi, wo), self.density(s, wi, wo))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let x = self.constants.falloff.sample(u[1], self.reach(wo));
        let point = around_axis(u[0], x.safe_sqrt(), R::zero()) - wo;
        let z2 = R::one() - (point.x * point.x + point.y * point.y);
        let up = Vec3::new(point.x, point.y, z2.safe_sqrt());
        let down = Vec3::new(R::zero(), R::zero(), -R::one());
        let lobe = Vec3::select(z2.gt(R::zero()), up, down);
        let diffuse = u[2].lt(self.constants.diffuse_probability(wo, self.gain()));
        self.sample_of(
            Vec3::select(diffuse, cosine_hemisphere([u[0], u[1]]), lobe),
            wo,
        )
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

    fn model(text: &str) -> Model<f64, 3> {
        ModelSpec::parse(text).unwrap().build().unwrap()
    }

    #[test]
    fn by_hand() {
        // ωi.xy + ωr.xy = (0.6, 0.6): |D|² = 0.72; |ωi.xy − ωr.xy|² is the same: cos²θd = 0.82.
        let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8));
        let f = model("low-smooth:diffuse=0.3,specular=4,b=5,c=2,ior=1.5").eval(wi, wo)[0];
        let c = 0.82f64.sqrt();
        let g = (2.25 + 0.82 - 1.0f64).sqrt();
        let other = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
        let fresnel = 0.5 * ((g - c) / (g + c)).powi(2) * (1.0 + other * other);
        let expected = 0.3 / PI + 4.0 * fresnel / 4.6f64.powi(2);
        assert!((f - expected).abs() < 1e-14, "{f} {expected}");
    }

    /// Seen along the normal the lobe's albedo is A π ∫ S dx but for F, which is 0.04 to 0.045 up to 40° (half of 80°, where a narrow
    /// lobe has long ended).
    #[test]
    fn albedo_along_the_normal() {
        let m = model("low-smooth:diffuse=0,specular=1000,b=2000,c=2,ior=1.5");
        let up = Vec3::new(0.0, 0.0, 1.0);
        let n = 60;
        let mut albedo = 0.0;
        for k in 0..n * n {
            let [x, y] = [k % n, k / n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
            albedo += m.sample(up, [x, y, 0.5]).weight[0] / f64::from(n * n);
        }
        // C = 2: ∫ S dx = (1 − 1/2001)/2000.
        let expected = 0.04 * 1000.0 * PI * (1.0 - 1.0 / 2001.0) / 2000.0;
        assert!(
            (albedo / expected - 1.0).abs() < 0.01,
            "{albedo} {expected}"
        );
    }
}
