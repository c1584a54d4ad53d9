//! Phong's model (T16): diffuse and a lobe around the mirror direction.

use crate::part::diffuse_and_lobe::{self, DiffuseAndLobe};
use crate::part::geometry::{above, mirror_cosine, mirrored};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, Sample};
use gonio_num::{Frame, Real, Vec3};
use gonio_radiometry::warp::{
    cosine_hemisphere, cosine_hemisphere_density, cosine_power_hemisphere,
};
use std::f64::consts::{FRAC_1_PI, TAU};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "phong",
    summary: "diffuse, and a power of the cosine around the mirror direction",
    paper: "Phong 1975, \"Illumination for Computer Generated Pictures\"; Lafortune & Willems 1994 for the normalised form",
    parameters: &[
        diffuse_and_lobe::DIFFUSE,
        diffuse_and_lobe::SPECULAR,
        diffuse_and_lobe::exponent(20.0),
        diffuse_and_lobe::normalisation(
            "published: the lobe is ks·cosᵖ; energy: times (p + 2)/2π, so that ks is its albedo at normal incidence",
        ),
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

/// The lobe's albedo is largest at normal incidence, ks·(energy: 1, published: 2π/(p + 2)).
fn declares(spec: &ModelSpec) -> Declares {
    let published = spec.word("normalisation") == "published";
    let gain = if published {
        TAU / (spec.real::<f64>("exponent") + 2.0)
    } else {
        1.0
    };
    Declares::physical(spec.largest_sum(&[("diffuse", 1.0), ("specular", gain)]))
}

/// f = kd/π + ks·c·cosᵖα, α between ωi and the mirror image of ωr; 0 for α ≥ 90°.
///
/// - energy: c = (p + 2)/2π. Then kd + ks ≤ 1 conserves energy (Lafortune & Willems 1994, eq. 7).
/// - published: c = 1, the lobe of Phong 1975 taken as the reflection function itself. It gains energy when
///   kd + 2π ks/(p + 2) > 1 and loses nearly all of the lobe for large p. (Phong's own shading formula has no cosθi beside
///   the lobe. Read as a BRDF that would be this lobe over cosθi: neither reciprocal nor bounded.)
#[derive(Debug, Clone, Copy)]
pub struct Phong<R: Real, const N: usize> {
    /// kd, ks, p, and whether c = (p + 2)/2π, otherwise 1.
    pub constants: DiffuseAndLobe<R, N>,
}

impl<R: Real, const N: usize> Phong<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        let constants = DiffuseAndLobe::from_spec(spec)?;
        Ok(Self { constants })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Phong<S, N> {
        let constants = self.constants.cast(f);
        Phong { constants }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.constants.set(parameter, value);
    }

    /// cosᵖα, 0 for α ≥ 90°.
    #[inline(always)]
    fn lobe(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let cos = mirror_cosine(wi, wo);
        let power = cos.clamp(R::zero(), R::one()).powf(self.constants.exponent);
        R::select(cos.gt(R::zero()), power, R::zero())
    }

    /// The constant c.
    #[inline(always)]
    fn c(&self) -> R {
        if self.constants.normalised {
            (self.constants.exponent + R::lit(2.0)) * R::lit(0.5 * FRAC_1_PI)
        } else {
            R::one()
        }
    }

    /// Albedo of the lobe at normal incidence over ks: 2πc/(p + 2).
    #[inline(always)]
    fn lobe_gain(&self) -> R {
        self.c() * R::lit(TAU) / (self.constants.exponent + R::lit(2.0))
    }

    /// pd cosθi/π + (1 − pd)(p + 1)/2π cosᵖα.
    #[inline(always)]
    fn density(&self, wi: Vec3<R>, wo: Vec3<R>, lobe: R) -> R {
        let lobe = lobe * (self.constants.exponent + R::one()) * R::lit(0.5 * FRAC_1_PI);
        let diffuse = cosine_hemisphere_density(wi);
        self.constants
            .density(above(wi, wo), self.lobe_gain(), diffuse, lobe)
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Phong<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        self.constants
            .value(above(wi, wo), self.lobe(wi, wo) * self.c())
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        self.density(wi, wo, self.lobe(wi, wo))
    }

    #[inline(always)]
    fn eval_and_pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> ([R; N], R) {
        let lobe = self.lobe(wi, wo);
        (
            self.constants.value(above(wi, wo), lobe * self.c()),
            self.density(wi, wo, lobe),
        )
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let diffuse = cosine_hemisphere([u[0], u[1]]);
        let lobe = cosine_power_hemisphere([u[0], u[1]], self.constants.exponent);
        let lobe = Frame::from_normal(mirrored(wo)).to_world(lobe);
        let pd = self.constants.diffuse_probability(self.lobe_gain());
        self.sample_of(Vec3::select(u[2].lt(pd), diffuse, lobe), wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        self.constants.albedo(self.lobe_gain())
    }
}
