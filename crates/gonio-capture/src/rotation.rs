//! [`Rotation`], an orientation in space, and rotations spread evenly over all.

use gonio_num::{Real, Vec3};

/// A rotation, as a unit quaternion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rotation {
    w: f64,
    v: Vec3<f64>,
}

impl Rotation {
    /// None.
    pub const IDENTITY: Self = Self {
        w: 1.0,
        v: Vec3 {
            x: 0.0,
            y: 0.0,
            z: 0.0,
        },
    };

    /// By the angle |r| \[rad] about the direction of `r`, right-handed.
    pub fn of_vector(r: Vec3<f64>) -> Self {
        let angle = r.length();
        let (s, c) = Real::sin_cos(0.5 * angle);
        Self {
            w: c,
            v: r * if angle > 1e-12 { s / angle } else { 0.5 },
        }
    }

    /// By `yaw` about +y, then `pitch` about +x, then `roll` about +z \[rad]: R = R_yaw R_pitch R_roll.
    pub fn of_angles(yaw: f64, pitch: f64, roll: f64) -> Self {
        let about = |x, y, z| Self::of_vector(Vec3::new(x, y, z));
        about(0.0, yaw, 0.0)
            .then_inner(about(pitch, 0.0, 0.0))
            .then_inner(about(0.0, 0.0, roll))
    }

    /// `self` after `inner`.
    pub fn then_inner(self, inner: Self) -> Self {
        let (a, b) = (self, inner);
        let w = a.w * b.w - a.v.dot(b.v);
        let v = b.v * a.w + a.v * b.w + a.v.cross(b.v);
        let k = 1.0 / (w * w + v.dot(v)).sqrt();
        Self { w: w * k, v: v * k }
    }

    /// The opposite rotation.
    pub fn inverse(self) -> Self {
        Self {
            w: self.w,
            v: -self.v,
        }
    }

    /// The rotated vector.
    pub fn apply(self, d: Vec3<f64>) -> Vec3<f64> {
        let t = self.v.cross(d) * 2.0;
        d + t * self.w + self.v.cross(t)
    }

    /// Its angle \[rad], in \[0, π].
    pub fn angle(self) -> f64 {
        2.0 * self.v.length().atan2(self.w.abs())
    }

    /// (yaw, pitch, roll) \[rad] as [`Rotation::of_angles`] takes them.
    pub fn angles(self) -> [f64; 3] {
        let forward = self.apply(Vec3::new(0.0, 0.0, 1.0));
        let right = self.apply(Vec3::new(1.0, 0.0, 0.0));
        let up = self.apply(Vec3::new(0.0, 1.0, 0.0));
        [
            forward.x.atan2(forward.z),
            Real::asin((-forward.y).clamp(-1.0, 1.0)),
            right.y.atan2(up.y),
        ]
    }

    /// The `k`th of `n` rotations spread evenly (Alexa 2022, "Super-Fibonacci Spirals").
    pub fn spread(k: usize, n: usize) -> Self {
        // ψ⁴ = ψ + 4
        const PSI: f64 = 1.533_751_168_755_204_3;
        let s = k as f64 + 0.5;
        let t = s / n as f64;
        let d = std::f64::consts::TAU * s;
        let (r, q) = (t.sqrt(), (1.0 - t).sqrt());
        let (sa, ca) = Real::sin_cos(d / std::f64::consts::SQRT_2);
        let (sb, cb) = Real::sin_cos(d / PSI);
        Self {
            w: q * cb,
            v: Vec3::new(r * sa, r * ca, q * sb),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quarter_turn_about_y() {
        let r = Rotation::of_angles(std::f64::consts::FRAC_PI_2, 0.0, 0.0);
        // Right-handed about +y: −z goes to −x.
        let d = r.apply(Vec3::new(0.0, 0.0, -1.0));
        assert!((d - Vec3::new(-1.0, 0.0, 0.0)).length() < 1e-15);
        assert!((r.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((r.inverse().apply(d) - Vec3::new(0.0, 0.0, -1.0)).length() < 1e-15);
    }

    #[test]
    fn angles_come_back() {
        for a in [[0.3, 0.2, -0.1], [-2.0, -1.0, 3.0], [0.0, 0.0, 0.0]] {
            let found = Rotation::of_angles(a[0], a[1], a[2]).angles();
            for (x, y) in found.iter().zip(a) {
                assert!((x - y).abs() < 1e-14, "{found:?} {a:?}");
            }
        }
    }

    /// 2,000 balls of equal volume fill SO(3), whose volume in angles is π² · 8/… : of radius r they have (r − sin r)/π each, which
    /// is 1/2000 at r = 0.21 rad. No point should be much farther than twice that.
    #[test]
    fn spread_rotations_leave_no_gap() {
        let n = 2000;
        for k in 0..50 {
            let any =
                Rotation::of_angles(f64::from(k) * 1.7, f64::from(k) * 0.9, f64::from(k) * 2.3);
            let nearest = (0..n)
                .map(|j| Rotation::spread(j, n).inverse().then_inner(any).angle())
                .fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.45, "{nearest}");
        }
    }
}
