//! Point, spot and directional lights: sums, not integrals.

use super::{Light, LightSample, LightTarget};
use gonio_num::{Real, Vec3};

/// The fall-off of a spot light: constant inside the inner cone, zero outside the outer one.
///
/// In between, with x = cos θ: ((x − cos θo) / (cos θi − cos θo))². Source: Khronos, KHR_lights_punctual, "Inner and outer cone
/// angles".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpotCone {
    cos_inner: f32,
    cos_outer: f32,
}

impl SpotCone {
    /// A cone with these half angles \[rad]; nothing unless 0 ≤ inner ≤ outer ≤ π/2 and outer > 0.
    pub fn new(inner_rad: f32, outer_rad: f32) -> Option<Self> {
        let widest = std::f32::consts::FRAC_PI_2 + 1e-6;
        let valid =
            inner_rad >= 0.0 && inner_rad <= outer_rad && outer_rad > 0.0 && outer_rad <= widest;
        valid.then(|| Self {
            cos_inner: Real::cos(f64::from(inner_rad)) as f32,
            cos_outer: (Real::cos(f64::from(outer_rad)) as f32).max(0.0),
        })
    }

    /// Cosine of the outer half angle, in \[0, 1].
    pub(super) fn cos_outer(&self) -> f32 {
        self.cos_outer
    }

    /// The factor on the intensity at an angle to the axis of this cosine, in \[0, 1].
    pub fn falloff(&self, cos_theta: f32) -> f32 {
        if cos_theta >= self.cos_inner {
            return 1.0;
        }
        let t = (cos_theta - self.cos_outer) / (self.cos_inner - self.cos_outer);
        if t > 0.0 { t * t } else { 0.0 }
    }

    /// ∫ falloff dω \[sr]: 2π ((1 − cos θi) + (cos θi − cos θo)/3).
    pub fn solid_angle(&self) -> f64 {
        let (inner, outer) = (f64::from(self.cos_inner), f64::from(self.cos_outer));
        2.0 * std::f64::consts::PI * ((1.0 - inner) + (inner - outer) / 3.0)
    }
}

/// What a delta light sends to the point `p`, with pdf 1; nothing from other lights, and none where no light arrives.
///
/// Point and spot: E⊥ = I/r². Directional: E⊥ as given.
pub(super) fn illuminate(light: &Light, index: u32, p: Vec3<f32>) -> Option<LightSample> {
    let sample = |wi, target, radiance| LightSample {
        wi,
        target,
        radiance,
        pdf: 1.0,
        delta: true,
        light: index,
    };
    let from_point = |position: Vec3<f32>, intensity: [f32; 3]| {
        let to = position - p;
        let r2 = to.length_squared();
        // A light nearer than this would overflow; so close there is no far field.
        (r2 > 1e-30 && r2.is_finite()).then(|| {
            let wi = to * (1.0 / r2.sqrt());
            sample(wi, LightTarget::Point(position), intensity.map(|i| i / r2))
        })
    };
    let found = match light {
        Light::Point {
            position,
            intensity,
        } => from_point(*position, *intensity),
        Light::Spot {
            position,
            direction,
            intensity,
            cone,
        } => from_point(*position, *intensity).map(|mut s| {
            let factor = cone.falloff(-direction.dot(s.wi));
            s.radiance = s.radiance.map(|r| r * factor);
            s
        }),
        Light::Directional {
            direction,
            irradiance,
        } => Some(sample(-*direction, LightTarget::Infinite, *irradiance)),
        Light::Area { .. } | Light::Environment(_) => None,
    };
    found.filter(|s| s.radiance.iter().any(|&r| r > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_light_falls_off_with_the_square_of_distance() {
        let light = Light::Point {
            position: Vec3::new(1.0, 4.0, 1.0),
            intensity: [8.0, 4.0, 2.0],
        };
        let s = illuminate(&light, 3, Vec3::new(1.0, 0.0, 1.0)).unwrap();
        assert_eq!(s.radiance, [0.5, 0.25, 0.125]);
        assert_eq!(s.wi, Vec3::new(0.0, 1.0, 0.0));
        assert_eq!((s.pdf, s.delta, s.light), (1.0, true, 3));
        assert_eq!(s.target, LightTarget::Point(Vec3::new(1.0, 4.0, 1.0)));
        assert!(
            illuminate(&light, 3, Vec3::new(1.0, 4.0, 1.0)).is_none(),
            "at the light itself"
        );
    }

    #[test]
    fn a_directional_light_is_the_same_everywhere() {
        let light = Light::Directional {
            direction: Vec3::new(0.0, -1.0, 0.0),
            irradiance: [3.0; 3],
        };
        for p in [Vec3::zero(), Vec3::splat(1e6)] {
            let s = illuminate(&light, 0, p).unwrap();
            assert_eq!(
                (s.wi, s.radiance, s.target),
                (Vec3::new(0.0, 1.0, 0.0), [3.0; 3], LightTarget::Infinite)
            );
        }
    }

    #[test]
    fn a_spot_is_full_inside_and_dark_outside() {
        let cone = SpotCone::new(0.2, 0.6).unwrap();
        assert_eq!(cone.falloff(1.0), 1.0);
        assert_eq!(cone.falloff(Real::cos(0.19_f32)), 1.0);
        assert_eq!(cone.falloff(Real::cos(0.61_f32)), 0.0);
        assert_eq!(cone.falloff(-1.0), 0.0);
        let (a, b) = (Real::cos(0.2_f32), Real::cos(0.6_f32));
        assert!(
            (cone.falloff(0.5 * (a + b)) - 0.25).abs() < 1e-6,
            "half way in cosine: a quarter"
        );
        let sharp = SpotCone::new(0.5, 0.5).unwrap();
        assert_eq!((sharp.falloff(0.9), sharp.falloff(0.8)), (1.0, 0.0));
        for (inner, outer) in [
            (0.3, 0.2),
            (0.0, 0.0),
            (0.0, 2.0),
            (-0.1, 0.3),
            (0.1, f32::NAN),
        ] {
            assert!(SpotCone::new(inner, outer).is_none());
        }
    }

    /// Against the midpoint rule over the sphere's cosines.
    #[test]
    fn the_cones_solid_angle_is_the_integral_of_its_falloff() {
        let cone = SpotCone::new(0.3, 1.1).unwrap();
        let n = 200_000;
        let sum: f64 = (0..n)
            .map(|i| f64::from(cone.falloff((-1.0 + (i as f64 + 0.5) * 2.0 / f64::from(n)) as f32)))
            .sum();
        let integral = sum * 2.0 / f64::from(n) * 2.0 * std::f64::consts::PI;
        assert!(
            (integral - cone.solid_angle()).abs() < 1e-4,
            "{integral} {}",
            cone.solid_angle()
        );
    }
}
