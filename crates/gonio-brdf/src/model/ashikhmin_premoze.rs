//! The distribution-based model of Ashikhmin and Premože.

use crate::part::ashikhmin_lobe::{
    AshikhminLobe, DIFFUSE, DIFFUSE_TERM, FRESNEL, IOR, NU, NV, Pair, SCALE, SPECULAR,
    albedo_bound, isotropic,
};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "ashikhmin-premoze",
    summary: "a density of half vectors and nothing else but Fresnel reflectance: no masking to choose",
    paper: "Ashikhmin & Premože 2007, \"Distribution-based BRDFs\" (technical report, University of Utah); Ashikhmin & Shirley 2000 \
            for the density and the diffuse part",
    parameters: &[DIFFUSE, SPECULAR, NU, NV, FRESNEL, IOR, SCALE, DIFFUSE_TERM],
    positional: None,
    aliases: &[crate::Alias {
        name: "d-brdf",
        preset: &[],
    }],
    recordable: true,
    declares: |spec| Declares {
        isotropic: isotropic(spec),
        ..Declares::physical(albedo_bound(spec))
    },
};

/// f = (diffuse part) + s p(h) F(k·h)/(4 (cosθi + cosθr − cosθi cosθr)),
///
/// p(h) = √((nu + 1)(nv + 1))/2π (h.z)ⁿ with n = nu cos²φh + nv sin²φh, F(c) = Rs + (1 − Rs)(1 − c)⁵, and the diffuse part of
/// `ashikhmin-shirley`.
///
/// The denominator is the paper's compromise between cosθi cosθr, which diverges at grazing angles, and max(cosθi, cosθr), which
/// bends: smooth, and never more than F in energy. On a smooth surface the lobe's albedo is F cosθr/(2 − cosθr).
///
/// Sampling: half vectors by p, with the density p(h)/(4 k·h), mixed with the cosine. The weight of a draw from the lobe
/// alone is s F (k·h) cosθi/(cosθi + cosθr − cosθi cosθr) ≤ s F.
#[derive(Debug, Clone, Copy)]
pub struct AshikhminPremoze<R: Real, const N: usize> {
    /// Rd, F, nu, nv and s.
    pub constants: AshikhminLobe<R, N>,
}

impl<R: Real, const N: usize> AshikhminPremoze<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let constants = AshikhminLobe::from_spec(spec)?;
        Ok(Self { constants })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> AshikhminPremoze<S, N> {
        let constants = self.constants.cast(f);
        AshikhminPremoze { constants }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    /// 1/(cosθi + cosθr − cosθi cosθr).
    #[inline(always)]
    fn factor(&self, pair: &Pair<R>) -> R {
        let (i, o) = (pair.wi.z, pair.wo.z);
        ((i + o) - i * o).max(R::lit(1e-29)).recip()
    }

    /// The lobe's albedo over s F on a smooth surface.
    #[inline(always)]
    fn gain(&self, wo: Vec3<R>) -> R {
        // What is left at grazing angles comes from a wide lobe; an estimate is enough.
        let mu = wo.z.clamp(R::lit(0.05), R::one());
        mu / (R::lit(2.0) - mu)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for AshikhminPremoze<R, N> {
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
        let [d, s] = self.constants.shares(wo.z, self.gain(wo));
        d + s
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
        // ωi and ωr at 60° from the normal and 90° of azimuth apart: |ωi + ωr|² = 2 + 2·¼ = 2.5, k·h = √2.5/2, h.z = 1/√2.5.
        let s = 0.75f64.sqrt();
        let (wi, wo) = (Vec3::new(s, 0.0, 0.5), Vec3::new(0.0, s, 0.5));
        let m = model("ashikhmin-premoze:diffuse=0,specular=0.2,nu=2,nv=7");
        let k = 2.5f64.sqrt() / 2.0;
        // φh = 45°: n = 4.5.
        let p = 24.0f64.sqrt() / (2.0 * PI) * (1.0 / 2.5f64.sqrt()).powf(4.5);
        let expected = p * (0.2 + 0.8 * (1.0 - k).powi(5)) / (4.0 * 0.75);
        assert!((m.eval(wi, wo)[0] - expected).abs() < 1e-14);
    }

    /// On a smooth surface the lobe's albedo is F cosθr/(2 − cosθr); exponent 1e5: slopes of 4e-3, so a percent at 60°.
    #[test]
    fn smooth_limit() {
        let m = model("ashikhmin-premoze:diffuse=0,specular=1,nu=1e5,nv=1e5");
        for cos in [1.0f64, 0.5] {
            let wo = around_axis(0.0, (1.0 - cos * cos).sqrt(), cos);
            let n = 40;
            let mut albedo = 0.0;
            for k in 0..n * n {
                let [x, y] = [k % n, k / n].map(|i| (f64::from(i) + 0.5) / f64::from(n));
                albedo += m.sample(wo, [x, y, 0.5]).weight[0] / f64::from(n * n);
            }
            assert!(
                (albedo / (cos / (2.0 - cos)) - 1.0).abs() < 0.01,
                "{albedo}"
            );
        }
    }
}
