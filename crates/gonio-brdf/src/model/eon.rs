//! The energy-preserving Oren–Nayar model of rough diffuse surfaces.

use crate::part::colour::{cast, each_component, mean, only_where};
use crate::part::geometry::{above, azimuth, sin_theta, turned};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{uniform_disk, uniform_hemisphere, uniform_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "eon",
    summary: "rough diffuse that preserves energy: Oren–Nayar with the light that scatters several times",
    paper: "Portsmouth, Kutz & Hill 2024, \"EON: A practical energy-preserving rough diffuse BRDF\"; Fujii 2012 for the single scattering",
    parameters: &[
        ParameterInfo::colour(
            "reflectance",
            (0.0, 1.0),
            Some([0.5; 3]),
            "reflectance ρ of the facets",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.5),
            "roughness r, linear; 0 is Lambertian",
        ),
        ParameterInfo::choice(
            "albedo",
            &["exact", "polynomial"],
            Some("exact"),
            "directional albedo of the single scattering: exact, or a polynomial within 7e-4 of it that needs no arc cosine",
        ),
    ],
    positional: Some("reflectance"),
    aliases: &[],
    recordable: true,
    declares,
};

/// The albedo of a direction, ρ E + ρₘₛ (1 − E), grows with E, as ρₘₛ ≤ ρ; and E ≤ E(0) = 1. So it is at most ρ.
///
/// With the polynomial g̃ the second term becomes ρₘₛ r A K (C₁ − g̃), K = ∫ (C₁ − g̃) 2μ dμ/(C₁ − C₂): larger than
/// ρₘₛ r A (C₁ − g) by no more than [`EXCESS`] ρₘₛ r A.
fn declares(spec: &ModelSpec) -> Declares {
    let (rho, r) = (spec.largest("reflectance"), spec.real::<f64>("roughness"));
    let excess = if spec.word("albedo") == "polynomial" {
        EXCESS * r * scale_a(r) * multiple_reflectance(rho, r)
    } else {
        0.0
    };
    Declares::physical(rho + excess)
}

/// C₁ = ½ − 2/(3π).
const C1: f64 = 0.5 - 2.0 / 3.0 * FRAC_1_PI;
/// C₂ = ⅔ − 28/(15π), the mean 2 ∫ g(μ) μ dμ.
const C2: f64 = 2.0 / 3.0 - 28.0 / 15.0 * FRAC_1_PI;
/// What K (C₁ − g̃(μ)) − (C₁ − g(μ)) nowhere exceeds; a test computes it.
const EXCESS: f64 = 1.9e-4;

/// A = 1/(1 + C₁ r).
#[inline(always)]
fn scale_a<R: Real>(r: R) -> R {
    (R::one() + R::lit(C1) * r).recip()
}

/// ρₘₛ = ρ² Ē/(1 − ρ (1 − Ē)), Ē = A (1 + C₂ r): what leaves after two or more facets.
#[inline(always)]
fn multiple_reflectance<R: Real>(rho: R, r: R) -> R {
    let mean = scale_a(r) * (R::one() + R::lit(C2) * r);
    rho * rho * mean / (R::one() - rho * (R::one() - mean))
}

/// f = ρ/π A (1 + r s/t) + ρₘₛ/π (1 − E(μi)) (1 − E(μr))/(1 − Ē), with
///
/// - s = ωi·ωr − μi μr, t = max(μi, μr) where s > 0, else 1,
/// - A = 1/(1 + C₁ r), C₁ = ½ − 2/(3π), C₂ = ⅔ − 28/(15π),
/// - E(μ) = A (1 + r g(μ)), its mean Ē = A (1 + C₂ r),
/// - g(μ) = [sinθ (θ − sinθ cosθ) + ⅔ (tanθ (1 − sin³θ) − sinθ)]/π, or the polynomial g̃ in 1 − μ of the paper's listing,
/// - ρₘₛ = ρ² Ē/(1 − ρ (1 − Ē)).
///
/// The second term gives back what the first one loses: with ρ = 1 every direction has the albedo 1. As 1 − E = r A (C₁ − g) and
/// 1 − Ē = r A (C₁ − C₂), it is evaluated as ρₘₛ/π r A (C₁ − g(μi)) (C₁ − g(μr))/(C₁ − C₂), without cancellation at r → 0.
///
/// Sampling: a linearly transformed cosine, clipped so that nothing falls below the horizon, mixed with the uniform
/// hemisphere (the paper's §4 and its fitted coefficients).
#[derive(Debug, Clone, Copy)]
pub struct Eon<R: Real, const N: usize> {
    /// ρ, [0, 1].
    pub reflectance: [R; N],
    /// r, [0, 1].
    pub roughness: R,
    /// Whether g is exact, otherwise g̃.
    pub exact: bool,
}

/// The clipped transformed cosine towards one viewer: ω = M ω_h/|M ω_h| with M = (a 0 b; 0 c 0; d 0 1), in the frame whose x axis is
/// the viewer's azimuth.
struct Lobe<R: Real> {
    azimuth: [R; 2],
    a: R,
    b: R,
    c: R,
    d: R,
    /// Probability of drawing uniformly instead.
    uniform: R,
}

impl<R: Real> Lobe<R> {
    #[inline(always)]
    fn new(wo: Vec3<R>, r: R) -> Self {
        let mu = wo.z.saturate();
        let l = R::lit;
        let a = l(0.303392) + (l(-0.518982) + l(0.111709) * mu) * mu;
        let a = R::one() + r * (a + (l(-0.276266) + l(0.335918) * mu) * r);
        let b = l(-1.16407) + l(1.15859) * mu + (l(0.150815) - l(0.150105) * mu) * r;
        let b = r * b / (mu * mu * mu - l(1.43545));
        let c = l(0.20013) + (l(-0.506373) + l(0.261777) * mu) * mu;
        let c = R::one() + c * r;
        let d = l(0.540852) + (l(-1.01625) + l(0.475392) * mu) * mu;
        let d = r * d / (l(-1.0743) + mu * (l(0.0725628) + mu));
        let uniform = l(0.162925) + (l(-0.372058) + (l(0.538233) - l(0.290822) * mu) * mu) * mu;
        Self {
            azimuth: azimuth(wo),
            a,
            b,
            c,
            d,
            uniform: r.powf(l(0.1)) * uniform,
        }
    }

    /// Where the cosine hemisphere is cut: the fraction of the unit disk that stays, (1 + 1/√(1 + d²))/2.
    #[inline(always)]
    fn kept(&self) -> R {
        R::lit(0.5) * (R::one() + (R::one() + self.d * self.d).sqrt().recip())
    }

    #[inline(always)]
    fn sample(&self, u: [R; 2]) -> Vec3<R> {
        let [x, y] = uniform_disk(u);
        let edge = (R::one() - y * y).safe_sqrt();
        let x = -self.kept().lerp(edge, x);
        let z = (R::one() - (x * x + y * y)).safe_sqrt();
        let w = Vec3::new(self.a * x + self.b * z, self.c * y, self.d * x + z);
        let [cos, sin] = self.azimuth;
        turned(w.normalize(), cos, sin)
    }

    /// Density per solid angle: |M|² max(z, 0)/(π kept |adj(M) ω|⁴), z that of adj(M) ω.
    #[inline(always)]
    fn density(&self, wi: Vec3<R>) -> R {
        let [cos, sin] = self.azimuth;
        let w = turned(wi, cos, -sin);
        let (a, b, c, d) = (self.a, self.b, self.c, self.d);
        let area = a - b * d;
        let det = c * area;
        let h = Vec3::new(c * (w.x - b * w.z), area * w.y, c * (a * w.z - d * w.x));
        let ratio = det / h.length_squared().max(R::lit(1e-12));
        let scale = R::lit(FRAC_1_PI) / self.kept();
        ratio * ratio * h.z.max(R::zero()) * scale
    }
}

impl<R: Real, const N: usize> Eon<R, N> {
    /// Of a reflectance and a roughness, with the exact albedo.
    pub(crate) fn new(reflectance: [R; N], roughness: R) -> Self {
        Self {
            reflectance,
            roughness,
            exact: true,
        }
    }

    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
            roughness: spec.real("roughness"),
            exact: spec.word("albedo") == "exact",
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Eon<S, N> {
        Eon {
            reflectance: cast(self.reflectance, f),
            roughness: f(self.roughness),
            exact: self.exact,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "reflectance" => self.reflectance = super::components(value),
            _ => self.roughness = value[0],
        }
    }

    /// C₁ − g, which is 0 at grazing directions.
    #[inline(always)]
    fn lost(&self, w: Vec3<R>) -> R {
        let mu = w.z.saturate();
        let g = if self.exact {
            let s = sin_theta(w).min(R::one());
            // tanθ (1 − sin³θ) = sinθ cosθ (1 + sinθ + sin²θ)/(1 + sinθ), without a division by cosθ.
            let tail = mu * (R::one() + s * s / (R::one() + s)) - R::one();
            R::lit(FRAC_1_PI) * s * (mu.acos() - s * mu + R::lit(2.0 / 3.0) * tail)
        } else {
            polynomial(mu)
        };
        (R::lit(C1) - g).max(R::zero())
    }

    /// The factors of ρ and of ρₘₛ.
    #[inline(always)]
    fn terms(&self, wi: Vec3<R>, wo: Vec3<R>) -> (R, R) {
        let r = self.roughness;
        let across = wi.x * wo.x + wi.y * wo.y;
        let tilt = wi.z.max(wo.z).clamp(R::lit(1e-12), R::one());
        let divisor = R::select(across.gt(R::zero()), tilt, R::one());
        let a = scale_a(r) * R::lit(FRAC_1_PI);
        let single = a * (R::one() + r * (across / divisor)).max(R::zero());
        let multiple = r * a * R::lit(1.0 / (C1 - C2)) * (self.lost(wi) * self.lost(wo));
        (single, multiple)
    }

    #[inline(always)]
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let (single, multiple) = self.terms(wi, wo);
        let mut f = self.reflectance;
        each_component!(N, k => {
            f[k] = f[k] * single + multiple_reflectance(f[k], self.roughness) * multiple;
        });
        f
    }
}

/// g̃, the paper's fit to g.
#[inline(always)]
fn polynomial<R: Real>(mu: R) -> R {
    let m = R::one() - mu;
    let g = R::lit(-0.332181442) + m * R::lit(0.0714429953);
    m * (R::lit(0.0571085289) + m * (R::lit(0.491881867) + m * g))
}

impl<R: Real, const N: usize> Brdf<R, N> for Eon<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        only_where(above(wi, wo), self.value(wi, wo))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let lobe = Lobe::new(wo, self.roughness);
        let density = lobe
            .uniform
            .lerp(lobe.density(wi), uniform_hemisphere_density(wi));
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let lobe = Lobe::new(wo, self.roughness);
        let uniform = uniform_hemisphere([u[0], u[1]]);
        let wi = Vec3::select(u[2].lt(lobe.uniform), uniform, lobe.sample([u[0], u[1]]));
        self.sample_of(wi, wo)
    }

    /// ρ E + ρₘₛ (1 − E) of the mean reflectance, E by the polynomial.
    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let (r, rho) = (self.roughness, mean(self.reflectance));
        let e = scale_a(r) * (R::one() + r * polynomial(wo.z.saturate()));
        e.lerp(multiple_reflectance(rho, r), rho)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::warp::around_axis;
    use std::f64::consts::TAU;

    fn eon(text: &str) -> Eon<f64, 3> {
        Eon::from_spec(&ModelSpec::parse(text).unwrap()).unwrap()
    }

    fn tilted(cos: f64, turns: f64) -> Vec3<f64> {
        around_axis(turns, (1.0 - cos * cos).sqrt(), cos)
    }

    /// g by the paper's own expression, with its division by μ.
    fn published_g(mu: f64) -> f64 {
        let s = (1.0 - mu * mu).sqrt();
        (s * (mu.acos() - s * mu) + 2.0 / 3.0 * (s / mu * (1.0 - s.powi(3)) - s)) * FRAC_1_PI
    }

    #[test]
    fn the_rewritten_terms_are_the_published_ones() {
        let model = eon("eon:0.9/0.5/0.1,roughness=0.7");
        for (i, o) in [(0.3, 0.8), (0.9, 0.05), (1.0, 0.4)] {
            let (wi, wo) = (tilted(i, 0.1), tilted(o, 0.45));
            let r = 0.7;
            let a = 1.0 / (1.0 + C1 * r);
            let e = |mu: f64| a * (1.0 + r * published_g(mu));
            let mean = a * (1.0 + C2 * r);
            let s = wi.dot(wo) - i * o;
            let t = if s > 0.0 { f64::max(i, o) } else { 1.0 };
            let f = model.eval(wi, wo);
            for (f, rho) in f.into_iter().zip([0.9, 0.5, 0.1]) {
                let many = rho * rho * mean / (1.0 - rho * (1.0 - mean));
                let expected = rho * FRAC_1_PI * a * (1.0 + r * s / t)
                    + many * FRAC_1_PI * (1.0 - e(i)) * (1.0 - e(o)) / (1.0 - mean);
                // Rounding of the published form: 1e-16 over 1 − Ē = 0.13.
                assert!((f - expected).abs() < 1e-13, "{f} {expected}");
            }
        }
    }

    #[test]
    fn the_mean_of_g_is_c2_and_the_polynomial_is_near() {
        let n = 20_000;
        let (mut mean, mut rough_mean, mut worst) = (0.0, 0.0, 0.0f64);
        let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
        let near = eon("eon");
        let far = eon("eon:albedo=polynomial");
        for mu in (0..n).map(at) {
            let (g, fit) = (
                C1 - near.lost(tilted(mu, 0.0)),
                C1 - far.lost(tilted(mu, 0.0)),
            );
            mean += 2.0 * g * mu / f64::from(n);
            rough_mean += 2.0 * fit * mu / f64::from(n);
            worst = worst.max((g - fit).abs());
        }
        // The midpoint rule errs by its step squared times the slope's change, here below 1e-8.
        assert!((mean - C2).abs() < 1e-8, "{mean}");
        assert!(worst < 7e-4, "{worst}");
        // What `declares` builds on.
        let k = (C1 - rough_mean) / (C1 - C2);
        let excess = (0..n)
            .map(|i| tilted(at(i), 0.0))
            .map(|w| k * far.lost(w) - near.lost(w))
            .fold(0.0, f64::max);
        assert!(excess < EXCESS && excess > 0.9 * EXCESS, "{excess}");
    }

    /// Midpoint rule in μi and φ: f is continuous with bends, so it errs by a few steps squared, 400⁻².
    #[test]
    fn a_white_furnace_is_1() {
        for roughness in [0.0, 0.3, 1.0] {
            let model = eon(&format!("eon:1,roughness={roughness}"));
            for mu in [1.0, 0.6, 0.1] {
                let (n, wo) = (400, tilted(mu, 0.2));
                let at = |k: i32| (f64::from(k) + 0.5) / f64::from(n);
                let mut sum = 0.0;
                for z in (0..n).map(at) {
                    for turn in (0..n).map(at) {
                        sum += model.eval(tilted(z, turn), wo)[0] * z;
                    }
                }
                let albedo = sum * TAU / f64::from(n * n);
                assert!((albedo - 1.0).abs() < 3e-5, "{roughness} {mu}: {albedo}");
            }
        }
    }

    #[test]
    fn without_roughness_it_is_lambertian() {
        let f = eon("eon:0.3,roughness=0").eval(tilted(0.2, 0.0), tilted(0.9, 0.4));
        assert!((f[0] - 0.3 * FRAC_1_PI).abs() < 1e-16);
    }

    /// At r = 1, light and viewer together at 60°: s = ¾, t = ½, so the single scattering is ρ/π A (1 + 3/2).
    #[test]
    fn brightens_towards_the_light() {
        let w = tilted(0.5, 0.3);
        let (single, _) = eon("eon:roughness=1").terms(w, w);
        assert!((single - 2.5 * FRAC_1_PI / (1.0 + C1)).abs() < 1e-14);
        // Opposite: 1 − ¾.
        let (single, _) = eon("eon:roughness=1").terms(tilted(0.5, 0.8), w);
        assert!((single - 0.25 * FRAC_1_PI / (1.0 + C1)).abs() < 1e-14);
    }
}
