//! The unit disc as the unit square and back (Shirley & Chiu 1997), by which tensor trees place directions.

use crate::Number;
use gonio_num::Vec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// The largest coordinate below 1 in single precision.
const BELOW_ONE: f64 = 1.0 - 1.0 / 16_777_216.0;

/// The point (x, y) of the unit disc as a point of [0, 1)²: equal areas stay equal.
///
/// The disc's quarter around azimuth 0 is the square's right triangle, the next one, counter-clockwise, the upper one.
#[inline(always)]
pub(in super::super) fn disc_to_square<R: Number>(x: R, y: R) -> [R; 2] {
    let r2 = x * x + y * y;
    let centre = r2.lt(R::lit(1e-30));
    let r = R::select(centre, R::zero(), r2.max(R::lit(1e-30)).sqrt());
    // Azimuth in quarters, from −½ to 3½.
    let quarters = y.atan2(R::select(centre, R::one(), x)) * R::lit(1.0 / FRAC_PI_2);
    let quarters = R::select(quarters.lt(R::lit(-0.5)), quarters + R::lit(4.0), quarters);
    let side = (quarters + R::lit(0.5)).floor();
    let along = r * R::lit(2.0) * (quarters - side);
    let (a, b) = on_side(side, r, along);
    let half = R::lit(0.5);
    [
        (half + half * a).clamp(R::zero(), R::lit(BELOW_ONE)),
        (half + half * b).clamp(R::zero(), R::lit(BELOW_ONE)),
    ]
}

/// The point of the square [−1, 1]² at distance `r` towards side 0 (right), 1 (up), 2 (left), 3 (down), `along` it
/// counter-clockwise.
#[inline(always)]
fn on_side<R: Number>(side: R, r: R, along: R) -> (R, R) {
    let horizontal = side.lt(R::lit(0.5)) | (side.gt(R::lit(1.5)) & side.lt(R::lit(2.5)));
    let first = side.lt(R::lit(1.5));
    let r = R::select(first, r, -r);
    let right = side.lt(R::lit(0.5)) | side.gt(R::lit(2.5));
    let along = R::select(right, along, -along);
    (
        R::select(horizontal, r, along),
        R::select(horizontal, along, r),
    )
}

/// The direction with z ≥ 0 whose horizontal part is the disc's point of (x, y) in [0, 1]²: uniform by projected solid angle.
#[inline(always)]
pub(in super::super) fn square_to_direction<R: Number>(x: R, y: R) -> Vec3<R> {
    let (two, one) = (R::lit(2.0), R::one());
    let (a, b) = (two * x - one, two * y - one);
    let horizontal = b.abs().lt(a.abs());
    let (r, along) = (R::select(horizontal, a, b), R::select(horizontal, b, -a));
    let small = r.abs().lt(R::lit(1e-30));
    let quarter = along / R::select(small, one, r) * R::lit(FRAC_PI_4);
    let (sin, cos) = quarter.sin_cos();
    // Turned by a quarter where the side is the upper or lower one; r has the sign of the side.
    let (x, y) = (
        R::select(horizontal, r * cos, -(r * sin)),
        R::select(horizontal, r * sin, r * cos),
    );
    Vec3::new(x, y, (one - x * x - y * y).safe_sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_and_the_disc_are_inverse() {
        for i in 0..40 {
            for j in 0..40 {
                let (x, y) = ((f64::from(i) + 0.37) / 40.0, (f64::from(j) + 0.61) / 40.0);
                let w = square_to_direction(x, y);
                let [a, b] = disc_to_square(w.x, w.y);
                assert!(
                    (a - x).abs() < 1e-9 && (b - y).abs() < 1e-9,
                    "{x} {y}: {a} {b}"
                );
                assert!((w.length() - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn azimuths_are_not_turned() {
        let right: Vec3<f64> = square_to_direction(1.0, 0.5);
        assert!((right.x - 1.0).abs() < 1e-12 && right.y.abs() < 1e-12);
        let up: Vec3<f64> = square_to_direction(0.5, 1.0);
        assert!((up.y - 1.0).abs() < 1e-12 && up.x.abs() < 1e-12);
        let corner: Vec3<f64> = square_to_direction(1.0, 1.0);
        assert!((corner.x - corner.y).abs() < 1e-12 && corner.x > 0.7);
    }
}
