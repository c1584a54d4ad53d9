//! The metallic-roughness material of glTF 2.0.

use crate::part::colour::{add, cast, each_component, largest, mean, only_where, scale};
use crate::part::distribution::{Distribution, Shape};
use crate::part::geometry::{Half, above};
use crate::part::masking::{Masking, smith_g1_over_cos, visibility};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "gltf",
    summary: "the metallic-roughness material of glTF 2.0, with its extensions ior and specular",
    paper: "Khronos glTF 2.0 specification, appendix B; KHR_materials_ior; KHR_materials_specular",
    parameters: &[
        ParameterInfo::colour(
            "base_color",
            (0.0, 1.0),
            Some([0.8; 3]),
            "diffuse colour of the dielectric, F0 of the metal",
        ),
        ParameterInfo::number(
            "metallic",
            "",
            (0.0, 1.0),
            Some(0.0),
            "0 dielectric, 1 metal",
        ),
        ParameterInfo::number(
            "roughness",
            "",
            (0.0, 1.0),
            Some(0.5),
            "perceptual roughness; alpha = roughness², not below 1e-4",
        ),
        ParameterInfo::number(
            "ior",
            "",
            (1.0, 10.0),
            Some(1.5),
            "index of refraction of the dielectric",
        ),
        ParameterInfo::number(
            "specular",
            "",
            (0.0, 1.0),
            Some(1.0),
            "strength of the dielectric's specular reflection",
        ),
        ParameterInfo::colour(
            "specular_color",
            (0.0, 100.0),
            Some([1.0; 3]),
            "tint of the dielectric's F0",
        ),
    ],
    positional: None,
    aliases: &[crate::Alias {
        name: "metallic-roughness",
        preset: &[],
    }],
    recordable: true,
    declares: |spec| {
        // Diffuse and specular are mixed by the Fresnel reflectance of the half vector, which at grazing angles takes less
        // from the diffuse part than the specular part adds: a bright dielectric can reflect more than it gets.
        let metal = spec.real::<f64>("metallic") == 1.0;
        let black = spec.largest("base_color") == 0.0;
        Declares::physical(if metal || black { 1.0 } else { f64::INFINITY })
    },
};

/// f = mix(dielectric, metal, metallic) as in appendix B.2:
///
/// - metal = S (c + (1 − c)(1 − cosθ′)⁵), c the base colour
/// - dielectric = (1 − max F) c/π + S F, F = F₀ + (F₉₀ − F₀)(1 − cosθ′)⁵,
///   F₀ = min(((ior − 1)/(ior + 1))² · specular_color, 1) · specular, F₉₀ = specular
/// - S = D V with the GGX distribution D and Smith's separable visibility V (B.3.2)
///
/// The appendix's shorter implementation (B.3.5) mixes parameters instead of results; both agree at metallic 0 and 1.
#[derive(Debug, Clone, Copy)]
pub struct Gltf<R: Real, const N: usize> {
    /// c, [0, 1].
    pub base_color: [R; N],
    /// [0, 1].
    pub metallic: R,
    /// GGX of alpha = roughness².
    pub distribution: Distribution<R>,
    /// Index of refraction ≥ 1.
    pub ior: R,
    /// F₉₀ of the dielectric, [0, 1].
    pub specular: R,
    /// Tint of F₀ of the dielectric.
    pub specular_color: [R; N],
}

impl<R: Real, const N: usize> Gltf<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let mut model = Self {
            base_color: spec.colour("base_color")?,
            metallic: spec.real("metallic"),
            distribution: Distribution::isotropic(Shape::Ggx, R::one()),
            ior: spec.real("ior"),
            specular: spec.real("specular"),
            specular_color: spec.colour("specular_color")?,
        };
        model.set_roughness(spec.real("roughness"));
        Ok(model)
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Gltf<S, N> {
        Gltf {
            base_color: cast(self.base_color, f),
            metallic: f(self.metallic),
            distribution: self.distribution.cast(f),
            ior: f(self.ior),
            specular: f(self.specular),
            specular_color: cast(self.specular_color, f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "base_color" => self.base_color = super::components(value),
            "metallic" => self.metallic = value[0],
            "roughness" => self.set_roughness(value[0]),
            "ior" => self.ior = value[0],
            "specular" => self.specular = value[0],
            _ => self.specular_color = super::components(value),
        }
    }

    fn set_roughness(&mut self, roughness: R) {
        let alpha = roughness * roughness;
        self.distribution.set_alpha(alpha, alpha);
    }

    /// F of the dielectric.
    #[inline(always)]
    fn dielectric(&self, weight: R) -> [R; N] {
        let r = (self.ior - R::one()) / (self.ior + R::one());
        let mut f = self.specular_color;
        each_component!(N, k => {
            let f0 = (r * r * f[k]).min(R::one()) * self.specular;
            f[k] = f0 + (self.specular - f0) * weight;
        });
        f
    }

    /// The factors on c/π and on S, by (1 − cosθ′)⁵.
    #[inline(always)]
    fn shares(&self, cos: R) -> (R, [R; N]) {
        let one = R::one();
        let weight = (one - cos).saturate().pow5();
        let mut specular = self.dielectric(weight);
        let diffuse = (one - self.metallic) * (one - largest(specular));
        each_component!(N, k => {
            let c = self.base_color[k];
            specular[k] = self.metallic.lerp(specular[k], c + (one - c) * weight);
        });
        (diffuse, specular)
    }

    /// Probability of the diffuse part: its share of the albedo, estimated with the mirror direction's Fresnel reflectance.
    #[inline(always)]
    fn diffuse_probability(&self, wo: Vec3<R>) -> R {
        let (d, s) = self.shares(wo.z.saturate());
        let diffuse = d * mean(self.base_color);
        diffuse / (diffuse + mean(s) + R::lit(1e-6))
    }

    /// f, from the half vector and D of it.
    #[inline(always)]
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>, d: R) -> [R; N] {
        let s = d * visibility(Masking::Smith, &self.distribution, wi, wo, half);
        let (diffuse, specular) = self.shares(half.cos);
        let diffuse = diffuse * R::lit(FRAC_1_PI);
        only_where(
            above(wi, wo),
            add(scale(specular, s), scale(self.base_color, diffuse)),
        )
    }

    /// The sampling density, from D of the half vector.
    #[inline(always)]
    fn density(&self, wi: Vec3<R>, wo: Vec3<R>, d: R) -> R {
        let facets = R::lit(0.25) * d * smith_g1_over_cos(&self.distribution, wo);
        let cosine = cosine_hemisphere_density(wi);
        let density = self.diffuse_probability(wo).lerp(facets, cosine);
        R::select(above(wi, wo), density, R::zero())
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Gltf<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let half = Half::new(wi, wo);
        self.value(wi, wo, &half, self.distribution.density(half.h))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let half = Half::new(wi, wo);
        self.density(wi, wo, self.distribution.density(half.h))
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let half = Half::new(wi, wo);
        let d = self.distribution.density(half.h);
        (self.value(wi, wo, &half, d), self.density(wi, wo, d))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let h = self.distribution.sample_visible_ggx(wo, u[0], u[1]);
        let wi = Vec3::select(
            u[2].lt(self.diffuse_probability(wo)),
            cosine_hemisphere([u[0], u[1]]),
            wo.reflect(h),
        );
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let (d, s) = self.shares(wo.z.saturate());
        d * mean(self.base_color) + mean(s)
    }
}
