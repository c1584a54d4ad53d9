//! A smooth boundary into a body of glass, water or another clear medium.

use crate::part::colour::{grey, scale};
use crate::part::dielectric::{self, Boundary};
use crate::part::geometry::{mirrored, refracted_about};
use crate::{Brdf, BrdfError, ModelInfo, ModelSpec, Sample};
use gonio_num::{Mask, Real, Vec3};

/// What the registry knows.
pub const INFO: ModelInfo = ModelInfo {
    name: "smooth-dielectric",
    summary: "a smooth boundary into glass or water: mirror reflection and refraction by Snell's law",
    paper: "Fresnel 1823; Born & Wolf, Principles of Optics, §1.5; Veach 1997, §5.2 for the scaling of radiance",
    parameters: &[
        dielectric::IOR,
        dielectric::REFLECTANCE,
        dielectric::TRANSMITTANCE,
        dielectric::ABSORPTION,
    ],
    positional: Some("ior"),
    aliases: &[crate::Alias {
        name: "glass",
        preset: &[("ior", "1.5")],
    }],
    recordable: true,
    declares: dielectric::declares,
};

/// With the Fresnel reflectance F(θr) of the side that the viewer is on, and n_r, n_i the indices of the two sides:
///
/// - the mirror direction with ρ F
/// - the refracted direction, n_i sinθi = n_r sinθr, with τ (1 − F) n_r²/n_i²
///
/// both Dirac deltas, which `eval` and `pdf` cannot see. The last factor is the scaling of radiance: light that enters a
/// denser body is squeezed into fewer directions. Beyond the critical angle F = 1.
#[derive(Debug, Clone, Copy)]
pub struct SmoothDielectric<R: Real, const N: usize> {
    /// Indices and scales.
    pub boundary: Boundary<R, N>,
}

impl<R: Real, const N: usize> SmoothDielectric<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            boundary: Boundary::from_spec(spec)?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> SmoothDielectric<S, N> {
        SmoothDielectric {
            boundary: self.boundary.cast(f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        self.boundary.set(parameter, value);
    }
}

impl<R: Real, const N: usize> Brdf<R, N> for SmoothDielectric<R, N> {
    #[inline(always)]
    fn eval(&self, _wi: Vec3<R>, _wo: Vec3<R>) -> [R; N] {
        grey(R::zero())
    }

    #[inline(always)]
    fn pdf(&self, _wi: Vec3<R>, _wo: Vec3<R>) -> R {
        R::zero()
    }

    #[inline(always)]
    fn sample(&self, wo: Vec3<R>, u: [R; 3]) -> Sample<R, N> {
        let b = &self.boundary;
        let inside = wo.z.lt(R::zero());
        let cos = wo.z.abs().min(R::one());
        let f = b.fresnel(cos, inside);
        let p = b.reflection_probability(f);
        let reflects = u[2].lt(p);
        let ratio = b.opposite_over_own(inside).recip();
        let normal = Vec3::new(R::zero(), R::zero(), R::select(inside, -R::one(), R::one()));
        let through = refracted_about(wo, normal, cos, ratio);
        let q = R::one() - p;
        let reflected = scale(b.reflectance, f / p);
        let transmitted = scale(
            b.transmittance,
            (R::one() - f) * ratio * ratio / q.max(R::lit(1e-20)),
        );
        let delta = R::Mask::splat(true);
        let drawn = Sample::select(
            reflects,
            Sample {
                wi: mirrored(wo),
                weight: reflected,
                pdf: p,
                delta,
            },
            Sample {
                wi: through,
                weight: transmitted,
                pdf: q,
                delta,
            },
        );
        let valid = wo.z.abs().gt(R::zero()) & drawn.pdf.gt(R::zero());
        Sample::select(valid, drawn, Sample::none())
    }

    #[inline(always)]
    fn albedo_estimate(&self, wo: Vec3<R>) -> R {
        let inside = wo.z.lt(R::zero());
        let f = self.boundary.fresnel(wo.z.abs().min(R::one()), inside);
        self.boundary.albedo(f)
    }

    #[inline(always)]
    fn transmits(&self) -> bool {
        true
    }

    #[inline(always)]
    fn relative_ior(&self) -> [R; N] {
        grey(self.boundary.ior)
    }

    #[inline(always)]
    fn absorption(&self) -> [R; N] {
        self.boundary.absorption
    }
}
