//! [`Cone`]: directions around an axis.

use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// The directions at most `half` \[rad] from `axis`, unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cone {
    pub axis: Vec3<f64>,
    pub half: f64,
}

/// What roundings may do to an angle.
const SLACK: f64 = 1e-6;

impl Cone {
    pub const ALL: Self = Self {
        axis: Vec3::new(0.0, 0.0, 1.0),
        half: PI,
    };

    /// A cone around both. Source: Conty Estévez & Kulla 2018, algorithm 1.
    pub fn union(&self, other: &Self) -> Self {
        let (a, b) = if self.half >= other.half {
            (self, other)
        } else {
            (other, self)
        };
        if a.half >= PI {
            return Self::ALL;
        }
        let between = Real::acos(a.axis.dot(b.axis).clamp(-1.0, 1.0));
        if between + b.half <= a.half {
            return *a;
        }
        let half = 0.5 * (a.half + between + b.half) + SLACK;
        // From a's axis towards b's, along the great circle.
        let across = b.axis - a.axis * a.axis.dot(b.axis);
        if half >= PI || across.length() < 1e-12 {
            // Axes that are opposite have no circle of their own.
            return if half >= PI || between > FRAC_PI_2 {
                Self::ALL
            } else {
                Self { half, ..*a }
            };
        }
        let (sin, cos) = Real::sin_cos(half - SLACK - a.half);
        let axis = (a.axis * cos + across.normalize() * sin).normalize();
        Self { axis, half }
    }

    pub fn cos_and_sin(&self) -> (f32, f32) {
        if self.half >= PI {
            return (-1.0, 0.0);
        }
        let (sin, cos) = Real::sin_cos(self.half);
        (cos as f32, sin as f32)
    }

    /// ∫ of the emission's profile over all directions \[sr], 1 up to θo and cos(θ − θo) from there to θo + θe: 2π (1 − cosθo) +
    /// π/2 (2 θw sinθo − cos(θo − 2θw) − 2θo sinθo + cosθo) with θw = min(θo + θe, π). Source: Conty Estévez & Kulla 2018, eq. 1.
    pub fn measure(&self, spread: f64) -> f64 {
        let end = (self.half + spread).min(PI);
        let (sin, cos) = Real::sin_cos(self.half);
        let rim = 2.0 * end * sin - Real::cos(self.half - 2.0 * end) - 2.0 * self.half * sin + cos;
        2.0 * PI * (1.0 - cos) + FRAC_PI_2 * rim
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;
    use gonio_radiometry::warp::uniform_sphere;

    #[test]
    fn the_measure_is_the_profiles_integral() {
        for (half, spread) in [
            (0.0, FRAC_PI_2),
            (0.7, FRAC_PI_2),
            (2.5, FRAC_PI_2),
            (PI, FRAC_PI_2),
            (0.4, 0.01),
        ] {
            let n = 100_000;
            let mut sum = 0.0;
            for i in 0..n {
                let theta = (f64::from(i) + 0.5) / f64::from(n) * PI;
                let profile = if theta <= half {
                    1.0
                } else if theta <= half + spread {
                    Real::cos(theta - half)
                } else {
                    0.0
                };
                sum += profile * Real::sin(theta);
            }
            let integral = 2.0 * PI * PI * sum / f64::from(n);
            let cone = Cone { half, ..Cone::ALL };
            // Midpoints of π/n at a jump: off by up to that.
            let error = (cone.measure(spread) - integral).abs();
            assert!(error < 2.0 * PI * PI / f64::from(n), "{half} {spread}");
        }
        let flat = Cone {
            half: 0.0,
            ..Cone::ALL
        };
        assert!((flat.measure(FRAC_PI_2) - PI).abs() < 1e-12);
        assert!((Cone::ALL.measure(FRAC_PI_2) - 4.0 * PI).abs() < 1e-12);
    }

    /// Every direction of either cone is in the union, and the union is no wider than it must be.
    #[test]
    fn a_union_holds_both() {
        let mut rng = Rng::from_name("a_union_holds_both");
        let direction = |rng: &mut Rng| {
            uniform_sphere([rng.next_f32(), rng.next_f32()])
                .to_f64()
                .normalize()
        };
        for _ in 0..2_000 {
            let cone = |axis, half| Cone { axis, half };
            let a = cone(direction(&mut rng), f64::from(rng.next_f32()) * 2.0);
            let b = cone(direction(&mut rng), f64::from(rng.next_f32()) * 2.0);
            let union = a.union(&b);
            for part in [a, b] {
                let to = Real::acos(union.axis.dot(part.axis).clamp(-1.0, 1.0));
                let holds = union.half >= PI || to + part.half <= union.half + 1e-7;
                assert!(holds, "{a:?} {b:?} {union:?}");
            }
            let between = Real::acos(a.axis.dot(b.axis).clamp(-1.0, 1.0));
            let least = (0.5 * (between + a.half + b.half)).max(a.half).max(b.half);
            assert!(union.half <= least + 1e-5 || least >= PI - 1e-5);
        }
        let up = Cone {
            half: 0.1,
            ..Cone::ALL
        };
        let down = Cone {
            axis: -up.axis,
            ..up
        };
        assert_eq!(up.union(&down), Cone::ALL);
        assert_eq!(up.union(&up), up);
    }
}
