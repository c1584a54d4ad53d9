//! Lights: what shines, and how a direction towards it is chosen.
//!
//! The reflection equation has two forms. For point-like lights it is a sum, Lr = Σᵢ f Eᵢ with Eᵢ = Iᵢ cosθᵢ / rᵢ²; for
//! extended ones an integral, Lr = ∫ Li f cosθ dω. [`Lights`] serves both: [`Lights::each`] enumerates the lights for sums,
//! [`LightSampler::sample`] chooses one and a direction for the integral, with the exact density per solid angle.

mod batch;
mod choice;
mod emitter;
pub(crate) mod group;
mod punctual;
mod sampler;
mod select;
mod tree;

pub use batch::LightSamples;
pub use group::NO_GROUP;
pub use punctual::SpotCone;
pub use sampler::{LightChoice, LightSampler};
pub use select::{LightRef, Lights};

use crate::SurfacePoint;
use gonio_env::Environment;
use gonio_num::Vec3;

/// A light of a scene.
#[derive(Debug, Clone)]
pub enum Light {
    /// Shines equally in all directions from a point.
    Point {
        /// Where.
        position: Vec3<f32>,
        /// Radiant intensity \[W sr⁻¹], ≥ 0.
        intensity: [f32; 3],
    },
    /// Parallel light from infinitely far away: the sun as a point.
    Directional {
        /// Where the light travels to, unit.
        direction: Vec3<f32>,
        /// Irradiance on a surface facing the light \[W m⁻²], ≥ 0.
        irradiance: [f32; 3],
    },
    /// A point that shines into a cone.
    Spot {
        /// Where.
        position: Vec3<f32>,
        /// Axis of the cone, away from the light, unit.
        direction: Vec3<f32>,
        /// Radiant intensity on the axis \[W sr⁻¹], ≥ 0.
        intensity: [f32; 3],
        /// Fall-off towards the cone's rim.
        cone: SpotCone,
    },
    /// A surface that shines: an instance with an emissive material.
    Area {
        /// Index of the instance in the scene's geometry.
        instance: u32,
        /// Radiance \[W m⁻² sr⁻¹]: its mean over the surface where it is textured.
        radiance: [f32; 3],
        /// Whether both sides shine, or the one that the geometric normal leaves.
        two_sided: bool,
    },
    /// Light from infinitely far away, one radiance per direction.
    Environment(Environment),
}

impl Light {
    /// Whether the light reaches a point from a single direction, so that no ray meets it by chance.
    pub fn is_delta(&self) -> bool {
        matches!(
            self,
            Self::Point { .. } | Self::Directional { .. } | Self::Spot { .. }
        )
    }
}

/// A point that light is looked for at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Receiver {
    /// Where.
    pub p: Vec3<f32>,
    /// Bound on the error of `p`, as [`SurfacePoint::error`].
    pub error: f32,
    /// Of the side from which light counts, unit; zero where it counts from all directions. It has a part in which of many lights is chosen, and
    /// in nothing else: light from the other side may still be found.
    pub normal: Vec3<f32>,
}

impl Receiver {
    /// A point that light counts at from all directions.
    pub fn all_around(point: &SurfacePoint) -> Self {
        Self {
            p: point.p,
            error: point.error,
            normal: Vec3::new(0.0, 0.0, 0.0),
        }
    }
}

/// All of a light, where a triangle might be named.
const WHOLE: u32 = u32::MAX;

/// Where a shadow ray towards a light ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LightTarget {
    /// At this point.
    Point(Vec3<f32>),
    /// Nowhere: the light is infinitely far away.
    Infinite,
}

/// A direction towards a light, and what comes from there if nothing is in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LightSample {
    /// Towards the light; world, unit.
    pub wi: Vec3<f32>,
    /// Where the shadow ray ends.
    pub target: LightTarget,
    /// Radiance \[W m⁻² sr⁻¹]; of a delta light the irradiance on a surface facing it \[W m⁻²], I/r² or E. Where the light's
    /// surface is partly transparent the radiance is multiplied by its opacity.
    pub radiance: [f32; 3],
    /// Density of `wi` \[sr⁻¹], the probability of having chosen this light included; of a delta light that probability alone.
    /// Always > 0.
    pub pdf: f32,
    /// Whether the light is a delta light.
    pub delta: bool,
    /// Index of the light.
    pub light: u32,
}

/// Luminance of linear Rec.709 RGB, in the unit of its components.
pub(crate) fn luminance(c: [f32; 3]) -> f64 {
    0.2126 * f64::from(c[0]) + 0.7152 * f64::from(c[1]) + 0.0722 * f64::from(c[2])
}
