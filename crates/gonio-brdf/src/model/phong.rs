//! Phong's model (T16): diffuse and a lobe around the mirror direction.

use crate::part::colour::{add, cast, mean, only_where, scale};
use crate::part::geometry::{
    above, cosine_density, cosine_hemisphere, mirror_cosine, mirrored, polar,
};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Frame, Real, Vec3};
use std::f64::consts::{FRAC_1_PI, PI, TAU};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "phong",
    summary: "diffuse, and a power of the cosine around the mirror direction",
    paper: "Phong 1975, \"Illumination for Computer Generated Pictures\"; Lafortune & Willems 1994 for the normalised form",
    parameters: &[
        ParameterInfo::colour(
            "diffuse",
            (0.0, 1.0),
            Some([0.5; 3]),
            "diffuse reflectance kd",
        ),
        ParameterInfo::colour(
            "specular",
            (0.0, 1.0),
            Some([0.5; 3]),
            "scale ks of the lobe",
        ),
        ParameterInfo::number(
            "exponent",
            "",
            (0.0, 1e5),
            Some(20.0),
            "exponent p: the larger, the narrower the lobe",
        ),
        ParameterInfo::choice(
            "normalisation",
            &["energy", "published"],
            Some("energy"),
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
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// ks, [0, 1].
    pub specular: [R; N],
    /// p, [0, 10⁵].
    pub exponent: R,
    /// Whether c = (p + 2)/2π, otherwise 1.
    pub normalised: bool,
}

impl<R: Real, const N: usize> Phong<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            diffuse: spec.colour("diffuse")?,
            specular: spec.colour("specular")?,
            exponent: spec.real("exponent"),
            normalised: spec.word("normalisation") == "energy",
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Phong<S, N> {
        Phong {
            diffuse: cast(self.diffuse, f),
            specular: cast(self.specular, f),
            exponent: f(self.exponent),
            normalised: self.normalised,
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "diffuse" => self.diffuse = super::components(value),
            "specular" => self.specular = super::components(value),
            _ => self.exponent = value[0],
        }
    }

    /// The constant c.
    #[inline(always)]
    fn constant(&self) -> R {
        if self.normalised {
            (self.exponent + R::lit(2.0)) * R::lit(0.5 * FRAC_1_PI)
        } else {
            R::one()
        }
    }

    /// Albedo of the lobe at normal incidence, mean over the colours.
    #[inline(always)]
    fn lobe_albedo(&self) -> R {
        self.constant() * mean(self.specular) * R::lit(2.0 * PI) / (self.exponent + R::lit(2.0))
    }

    /// Probability of the diffuse part.
    #[inline(always)]
    fn diffuse_probability(&self) -> R {
        let (d, s) = (mean(self.diffuse), self.lobe_albedo());
        // Both black: whatever is drawn has weight 0.
        (d + R::lit(1e-20)) / (d + s + R::lit(1e-20))
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Phong<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let cos = mirror_cosine(wi, wo);
        let lobe = R::select(
            cos.gt(R::zero()),
            cos.clamp(R::zero(), R::one()).powf(self.exponent),
            R::zero(),
        ) * self.constant();
        let f = add(
            scale(self.diffuse, R::lit(FRAC_1_PI)),
            scale(self.specular, lobe),
        );
        only_where(above(wi, wo), f)
    }

    /// pd cosθi/π + (1 − pd)(p + 1)/2π cosᵖα.
    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let cos = mirror_cosine(wi, wo);
        let lobe = R::select(
            cos.gt(R::zero()),
            cos.clamp(R::zero(), R::one()).powf(self.exponent),
            R::zero(),
        ) * (self.exponent + R::one())
            * R::lit(0.5 * FRAC_1_PI);
        let p = self.diffuse_probability();
        let density = p.lerp(lobe, cosine_density(wi));
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let diffuse = cosine_hemisphere(u[0], u[1]);
        // cosα = (1 − u₁)^(1/(p + 1)) has the density (p + 1)/2π cosᵖα.
        let cos = (R::one() - u[1]).powf((self.exponent + R::one()).recip());
        let sin = (R::one() - cos * cos).safe_sqrt();
        let lobe = Frame::from_normal(mirrored(wo)).to_world(polar(cos, sin, u[0]));
        let wi = Vec3::select(u[2].lt(self.diffuse_probability()), diffuse, lobe);
        Sample::continuous(wi, self.eval_cos(wi, wo), self.pdf(wi, wo))
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        mean(self.diffuse) + self.lobe_albedo()
    }
}
