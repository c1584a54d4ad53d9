//! [`Interior`], the bodies that a place is inside of, and what they absorb.
//!
//! A surface that transmits bounds a body, which may absorb: over a distance d the share e^(−σd) of the radiance is left
//! (Bouguer 1729, Lambert 1760, Beer 1852). Which body a part of a path lies in is found in two ways:
//!
//! - A ray that arrives at a boundary from its inner side has come through that body, whatever happened before. This needs no
//!   memory, so it holds for a camera inside a body too.
//! - Elsewhere, before an opaque surface, a light or another body's outer side, a path remembers the bodies that it entered and has
//!   not left. The innermost, the one entered last, is the one that absorbs.
//!
//! Both agree where bodies are closed surfaces that lie apart or one wholly inside the other. The index of refraction of an inner body
//! is relative to the body around it. Where bodies overlap the one entered last absorbs, and there is no other priority among them.

use gonio_num::Real;

/// A body whose boundary transmits, as it is at one point of that boundary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Body {
    /// Index of the boundary's material, by which the body is known again: the boundary may consist of several shapes.
    pub material: u32,
    /// Absorption coefficient σ ≥ 0 of each component, per unit of length.
    pub absorption: [f32; 3],
}

/// Bodies inside each other that are remembered; beyond that the outermost is forgotten.
const DEPTH: usize = 4;

/// The bodies that a place is inside of, outermost first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interior {
    bodies: [Body; DEPTH],
    count: u8,
}

impl Interior {
    /// Outside all bodies.
    pub const OUTSIDE: Self = Self {
        bodies: [Body {
            material: u32::MAX,
            absorption: [0.0; 3],
        }; DEPTH],
        count: 0,
    };

    /// The bodies, outermost first.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies[..usize::from(self.count)]
    }

    /// Whether it is inside of no body.
    #[inline]
    pub fn is_outside(&self) -> bool {
        self.count == 0
    }

    /// The share of radiance that is left after a distance in the innermost body, each component in \[0, 1]; 1 outside. The distance
    /// may be infinite.
    #[inline]
    pub fn transmittance(&self, distance: f32) -> [f32; 3] {
        match self.bodies().last() {
            None => [1.0; 3],
            Some(body) => body.transmittance(distance),
        }
    }

    /// `weight` times [`Interior::transmittance`].
    #[inline]
    pub fn absorb(&self, weight: [f32; 3], distance: f32) -> [f32; 3] {
        match self.bodies().last() {
            None => weight,
            Some(body) => body.absorb(weight, distance),
        }
    }

    /// `weight` times the share of radiance that is left of a way of this length that ends on a boundary, on its inner or its outer side. An
    /// inner side tells that the way was through its body, and if no body was known to be around, that one is from here on.
    pub fn arrive(
        &mut self,
        boundary: &Body,
        inner: bool,
        weight: [f32; 3],
        distance: f32,
    ) -> [f32; 3] {
        if !inner {
            return self.absorb(weight, distance);
        }
        if self.count == 0 {
            self.enter(*boundary);
        }
        boundary.absorb(weight, distance)
    }

    /// Goes through a boundary, into its body or out of it.
    ///
    /// Who leaves a body that was never entered is outside all of them: the surfaces then are not nested as described in the head of
    /// this module, and to assume the other bodies left too errs on the side of clear air.
    pub fn cross(&mut self, boundary: &Body, inwards: bool) {
        if inwards {
            self.enter(*boundary);
            return;
        }
        let known = |body: &Body| body.material == boundary.material;
        match self.bodies().iter().rposition(known) {
            Some(at) => {
                self.bodies.copy_within(at + 1.., at);
                self.count -= 1;
            }
            None => self.count = 0,
        }
    }

    fn enter(&mut self, body: Body) {
        if usize::from(self.count) == DEPTH {
            self.bodies.copy_within(1.., 0);
            self.count -= 1;
        }
        self.bodies[usize::from(self.count)] = body;
        self.count += 1;
    }

    /// Puts a body around all that are known, unless it is one of them or there is no room.
    pub(crate) fn surround(&mut self, body: Body) {
        let known = self.bodies().iter().any(|b| b.material == body.material);
        if known || usize::from(self.count) == DEPTH {
            return;
        }
        self.bodies.copy_within(..DEPTH - 1, 1);
        self.bodies[0] = body;
        self.count += 1;
    }
}

impl Body {
    /// e^(−σd).
    #[inline]
    fn transmittance(&self, distance: f32) -> [f32; 3] {
        let left = |sigma: f32| {
            // 0 · ∞ is not a number; a clear body leaves all.
            if sigma > 0.0 {
                Real::exp(-sigma * distance)
            } else {
                1.0
            }
        };
        let [r, g, b] = self.absorption;
        [left(r), left(g), left(b)]
    }

    fn absorb(&self, weight: [f32; 3], distance: f32) -> [f32; 3] {
        let left = self.transmittance(distance);
        [
            weight[0] * left[0],
            weight[1] * left[1],
            weight[2] * left[2],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(material: u32, sigma: f32) -> Body {
        Body {
            material,
            absorption: [sigma; 3],
        }
    }

    fn sigma(interior: &Interior) -> f32 {
        interior.bodies().last().map_or(0.0, |b| b.absorption[0])
    }

    /// e^(−2·0.5) = e⁻¹; nothing is left of an endless way, unless the body is clear.
    #[test]
    fn absorption_is_exponential() {
        let mut interior = Interior::OUTSIDE;
        assert_eq!(interior.transmittance(f32::INFINITY), [1.0; 3]);
        let tinted = Body {
            material: 0,
            absorption: [0.0, 0.5, 1.0],
        };
        interior.cross(&tinted, true);
        let t = interior.transmittance(2.0);
        for (found, expected) in t
            .into_iter()
            .zip([1.0, Real::exp(-1.0_f32), Real::exp(-2.0_f32)])
        {
            assert!((found - expected).abs() < 1e-6, "{t:?}");
        }
        assert_eq!(interior.transmittance(f32::INFINITY), [1.0, 0.0, 0.0]);
        assert_eq!(interior.transmittance(0.0), [1.0; 3]);
    }

    #[test]
    fn a_bubble_in_a_ball_gives_the_ball_back() {
        let (ball, bubble) = (body(3, 2.0), body(7, 0.0));
        let mut interior = Interior::OUTSIDE;
        interior.cross(&ball, true);
        assert_eq!(
            interior.arrive(&bubble, false, [1.0; 3], 1.0),
            ball.transmittance(1.0)
        );
        interior.cross(&bubble, true);
        assert_eq!(interior.transmittance(9.0), [1.0; 3]);
        interior.cross(&bubble, false);
        assert_eq!(sigma(&interior), 2.0);
        interior.cross(&ball, false);
        assert_eq!(
            interior,
            Interior {
                bodies: interior.bodies,
                ..Interior::OUTSIDE
            }
        );
    }

    /// Two bodies that overlap: whichever is left first, the other one remains. Two of the same material count twice.
    #[test]
    fn overlapping_bodies_are_left_in_any_order() {
        for second in [body(2, 5.0), body(1, 1.0)] {
            let mut interior = Interior::OUTSIDE;
            interior.cross(&body(1, 1.0), true);
            interior.cross(&second, true);
            assert_eq!(sigma(&interior), second.absorption[0]);
            interior.cross(&body(1, 1.0), false);
            assert_eq!(sigma(&interior), second.absorption[0]);
            interior.cross(&second, false);
            assert!(interior.bodies().is_empty());
        }
    }

    /// A liquid in a glass, as three surfaces of three materials: air to glass, glass to liquid, liquid to air. The list is not nested, yet
    /// in the air it is empty.
    #[test]
    fn a_body_left_without_being_entered_leads_outside() {
        let (glass, wall, top) = (body(0, 1.0), body(1, 2.0), body(2, 2.0));
        let mut interior = Interior::OUTSIDE;
        interior.cross(&glass, true);
        interior.cross(&wall, true);
        assert_eq!(
            interior.arrive(&top, true, [1.0; 3], 1.0),
            top.transmittance(1.0)
        );
        interior.cross(&top, false);
        assert!(interior.bodies().is_empty());
    }

    #[test]
    fn an_inner_side_tells_where_a_path_began() {
        let ocean = body(4, 0.3);
        let mut interior = Interior::OUTSIDE;
        assert_eq!(
            interior.arrive(&ocean, true, [1.0; 3], 2.0),
            ocean.transmittance(2.0)
        );
        assert_eq!(sigma(&interior), 0.3);
        interior.cross(&ocean, false);
        assert!(interior.bodies().is_empty());
    }

    #[test]
    fn the_outermost_is_forgotten_first() {
        let mut interior = Interior::OUTSIDE;
        for k in 0..6 {
            interior.cross(&body(k, k as f32), true);
        }
        let kept: Vec<u32> = interior.bodies().iter().map(|b| b.material).collect();
        assert_eq!(kept, [2, 3, 4, 5]);
        interior.surround(body(9, 1.0));
        assert_eq!(interior.bodies().len(), 4);
        interior.cross(&body(5, 5.0), false);
        interior.surround(body(9, 1.0));
        interior.surround(body(9, 1.0));
        let kept: Vec<u32> = interior.bodies().iter().map(|b| b.material).collect();
        assert_eq!(kept, [9, 2, 3, 4]);
    }
}
