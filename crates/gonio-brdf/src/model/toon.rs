//! A cartoon shader (T20).

use crate::part::colour::{add, cast, mean, only_where, scale};
use crate::part::geometry::{Half, above, mirrored_about};
use crate::{Brdf, BrdfError, Declares, ModelInfo, ModelSpec, ParameterInfo, Sample};
use gonio_num::{Real, Vec3};
use gonio_radiometry::warp::{cosine_hemisphere, cosine_hemisphere_density, uniform_cone};
use std::f64::consts::{FRAC_1_PI, PI};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "toon",
    summary: "a cartoon shader: flat bands of light, a hard highlight and a bright rim; not physical",
    paper: "Lake et al. 2000, \"Stylized Rendering Techniques for Scalable Real-Time 3D Animation\"",
    parameters: &[
        ParameterInfo::colour(
            "reflectance",
            (0.0, 1.0),
            Some([0.5; 3]),
            "reflectance ρ; also the albedo of every viewing direction but the rim's",
        ),
        ParameterInfo::number(
            "bands",
            "",
            (1.0, 32.0),
            Some(3.0),
            "number of steps from dark to bright, rounded to a whole number",
        ),
        ParameterInfo::colour(
            "specular",
            (0.0, 1.0),
            Some([0.5; 3]),
            "brightness of the highlight",
        ),
        ParameterInfo::number(
            "highlight_deg",
            "°",
            (0.0, 45.0),
            Some(8.0),
            "angle between normal and half vector at the highlight's edge; 0: none",
        ),
        ParameterInfo::colour(
            "rim",
            (0.0, 1.0),
            Some([0.0; 3]),
            "what the reflectance gains in the rim, the band along the silhouette",
        ),
        ParameterInfo::number(
            "rim_deg",
            "°",
            (0.0, 90.0),
            Some(25.0),
            "width of the rim: the viewer's angle to the surface at its inner edge; 0: none",
        ),
    ],
    positional: Some("reflectance"),
    aliases: &[],
    recordable: true,
    declares: |_| Declares {
        reciprocal: false,
        ..Declares::physical(f64::INFINITY)
    },
};

/// f = ρ′/π · q(cosθi)/cosθi + ks/π · [θh ≤ edge], q(x) = ⌊x·bands + ½⌋/bands, ρ′ = ρ + rim · [90° − θr < rim's width].
///
/// Under one light the reflected radiance f·cosθi is flat within each band. As ∫₀¹ q = ½, the banded part reflects exactly
/// ρ′ of a uniform field towards every viewer. By design it is not reciprocal, and light from the bright edge of the lowest
/// band returns up to 2ρ′ of its energy.
#[derive(Debug, Clone, Copy)]
pub struct Toon<R: Real, const N: usize> {
    /// ρ, [0, 1].
    pub reflectance: [R; N],
    /// Number of bands, whole.
    pub bands: R,
    /// ks, [0, 1].
    pub specular: [R; N],
    /// Cosine of the half vector's angle at the highlight's edge.
    pub cos_edge: R,
    /// Gain of the reflectance in the rim, [0, 1].
    pub rim: [R; N],
    /// Cosine of the viewer's direction at the rim's inner edge.
    pub rim_cos: R,
}

impl<R: Real, const N: usize> Toon<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            reflectance: spec.colour("reflectance")?,
            bands: R::lit(spec.real::<f64>("bands").round()),
            specular: spec.colour("specular")?,
            cos_edge: (spec.real::<R>("highlight_deg") * R::lit(PI / 180.0)).cos(),
            rim: spec.colour("rim")?,
            rim_cos: (spec.real::<R>("rim_deg") * R::lit(PI / 180.0)).sin(),
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Toon<S, N> {
        Toon {
            reflectance: cast(self.reflectance, f),
            bands: f(self.bands),
            specular: cast(self.specular, f),
            cos_edge: f(self.cos_edge),
            rim: cast(self.rim, f),
            rim_cos: f(self.rim_cos),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "reflectance" => self.reflectance = super::components(value),
            "specular" => self.specular = super::components(value),
            "bands" => self.bands = (value[0] + R::lit(0.5)).floor(),
            "rim" => self.rim = super::components(value),
            "rim_deg" => self.rim_cos = (value[0] * R::lit(PI / 180.0)).sin(),
            _ => self.cos_edge = (value[0] * R::lit(PI / 180.0)).cos(),
        }
    }

    /// ρ′ towards a viewer.
    #[inline(always)]
    fn banded(&self, wo: Vec3<R>) -> [R; N] {
        let inside = R::from_mask(wo.z.lt(self.rim_cos));
        add(self.reflectance, scale(self.rim, inside))
    }

    /// Probability of drawing within the highlight: its solid angle of half vectors is small, so is its albedo.
    #[inline(always)]
    fn highlight_probability(&self, wo: Vec3<R>) -> R {
        let s = mean(self.specular) * (R::one() - self.cos_edge) * R::lit(8.0);
        s / (mean(self.banded(wo)) + s + R::lit(1e-20))
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for Toon<R, N> {
    #[inline(always)]
    fn eval(&self, wi: Vec3<R>, wo: Vec3<R>) -> [R; N] {
        let half = Half::new(wi, wo);
        // q(x)/x ≤ 2, and 0 for x below half a band: the division is guarded by the smallest such x.
        let step = (wi.z * self.bands + R::lit(0.5)).floor();
        let diffuse = step / (self.bands * wi.z).max(R::lit(0.01));
        let lit = R::from_mask(half.h().z.ge(self.cos_edge) & self.cos_edge.lt(R::one()));
        let f = add(
            scale(self.banded(wo), diffuse * R::lit(FRAC_1_PI)),
            scale(self.specular, lit * R::lit(FRAC_1_PI)),
        );
        only_where(above(wi, wo), f)
    }

    #[inline(always)]
    fn pdf(&self, wi: Vec3<R>, wo: Vec3<R>) -> R {
        let half = Half::new(wi, wo);
        let inside = half.h().z.ge(self.cos_edge) & self.cos_edge.lt(R::one());
        // Half vectors uniform in the cone of 2π(1 − cos edge) sr, times dh/dωi = 1/(4 cosθ′).
        let cone = (R::one() - self.cos_edge).max(R::lit(1e-12)) * R::lit(8.0 * PI);
        let spot = (cone * half.cos.max(R::lit(1e-15))).recip();
        let p = self.highlight_probability(wo);
        let density = p.lerp(
            cosine_hemisphere_density(wi),
            R::select(inside, spot, R::zero()),
        );
        R::select(above(wi, wo), density, R::zero())
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let diffuse = cosine_hemisphere([u[0], u[1]]);
        let spot = mirrored_about(wo, uniform_cone([u[0], u[1]], self.cos_edge));
        let wi = Vec3::select(u[2].lt(self.highlight_probability(wo)), spot, diffuse);
        self.sample_of(wi, wo)
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        mean(self.banded(wo)) + mean(self.specular) * (R::one() - self.cos_edge) * R::lit(8.0)
    }
}
