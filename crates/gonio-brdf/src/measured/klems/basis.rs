//! [`Basis`], the hemisphere cut into patches, ring by ring.

use super::super::search::last_not_above;
use crate::{Index, Number};
use gonio_num::{Real, Vec3};
use gonio_radiometry::direction::spherical_direction;
use std::f64::consts::{PI, TAU};

/// The hemisphere cut into rings of elevation and each ring into equal steps of azimuth, the first centred on azimuth 0 (Klems 1994).
#[derive(Debug, Clone, PartialEq)]
pub struct Basis {
    name: String,
    /// Elevations of the rings' edges in degrees, one more than rings.
    edges_deg: Vec<f64>,
    counts: Vec<u32>,
    /// sin²θ of the edges.
    sin2: Vec<f32>,
    /// (patches of the ring, patches before it) of each ring.
    steps: Vec<f32>,
}

/// Patches of each of the bases that are known by name, with the upper edges of their rings in degrees.
/// Source: Klems 1994, ASHRAE Trans. 100(1); the half and quarter bases of LBNL WINDOW.
const KNOWN: [(&str, &[(f64, u32)]); 3] = [
    (
        "LBNL/Klems Full",
        &[
            (5.0, 1),
            (15.0, 8),
            (25.0, 16),
            (35.0, 20),
            (45.0, 24),
            (55.0, 24),
            (65.0, 24),
            (75.0, 16),
            (90.0, 12),
        ],
    ),
    (
        "LBNL/Klems Half",
        &[
            (6.5, 1),
            (19.5, 8),
            (32.5, 12),
            (46.5, 16),
            (61.5, 20),
            (76.5, 12),
            (90.0, 4),
        ],
    ),
    (
        "LBNL/Klems Quarter",
        &[(9.0, 1), (27.0, 8), (46.0, 12), (66.0, 12), (90.0, 8)],
    ),
];

impl Basis {
    /// A basis with these rings: the elevation of each one's outer edge in degrees and its number of patches.
    ///
    /// # Errors
    /// What is wrong with them: edges that don't increase from 0 to 90°, rings without patches, more than 4096 patches.
    pub fn new(name: &str, rings: &[(f64, u32)]) -> Result<Self, String> {
        let mut edges_deg = vec![0.0];
        let mut steps = Vec::new();
        let mut before = 0u64;
        for (k, (edge, count)) in rings.iter().enumerate() {
            let inner = edges_deg[k];
            if !(*edge > inner + 1e-6 && *edge <= 90.0 + 1e-6) {
                return Err(format!("a ring from {inner}° to {edge}°"));
            }
            if *count == 0 {
                return Err(format!("no patch in the ring up to {edge}°"));
            }
            edges_deg.push(edge.min(90.0));
            steps.extend([*count as f32, before as f32]);
            before += u64::from(*count);
            if before > 4096 {
                return Err(format!("{before} patches or more"));
            }
        }
        if edges_deg.last().is_none_or(|e| (e - 90.0).abs() > 1e-3) {
            return Err("rings that don't reach 90°".into());
        }
        if let Some(last) = edges_deg.last_mut() {
            *last = 90.0;
        }
        let sin2 = edges_deg.iter().map(|e| sin2(*e) as f32).collect();
        Ok(Self {
            name: name.into(),
            counts: rings.iter().map(|(_, n)| *n).collect(),
            edges_deg,
            sin2,
            steps,
        })
    }

    /// A basis that is known by name, in upper or lower case.
    pub fn known(name: &str) -> Option<Self> {
        KNOWN
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name.trim()))
            .map(|(name, rings)| {
                Self::new(name, rings).expect("invariant: the rings in the source are sound")
            })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of patches.
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.counts.iter().map(|n| *n as usize).sum()
    }

    /// Inner and outer edge in degrees and number of patches of each ring.
    pub fn rings(&self) -> impl Iterator<Item = (f64, f64, u32)> {
        let edges = self.edges_deg.windows(2);
        edges.zip(&self.counts).map(|(e, n)| (e[0], e[1], *n))
    }

    /// (sin²θ of the inner edge, of the outer edge, azimuth of the first border, azimuth of the second) of a patch.
    pub(in super::super) fn patch(&self, index: usize) -> [f64; 4] {
        let mut rest = index;
        for (inner, outer, count) in self.rings() {
            let n = count as usize;
            if rest < n {
                let width = TAU / n as f64;
                let first = (rest as f64 - 0.5) * width;
                return [sin2(inner), sin2(outer), first, first + width];
            }
            rest -= n;
        }
        [0.0; 4]
    }

    /// ∫ cosθ dω over a patch: π (sin²θ₁ − sin²θ₀)/n.
    pub fn projected_solid_angle(&self, index: usize) -> f64 {
        let [a, b, first, second] = self.patch(index);
        0.5 * (b - a) * (second - first)
    }

    /// The direction in a patch at `u` in [0, 1]²: uniform u are uniform by projected solid angle.
    pub(in super::super) fn direction(&self, index: usize, u: [f64; 2]) -> Vec3<f64> {
        let [a, b, first, second] = self.patch(index);
        let s = a + u[0] * (b - a);
        spherical_direction(
            Real::atan2(s.sqrt(), (1.0 - s).max(0.0).sqrt()),
            first + u[1] * (second - first),
        )
    }

    /// The patch that a direction with the horizontal part (x, y) lies in.
    #[inline(always)]
    pub(in super::super) fn find<R: Number>(&self, x: R, y: R) -> R::Index {
        let s = x * x + y * y;
        let rings = self.counts.len() as u32;
        let ring = last_not_above(&self.sin2, R::Index::splat(0), rings, s);
        let [count, before] = R::gather(&self.steps, ring.times(2));
        let at_normal = s.lt(R::lit(1e-30));
        let turns = y.atan2(R::select(at_normal, R::one(), x)) * R::lit(1.0 / TAU);
        let step = (turns * count + R::lit(0.5)).floor();
        let step = R::select(step.lt(R::zero()), step + count, step);
        let step = R::select(step.ge(count), R::zero(), step);
        (before + step).index(self.len() as u32 - 1)
    }

    /// For each patch: sin²θ of its edges, and its first border and width in turns, for drawing in it.
    pub(in super::super) fn table(&self) -> Vec<f32> {
        (0..self.len())
            .flat_map(|k| {
                let [a, b, first, second] = self.patch(k);
                [
                    a as f32,
                    b as f32,
                    (first / TAU) as f32,
                    ((second - first) / TAU) as f32,
                ]
            })
            .collect()
    }
}

fn sin2(deg: f64) -> f64 {
    let sin: f64 = Real::sin(deg * (PI / 180.0));
    sin * sin
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    #[test]
    fn the_known_bases_have_their_patches() {
        for (name, n) in [
            ("LBNL/Klems Full", 145),
            ("lbnl/klems half", 73),
            ("LBNL/Klems Quarter", 41),
        ] {
            let basis = Basis::known(name).unwrap();
            assert_eq!(basis.len(), n);
            let sum: f64 = (0..n).map(|k| basis.projected_solid_angle(k)).sum();
            assert!((sum - PI).abs() < 1e-12);
        }
        assert!(Basis::known("LBNL/Klems Double").is_none());
    }

    #[test]
    fn directions_are_found_in_their_patches() {
        let custom = Basis::new("mine", &[(10.0, 3), (60.0, 7), (90.0, 1)]).unwrap();
        let mut rng = Rng::from_name("patches");
        for basis in [custom, Basis::known("LBNL/Klems Full").unwrap()] {
            for k in 0..basis.len() {
                for _ in 0..20 {
                    let u = [
                        0.001 + 0.998 * rng.next_f64(),
                        0.001 + 0.998 * rng.next_f64(),
                    ];
                    let w = basis.direction(k, u);
                    assert_eq!(basis.find(w.x, w.y) as usize, k);
                }
            }
            assert_eq!(basis.find(0.0f64, 0.0), 0);
        }
    }

    #[test]
    fn bad_rings_are_refused() {
        for rings in [
            &[][..],
            &[(45.0, 8)],
            &[(45.0, 0), (90.0, 1)],
            &[(90.0, 1), (45.0, 1)],
            &[(f64::NAN, 1)],
            &[(90.0, u32::MAX)],
        ] {
            assert!(Basis::new("bad", rings).is_err(), "{rings:?}");
        }
    }
}
