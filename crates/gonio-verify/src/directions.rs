//! Directions to look in: random ones, and those where implementations break.

use gonio_num::{Frame, Real, Vec3};
pub(crate) use gonio_radiometry::direction::spherical_direction as spherical;
use gonio_radiometry::sequence::Rng;
use std::f64::consts::{PI, TAU};

/// The unit vector of height `z` in [−1, 1] and azimuth `phi`: equal areas in (z, φ) are equal solid angles.
pub(crate) fn at_height(z: f64, phi: f64) -> Vec3<f64> {
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let (sin_phi, cos_phi) = Real::sin_cos(phi);
    Vec3::new(sin * cos_phi, sin * sin_phi, z)
}

/// Azimuth in [0, 2π).
pub(crate) fn azimuth(w: Vec3<f64>) -> f64 {
    let phi: f64 = Real::atan2(w.y, w.x);
    if phi < 0.0 { (phi + TAU).min(TAU) } else { phi }
}

/// The mirror direction.
pub(crate) fn mirror(w: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(-w.x, -w.y, w.z)
}

/// `w` turned about the normal by `angle` radians.
pub(crate) fn turned(w: Vec3<f64>, angle: f64) -> Vec3<f64> {
    let (sin, cos) = Real::sin_cos(angle);
    Vec3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z)
}

/// `w` moved by `radius` radians towards azimuth `around` of a frame about it.
pub(crate) fn moved(w: Vec3<f64>, radius: f64, around: f64) -> Vec3<f64> {
    let (sin, cos) = Real::sin_cos(around);
    let frame = Frame::from_normal(w);
    (w + frame.to_world(Vec3::new(cos, sin, 0.0)) * Real::tan(radius)).normalize()
}

/// Uniform over the upper hemisphere.
pub(crate) fn uniform(rng: &mut Rng) -> Vec3<f64> {
    let z = 1.0 - rng.next_f64();
    at_height(z, TAU * rng.next_f64())
}

/// Where the directions of a subject lie.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Region {
    /// Above the horizon.
    Above,
    /// On both sides of a boundary, the lower one with this index of refraction relative to the upper one.
    Sphere { relative_ior: f64 },
}

/// `w` on the other side of the surface.
pub(crate) fn flipped(w: Vec3<f64>) -> Vec3<f64> {
    Vec3::new(w.x, w.y, -w.z)
}

/// The direction on the other side that a smooth boundary with the index `relative_ior` below it refracts into `w`; −w, straight
/// through, beyond the critical angle.
pub(crate) fn refracted(w: Vec3<f64>, relative_ior: f64) -> Vec3<f64> {
    let ratio = if w.z > 0.0 {
        1.0 / relative_ior
    } else {
        relative_ior
    };
    let sin2 = (w.x * w.x + w.y * w.y) * ratio * ratio;
    if sin2 >= 1.0 {
        return -w;
    }
    Vec3::new(
        -ratio * w.x,
        -ratio * w.y,
        if w.z > 0.0 { -1.0 } else { 1.0 } * (1.0 - sin2).sqrt(),
    )
}

/// A random pair (wi, wo) of the region. On the same side half of them are uniform, and the rest near the mirror direction (at
/// distances from 1 to 10⁻⁴ radians, where lobes of every width are steep), at grazing angles, and near coincidence; half of
/// those on different sides are near the refracted direction.
pub(crate) fn random_pair(rng: &mut Rng, region: Region) -> (Vec3<f64>, Vec3<f64>) {
    let (wi, wo) = pair_above(rng);
    let Region::Sphere { relative_ior } = region else {
        return (wi, wo);
    };
    match (rng.next_f64() * 4.0) as u32 {
        0 => (wi, wo),
        1 => (flipped(wi), flipped(wo)),
        side => {
            let wo = if side == 2 { wo } else { flipped(wo) };
            let near = (rng.next_f64() < 0.5).then(|| {
                let small: f64 = Real::exp(-9.2 * rng.next_f64());
                moved(refracted(wo, relative_ior), small, TAU * rng.next_f64())
            });
            match near {
                Some(wi) if wi.z * wo.z < 0.0 => (wi, wo),
                _ if wo.z > 0.0 => (flipped(wi), wo),
                _ => (wi, wo),
            }
        }
    }
}

fn pair_above(rng: &mut Rng) -> (Vec3<f64>, Vec3<f64>) {
    let mut wo = uniform(rng);
    let kind = (rng.next_f64() * 8.0) as u32;
    let small: f64 = Real::exp(-9.2 * rng.next_f64());
    let around = TAU * rng.next_f64();
    let wi = match kind {
        0 | 1 => moved(mirror(wo), small, around),
        2 => moved(wo, small, around),
        3 => {
            wo = at_height(small, around);
            uniform(rng)
        }
        _ => uniform(rng),
    };
    if wi.z > 0.0 {
        (wi, wo)
    } else {
        (mirror(wo), wo)
    }
}

/// Outgoing directions where implementations break: the normal (also with a negative zero and slightly off), the axes,
/// and grazing angles down to exactly 90°.
pub(crate) fn awkward() -> Vec<Vec3<f64>> {
    let mut all = vec![Vec3::new(0.0, 0.0, 1.0), Vec3::new(-0.0, -0.0, 1.0)];
    for z in [0.0, 1e-12, 1e-7, 1e-4, 1e-2] {
        all.push(at_height(z, 0.0));
        all.push(at_height(z, 2.5));
    }
    for (theta, phi) in [
        (1e-9, 1.0),
        (1e-4, 0.3),
        (0.25 * PI, 0.0),
        (0.25 * PI, 0.5 * PI),
        (0.25 * PI, PI),
        (1.0, -2.0),
        (1.4, 0.7),
    ] {
        all.push(spherical(theta, phi));
    }
    all
}

/// Incoming directions where implementations break, given `wo`: the awkward ones, coincident, mirrored, opposite, and
/// just beside them.
pub(crate) fn awkward_about(wo: Vec3<f64>) -> Vec<Vec3<f64>> {
    let mut all = awkward();
    all.extend([wo, mirror(wo), -wo, -mirror(wo)]);
    for w in [wo, mirror(wo)] {
        all.extend([1e-9, 1e-5, 1e-2].map(|r| moved(w, r, 0.4)));
    }
    all
}

/// Values of each of the three numbers given to `sample`: the ends of [0, 1) in `f32`, and the middle.
pub(crate) fn awkward_numbers() -> Vec<[f64; 3]> {
    const STEP: f64 = 1.0 / (1u32 << 24) as f64;
    let ends = [0.0, STEP, 0.5, 1.0 - STEP];
    let mut all = Vec::with_capacity(64);
    for a in ends {
        for b in ends {
            for c in ends {
                all.push([a, b, c]);
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_unit_and_above_the_horizon() {
        let mut rng = Rng::from_name("directions_are_unit_and_above_the_horizon");
        for _ in 0..10_000 {
            let (wi, wo) = random_pair(&mut rng, Region::Above);
            for w in [wi, wo] {
                // A handful of roundings of 1.1e-16 each.
                assert!((w.length() - 1.0).abs() < 1e-14 && w.z > 0.0, "{w:?}");
            }
        }
        for wo in awkward() {
            assert!(wo.z >= 0.0);
            for wi in awkward_about(wo) {
                assert!((wi.length() - 1.0).abs() < 1e-14, "{wi:?}");
            }
        }
    }

    #[test]
    fn pairs_on_the_sphere_cover_every_combination_of_sides() {
        let mut rng = Rng::from_name("pairs_on_the_sphere_cover_every_combination_of_sides");
        let mut counts = [0; 4];
        for _ in 0..4000 {
            let (wi, wo) = random_pair(&mut rng, Region::Sphere { relative_ior: 1.5 });
            for w in [wi, wo] {
                assert!((w.length() - 1.0).abs() < 1e-14 && w.z != 0.0, "{w:?}");
            }
            counts[usize::from(wi.z < 0.0) + 2 * usize::from(wo.z < 0.0)] += 1;
        }
        // A quarter each, give or take five standard errors of 27.
        assert!(counts.iter().all(|n| (865..1135).contains(n)), "{counts:?}");
    }

    #[test]
    fn refraction_is_snells_law_and_its_own_inverse() {
        let w = spherical(0.7, 0.4);
        let t = refracted(w, 1.5);
        let sin = |w: Vec3<f64>| (w.x * w.x + w.y * w.y).sqrt();
        assert!((sin(w) - 1.5 * sin(t)).abs() < 1e-15 && t.z < 0.0);
        assert!((refracted(t, 1.5) - w).length() < 1e-15);
        let steep = flipped(spherical(0.8, 0.0));
        assert_eq!(refracted(steep, 1.5), -steep);
    }

    #[test]
    fn moving_keeps_the_distance() {
        let w = spherical(0.7, 0.2);
        for r in [1e-4, 0.1, 1.0] {
            let cos: f64 = Real::cos(r);
            assert!((moved(w, r, 1.3).dot(w) - cos).abs() < 1e-12);
        }
    }

    #[test]
    fn the_corpus_of_numbers_stays_below_one_in_single_precision() {
        for u in awkward_numbers().iter().flatten() {
            assert!((*u as f32) < 1.0 && *u as f32 as f64 == *u);
        }
    }
}
