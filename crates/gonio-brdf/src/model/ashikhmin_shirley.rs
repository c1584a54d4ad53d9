//! The anisotropic Phong model of Ashikhmin and Shirley.

use crate::part::ashikhmin_lobe::{
    AshikhminLobe, DIFFUSE, DIFFUSE_TERM, FRESNEL, IOR, NU, NV, Pair, SCALE, SPECULAR,
    albedo_bound, isotropic,
};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "ashikhmin-shirley",
    summary: "an anisotropic cosine power with Fresnel reflectance, over a diffuse part that gets the rest of the light",
    paper: "Ashikhmin & Shirley 2000, \"An Anisotropic Phong BRDF Model\"",
    parameters: &[DIFFUSE, SPECULAR, NU, NV, FRESNEL, IOR, SCALE, DIFFUSE_TERM],
    positional: None,
    aliases: &[],
    recordable: true,
    declares: |spec| Declares {
        isotropic: isotropic(spec),
        ..Declares::physical(albedo_bound(spec))
    },
};

/// f = 28 Rd/(23π) (1 − Rs) [1 − (1 − cosθi/2)⁵] [1 − (1 − cosθr/2)⁵]
///   \+ s √((nu + 1)(nv + 1))/8π (h.z)ⁿ F(k·h)/((k·h) max(cosθi, cosθr)),
///
/// n = nu cos²φh + nv sin²φh, k·h = ωi·h = ωr·h, F(c) = Rs + (1 − Rs)(1 − c)⁵.
///
/// As published s = 1, and the sum conserves energy for every Rd, Rs ≤ 1. Fits to measurements use a scale s, a Lambertian
/// diffuse part (`diffuse_term=lambertian`), or Fresnel's equations (`ior`).
///
/// Sampling: half vectors by their power, with the density p(h)/(4 k·h), mixed with the cosine. The weight of a draw from the
/// lobe alone is s F cosθi/max(cosθi, cosθr) ≤ s F.
#[derive(Debug, Clone, Copy)]
pub struct AshikhminShirley<R: Real, const N: usize> {
    /// Rd, F, nu, nv and s.
    pub constants: AshikhminLobe<R, N>,
}

impl<R: Real, const N: usize> AshikhminShirley<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let constants = AshikhminLobe::from_spec(spec)?;
        Ok(Self { constants })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> AshikhminShirley<S, N> {
        let constants = self.constants.cast(f);
        AshikhminShirley { constants }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    /// 1/((k·h) max(cosθi, cosθr)).
    #[inline(always)]
    fn factor(&self, pair: &Pair<R>) -> R {
        // k·h is at least half of the larger cosine.
        (pair.half.cos * pair.wi.z.max(pair.wo.z))
            .max(R::lit(1e-29))
            .recip()
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for AshikhminShirley<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let pair = self.constants.pair(wi, wo);
        self.constants.value(&pair, self.factor(&pair))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let pair = self.constants.pair(wi, wo);
        self.constants.density(&pair, R::one())
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let pair = self.constants.pair(wi, wo);
        (
            self.constants.value(&pair, self.factor(&pair)),
            self.constants.density(&pair, R::one()),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        self.sample_of(self.constants.draw(wo, R::one(), u), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let [d, s] = self.constants.shares(wo.z, R::one());
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
        // ωi = (0.6, 0, 0.8), ωr = z: |ωi + ωr| = √3.6, k·h = √0.9, h.z = 1.8/√3.6 = √0.9, φh = 0: n = nu.
        let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.0, 1.0));
        let k = 0.9f64.sqrt();
        let m = model("ashikhmin-shirley:diffuse=0,specular=0.3,nu=4,nv=19");
        let fresnel = 0.3 + 0.7 * (1.0 - k).powi(5);
        let lobe = 10.0 / (8.0 * PI) * k.powi(4) * fresnel / k;
        assert!((m.eval(wi, wo)[0] - lobe).abs() < 1e-14);
        // Across: n = nv.
        let f = m.eval(Vec3::new(0.0, 0.6, 0.8), wo)[0];
        assert!((f - lobe * k.powi(15)).abs() < 1e-14);
        // The diffuse part alone: 28/(23π) 0.7 · 0.5 (1 − 0.6⁵)(1 − ½⁵).
        let m = model("ashikhmin-shirley:diffuse=0.5,specular=0.3,scale=0");
        let body = 28.0 / (23.0 * PI) * 0.35 * (1.0 - 0.6f64.powi(5)) * (31.0 / 32.0);
        assert!((m.eval(wi, wo)[0] - body).abs() < 1e-14);
        // Glass: 4 % where light and viewer are at the normal.
        let m = model("ashikhmin-shirley:diffuse=0.5,diffuse_term=lambertian,ior=1.5,nu=9,nv=9");
        let f = m.eval(wo, wo)[0];
        assert!((f - 0.5 / PI - 10.0 / (8.0 * PI) * 0.04).abs() < 1e-14);
    }

    /// The worst case of the energy's proof: Rd = 1. Mean weights over a grid; the share lost below the horizon has an edge of a
    /// cell, 1/60.
    #[test]
    fn white_over_white_keeps_the_energy() {
        for (nu, rs) in [(5.0, 0.0), (50.0, 0.5), (5.0, 1.0)] {
            let m = model(&format!(
                "ashikhmin-shirley:diffuse=1,specular={rs},nu={nu},nv={nu}"
            ));
            for cos in [0.05f64, 0.4, 1.0] {
                let wo = around_axis(0.0, (1.0 - cos * cos).sqrt(), cos);
                let n = 60;
                let mut albedo = 0.0;
                for k in 0..n * n * n {
                    let u = [k % n, k / n % n, k / (n * n)]
                        .map(|i| (f64::from(i) + 0.5) / f64::from(n));
                    albedo += m.sample(wo, u).weight[0] / f64::from(n * n * n);
                }
                assert!(albedo < 1.0 + 1.0 / 60.0, "{nu} {rs} {cos}: {albedo}");
            }
        }
    }

    #[test]
    fn one_reflectance_at_a_time() {
        for (text, key) in [
            ("ashikhmin-shirley:specular=0.1,ior=1.5", "specular"),
            ("ashikhmin-shirley:fresnel=schlick,ior=1.5", "ior"),
        ] {
            let error = ModelSpec::parse(text).unwrap().build::<f64, 3>();
            let error = error.unwrap_err().to_string();
            assert!(
                error.contains(key) && error.contains("only fresnel="),
                "{error}"
            );
        }
    }
}
