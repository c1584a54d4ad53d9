//! The material of glTF 2.0: metallic-roughness, and the layers that extensions add to it.

mod layers;
mod parameters;
mod whole;

pub use layers::{Anisotropy, Coat, Film, Passage, Sheen};
pub use parameters::INFO;

use crate::part::colour::{add, cast, each_component, grey, largest, mean, only_where, scale};
use crate::part::distribution::{Distribution, Shape};
use crate::part::geometry::{Half, above};
use crate::part::masking::{Masking, smith_g1_over_cos, visibility};
use crate::{Brdf, BrdfError, ModelSpec, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};
use std::f64::consts::FRAC_1_PI;
use whole::EvalWhole;

/// f = mix(dielectric, metal, metallic) as in appendix B.2:
///
/// - metal = S (c + (1 − c)(1 − cosθ′)⁵), c the base colour
/// - dielectric = (1 − max F) c/π + S F, F = F₀ + (F₉₀ − F₀)(1 − cosθ′)⁵,
///   F₀ = min(((ior − 1)/(ior + 1))² · specular_color, 1) · specular, F₉₀ = specular
/// - S = D V with the GGX distribution D and Smith's separable visibility V (B.3.2)
///
/// The appendix's shorter implementation (B.3.5) mixes parameters instead of results; both agree at metallic 0 and 1.
///
/// What the extensions add, each where its strength isn't 0:
///
/// - anisotropy: αx = mix(α, 1, s²) along its direction, αy = α
/// - iridescence: both F are mixed with the reflectance of a thin film on a clear body of the same F₀
/// - transmission t: mix(c/π, c T, t) in place of c/π. For a thin wall T is S of the mirror image of ωi. For a solid body it is
///   Walter's refraction, f = |ωi·h| |ωr·h| n_r² G D/(|cosθi cosθr| (n_i ωi·h + n_r ωr·h)²), with F by the angle outside, and 1 beyond the
///   critical angle; the body absorbs σ = −ln(attenuation_color)/attenuation_distance
/// - sheen: f = sheen + f min(1 − max(s) E(ωi), 1 − max(s) E(ωr)), with the fibres of `sheen-charlie` of alpha = sheen_roughness², s their
///   colour and E the albedo of white ones; below sheen_roughness 0.3 they return more than they get at grazing angles
/// - clearcoat: f = mix(f, S, k), k = clearcoat · (0.04 + 0.96 (1 − cosθr)⁵), S with the coat's roughness; by the viewer's angle alone, so it isn't reciprocal.
///   A coat with a normal N of its own has cosθr = |N·ωr| and S |N·ωi|/cosθi
///
/// Sheen and clear coat lie outside of a body, and on both sides of a thin wall. The film borders on air.
/// A material that transmits is a function of both sides; any other is 0 below the horizon.
///
/// Sampling: one part by its share of the albedo (the cosine for diffuse, visible normals for facets and coat, the sheen's own lobe), then
/// reflection or transmission by the drawn facet's.
#[derive(Debug, Clone, Copy)]
pub struct Gltf<R: Real, const N: usize> {
    /// c, [0, 1].
    pub base_color: [R; N],
    /// [0, 1].
    pub metallic: R,
    /// Perceptual, [0, 1].
    pub roughness: R,
    /// GGX of alpha = roughness².
    pub distribution: Distribution<R>,
    /// Index of refraction ≥ 1.
    pub ior: R,
    /// F₉₀ of the dielectric, [0, 1].
    pub specular: R,
    /// Tint of F₀ of the dielectric.
    pub specular_color: [R; N],
    /// The direction along which it is rougher.
    pub anisotropy: Anisotropy<R>,
    /// The thin film on it.
    pub film: Film<R>,
    /// What passes it.
    pub passage: Passage<R, N>,
    /// The fibres on it.
    pub sheen: Sheen<R, N>,
    /// The coat over all.
    pub coat: Coat<R>,
}

impl<R: Real, const N: usize> Gltf<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let mut model = Self {
            base_color: spec.colour("base_color")?,
            metallic: spec.real("metallic"),
            roughness: spec.real("roughness"),
            distribution: Distribution::isotropic(Shape::Ggx, R::one()),
            ior: spec.real("ior"),
            specular: spec.real("specular"),
            specular_color: spec.colour("specular_color")?,
            anisotropy: Anisotropy::from_spec(spec),
            film: Film::from_spec(spec),
            passage: Passage::from_spec(spec)?,
            sheen: Sheen::from_spec(spec)?,
            coat: Coat::from_spec(spec),
        };
        model.set_scales();
        Ok(model)
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Gltf<S, N> {
        Gltf {
            base_color: cast(self.base_color, f),
            metallic: f(self.metallic),
            roughness: f(self.roughness),
            distribution: self.distribution.cast(f),
            ior: f(self.ior),
            specular: f(self.specular),
            specular_color: cast(self.specular_color, f),
            anisotropy: self.anisotropy.cast(f),
            film: self.film.cast(f),
            passage: self.passage.cast(f),
            sheen: self.sheen.cast(f),
            coat: self.coat.cast(f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        let x = value[0];
        match parameter {
            "base_color" => self.base_color = super::components(value),
            "metallic" => self.metallic = x,
            "roughness" => {
                self.roughness = x;
                self.set_scales();
            }
            "ior" => self.ior = x,
            "specular" => self.specular = x,
            "specular_color" => self.specular_color = super::components(value),
            "anisotropy" | "rotation_deg" | "anisotropy_direction" => {
                self.anisotropy.set(parameter, value);
                self.set_scales();
            }
            "iridescence" | "iridescence_ior" | "iridescence_thickness_nm" => {
                self.film.set(parameter, x);
            }
            "sheen_color" | "sheen_roughness" => self.sheen.set(parameter, value),
            "clearcoat" | "clearcoat_roughness" | "clearcoat_normal" => {
                self.coat.set(parameter, value);
            }
            _ => self.passage.set(parameter, value),
        }
    }

    fn set_scales(&mut self) {
        let [along, across] = self.anisotropy.scales(self.roughness * self.roughness);
        self.distribution.set_alpha(along, across);
    }

    /// Whether there is more than the isotropic metallic-roughness base, which has a shorter way of its own.
    #[inline(always)]
    fn is_layered(&self) -> bool {
        self.anisotropy.on || self.film.on || self.passage.on || self.sheen.on || self.coat.on
    }

    /// F of the dielectric, by (1 − cosθ′)⁵.
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

    /// F of the metal, by (1 − cosθ′)⁵.
    #[inline(always)]
    fn metal(&self, weight: R) -> [R; N] {
        let mut f = self.base_color;
        each_component!(N, k => {
            let c = self.base_color[k];
            f[k] = c + (R::one() - c) * weight;
        });
        f
    }

    /// The factors on c/π and on S, by cosθ′.
    #[inline(always)]
    fn shares(&self, cos: R) -> (R, [R; N]) {
        let one = R::one();
        let weight = (one - cos).saturate().pow5();
        let mut specular = self.dielectric(weight);
        let metal = self.metal(weight);
        let diffuse = (one - self.metallic) * (one - largest(specular));
        each_component!(N, k => { specular[k] = self.metallic.lerp(specular[k], metal[k]); });
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
        if self.is_layered() {
            return R::out_of_line(EvalWhole(self, wi, wo)).0;
        }
        let half = Half::new(wi, wo);
        self.value(wi, wo, &half, self.distribution.density_of(&half))
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        if self.is_layered() {
            return R::out_of_line(EvalWhole(self, wi, wo)).1;
        }
        let half = Half::new(wi, wo);
        self.density(wi, wo, self.distribution.density_of(&half))
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        if self.is_layered() {
            return R::out_of_line(EvalWhole(self, wi, wo));
        }
        let half = Half::new(wi, wo);
        let d = self.distribution.density_of(&half);
        (self.value(wi, wo, &half, d), self.density(wi, wo, d))
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        if self.is_layered() {
            return self.sample_whole(wo, u);
        }
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
        if self.is_layered() {
            return self.whole_albedo(wo);
        }
        let (d, s) = self.shares(wo.z.saturate());
        d * mean(self.base_color) + mean(s)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        self.passage.on
    }

    #[inline(always)]
    fn relative_ior(&self) -> [R; N] {
        grey(self.passage.relative_ior(self.ior))
    }

    #[inline(always)]
    fn absorption(&self) -> [R; N] {
        self.passage.absorption()
    }
}
