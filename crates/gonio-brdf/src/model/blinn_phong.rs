//! The Blinn–Phong model: diffuse and a power of the half vector's cosine.

use crate::part::colour::{add, cast, mean, only_where, scale};
use crate::part::geometry::{Half, above, cosine_density, cosine_hemisphere, polar};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_1_PI, LN_2, PI};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "blinn-phong",
    summary: "diffuse, and a power of the cosine between the normal and the half vector",
    paper: "Blinn 1977, \"Models of Light Reflection for Computer Synthesized Pictures\"; Giesen 2009 for the normalisation",
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
            Some(80.0),
            "exponent p: the larger, the narrower the lobe",
        ),
        ParameterInfo::choice(
            "normalisation",
            &["energy", "published"],
            Some("energy"),
            "published: the lobe is ks·cosᵖ; energy: scaled so that ks is its albedo at normal incidence",
        ),
    ],
    positional: None,
    aliases: &[],
    recordable: true,
    declares,
};

fn declares(spec: &ModelSpec) -> Declares {
    let published = spec.word("normalisation") == "published";
    let gain = if published {
        plain_albedo(spec.real::<f64>("exponent"))
    } else {
        1.0
    };
    Declares::physical(spec.largest_sum(&[("diffuse", 1.0), ("specular", gain)]))
}

/// f = kd/π + ks·c·cosᵖθh.
///
/// energy: c = (p + 2)(p + 4)/(8π (2^(−p/2) + p)), the inverse of the lobe's albedo at normal incidence, which is its largest;
/// published: c = 1.
#[derive(Debug, Clone, Copy)]
pub struct BlinnPhong<R: Real, const N: usize> {
    /// kd, [0, 1].
    pub diffuse: [R; N],
    /// ks, [0, 1].
    pub specular: [R; N],
    /// p, [0, 10⁵].
    pub exponent: R,
    /// Whether the lobe is normalised.
    pub normalised: bool,
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
            diffuse: spec.colour("diffuse")?,
            specular: spec.colour("specular")?,
            exponent: spec.real("exponent"),
            normalised: spec.word("normalisation") == "energy",
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> BlinnPhong<S, N> {
        BlinnPhong {
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

    #[inline(always)]
    fn constant(&self) -> R {
        if self.normalised {
            plain_albedo(self.exponent).recip()
        } else {
            R::one()
        }
    }

    #[inline(always)]
    fn lobe_albedo(&self) -> R {
        if self.normalised {
            mean(self.specular)
        } else {
            mean(self.specular) * plain_albedo(self.exponent)
        }
    }

    #[inline(always)]
    fn diffuse_probability(&self) -> R {
        let (d, s) = (mean(self.diffuse), self.lobe_albedo());
        // Both black: whatever is drawn has weight 0.
        (d + R::lit(1e-20)) / (d + s + R::lit(1e-20))
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for BlinnPhong<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let half = Half::new(wi, wo);
        let lobe = half.h.z.saturate().powf(self.exponent) * self.constant();
        let f = add(
            scale(self.diffuse, R::lit(FRAC_1_PI)),
            scale(self.specular, lobe),
        );
        only_where(above(wi, wo), f)
    }

    /// pd cosθi/π + (1 − pd)(p + 1)/2π cosᵖθh/(4 cosθ′).
    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let half = Half::new(wi, wo);
        let lobe = half.h.z.saturate().powf(self.exponent) * (self.exponent + R::one())
            / half.cos.max(R::lit(1e-15))
            * R::lit(FRAC_1_PI / 8.0);
        let p = self.diffuse_probability();
        let density = p.lerp(lobe, cosine_density(wi));
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let diffuse = cosine_hemisphere(u[0], u[1]);
        let cos = (R::one() - u[1]).powf((self.exponent + R::one()).recip());
        let sin = (R::one() - cos * cos).safe_sqrt();
        let h = polar(cos, sin, u[0]);
        // A half vector turned away from wo would mirror wo to where h is not the half vector: no direction.
        let down = Vec3::new(R::zero(), R::zero(), -R::one());
        let lobe = Vec3::select(wo.dot(h).gt(R::zero()), wo.reflect(h), down);
        let wi = Vec3::select(u[2].lt(self.diffuse_probability()), diffuse, lobe);
        Sample::continuous(wi, self.eval_cos(wi, wo), self.pdf(wi, wo))
    }

    #[inline(always)]
    fn albedo_estimate(&self, _wo: Vec3<R>) -> R {
        mean(self.diffuse) + self.lobe_albedo()
    }
}
