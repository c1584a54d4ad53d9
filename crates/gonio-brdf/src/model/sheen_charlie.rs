//! The microfacet sheen of Estevez and Kulla, known as "Charlie".

use crate::part::colour::{cast, mean, only_where, scale};
use crate::part::geometry::{Half, above};
use crate::part::sheen_lobe::{SheenLobe, reflectance};
use crate::part::special::ln_1p;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{uniform_hemisphere, uniform_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "sheen-charlie",
    summary: "sheen of cloth by microfacets whose normals lie near the surface: a power of the sine",
    paper: "Estevez & Kulla 2017, \"Production Friendly Microfacet Sheen BRDF\"; Neubelt & Pettineo 2013, \"Crafting a Next-Gen \
            Material Pipeline for The Order: 1886\" for their visibility",
    parameters: &[
        ParameterInfo::colour(
            "color",
            (0.0, 1.0),
            Some([1.0; 3]),
            "scale of the reflected light",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.5),
            "perceptual roughness; alpha = roughness², not below 1e-3",
        ),
        ParameterInfo::number(
            "alpha",
            "",
            (0.0, 1.0),
            None,
            "the paper's roughness r instead of roughness, not below 1e-3",
        ),
        ParameterInfo::choice(
            "visibility",
            &["charlie", "charlie-softened", "neubelt"],
            Some("charlie"),
            "masking and shadowing: the paper's fit; the same with its softened terminator, not reciprocal; Neubelt & Pettineo's",
        ),
    ],
    positional: Some("color"),
    aliases: &[],
    recordable: true,
    declares: |spec| Declares {
        reciprocal: spec.word("visibility") != "charlie-softened",
        // The fits say nothing on energy: with `neubelt` a viewer at 85° gets up to 6 % more than there is.
        ..Declares::physical(f64::INFINITY)
    },
};

/// Masking and shadowing of the fibres.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// 1/((1 + Λ(θi) + Λ(θr)) 4 cosθi cosθr).
    Charlie,
    /// The same with Λ(θi)^(1 + 2 (1 − cosθi)⁸) for the light.
    CharlieSoftened,
    /// 1/(4 (cosθi + cosθr − cosθi cosθr)).
    Neubelt,
}

/// f = c D(θh) V(ωi, ωr), D = (2 + 1/α) sin^(1/α)θh/2π, and V one of
///
/// - charlie: 1/((1 + Λ(θi) + Λ(θr)) 4 cosθi cosθr), Λ = exp(L(cosθ)) for cosθ < ½, else exp(2L(½) − L(1 − cosθ)),
///   L(x) = a/(1 + b xᶜ) + dx + e, where each coefficient goes from its value at α = 0 to that at α = 1 as 1 − (1 − α)²:
///   a 25.3245 to 21.5473, b 3.32435 to 3.82987, c 0.16801 to 0.19823, d −1.27393 to −1.97760, e −4.85967 to −4.32054;
/// - charlie-softened: the light's Λ to the power 1 + 2 (1 − cosθi)⁸, which softens the edge of the shadow and costs reciprocity;
/// - neubelt: 1/(4 (cosθi + cosθr − cosθi cosθr)).
///
/// Without Fresnel reflectance: the colour is the fibres'.
///
/// Sampling: the lobe of `sheen-ltc` at roughness √α, which has nearly this shape, mixed with the uniform hemisphere.
#[derive(Debug, Clone, Copy)]
pub struct SheenCharlie<R: Real, const N: usize> {
    /// c, [0, 1].
    pub color: [R; N],
    /// α, [1e-3, 1].
    pub alpha: R,
    /// V.
    pub visibility: Visibility,
}

/// The smallest α: smaller ones are taken for this one. Below it no light comes back but at grazing angles.
pub(crate) const ALPHA_MIN: f64 = 1e-3;

/// L(x) for α.
#[inline(always)]
fn log_lambda<R: Real>(x: R, alpha: R) -> R {
    let t = (R::one() - alpha).sq();
    let l = R::lit;
    let a = t.lerp(l(21.5473), l(25.3245));
    let b = t.lerp(l(3.82987), l(3.32435));
    let c = t.lerp(l(0.19823), l(0.16801));
    let d = t.lerp(l(-1.97760), l(-1.27393));
    let e = t.lerp(l(-4.32054), l(-4.85967));
    a / (R::one() + b * x.powf(c)) + d * x + e
}

/// ln Λ(θ).
#[inline(always)]
fn log_masking<R: Real>(cos: R, alpha: R) -> R {
    let half = R::lit(0.5);
    let cos = cos.saturate();
    let steep = cos.lt(half);
    let l = log_lambda(R::select(steep, cos, R::one() - cos), alpha);
    let flat = R::lit(2.0) * log_lambda(half, alpha) - l;
    R::select(steep, l, flat)
}

impl<R: Real, const N: usize> SheenCharlie<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        if spec.values.contains_key("alpha") && spec.values.contains_key("roughness") {
            return Err(spec.wrong("alpha", "either roughness or alpha, not both"));
        }
        let roughness: f64 = spec.real("roughness");
        let alpha = spec.number("alpha").unwrap_or(roughness * roughness);
        Ok(Self {
            color: spec.colour("color")?,
            alpha: R::lit(alpha.max(ALPHA_MIN)),
            visibility: match spec.word("visibility").as_str() {
                "charlie-softened" => Visibility::CharlieSoftened,
                "neubelt" => Visibility::Neubelt,
                _ => Visibility::Charlie,
            },
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> SheenCharlie<S, N> {
        SheenCharlie {
            color: cast(self.color, f),
            alpha: f(self.alpha),
            visibility: self.visibility,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let x = value[0];
        match parameter {
            "color" => self.color = super::components(value),
            "alpha" => self.alpha = x.max(R::lit(ALPHA_MIN)),
            _ => self.alpha = (x * x).max(R::lit(ALPHA_MIN)),
        }
    }

    /// D of the half vector `h`.
    #[inline(always)]
    fn distribution(&self, h: Vec3<R>) -> R {
        let over = self.alpha.recip();
        // sin^(1/α) = exp(ln(1 − cos²)/2α), with all digits where the normal lies in the surface.
        let z2 = h.z * h.z;
        let sin2 = h.x * h.x + h.y * h.y;
        let near = z2.lt(R::lit(0.4));
        let lying = ln_1p(-z2.min(R::lit(0.4)));
        let log = R::select(near, lying, sin2.max(R::lit(1e-37)).ln());
        let power = (R::lit(0.5) * over * log).exp();
        (R::lit(2.0) + over) * R::lit(0.5 * FRAC_1_PI) * power
    }

    /// V, above the horizon.
    #[inline(always)]
    fn masking(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (i, o) = (wi.z, wo.z);
        let tiny = R::lit(1e-29);
        match self.visibility {
            Visibility::Neubelt => (R::lit(4.0) * ((i + o) - i * o)).max(tiny).recip(),
            _ => {
                let mut light = log_masking(i, self.alpha);
                if self.visibility == Visibility::CharlieSoftened {
                    let steep = (R::one() - i).saturate();
                    light = light * (R::one() + R::lit(2.0) * steep.sq().sq().sq());
                }
                let hidden = light.exp() + log_masking(o, self.alpha).exp();
                ((R::one() + hidden) * (R::lit(4.0) * (i * o)))
                    .max(tiny)
                    .recip()
            }
        }
    }

    /// Probability of drawing from the lobe of `sheen-ltc`, which is too narrow at grazing angles.
    #[inline(always)]
    fn lobe_probability(wo: Vec3<R>) -> R {
        R::lit(0.2) + R::lit(0.7) * wo.z.saturate()
    }

    /// A direction with the density `pdf`.
    #[inline(always)]
    pub(crate) fn draw(&self, wo: Vec3<R>, u: [R; 3]) -> Vec3<R> {
        let lobe = SheenLobe::new(wo, self.alpha.sqrt()).sample([u[0], u[1]]);
        let uniform = uniform_hemisphere([u[0], u[1]]);
        Vec3::select(u[2].lt(Self::lobe_probability(wo)), lobe, uniform)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for SheenCharlie<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let d = self.distribution(Half::new(wi, wo).h());
        let f = scale(self.color, d * self.masking(wi, wo));
        only_where(above(wi, wo), f)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let lobe = SheenLobe::new(wo, self.alpha.sqrt()).density_over_cos(wi) * wi.z;
        let density = Self::lobe_probability(wo).lerp(uniform_hemisphere_density(wi), lobe);
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        self.sample_of(self.draw(wo, u), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(self.color) * reflectance(wo.z, self.alpha.sqrt())
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
        // Light and viewer at 60° in the same azimuth: h = ωr, sinθh = √¾; α = ½: D = 4 · ¾/2π. V = 1/(4 · ¾).
        let w = around_axis(0.3, 0.75f64.sqrt(), 0.5);
        let f = model("sheen-charlie:0.5,alpha=0.5,visibility=neubelt").eval(w, w)[0];
        assert!((f - 0.5 * (3.0 / (2.0 * PI)) / 3.0).abs() < 1e-14);
        // With the fit at α = 1, cosθ = ½: Λ = exp(21.5473/(1 + 3.82987/2^0.19823) − 0.9888 − 4.32054).
        let lambda = (21.5473 / (1.0 + 3.82987 * 0.5f64.powf(0.19823)) - 0.9888 - 4.32054).exp();
        let d = 3.0 * 0.75f64.sqrt() / (2.0 * PI);
        let f = model("sheen-charlie:alpha=1").eval(w, w)[0];
        assert!((f - d / (1.0 + 2.0 * lambda)).abs() < 1e-14);
        // Softened: the light's Λ to 1 + 2/256.
        let softer = lambda.powf(1.0 + 2.0 / 256.0);
        let f = model("sheen-charlie:alpha=1,visibility=charlie-softened").eval(w, w)[0];
        assert!((f - d / (1.0 + lambda + softer)).abs() < 1e-14);
    }

    /// ∫ D(h) h.z dh = 1, midpoint rule over θ.
    #[test]
    fn normals_have_unit_projected_area() {
        for alpha in [0.01, 0.3, 1.0] {
            let sheen: SheenCharlie<f64, 3> = SheenCharlie {
                color: [1.0; 3],
                alpha,
                visibility: Visibility::Charlie,
            };
            let n = 20_000;
            let mut sum = 0.0;
            for k in 0..n {
                let theta = (f64::from(k) + 0.5) / f64::from(n) * PI / 2.0;
                let (sin, cos) = theta.sin_cos();
                sum += sheen.distribution(Vec3::new(sin, 0.0, cos)) * cos * sin;
            }
            let area = sum * PI * PI / f64::from(n);
            assert!((area - 1.0).abs() < 1e-5, "{alpha}: {area}");
        }
    }

    /// Λ is continuous where its two branches meet.
    #[test]
    fn masking_has_no_step() {
        for alpha in [0.01, 0.5, 1.0] {
            let (below, above) = (log_masking(0.5 - 1e-9, alpha), log_masking(0.5, alpha));
            assert!((below - above).abs() < 1e-7);
        }
    }
}
