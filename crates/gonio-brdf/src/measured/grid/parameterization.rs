//! [`Parameterization`], which angles a grid's axes are.

use gonio_num::{Real, Vec3};
use gonio_radiometry::direction::spherical_direction;
use std::f64::consts::{PI, TAU};

/// Which angles a grid's axes are, the slowest first. In radians; φ grows counter-clockwise seen from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameterization {
    /// Isotropic, half and difference vector (Rusinkiewicz 1998): θh, θd, φd, as in the MERL database.
    HalfDifference,
    /// The same with the azimuth of the half vector: θh, φh, θd, φd.
    HalfDifferenceAnisotropic,
    /// Isotropic, incoming and outgoing elevation and how far the outgoing azimuth is from the incoming one: θi, θo, φo − φi.
    Spherical,
    /// Any function of two directions: θi, φi, θo, φo.
    SphericalAnisotropic,
}

impl Parameterization {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::HalfDifference,
        Self::HalfDifferenceAnisotropic,
        Self::Spherical,
        Self::SphericalAnisotropic,
    ];

    /// Its name in files and commands.
    pub fn name(self) -> &'static str {
        match self {
            Self::HalfDifference => "half-difference",
            Self::HalfDifferenceAnisotropic => "half-difference-anisotropic",
            Self::Spherical => "spherical",
            Self::SphericalAnisotropic => "spherical-anisotropic",
        }
    }

    /// By name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|p| p.name() == name)
    }

    /// The names of the axes in files.
    pub fn axes(self) -> &'static [&'static str] {
        match self {
            Self::HalfDifference => &["theta_h", "theta_d", "phi_d"],
            Self::HalfDifferenceAnisotropic => &["theta_h", "phi_h", "theta_d", "phi_d"],
            Self::Spherical => &["theta_i", "theta_o", "delta_phi"],
            Self::SphericalAnisotropic => &["theta_i", "phi_i", "theta_o", "phi_o"],
        }
    }

    /// Number of axes: 3 if isotropic, 4 otherwise.
    pub fn rank(self) -> usize {
        self.axes().len()
    }

    /// Whether it depends on the difference of the azimuths only.
    pub fn is_isotropic(self) -> bool {
        self.rank() == 3
    }

    /// Whether it is by the half vector.
    pub fn is_half(self) -> bool {
        matches!(self, Self::HalfDifference | Self::HalfDifferenceAnisotropic)
    }

    /// The coordinates of a pair of directions on the same side, the last of four unused if isotropic.
    #[inline(always)]
    pub(in super::super) fn coordinates<R: Real>(self, wi: Vec3<R>, wo: Vec3<R>) -> [R; 4] {
        let zero = R::zero();
        match self {
            Self::HalfDifference => {
                let [theta_h, _, theta_d, phi_d] = half_difference(wi, wo);
                [theta_h, theta_d, phi_d, zero]
            }
            Self::HalfDifferenceAnisotropic => half_difference(wi, wo),
            Self::Spherical => {
                let (oi, oo) = (horizontal(wi), horizontal(wo));
                let delta = (oi[0] * oo[1] - oi[1] * oo[0]).atan2(oi[0] * oo[0] + oi[1] * oo[1]);
                [elevation(wi), elevation(wo), delta, zero]
            }
            Self::SphericalAnisotropic => [elevation(wi), azimuth(wi), elevation(wo), azimuth(wo)],
        }
    }

    /// The pair of directions (wi, wo) with these coordinates; the incoming azimuth or that of the half vector is 0 if isotropic.
    /// Either may lie below the horizon.
    pub(in super::super) fn directions(self, x: [f64; 4]) -> (Vec3<f64>, Vec3<f64>) {
        match self {
            Self::HalfDifference => from_half_difference([x[0], 0.0, x[1], x[2]]),
            Self::HalfDifferenceAnisotropic => from_half_difference(x),
            Self::Spherical => (
                spherical_direction(x[0], 0.0),
                spherical_direction(x[1], x[2]),
            ),
            Self::SphericalAnisotropic => (
                spherical_direction(x[0], x[1]),
                spherical_direction(x[2], x[3]),
            ),
        }
    }
}

/// θ in [0, π/2] from the normal, exact near it.
#[inline(always)]
pub(in super::super) fn elevation<R: Real>(w: Vec3<R>) -> R {
    (w.x * w.x + w.y * w.y)
        .max(R::lit(1e-30))
        .sqrt()
        .atan2(w.z.abs())
}

/// φ in (−π, π]; 0 at the normal.
#[inline(always)]
pub(in super::super) fn azimuth<R: Real>(w: Vec3<R>) -> R {
    let [x, y] = horizontal(w);
    y.atan2(x)
}

/// The horizontal part, (1, 0) at the normal.
#[inline(always)]
pub(in super::super) fn horizontal<R: Real>(w: Vec3<R>) -> [R; 2] {
    let normal = (w.x * w.x + w.y * w.y).lt(R::lit(1e-30));
    [
        R::select(normal, R::one(), w.x),
        R::select(normal, R::zero(), w.y),
    ]
}

/// θh, φh, θd, φd. With the two directions exchanged φd is turned by π and the others are the same, to the last bit.
#[inline(always)]
fn half_difference<R: Real>(wi: Vec3<R>, wo: Vec3<R>) -> [R; 4] {
    let (sum, difference) = (wi + wo, wi - wo);
    let length = sum.length_squared().max(R::lit(1e-30)).sqrt();
    let h = sum * length.recip();
    let sin2 = h.x * h.x + h.y * h.y;
    let up = sin2.lt(R::lit(1e-24));
    let sin_h = sin2.max(R::lit(1e-24)).sqrt();
    let cos_phi = R::select(up, R::one(), h.x / sin_h);
    let sin_phi = R::select(up, R::zero(), h.y / sin_h);
    let sin_h = R::select(up, R::zero(), sin_h);
    // The difference in the frame whose z axis is h and whose x axis lies in the plane of h and the normal. Half of it is the part of
    // wi across h.
    let x = h.z * (cos_phi * difference.x + sin_phi * difference.y) - sin_h * difference.z;
    let y = cos_phi * difference.y - sin_phi * difference.x;
    // At ωi = ωo the azimuth has no meaning, and no derivative.
    let same = (x * x + y * y).lt(R::lit(1e-30));
    let phi_d = R::select(same, R::zero(), y).atan2(R::select(same, R::one(), x));
    [
        sin_h.atan2(h.z),
        sin_phi.atan2(cos_phi),
        difference
            .length_squared()
            .max(R::lit(1e-30))
            .sqrt()
            .atan2(length),
        phi_d,
    ]
}

fn from_half_difference([theta_h, phi_h, theta_d, phi_d]: [f64; 4]) -> (Vec3<f64>, Vec3<f64>) {
    let h = spherical_direction(theta_h, phi_h);
    let d = spherical_direction(theta_d, phi_d);
    let (sin, cos) = Real::sin_cos(theta_h);
    // The difference vector turned by θh about the y axis, then by φh about the normal.
    let (x, z) = (cos * d.x + sin * d.z, cos * d.z - sin * d.x);
    let (sin, cos) = Real::sin_cos(phi_h);
    let wi = Vec3::new(cos * x - sin * d.y, sin * x + cos * d.y, z);
    (wi, wi.reflect(h))
}

/// An angle brought to [0, 2π).
pub(in super::super) fn wrapped(phi: f64) -> f64 {
    let x = phi - (phi / TAU).floor() * TAU;
    if x >= TAU { 0.0 } else { x }
}

/// Radians of degrees.
pub(in super::super) fn radians(deg: f64) -> f64 {
    deg * (PI / 180.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    #[test]
    fn directions_have_their_coordinates() {
        let mut rng = Rng::from_name("coordinates");
        for p in Parameterization::ALL {
            for _ in 0..200 {
                let draw = |z: f64, u: f64| {
                    let s = (1.0 - z * z).sqrt();
                    let (sin, cos) = Real::sin_cos(TAU * u);
                    Vec3::new(s * cos, s * sin, z)
                };
                let wi = draw(rng.next_f64(), rng.next_f64());
                let wo = draw(rng.next_f64(), rng.next_f64());
                let x = p.coordinates(wi, wo);
                let (a, b) = p.directions(x);
                // Isotropic: the same but for a turn about the normal.
                assert!((a.z - wi.z).abs() < 1e-9 && (b.z - wo.z).abs() < 1e-9);
                assert!((a.dot(b) - wi.dot(wo)).abs() < 1e-9, "{p:?}");
                let turned = |v: Vec3<f64>, w: Vec3<f64>| v.x * w.y - v.y * w.x;
                assert!((turned(a, b) - turned(wi, wo)).abs() < 1e-9, "{p:?}");
                if p.rank() == 4 {
                    assert!(
                        (a - wi).length() < 1e-9 && (b - wo).length() < 1e-9,
                        "{p:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn exchanging_the_directions_turns_phi_d_by_half_a_turn() {
        let wi: Vec3<f64> = spherical_direction(0.7, 0.4);
        let wo: Vec3<f64> = spherical_direction(1.1, 2.9);
        let a = half_difference(wi, wo);
        let b = half_difference(wo, wi);
        assert_eq!(a[..3], b[..3]);
        assert!((wrapped(a[3] - b[3]) - PI).abs() < 1e-12);
    }

    #[test]
    fn the_outgoing_azimuth_counts_from_the_incoming_one() {
        let wi: Vec3<f64> = spherical_direction(0.5, 1.0);
        let wo: Vec3<f64> = spherical_direction(0.8, 1.25);
        let x = Parameterization::Spherical.coordinates(wi, wo);
        for (x, expected) in x.into_iter().zip([0.5, 0.8, 0.25]) {
            assert!((x - expected).abs() < 1e-12);
        }
    }
}
