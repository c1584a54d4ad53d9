//! Oren & Nayar's model of rough diffuse surfaces.

use crate::part::colour::{cast, each_component, mean, only_where};
use crate::part::geometry::{above, sin_theta};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::{FRAC_1_PI, PI};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "oren-nayar",
    summary: "rough diffuse: Lambertian V-shaped grooves that shadow, mask and light each other",
    paper: "Oren & Nayar 1994, \"Generalization of Lambert's Reflectance Model\"",
    parameters: &[
        ParameterInfo::colour(
            "reflectance",
            (0.0, 1.0),
            Some([0.5; 3]),
            "reflectance ρ of the facets",
        ),
        ParameterInfo::number(
            "sigma_deg",
            "°",
            (0.0, 60.0),
            Some(20.0),
            "standard deviation σ of the facets' slope angle; 0 is Lambertian",
        ),
        ParameterInfo::choice(
            "form",
            &["qualitative", "full"],
            Some("qualitative"),
            "qualitative: eq. 30 with A and B alone; full: eqs 27 to 29, with interreflection",
        ),
    ],
    positional: Some("reflectance"),
    aliases: &[],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    // Both forms diverge where both directions graze on the same side: no bound holds at every angle.
    let bound = if spec.real::<f64>("sigma_deg") == 0.0 {
        spec.largest("reflectance")
    } else {
        f64::INFINITY
    };
    Declares::physical(bound)
}

/// With α = max(θi, θr), β = min(θi, θr), Δφ = φi − φr and σ in radians:
///
/// - qualitative (eq. 30): f = ρ/π (A + B max(0, cosΔφ) sinα tanβ),
///   A = 1 − 0.5 σ²/(σ² + 0.33), B = 0.45 σ²/(σ² + 0.09)
/// - full (eqs 27–29): f = ρ/π [C₁ + cosΔφ C₂ tanβ + (1 − |cosΔφ|) C₃ tan((α + β)/2)]
///   \+ 0.17 ρ²/π σ²/(σ² + 0.13) [1 − cosΔφ (2β/π)²],
///   C₁ = A, C₂ = B sinα (cosΔφ ≥ 0) or B (sinα − (2β/π)³), C₃ = 0.125 σ²/(σ² + 0.09) (4αβ/π²)²
///
/// Negative values, which the full form has at small angles of α against β for cosΔφ < 0, are set to 0.
#[derive(Debug, Clone, Copy)]
pub struct OrenNayar<R: Real, const N: usize> {
    /// ρ, [0, 1].
    pub reflectance: [R; N],
    /// σ in radians.
    pub sigma: R,
    /// Whether the full form is meant.
    pub full: bool,
}

impl<R: Real, const N: usize> OrenNayar<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
            sigma: spec.real::<R>("sigma_deg") * R::lit(PI / 180.0),
            full: spec.word("form") == "full",
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> OrenNayar<S, N> {
        OrenNayar {
            reflectance: cast(self.reflectance, f),
            sigma: f(self.sigma),
            full: self.full,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "reflectance" => self.reflectance = super::components(value),
            _ => self.sigma = value[0] * R::lit(PI / 180.0),
        }
    }

    /// The factor on ρ/π and the one on ρ²/π.
    #[inline(always)]
    fn terms(&self, wi: Vec3<R>, wo: Vec3<R>) -> (R, R) {
        let one = R::one();
        let s2 = self.sigma * self.sigma;
        let a = one - R::lit(0.5) * s2 / (s2 + R::lit(0.33));
        let b = R::lit(0.45) * s2 / (s2 + R::lit(0.09));
        // sinθi sinθr cosΔφ, so that sinα tanβ cosΔφ needs no division at normal incidence.
        let across = wi.x * wo.x + wi.y * wo.y;
        let high = wi.z.max(wo.z).max(R::lit(1e-12)); // cosβ
        if !self.full {
            return (a + b * across.max(R::zero()) / high, R::zero());
        }
        let low = wi.z.min(wo.z); // cosα
        let (alpha, beta) = (low.acos(), high.acos());
        let (si, so) = (sin_theta(wi), sin_theta(wo));
        let (sin_a, sin_b) = (si.max(so), si.min(so));
        let cos_phi = (across / (si * so).max(R::lit(1e-20))).clamp(-one, one);
        let b2 = beta * R::lit(2.0 * FRAC_1_PI);
        let deep = R::select(cos_phi.lt(R::zero()), b2 * b2 * b2, R::zero());
        let c2 = b * (sin_a - deep);
        let c3 = R::lit(0.125) * s2 / (s2 + R::lit(0.09))
            * (R::lit(4.0 * FRAC_1_PI * FRAC_1_PI) * alpha * beta).sq();
        // tan((α + β)/2) = (sinα + sinβ)/(cosα + cosβ).
        let tan_mid = (sin_a + sin_b) / (low + high).max(R::lit(1e-12));
        let direct = a + cos_phi * c2 * sin_b / high + (one - cos_phi.abs()) * c3 * tan_mid;
        let twice = R::lit(0.17) * s2 / (s2 + R::lit(0.13)) * (one - cos_phi * b2 * b2);
        (direct.max(R::zero()), twice)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for OrenNayar<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let (once, twice) = self.terms(wi, wo);
        let mut f = self.reflectance;
        each_component!(N, k => { f[k] = f[k] * R::lit(FRAC_1_PI) * (once + twice * f[k]); });
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

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        mean(self.reflectance)
    }
}
