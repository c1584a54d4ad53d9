//! Differential elements (T4) and the factors that turn a density of one measure into one of another.
//!
//! A factor is named after what it multiplies: with dω = `solid_angle_per_area` · dA, a density by area is
//! `density by solid angle · solid_angle_per_area`.

use gonio_num::{Real, Vec3};

/// dω / (dθ dφ) = sinθ (sr rad⁻²), for θ in [0, π] (rad): 0 at the poles. (5) with r = 1
#[inline(always)]
pub fn solid_angle_per_angles<R: Real>(theta: R) -> R {
    theta.sin()
}

/// dω / (d(cosθ) dφ) = −1: dA = −r² dφ d(cosθ) (6) with r = 1. Negative since cosθ falls as θ rises; an integral from
/// cosθ = −1 to 1 takes its absolute value, so that a uniform cosθ and φ is a uniform direction.
#[inline(always)]
pub fn solid_angle_per_cosine<R: Real>() -> R {
    -R::one()
}

/// dA / (dθ dφ) = r² sinθ on the sphere of radius `r` (length²). (5)
#[inline(always)]
pub fn sphere_area_per_angles<R: Real>(r: R, theta: R) -> R {
    r * r * theta.sin()
}

/// dω / dA = |cosθ| / r² (sr per length²): the solid angle that an area element subtends.
///
/// - `to_surface`: from the point of view to the element, of length r > 0
/// - `normal`: the element's unit normal; its sign doesn't matter
///
/// NaN where the point lies on the element.
#[inline(always)]
pub fn solid_angle_per_area<R: Real>(to_surface: Vec3<R>, normal: Vec3<R>) -> R {
    let r2 = to_surface.length_squared();
    // cosθ = d·n / r, so cosθ / r² = d·n / r³.
    to_surface.dot(normal).abs() / (r2 * r2.sqrt())
}

/// dA / dω = r² / |cosθ|, the inverse of [`solid_angle_per_area`]. Infinite for an element seen edge on.
#[inline(always)]
pub fn area_per_solid_angle<R: Real>(to_surface: Vec3<R>, normal: Vec3<R>) -> R {
    let r2 = to_surface.length_squared();
    r2 * r2.sqrt() / to_surface.dot(normal).abs()
}

/// dωi / dωh = 4 |wo·h|: a density of reflected directions is the density of half vectors divided by this.
///
/// - `wo_dot_h`: cosine between the fixed direction wo and the half vector h, about which wo is mirrored to wi
///
/// Source: Torrance and Sparrow 1967; Walter et al. 2007, eq. 14.
#[inline(always)]
pub fn reflected_per_half_vector<R: Real>(wo_dot_h: R) -> R {
    R::lit(4.0) * wo_dot_h.abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::spherical_direction;
    use crate::solid_angle::triangle;

    /// The solid angle of the small patch that a map takes the square [u, u + h]² to, over h²: twice its lower and upper
    /// triangle. Truncation of order h, and the centre is used to make it h².
    fn patch(map: impl Fn(f64, f64) -> Vec3<f64>, u: f64, v: f64) -> f64 {
        let h = 1e-4;
        let at = |i: f64, j: f64| map(u + (i - 0.5) * h, v + (j - 0.5) * h).normalize();
        let (a, b, c, d) = (at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0));
        (triangle([a, b, c]) + triangle([a, c, d])) / (h * h)
    }

    #[test]
    fn angles_to_solid_angle() {
        for theta in [0.2, 1.0, 1.5, 2.8] {
            let measured = patch(spherical_direction, theta, 0.4);
            assert!((measured - solid_angle_per_angles(theta)).abs() < 1e-7);
            assert!((sphere_area_per_angles(3.0, theta) - 9.0 * measured).abs() < 1e-6);
        }
        assert_eq!(solid_angle_per_angles(0.0), 0.0);
    }

    #[test]
    fn cosine_to_solid_angle() {
        let map = |z: f64, phi: f64| {
            let s = (1.0 - z * z).sqrt();
            Vec3::new(s * Real::cos(phi), s * Real::sin(phi), z)
        };
        for z in [-0.7, 0.1, 0.9] {
            assert!((patch(map, z, 1.0) - solid_angle_per_cosine::<f64>().abs()).abs() < 1e-6);
        }
    }

    #[test]
    fn area_to_solid_angle() {
        let normal = Vec3::new(0.36, 0.48, 0.8);
        let frame = gonio_num::Frame::from_normal(normal);
        let centre = Vec3::new(1.0, 2.0, -0.5);
        let measured = patch(|u, v| centre + frame.s * u + frame.t * v, 0.0, 0.0);
        let factor = solid_angle_per_area(centre, normal);
        assert!((measured / factor - 1.0).abs() < 1e-7);
        assert!((factor * area_per_solid_angle(centre, -normal) - 1.0).abs() < 1e-15);
        assert!(solid_angle_per_area(Vec3::zero(), normal).is_nan());
    }

    #[test]
    fn half_vector_to_reflected() {
        let wo = Vec3::new(0.48, 0.0, 0.8).normalize();
        for theta in [0.1, 0.5, 0.9] {
            let h = spherical_direction(theta, 0.7);
            let on_h = patch(spherical_direction, theta, 0.7);
            let on_wi = patch(|t, p| wo.reflect(spherical_direction(t, p)), theta, 0.7);
            let factor = reflected_per_half_vector(wo.dot(h));
            assert!((on_wi / on_h / factor - 1.0).abs() < 1e-6);
        }
    }
}
