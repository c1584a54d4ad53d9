//! The Blinn–Phong model: diffuse and a power of the half vector's cosine.

use crate::part::diffuse_and_lobe::{self, DiffuseAndLobe};
use crate::part::geometry::{Half, above, mirrored_about};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{
    cosine_hemisphere, cosine_hemisphere_density, cosine_power_hemisphere,
    cosine_power_hemisphere_density,
};
use std::f64::consts::{LN_2, PI, TAU};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "blinn-phong",
    summary: "diffuse, and a power of the cosine between the normal and the half vector",
    paper: "Blinn 1977, \"Models of Light Reflection for Computer Synthesized Pictures\"; Giesen 2009 for the normalisation; Ngan, Durand \
            & Matusik 2005 for that of fits",
    parameters: &[
        diffuse_and_lobe::DIFFUSE,
        diffuse_and_lobe::SPECULAR,
        diffuse_and_lobe::exponent(80.0),
        ParameterInfo::choice(
            "normalisation",
            &["energy", "published", "normals"],
            Some("energy"),
            "published: the lobe is ks·cosᵖ; energy: scaled so that ks is its albedo at normal incidence; normals: times (p + 2)/2π, the \
             density of normals, as in fits: its albedo then is about 4 ks",
        ),
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    let p: f64 = spec.real("exponent");
    let gain = match Normalisation::from_spec(spec) {
        Normalisation::Energy => 1.0,
        Normalisation::Published => plain_albedo(p),
        Normalisation::Normals => plain_albedo(p) * normals(p),
    };
    Declares::physical(spec.largest_sum(&[("diffuse", 1.0), ("specular", gain)]))
}

/// f = kd/π + ks·c·cosᵖθh.
///
/// - energy: c = (p + 2)(p + 4)/(8π (2^(−p/2) + p)), the inverse of the lobe's albedo at normal incidence, which is its largest
/// - published: c = 1
/// - normals: c = (p + 2)/2π, with which ∫ c cosᵖθ cosθ dω = 1, as of a density of microfacets (Ngan et al. 2005)
#[derive(Debug, Clone, Copy)]
pub struct BlinnPhong<R: Real, const N: usize> {
    /// kd, ks and p.
    pub constants: DiffuseAndLobe<R, N>,
    /// c.
    pub normalisation: Normalisation,
}

/// The constant c before the power.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Normalisation {
    /// One over the lobe's albedo at normal incidence.
    Energy,
    /// 1.
    Published,
    /// (p + 2)/2π.
    Normals,
}

impl Normalisation {
    fn from_spec(spec: &ModelSpec) -> Self {
        match spec.word("normalisation").as_str() {
            "published" => Self::Published,
            "normals" => Self::Normals,
            _ => Self::Energy,
        }
    }
}

/// (p + 2)/2π.
#[inline(always)]
fn normals<R: Real>(p: R) -> R {
    (p + R::lit(2.0)) * R::lit(1.0 / TAU)
}

/// Albedo of cosᵖθh at normal incidence: 8π (2^(−p/2) + p)/((p + 2)(p + 4)).
#[inline(always)]
fn plain_albedo<R: Real>(p: R) -> R {
    let two = R::lit(2.0);
    let top = (p * R::lit(-0.5 * LN_2)).exp() + p;
    R::lit(8.0 * PI) * top / ((p + two) * (p + two + two))
}

impl<R: Real, const N: usize> BlinnPhong<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            constants: DiffuseAndLobe::from_spec(spec)?,
            normalisation: Normalisation::from_spec(spec),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> BlinnPhong<S, N> {
        BlinnPhong {
            constants: self.constants.cast(f),
            normalisation: self.normalisation,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    /// The constant c over that of the density of half vectors, (p + 1)/2π.
    #[inline(always)]
    fn relative_c(&self) -> R {
        let p = self.constants.exponent;
        let over = R::lit(TAU) / (p + R::one());
        match self.normalisation {
            Normalisation::Energy => over / plain_albedo(p),
            Normalisation::Published => over,
            Normalisation::Normals => over * normals(p),
        }
    }

    /// Albedo of the lobe at normal incidence over ks.
    #[inline(always)]
    fn lobe_gain(&self) -> R {
        let p = self.constants.exponent;
        match self.normalisation {
            Normalisation::Energy => R::one(),
            Normalisation::Published => plain_albedo(p),
            Normalisation::Normals => plain_albedo(p) * normals(p),
        }
    }

    /// f, from the density of half vectors (p + 1)/2π cosᵖθh.
    #[inline(always)]
    fn value(&self, wi: Vec3<R>, wo: Vec3<R>, halves: R) -> [R; N] {
        self.constants
            .value(above(wi, wo), halves * self.relative_c())
    }

    /// pd cosθi/π + (1 − pd)(p + 1)/2π cosᵖθh/(4 cosθ′).
    #[inline(always)]
    fn density(&self, wi: Vec3<R>, wo: Vec3<R>, half: &Half<R>, halves: R) -> R {
        let lobe = R::lit(0.25) * halves / half.cos.max(R::lit(1e-15));
        let diffuse = cosine_hemisphere_density(wi);
        self.constants
            .density(above(wi, wo), self.lobe_gain(), diffuse, lobe)
    }

    /// The half vector and its density (p + 1)/2π cosᵖθh.
    #[inline(always)]
    fn half(&self, wi: Vec3<R>, wo: Vec3<R>) -> (Half<R>, R) {
        let half = Half::new(wi, wo);
        let density = cosine_power_hemisphere_density(half.h(), self.constants.exponent);
        (half, density)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for BlinnPhong<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let (_, halves) = self.half(wi, wo);
        self.value(wi, wo, halves)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let (half, halves) = self.half(wi, wo);
        self.density(wi, wo, &half, halves)
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let (half, halves) = self.half(wi, wo);
        (
            self.value(wi, wo, halves),
            self.density(wi, wo, &half, halves),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let diffuse = cosine_hemisphere([u[0], u[1]]);
        let h = cosine_power_hemisphere([u[0], u[1]], self.constants.exponent);
        let pd = self.constants.diffuse_probability(self.lobe_gain());
        let wi = Vec3::select(u[2].lt(pd), diffuse, mirrored_about(wo, h));
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        self.constants.albedo(self.lobe_gain())
    }
}
