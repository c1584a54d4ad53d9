//! Perfectly diffuse reflection (T15).

use crate::part::colour::{cast, mean, only_where, scale};
use crate::part::geometry::above;
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "lambertian",
    summary: "perfectly diffuse: the same radiance in every direction",
    paper: "Lambert 1760, Photometria",
    parameters: &[ParameterInfo::colour(
        "reflectance",
        (0.0, 1.0),
        Some([0.5; 3]),
        "fraction of the irradiance that leaves",
    )],
    positional: Some("reflectance"),
    aliases: &[crate::Alias {
        name: "diffuse",
        preset: &[],
    }],
    recordable: true,
    declares: |spec| Declares::physical(spec.largest("reflectance")),
};

/// f = ρ/π.
#[derive(Debug, Clone, Copy)]
pub struct Lambertian<R: Real, const N: usize> {
    /// ρ, [0, 1]: also the directional albedo of every direction.
    pub reflectance: [R; N],
}

impl<R: Real, const N: usize> Lambertian<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Lambertian<S, N> {
        Lambertian {
            reflectance: cast(self.reflectance, f),
        }
    }

    pub(crate) fn set(&mut self, _parameter: &str, value: [R; 3]) {
        self.reflectance = super::components(value);
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Lambertian<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let f = scale(self.reflectance, R::lit(std::f64::consts::FRAC_1_PI));
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
