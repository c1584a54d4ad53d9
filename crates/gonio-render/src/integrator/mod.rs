//! Integrators: estimates of the radiance that arrives along a ray.

pub mod direct;
mod environment;
pub mod path;
pub(crate) mod shares;
mod vertex;
pub(crate) mod wavefront;
pub(crate) mod worth;

pub use direct::Direct;
pub use environment::EnvironmentSampling;
pub use gonio_scene::LightChoice;
pub use path::{Path, Roulette};
pub use vertex::Vertex;

use crate::film::{FilmSample, FirstSurface};
use gonio_radiometry::sequence::SampleStream;
use gonio_scene::{Interior, Ray, Scene, SurfacePoint};
use shares::Shares;
use std::ops::AddAssign;
use worth::Judge;

/// How the reflection equation is solved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Integrator {
    /// The reflection equation alone: one reflection, light after light.
    Direct(Direct),
    /// Path tracing over many reflections.
    Path(Path),
}

impl Default for Integrator {
    fn default() -> Self {
        Self::Path(Path::default())
    }
}

impl Integrator {
    /// The name: `direct` or `path`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Direct(_) => "direct",
            Self::Path(_) => "path",
        }
    }

    /// Estimates the radiance that arrives along `ray` at its origin \[W m⁻² sr⁻¹], with what the ray met first.
    ///
    /// - `interior`: the bodies that the origin is inside of, [`Scene::interior_at`]
    pub fn radiance(
        &self,
        scene: &Scene,
        ray: &Ray,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
    ) -> FilmSample {
        let mut shares = Shares::none();
        self.radiance_in_shares(scene, ray, interior, stream, counts, &mut shares, None)
    }

    /// [`Integrator::radiance`], told apart.
    ///
    /// - `judge`: what Russian roulette knows of the scene, for [`Roulette::Efficiency`]
    #[allow(clippy::too_many_arguments, reason = "a ray with all that it needs")]
    pub(crate) fn radiance_in_shares(
        &self,
        scene: &Scene,
        ray: &Ray,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
        judge: Option<Judge<'_>>,
    ) -> FilmSample {
        let (mut interior, mut left) = (*interior, [1.0; 3]);
        let arrived = vertex::arrive(scene, ray, &mut interior, &mut left, 0, stream, counts);
        let (radiance, first) = match arrived {
            None => {
                let radiance = vertex::environment_radiance(scene, ray.origin, ray.direction);
                shares.add(scene.lights.environment_index(), 0, radiance);
                (radiance, None)
            }
            Some(vertex) => {
                let first = FirstSurface {
                    albedo: vertex.albedo,
                    normal: vertex.facing_normal().to_array(),
                    position: vertex.point.p.to_array(),
                    depth: vertex.distance,
                    material: vertex.material,
                };
                let emitted = scene.emitted(&vertex.point, -ray.direction);
                shares.add(light_at(scene, &vertex.point), 0, emitted);
                let reflected = self
                    .reflected_in_shares(scene, vertex, &interior, stream, counts, shares, judge);
                (sum(emitted, reflected), Some(first))
            }
        };
        shares.attenuate(left);
        FilmSample {
            radiance: product(left, radiance),
            first,
        }
    }

    /// Estimates the radiance that `vertex` reflects or lets through toward its viewer, Lr(ωr) of the reflection equation (12, 13)
    /// \[W m⁻² sr⁻¹].
    ///
    /// - `interior`: the bodies on the viewer's side
    pub fn reflected(
        &self,
        scene: &Scene,
        vertex: Vertex<'_>,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
    ) -> [f32; 3] {
        let mut shares = Shares::none();
        self.reflected_in_shares(scene, vertex, interior, stream, counts, &mut shares, None)
    }

    #[allow(clippy::too_many_arguments, reason = "a ray with all that it needs")]
    fn reflected_in_shares(
        &self,
        scene: &Scene,
        vertex: Vertex<'_>,
        interior: &Interior,
        stream: &mut SampleStream,
        counts: &mut RayCounts,
        shares: &mut Shares<'_>,
        judge: Option<Judge<'_>>,
    ) -> [f32; 3] {
        match self {
            Self::Direct(direct) => {
                direct.reflected(scene, &vertex, interior, stream, counts, shares)
            }
            Self::Path(path) => {
                path.reflected(scene, vertex, interior, stream, counts, shares, judge)
            }
        }
    }
}

/// The light that a surface point lies on, if it lies on any.
#[inline]
fn light_at(scene: &Scene, point: &SurfacePoint) -> Option<u32> {
    scene.geometry.instances()[point.instance as usize].area_light
}

/// How many rays were followed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct RayCounts {
    /// Rays to the nearest surface.
    pub nearest: u64,
    /// Shadow rays.
    pub shadow: u64,
}

impl RayCounts {
    /// All rays.
    pub fn total(&self) -> u64 {
        self.nearest.saturating_add(self.shadow)
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        // Counts read from files may be any.
        self.nearest = self.nearest.saturating_add(other.nearest);
        self.shadow = self.shadow.saturating_add(other.shadow);
    }
}

/// Dimensions of the sample sequence: the film takes 0 and 1, the lens 2 and 3, then each reflection eight.
pub(crate) mod dimension {
    /// The place on the film, two numbers.
    pub const FILM: u32 = 0;
    /// The place on the lens, two numbers.
    pub const LENS: u32 = 2;
    /// Where reflection `bounce` begins to draw: light position and choice (3), direction (3), roulette, resampling.
    pub const fn of_bounce(bounce: u32) -> u32 {
        4 + 8 * bounce
    }
    /// Offset of the direction's three numbers.
    pub const DIRECTION: u32 = 3;
    /// Offset of Russian roulette's number.
    pub const ROULETTE: u32 = 6;
    /// Offset of the number by which a candidate among light samples is kept.
    pub const RESAMPLING: u32 = 7;
    /// Partly transparent surfaces that one ray may meet; the last of them counts as opaque.
    pub const MOST_PASSED: u32 = 256;
    /// The number that decides whether the ray after `segment` reflections passes its surface number `passed`: far above
    /// any bounce, and another for each, since one number for two decisions would make them alike.
    pub const fn of_opacity(segment: u32, passed: u32) -> u32 {
        (1 << 24) + segment * MOST_PASSED + passed
    }
    /// Where the candidates of reflection `bounce` begin, three numbers each and three to choose: above all of the others.
    pub const fn of_product(bounce: u32) -> u32 {
        (1 << 30) + bounce * 4096
    }
    /// Where `direct` begins to draw for its lights, three numbers each.
    pub const LIGHTS: u32 = 1 << 20;
}

pub(crate) fn sum(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn product(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

pub(crate) fn scaled(a: [f32; 3], s: f32) -> [f32; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

/// Weight of a strategy with density `own` against one with density `other`, one sample each: the power heuristic with
/// exponent 2 (Veach 1997, eq. 9.15). 0 where `own` is 0; finite densities never overflow.
pub(crate) fn power_heuristic(own: f32, other: f32) -> f32 {
    if own <= 0.0 {
        return 0.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_weights_of_two_strategies_sum_to_one() {
        for (a, b) in [
            (1.0, 1.0),
            (0.3, 7.0),
            (1e30, 1e-30),
            (1e-30, 1e30),
            (5.0, 0.0),
        ] {
            let total = power_heuristic(a, b) + power_heuristic(b, a);
            assert!((total - 1.0).abs() < 1e-6, "{a} {b}: {total}");
        }
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
        assert!((power_heuristic(2.0, 1.0) - 0.8).abs() < 1e-6);
    }
}
