//! Directions in spherical coordinates (T3).
//!
//! x = r sinθ cosφ, y = r sinθ sinφ, z = r cosθ, (1)–(3): θ in [0, π] is measured from +z, φ in [−π, π] from +x
//! towards +y. Angles are in radians.

use gonio_num::{Real, Vec3};

/// The unit direction of the spherical angles θ and φ (rad).
///
/// θ = 0 is +z whatever φ is. Any real angles are valid; θ outside [0, π] gives the direction of an equivalent pair.
#[inline(always)]
pub fn spherical_direction<R: Real>(theta: R, phi: R) -> Vec3<R> {
    let (sin_theta, cos_theta) = theta.sin_cos();
    let (sin_phi, cos_phi) = phi.sin_cos();
    Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)
}

/// The point at distance `r` in the direction of θ and φ (rad): equations (1).
#[inline(always)]
pub fn spherical_point<R: Real>(r: R, theta: R, phi: R) -> Vec3<R> {
    spherical_direction(theta, phi) * r
}

/// The spherical angles (θ, φ) (rad) of `v`, of any length: θ = atan2(√(x² + y²), z), φ = atan2(y, x).
///
/// θ in [0, π], accurate near the poles too; φ in [−π, π]. On the z axis φ = 0; the zero vector gives (0, 0). Zeros count
/// as positive, whatever their sign, except that φ is −π where x < 0 and y is −0.
#[inline(always)]
pub fn spherical_coordinates<R: Real>(v: Vec3<R>) -> (R, R) {
    // Adding zero turns −0 into 0: atan2(0, −0) is π.
    let x = v.x + R::zero();
    let z = v.z + R::zero();
    let across = (v.x * v.x + v.y * v.y).sqrt();
    (across.atan2(z), v.y.atan2(x))
}

/// The spherical coordinates (r, θ, φ) of the point `p`: r = |p| and [`spherical_coordinates`]. (2), (3)
#[inline(always)]
pub fn spherical_coordinates_of_point<R: Real>(p: Vec3<R>) -> (R, R, R) {
    let (theta, phi) = spherical_coordinates(p);
    (p.length(), theta, phi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn close(a: Vec3<f64>, b: Vec3<f64>) -> bool {
        (a - b).length() < 1e-14
    }

    #[test]
    fn the_axes_have_their_angles() {
        let cases = [
            ([0.0, 0.0, 1.0], (0.0, 0.0)),
            ([0.0, 0.0, -1.0], (PI, 0.0)),
            ([1.0, 0.0, 0.0], (FRAC_PI_2, 0.0)),
            ([0.0, 1.0, 0.0], (FRAC_PI_2, FRAC_PI_2)),
            ([-1.0, 0.0, 0.0], (FRAC_PI_2, PI)),
            ([0.0, -1.0, 0.0], (FRAC_PI_2, -FRAC_PI_2)),
        ];
        for (v, (theta, phi)) in cases {
            let v = Vec3::from(v);
            let found = spherical_coordinates(v);
            assert!((found.0 - theta).abs() < 1e-15 && (found.1 - phi).abs() < 1e-15);
            assert!(close(spherical_direction(theta, phi), v));
        }
    }

    #[test]
    fn zero_vectors_and_signed_zeros_are_the_pole() {
        for z in [0.0, -0.0] {
            for x in [0.0, -0.0] {
                assert_eq!(spherical_coordinates(Vec3::new(x, 0.0, z)), (0.0, 0.0));
            }
        }
        assert_eq!(spherical_coordinates(Vec3::new(-0.0, 0.0, 2.0f32)).1, 0.0);
    }

    #[test]
    fn angles_near_the_pole_keep_their_digits() {
        let theta = 1e-9;
        let (found, _) = spherical_coordinates(spherical_direction(theta, 0.3));
        assert!((found / theta - 1.0).abs() < 1e-14);
    }

    proptest! {
        #[test]
        fn points_survive_the_round_trip(x in -9.0..9.0f64, y in -9.0..9.0f64, z in -9.0..9.0f64) {
            let p = Vec3::new(x, y, z);
            let (r, theta, phi) = spherical_coordinates_of_point(p);
            prop_assert!((0.0..=PI).contains(&theta) && (-PI..=PI).contains(&phi));
            prop_assert!((spherical_point(r, theta, phi) - p).length() <= 1e-14 * (1.0 + r));
        }

        #[test]
        fn angles_survive_the_round_trip(theta in 0.001..3.1f64, phi in -3.1..3.1f64) {
            let found = spherical_coordinates(spherical_direction(theta, phi));
            prop_assert!((found.0 - theta).abs() < 1e-12 && (found.1 - phi).abs() < 1e-11);
        }
    }
}
