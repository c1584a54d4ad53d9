//! What the dielectrics that transmit have in common: their constants, parameters, and how they split light.

use super::colour::{cast, mean};
use super::fresnel::dielectric;
use crate::model::components;
use crate::{BrdfError, Declares, ModelSpec, ParameterInfo};
use gonio_num::Real;

/// The constants of a boundary into a dielectric body.
#[derive(Debug, Clone, Copy)]
pub struct Boundary<R: Real, const N: usize> {
    /// Index of refraction of the body over that of its surroundings.
    pub ior: R,
    /// Scale of what is reflected, [0, 1].
    pub reflectance: [R; N],
    /// Scale of what is transmitted, [0, 1].
    pub transmittance: [R; N],
    /// Absorption coefficient of the body, per unit of length.
    pub absorption: [R; N],
}

/// `ior` of a body whose boundary light passes.
pub(crate) const IOR: ParameterInfo = ParameterInfo::number(
    "ior",
    "",
    (0.25, 4.0),
    Some(1.5),
    "index of refraction of the body over that of its surroundings",
);
/// `reflectance`.
pub(crate) const REFLECTANCE: ParameterInfo = ParameterInfo::colour(
    "reflectance",
    (0.0, 1.0),
    Some([1.0; 3]),
    "scale of what is reflected; 1 is physical",
);
/// `transmittance`.
pub(crate) const TRANSMITTANCE: ParameterInfo = ParameterInfo::colour(
    "transmittance",
    (0.0, 1.0),
    Some([1.0; 3]),
    "scale of what passes the boundary; 1 is physical",
);
/// `absorption`.
pub(crate) const ABSORPTION: ParameterInfo = ParameterInfo::colour(
    "absorption",
    (0.0, 1e6),
    Some([0.0; 3]),
    "absorption coefficient σ of the body, per unit of length: e^(−σd) is left after a distance d",
);

/// A rough boundary's index of refraction may not be nearer to 1 than this: there the refracted lobe of the smoothest surface is narrower
/// than single precision resolves directions. A power of 2: 1 ± this has no rounding.
pub const LEAST_CONTRAST: f64 = 1.0 / 1024.0;

/// An index of refraction that isn't nearer to 1 than [`LEAST_CONTRAST`].
pub(crate) fn contrasted<R: Real>(ior: R) -> R {
    let near = (ior - R::one()).abs().lt(R::lit(LEAST_CONTRAST));
    let beside = R::select(
        ior.lt(R::one()),
        R::lit(1.0 - LEAST_CONTRAST),
        R::lit(1.0 + LEAST_CONTRAST),
    );
    R::select(near, beside, ior)
}

impl<R: Real, const N: usize> Boundary<R, N> {
    pub(crate) fn from_spec(spec: &ModelSpec) -> Result<Self, BrdfError> {
        Ok(Self {
            ior: spec.real("ior"),
            reflectance: spec.colour("reflectance")?,
            transmittance: spec.colour("transmittance")?,
            absorption: spec.colour("absorption")?,
        })
    }

    pub(crate) fn cast<S: Real>(&self, f: &impl Fn(R) -> S) -> Boundary<S, N> {
        Boundary {
            ior: f(self.ior),
            reflectance: cast(self.reflectance, f),
            transmittance: cast(self.transmittance, f),
            absorption: cast(self.absorption, f),
        }
    }

    pub(crate) fn set(&mut self, parameter: &str, value: [R; 3]) {
        match parameter {
            "ior" => self.ior = value[0],
            "reflectance" => self.reflectance = components(value),
            "transmittance" => self.transmittance = components(value),
            _ => self.absorption = components(value),
        }
    }

    /// The index of the side opposite to a direction over that of its own side; `inside`: whether the direction is in the body.
    #[inline(always)]
    pub fn opposite_over_own(&self, inside: R::Mask) -> R {
        R::select(inside, self.ior.recip(), self.ior)
    }

    /// Fresnel reflectance for a direction at `cos` to the normal on its own side.
    #[inline(always)]
    pub fn fresnel(&self, cos: R, inside: R::Mask) -> R {
        dielectric(cos, self.opposite_over_own(inside))
    }

    /// Probability of reflecting where the share `f` is reflected: its part of the scaled energies.
    #[inline(always)]
    pub fn reflection_probability(&self, f: R) -> R {
        let reflected = f * mean(self.reflectance) + R::lit(1e-20);
        let through = (R::one() - f) * mean(self.transmittance);
        reflected / (reflected + through)
    }

    /// What leaves on average where the share `f` is reflected.
    #[inline(always)]
    pub fn albedo(&self, f: R) -> R {
        f.lerp(mean(self.transmittance), mean(self.reflectance))
    }
}

/// Reciprocal, conserving energy, isotropic, and transmitting into a medium of index `ior`.
pub(crate) fn declares(spec: &ModelSpec) -> Declares {
    let bound = spec
        .largest("reflectance")
        .max(spec.largest("transmittance"));
    Declares {
        relative_ior: Some([spec.real("ior"); 3]),
        ..Declares::physical(bound)
    }
}
