//! Solid angles of round things: cones, caps, spheres, disks.

use gonio_num::Real;
use std::f64::consts::{PI, TAU};

/// The solid angle (sr) of the cone whose half-angle has the cosine `cos_max` in [−1, 1]: 2π (1 − `cos_max`).
///
/// Cancels for narrow cones: [`cone_of_angle`] and [`cap`] don't.
#[inline(always)]
pub fn cone<R: Real>(cos_max: R) -> R {
    cap(R::one() - cos_max)
}

/// The solid angle (sr) of the cone of half-angle `theta_max` (rad) in [0, π]: 4π sin²(θ/2).
#[inline(always)]
pub fn cone_of_angle<R: Real>(theta_max: R) -> R {
    R::lit(4.0 * PI) * (R::lit(0.5) * theta_max).sin().sq()
}

/// The solid angle (sr) of the cap of the unit sphere of height `height` = 1 − cos θmax in [0, 2]: 2π h, by Archimedes.
#[inline(always)]
pub fn cap<R: Real>(height: R) -> R {
    R::lit(TAU) * height
}

/// The solid angle (sr) of a sphere of radius `radius` ≥ 0 whose centre is at `distance` ≥ 0 (one unit of length):
/// 2π s² / (1 + √(1 − s²)) with s = r/d. From inside 4π, from the surface 2π.
#[inline(always)]
pub fn sphere<R: Real>(radius: R, distance: R) -> R {
    let s = radius / distance.max(radius).max(R::lit(1e-37));
    let s2 = s * s;
    let seen = R::lit(TAU) * s2 / (R::one() + (R::one() - s2).safe_sqrt());
    R::select(distance.lt(radius), R::lit(4.0 * PI), seen)
}

/// The solid angle (sr) of a disk of radius `radius` ≥ 0 from a point of its axis at `distance` > 0:
/// 2π (1 − d/√(d² + r²)), without cancellation. 2π as the distance goes to 0.
#[inline(always)]
pub fn disk<R: Real>(radius: R, distance: R) -> R {
    let d = distance.abs();
    let slant = (d * d + radius * radius).sqrt().max(R::lit(1e-37));
    R::lit(TAU) * (radius / slant) * (radius / (slant + d).max(R::lit(1e-37)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn the_full_cone_is_the_sphere() {
        for (theta, expected) in [(0.0, 0.0), (FRAC_PI_2, TAU), (PI, 4.0 * PI)] {
            assert!((cone_of_angle(theta) - expected).abs() < 1e-14);
            assert!((cone(Real::cos(theta)) - expected).abs() < 1e-14);
        }
    }

    /// The Sun from the Earth: radius 695 700 km at 149 597 871 km is 6.794e-5 sr.
    #[test]
    fn the_sun() {
        let sun: f64 = sphere(695_700.0, 149_597_871.0);
        assert!((sun - 6.794e-5).abs() < 1e-8);
        let single = sphere(695_700.0f32, 149_597_871.0);
        assert!((f64::from(single) / sun - 1.0).abs() < 1e-6);
    }

    #[test]
    fn spheres_and_disks_at_their_limits() {
        assert_eq!(sphere(1.0, 1.0), TAU);
        assert_eq!(sphere(1.0, 0.5), 4.0 * PI);
        assert_eq!(sphere(0.0, 0.0), 0.0);
        assert_eq!(disk(1.0, 0.0), TAU);
        assert_eq!(disk(0.0, 1.0), 0.0);
        // Far away both are A/d².
        assert!((sphere(1.0, 1e6) / (PI * 1e-12) - 1.0).abs() < 1e-11);
        assert!((disk(1.0, 1e6) / (PI * 1e-12) - 1.0).abs() < 1e-11);
    }

    #[test]
    fn a_disk_is_the_cone_of_its_rim() {
        for (r, d) in [(1.0, 2.0), (3.0, 0.1), (0.2, 7.0)] {
            let theta = Real::atan2(r, d);
            assert!((disk(r, d) - cone_of_angle(theta)).abs() < 1e-14);
        }
    }
}
