//! The diffuse part of Disney's principled model of 2012.

use crate::part::colour::{cast, mean, only_where, scale};
use crate::part::fresnel::schlick;
use crate::part::geometry::{Half, above};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "burley",
    summary: "Disney's diffuse: darker at grazing angles where smooth, brighter towards the light where rough",
    paper: "Burley 2012, \"Physically-Based Shading at Disney\", §5.3",
    parameters: &[
        ParameterInfo::colour(
            "reflectance",
            (0.0, 1.0),
            Some([0.5; 3]),
            "reflectance ρ; the albedo differs from it by up to 56 %",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.5),
            "perceptual roughness r",
        ),
    ],
    positional: Some("reflectance"),
    aliases: &[],
    recordable: true,
    declares: |spec| {
        Declares::physical(spec.largest("reflectance") * largest_albedo(spec.real("roughness")))
    },
};

/// f = ρ/π [1 + (F₉₀ − 1)(1 − cosθi)⁵] [1 + (F₉₀ − 1)(1 − cosθr)⁵], F₉₀ = ½ + 2 r cos²θ′,
///
/// θ′ the angle between light and half vector. Not energy-conserving for bright, rough surfaces: with r = 1 the albedo at
/// grazing angles is 1.56 ρ, and for ρ = 1 it passes 1 where r > 0.4. Its directional albedo, with F = (1 − μ)⁵, is
///
/// E(μ)/ρ = 1 + (r − ½)/21 + rμ/84 + F [r − ½ + ⅔rμ + (r − ½)²/21 + (r − ½)rμ/42 + r²μ²/252 + 11 r²(1 − μ²)/504].
#[derive(Debug, Clone, Copy)]
pub struct Burley<R: Real, const N: usize> {
    /// ρ, [0, 1].
    pub reflectance: [R; N],
    /// r, [0, 1].
    pub roughness: R,
}

/// E(μ)/ρ: the polynomial integrals ∫ (1 − c)⁵ cⁿ 2c dc of the product, with cos²θ′ = (1 + ωi·ωr)/2 averaged over the azimuth.
#[inline(always)]
fn albedo<R: Real>(mu: R, r: R) -> R {
    let l = R::lit;
    let (f, x, y) = ((R::one() - mu).pow5(), r - l(0.5), r * mu);
    let once = x * l(1.0 / 21.0) + y * l(1.0 / 84.0);
    let twice = x * x * l(1.0 / 21.0) + x * y * l(1.0 / 42.0) + y * y * l(1.0 / 252.0);
    let aside = r * r * (R::one() - mu * mu) * l(11.0 / 504.0);
    R::one() + once + f * (x + y * l(2.0 / 3.0) + twice + aside)
}

/// A bound of E(μ)/ρ over all μ: the largest at 2049 nodes, and what E can rise between them. As |E″| < 40, that is less than
/// 40 h²/8 = 1.2e-6.
fn largest_albedo(r: f64) -> f64 {
    let nodes = (0..=2048).map(|k| albedo(f64::from(k) / 2048.0, r));
    nodes.fold(0.0, f64::max) + 1.2e-6
}

impl<R: Real, const N: usize> Burley<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
            roughness: spec.real("roughness"),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Burley<S, N> {
        Burley {
            reflectance: cast(self.reflectance, f),
            roughness: f(self.roughness),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "reflectance" => self.reflectance = super::components(value),
            _ => self.roughness = value[0],
        }
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Burley<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let cos = Half::new(wi, wo).cos;
        let f90 = R::lit(0.5) + R::lit(2.0) * self.roughness * (cos * cos);
        let both = schlick(wi.z, R::one(), f90) * schlick(wo.z, R::one(), f90);
        let f = scale(self.reflectance, both * R::lit(FRAC_1_PI));
        only_where(above(wi, wo), f)
    }

    /// cosθi/π.
    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        R::select(above(wi, wo), cosine_hemisphere_density(wi), R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        self.sample_of(cosine_hemisphere([u[0], u[1]]), wo)
    }

    /// The albedo, exactly.
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(self.reflectance) * albedo(wo.z.saturate(), self.roughness)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::warp::around_axis;

    fn tilted(cos: f64, turns: f64) -> Vec3<f64> {
        around_axis(turns, (1.0 - cos * cos).sqrt(), cos)
    }

    #[test]
    fn by_hand() {
        let model: Burley<f64, 3> =
            Burley::from_spec(&ModelSpec::parse("burley:0.8,roughness=0.75").unwrap()).unwrap();
        // Light and viewer together at 60°: θ′ = 0, F₉₀ = 2, each factor 1 + ½⁵.
        let w = tilted(0.5, 0.2);
        let expected = 0.8 * FRAC_1_PI * (1.0 + 1.0 / 32.0f64).powi(2);
        assert!((model.eval(w, w)[0] - expected).abs() < 1e-14);
        // Opposite at 60°: θ′ = 60°, F₉₀ = 7/8, each factor 1 − ⅛·½⁵.
        let expected = 0.8 * FRAC_1_PI * (1.0 - 1.0 / 256.0f64).powi(2);
        assert!((model.eval(tilted(0.5, 0.7), w)[0] - expected).abs() < 1e-14);
    }

    /// Midpoint rule over μ and φ: the integrand is smooth in both, and the step squared is 1e-5.
    #[test]
    fn the_albedo_is_the_integral() {
        for (r, mu) in [(0.0, 0.05), (0.3, 0.5), (1.0, 0.01), (1.0, 0.9)] {
            let spec = format!("burley:1,roughness={r}");
            let model: Burley<f64, 3> =
                Burley::from_spec(&ModelSpec::parse(&spec).unwrap()).unwrap();
            let (n, wo) = (300, tilted(mu, 0.0));
            let mut sum = 0.0;
            for i in 0..n {
                let z = (f64::from(i) + 0.5) / f64::from(n);
                for k in 0..64 {
                    sum += model.eval(tilted(z, f64::from(k) / 64.0), wo)[0] * z;
                }
            }
            let integral = sum * std::f64::consts::TAU / f64::from(n * 64);
            assert!(
                (integral - albedo(mu, r)).abs() < 1e-5,
                "{r} {mu}: {integral}"
            );
            assert!(largest_albedo(r) >= albedo(mu, r));
        }
        // At r = 1 and grazing: 1 + 11/21 + 1/84 + 11/504.
        let grazing = 1.0 + 11.0 / 21.0 + 1.0 / 84.0 + 11.0 / 504.0;
        assert!((albedo(0.0, 1.0) - grazing).abs() < 1e-14);
    }
}
