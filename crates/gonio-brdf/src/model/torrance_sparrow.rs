//! The microfacet model of Torrance and Sparrow (T18).

use crate::part::albedo;
use crate::part::colour::{add, cast, each_component, mean, only_where, scale};
use crate::part::distribution::{ALPHA_MIN, Distribution, Shape};
use crate::part::fresnel::{self, Fresnel};
use crate::part::geometry::{Half, above, mirrored_about, turned};
use crate::part::masking::{Masking, smith_g1_over_cos, visibility};
use crate::{Alias, Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::{FRAC_1_PI, PI};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "torrance-sparrow",
    summary: "microfacets: tiny mirrors with a distribution of normals that shadow, mask and light each other",
    paper: "Torrance & Sparrow 1967, \"Theory for Off-Specular Reflection from Roughened Surfaces\"; Cook & Torrance 1982; \
            Walter et al. 2007; Heitz 2014; Kulla & Conty 2017 for interreflection",
    parameters: &[
        ParameterInfo::choice(
            "distribution",
            &["ggx", "beckmann", "blinn-phong"],
            Some("ggx"),
            "distribution D of the facets' normals",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.3),
            "perceptual roughness; alpha = roughness², not below 1e-4",
        ),
        ParameterInfo::number(
            "alpha",
            "",
            (0.0, 1.0),
            None,
            "slope scale instead of roughness, not below 1e-4",
        ),
        ParameterInfo::number(
            "anisotropy",
            "",
            (0.0, 1.0),
            Some(0.0),
            "alpha_x = alpha/a, alpha_y = alpha·a with a = √(1 − 0.9 anisotropy) (Burley 2012)",
        ),
        ParameterInfo::number(
            "alpha_x",
            "",
            (0.0, 1.0),
            None,
            "slope scale along x, with alpha_y, instead of the above",
        ),
        ParameterInfo::number(
            "alpha_y",
            "",
            (0.0, 1.0),
            None,
            "slope scale along y, with alpha_x",
        ),
        ParameterInfo::number(
            "rotation_deg",
            "°",
            (-360.0, 360.0),
            Some(0.0),
            "angle from the tangent to the direction of alpha_x, counter-clockwise seen from above",
        ),
        ParameterInfo::choice(
            "masking",
            &["smith-correlated", "smith", "v-cavity"],
            Some("smith-correlated"),
            "masking and shadowing G",
        ),
        fresnel::parameter("schlick"),
        fresnel::F0,
        fresnel::IOR,
        fresnel::ETA,
        fresnel::K,
        fresnel::METAL,
        ParameterInfo::choice(
            "interreflection",
            &["on", "off"],
            Some("on"),
            "a reciprocal lobe for the light that leaves after several facets",
        ),
    ],
    positional: None,
    aliases: &[
        Alias {
            name: "ggx",
            preset: &[("distribution", "ggx")],
        },
        Alias {
            name: "beckmann",
            preset: &[("distribution", "beckmann")],
        },
        Alias {
            name: "cook-torrance",
            preset: &[("distribution", "beckmann"), ("masking", "v-cavity")],
        },
    ],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    let isotropic = slope_scales(spec).is_ok_and(|(x, y)| x == y);
    // Smith's masking for the Blinn–Phong distribution borrows Λ from Beckmann's: visible areas then don't add up.
    let borrowed = spec.word("distribution") == "blinn-phong" && spec.word("masking") != "v-cavity";
    Declares {
        isotropic,
        ..Declares::physical(if borrowed { f64::INFINITY } else { 1.0 })
    }
}

/// (αx, αy) of a description.
fn slope_scales(spec: &ModelSpec) -> Result<(f64, f64), BrdfError> {
    let given = |key: &str| spec.values.contains_key(key);
    let floor = |x: f64| x.clamp(ALPHA_MIN, 1.0);
    match (spec.number("alpha_x"), spec.number("alpha_y")) {
        (Some(x), Some(y)) => {
            for other in ["roughness", "alpha", "anisotropy"] {
                if given(other) {
                    return Err(spec.wrong(other, "no value beside alpha_x and alpha_y"));
                }
            }
            Ok((floor(x), floor(y)))
        }
        (None, None) => {
            if given("alpha") && given("roughness") {
                return Err(spec.wrong("alpha", "either roughness or alpha, not both"));
            }
            let roughness: f64 = spec.real("roughness");
            let alpha = spec.number("alpha").unwrap_or(roughness * roughness);
            let aspect = aspect(spec.real::<f64>("anisotropy"));
            Ok((floor(alpha / aspect), floor(alpha * aspect)))
        }
        (x, _) => {
            let missing = if x.is_some() { "alpha_y" } else { "alpha_x" };
            Err(spec.wrong(missing, "both alpha_x and alpha_y"))
        }
    }
}

/// a = √(1 − 0.9 anisotropy).
fn aspect<R: Real>(anisotropy: R) -> R {
    (R::one() - R::lit(0.9) * anisotropy).sqrt()
}

/// f = F(θ′) G(ωi, ωr) D(θh)/(4 cosθi cosθr), and with interreflection also
///
/// f_ms = F_ms (1 − E(μi)) (1 − E(μr))/(π (1 − Ē)),  F_ms = F̄² Ē/(1 − F̄ (1 − Ē)),
///
/// where E is the directional albedo for F = 1 (a table over √μ and √α), Ē its mean and F̄ the mean reflectance. The
/// geometric series F̄^k (1 − Ē)^(k−1) Ē over k ≥ 2 facets gives F_ms. For F = 1 a white furnace then is 1 but for the table's
/// interpolation: never more, and at most 4e-3 less. With anisotropy the table is read at the smaller slope scale, which loses less than the true
/// surface: the lobe then compensates too little, never too much.
///
/// Sampling: visible normals for GGX (Dupuy & Benyoub 2023), all normals with density D h.z for the others, and the
/// cosine for interreflection, mixed by their shares of the albedo.
#[derive(Debug, Clone, Copy)]
pub struct TorranceSparrow<R: Real, const N: usize> {
    /// D.
    pub distribution: Distribution<R>,
    /// G.
    pub masking: Masking,
    /// F.
    pub fresnel: Fresnel<R, N>,
    /// F̄ for the interreflection lobe; `None` without one.
    pub interreflection: Option<[R; N]>,
    /// Cosine and sine of the rotation of the x axis, if any.
    pub rotation: Option<[R; 2]>,
    alpha: R,
    aspect: R,
}

/// What evaluation and density share for one pair of directions, in the frame of (αx, αy).
struct Pair<R: Real> {
    wi: Vec3<R>,
    wo: Vec3<R>,
    half: Half<R>,
    /// D of the half vector.
    d: R,
}

/// The interreflection lobe towards one viewer.
struct Lobe<R: Real, const N: usize> {
    /// √α.
    roughness: R,
    /// (1 − E(μr))/(π (1 − Ē)).
    shape: R,
    /// F_ms.
    factor: [R; N],
    /// Probability of sampling it from ωr.
    probability: R,
}

impl<R: Real, const N: usize> TorranceSparrow<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let (x, y) = slope_scales(spec)?;
        let fresnel = Fresnel::from_spec(spec)?;
        let rotation_deg: f64 = spec.real("rotation_deg");
        let turn = R::lit(rotation_deg * PI / 180.0);
        Ok(Self {
            distribution: Distribution {
                shape: match spec.word("distribution").as_str() {
                    "beckmann" => Shape::Beckmann,
                    "blinn-phong" => Shape::BlinnPhong,
                    _ => Shape::Ggx,
                },
                alpha_x: R::lit(x),
                alpha_y: R::lit(y),
            },
            masking: match spec.word("masking").as_str() {
                "smith" => Masking::Smith,
                "v-cavity" => Masking::VCavity,
                _ => Masking::SmithCorrelated,
            },
            interreflection: (spec.word("interreflection") == "on").then(|| fresnel.average()),
            fresnel,
            rotation: (rotation_deg != 0.0 && x != y).then(|| [turn.cos(), turn.sin()]),
            alpha: R::lit((x * y).sqrt()),
            aspect: R::lit((y / x).sqrt()),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> TorranceSparrow<S, N> {
        TorranceSparrow {
            distribution: self.distribution.cast(f),
            masking: self.masking,
            fresnel: self.fresnel.cast(f),
            interreflection: self.interreflection.map(|a| cast(a, f)),
            rotation: self.rotation.map(|[c, s]| [f(c), f(s)]),
            alpha: f(self.alpha),
            aspect: f(self.aspect),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let x = value[0];
        let floor = |a: R| a.clamp(R::lit(ALPHA_MIN), R::one());
        match parameter {
            "roughness" => self.alpha = x * x,
            "alpha" => self.alpha = x,
            "anisotropy" => self.aspect = aspect(x),
            "alpha_x" => return self.distribution.alpha_x = floor(x),
            "alpha_y" => return self.distribution.alpha_y = floor(x),
            "rotation_deg" => {
                let turn = x * R::lit(PI / 180.0);
                return self.rotation = Some([turn.cos(), turn.sin()]);
            }
            _ => {
                self.fresnel.set(parameter, value);
                if let Some(average) = &mut self.interreflection {
                    *average = self.fresnel.average();
                }
                return;
            }
        }
        self.distribution.alpha_x = floor(self.alpha / self.aspect);
        self.distribution.alpha_y = floor(self.alpha * self.aspect);
    }

    /// A direction in the frame of (αx, αy).
    #[inline(always)]
    fn in_axes(&self, w: Vec3<R>) -> Vec3<R> {
        match self.rotation {
            Some([c, s]) => turned(w, c, -s),
            None => w,
        }
    }

    #[inline(always)]
    fn pair(&self, wi: Vec3<R>, wo: Vec3<R>) -> Pair<R> {
        let (wi, wo) = (self.in_axes(wi), self.in_axes(wo));
        let half = Half::new(wi, wo);
        Pair {
            wi,
            wo,
            half,
            d: self.distribution.density(half.h),
        }
    }

    /// The interreflection lobe towards a viewer at cosine `mu_o`, if there is one.
    #[inline(always)]
    fn lobe(&self, mu_o: R) -> Option<Lobe<R, N>> {
        let average = self.interreflection?;
        let d = &self.distribution;
        let table = albedo::losses(d.shape, self.masking);
        let roughness = d.alpha_x.min(d.alpha_y).sqrt();
        let loss_o = table.directional(mu_o, roughness);
        let mean_loss = table.mean(roughness);
        let mut factor = average;
        each_component!(N, k => {
            let f = average[k];
            factor[k] = f * f * (R::one() - mean_loss) / (R::one() - f * mean_loss);
        });
        let many = loss_o * mean(factor);
        let once = (R::one() - loss_o) * mean(average) + R::lit(1e-20);
        Some(Lobe {
            roughness,
            shape: loss_o * R::lit(FRAC_1_PI) / mean_loss.max(R::lit(1e-9)),
            factor,
            probability: many / (many + once),
        })
    }

    /// f of a pair above the horizon.
    #[inline(always)]
    fn value(&self, pair: &Pair<R>, lobe: &Option<Lobe<R, N>>) -> [R; N] {
        let d = &self.distribution;
        let (wi, wo) = (pair.wi, pair.wo);
        let facets = pair.d * visibility(self.masking, d, wi, wo, &pair.half);
        let f = scale(self.fresnel.eval(pair.half.cos), facets);
        match lobe {
            Some(lobe) => {
                let table = albedo::losses(d.shape, self.masking);
                let loss_i = table.directional(wi.z, lobe.roughness);
                add(f, scale(lobe.factor, lobe.shape * loss_i))
            }
            None => f,
        }
    }

    /// The sampling density of a pair above the horizon.
    #[inline(always)]
    fn density(&self, pair: &Pair<R>, lobe: &Option<Lobe<R, N>>) -> R {
        let quarter = R::lit(0.25) * pair.d;
        let facets = match self.distribution.shape {
            Shape::Ggx => quarter * smith_g1_over_cos(&self.distribution, pair.wo),
            Shape::Beckmann | Shape::BlinnPhong => {
                quarter * pair.half.h.z / pair.half.cos.max(R::lit(1e-15))
            }
        };
        match lobe {
            Some(lobe) => lobe
                .probability
                .lerp(facets, cosine_hemisphere_density(pair.wi)),
            None => facets,
        }
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for TorranceSparrow<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let pair = self.pair(wi, wo);
        only_where(above(wi, wo), self.value(&pair, &self.lobe(wo.z)))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let density = self.density(&self.pair(wi, wo), &self.lobe(wo.z));
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (up, pair, lobe) = (above(wi, wo), self.pair(wi, wo), self.lobe(wo.z));
        (
            only_where(up, self.value(&pair, &lobe)),
            R::select(up, self.density(&pair, &lobe), R::zero()),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let local = self.in_axes(wo);
        let d = &self.distribution;
        let h = match d.shape {
            Shape::Ggx => d.sample_visible_ggx(local, u[0], u[1]),
            Shape::Beckmann | Shape::BlinnPhong => d.sample_normal(u[0], u[1]),
        };
        let mut wi = mirrored_about(local, h);
        if let Some(lobe) = self.lobe(wo.z) {
            let many = cosine_hemisphere([u[0], u[1]]);
            wi = Vec3::select(u[2].lt(lobe.probability), many, wi);
        }
        if let Some([c, s]) = self.rotation {
            wi = turned(wi, c, s);
        }
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(self.fresnel.eval(wo.z.saturate()))
    }
}
