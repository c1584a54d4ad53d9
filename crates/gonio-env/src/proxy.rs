//! [`Proxy`], the room around a panorama.
//!
//! A panorama tells what one point sees. From another point of the room, the wall that lies in direction ω is not the one that the
//! panorama shows in direction ω: what is right only infinitely far away is wrong in a room. With the room's shape known, roughly, the
//! error goes: from the point x the ray along ω meets the proxy at h, and the panorama is read in the direction of h from where it was
//! taken, c (Brennan, "Accurate environment mapped reflections and refractions by adjusting for object distance", *ShaderX*, 2002;
//! Lagarde & Zanuttini, "Local image-based lighting with parallax-corrected cubemaps", SIGGRAPH 2012).
//!
//! A direction ω′ drawn at c with density p(ω′) becomes ω = (h − x)/|h − x|. Both see the same piece of the proxy, dA, so that
//!
//! p(ω) = p(ω′) · (|n·ω′| / |h − c|²) / (|n·ω| / |h − x|²)
//!
//! with the proxy's normal n at h. Exact for a convex proxy with both points inside.

use crate::EnvError;
use gonio_num::Vec3;
use std::str::FromStr;

/// The room around a panorama, and where in it the panorama was taken. World coordinates.
///
/// In words: `box:X0,Y0,Z0,X1,Y1,Z1` or `sphere:X,Y,Z,RADIUS`, then `@X,Y,Z` if the capture position is not the centre.
///
/// A point outside is moved to the nearest point of the room: it sees what that point sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Proxy {
    shape: Shape,
    capture: Vec3<f32>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Shape {
    Box { low: Vec3<f32>, high: Vec3<f32> },
    Sphere { centre: Vec3<f32>, radius: f32 },
}

/// How near to the wall, relative to the room, a point may be: nearer ones are moved in, so that every direction has its wall.
const SKIN: f32 = 1e-4;

impl Proxy {
    /// A box between two corners.
    ///
    /// # Errors
    /// [`EnvError::Parameter`] unless the numbers are finite, `low` is below `high`, and `capture` well inside.
    pub fn cuboid(low: Vec3<f32>, high: Vec3<f32>, capture: Vec3<f32>) -> Result<Self, EnvError> {
        let size = high - low;
        if !(size.is_finite() && size.x > 0.0 && size.y > 0.0 && size.z > 0.0) {
            return Err(wrong(
                format!("box from {low:?} to {high:?}"),
                "two corners, the lower one first",
            ));
        }
        Self {
            shape: Shape::Box { low, high },
            capture,
        }
        .checked()
    }

    /// A sphere.
    ///
    /// # Errors
    /// [`EnvError::Parameter`] unless the numbers are finite, `radius` > 0, and `capture` well inside.
    pub fn sphere(centre: Vec3<f32>, radius: f32, capture: Vec3<f32>) -> Result<Self, EnvError> {
        if !(centre.is_finite() && radius.is_finite() && radius > 0.0) {
            return Err(wrong(
                format!("sphere of radius {radius}"),
                "a finite centre and a positive radius",
            ));
        }
        Self {
            shape: Shape::Sphere { centre, radius },
            capture,
        }
        .checked()
    }

    fn checked(self) -> Result<Self, EnvError> {
        let c = self.capture;
        if c.is_finite() && self.moved_in(c) == c {
            return Ok(self);
        }
        Err(wrong(
            format!("capture position {}, {}, {}", c.x, c.y, c.z),
            "a point inside of the proxy",
        ))
    }

    /// Where the panorama was taken.
    pub fn capture(&self) -> Vec3<f32> {
        self.capture
    }

    /// The nearest point of the room, its skin left out.
    #[inline]
    fn moved_in(&self, p: Vec3<f32>) -> Vec3<f32> {
        match self.shape {
            Shape::Box { low, high } => {
                let skin = (high - low) * SKIN;
                p.max(low + skin).min(high - skin)
            }
            Shape::Sphere { centre, radius } => {
                let off = p - centre;
                let most = radius * (1.0 - SKIN);
                let length = off.length();
                if length > most {
                    centre + off * (most / length)
                } else {
                    p
                }
            }
        }
    }

    /// How far it is from `p`, inside, to the wall in the direction `d` (unit), and the cosine between `d` and the wall's normal.
    #[inline]
    fn wall(&self, p: Vec3<f32>, d: Vec3<f32>) -> (f32, f32) {
        match self.shape {
            Shape::Box { low, high } => {
                let mut nearest = (f32::MAX, 1.0);
                for axis in 0..3 {
                    let to = if d[axis] > 0.0 { high[axis] } else { low[axis] };
                    let t = (to - p[axis]) / d[axis];
                    if d[axis] != 0.0 && t < nearest.0 {
                        nearest = (t, d[axis].abs());
                    }
                }
                nearest
            }
            Shape::Sphere { centre, radius } => {
                let from = p - centre;
                let half = from.dot(d);
                // r² − |from|², without cancellation near the wall.
                let length = from.length();
                let inside = (radius - length) * (radius + length);
                let root = (half * half + inside).max(0.0).sqrt();
                let t = if half > 0.0 {
                    inside / (half + root)
                } else {
                    root - half
                };
                (t, root / radius)
            }
        }
    }

    /// The direction (unit) in which the capture position sees what `p` sees in the direction `d`, and how much denser directions
    /// drawn there are at `p`: p(ω) / p(ω′).
    #[inline]
    pub fn look_up(&self, p: Vec3<f32>, d: Vec3<f32>) -> (Vec3<f32>, f32) {
        let p = self.moved_in(p);
        let (far, cos) = self.wall(p, d);
        let hit = p + d * far;
        let from_capture = hit - self.capture;
        let seen = from_capture.normalize();
        let (away, cos_seen) = self.wall(self.capture, seen);
        let ratio = far / away;
        (seen, cos_seen / cos.max(f32::MIN_POSITIVE) * ratio * ratio)
    }

    /// The direction (unit) in which `p` sees what the capture position sees in the direction `seen`.
    #[inline]
    pub fn direction(&self, p: Vec3<f32>, seen: Vec3<f32>) -> Vec3<f32> {
        let (away, _) = self.wall(self.capture, seen);
        (self.capture + seen * away - self.moved_in(p)).normalize()
    }
}

fn wrong(found: String, expected: &'static str) -> EnvError {
    EnvError::Parameter {
        name: "proxy",
        found,
        expected,
    }
}

impl FromStr for Proxy {
    type Err = EnvError;

    fn from_str(text: &str) -> Result<Self, EnvError> {
        const FORM: &str =
            "box:X0,Y0,Z0,X1,Y1,Z1 or sphere:X,Y,Z,RADIUS, then @X,Y,Z of the capture position";
        let error = || wrong(text.to_owned(), FORM);
        let numbers = |text: &str| -> Result<Vec<f32>, EnvError> {
            text.split(',')
                .map(|n| n.trim().parse().map_err(|_| error()))
                .collect()
        };
        let (kind, rest) = text.split_once(':').ok_or_else(error)?;
        let (shape, capture) = match rest.split_once('@') {
            Some((shape, capture)) => (shape, Some(numbers(capture)?)),
            None => (rest, None),
        };
        let capture = match capture.as_deref() {
            None => None,
            Some(&[x, y, z]) => Some(Vec3::new(x, y, z)),
            Some(_) => return Err(error()),
        };
        match (kind, &numbers(shape)?[..]) {
            ("box", &[x0, y0, z0, x1, y1, z1]) => {
                let (low, high) = (Vec3::new(x0, y0, z0), Vec3::new(x1, y1, z1));
                Self::cuboid(low, high, capture.unwrap_or((low + high) * 0.5))
            }
            ("sphere", &[x, y, z, radius]) => {
                let centre = Vec3::new(x, y, z);
                Self::sphere(centre, radius, capture.unwrap_or(centre))
            }
            _ => Err(error()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    fn proxies() -> [Proxy; 3] {
        [
            "box:-2,0,-3,2,2.5,3@0.3,1.5,-1",
            "sphere:1,2,3,4",
            "sphere:0,0,0,2@0.5,0.9,-0.4",
        ]
        .map(|t| t.parse().unwrap())
    }

    fn unit(rng: &mut Rng) -> Vec3<f32> {
        crate::sampling::uniform_direction([rng.next_f32(), rng.next_f32()])
    }

    #[test]
    fn both_ways_are_inverse() {
        let mut rng = Rng::from_name("proxy both ways");
        for proxy in proxies() {
            for _ in 0..2000 {
                // Some are outside, and moved in.
                let p = proxy.capture + unit(&mut rng) * (4.0 * rng.next_f32());
                let d = unit(&mut rng);
                let (seen, jacobian) = proxy.look_up(p, d);
                let back = proxy.direction(p, seen);
                // Directions to a wall at the relative distance SKIN lose four of seven digits.
                assert!((back - d).length() < 3e-3, "{proxy:?} {p:?} {d:?} {back:?}");
                assert!(
                    jacobian.is_finite() && jacobian > 0.0,
                    "{proxy:?} {p:?} {d:?}"
                );
            }
        }
    }

    #[test]
    fn at_the_capture_position_nothing_changes() {
        let mut rng = Rng::from_name("proxy capture");
        for proxy in proxies() {
            for _ in 0..500 {
                let d = unit(&mut rng);
                let (seen, jacobian) = proxy.look_up(proxy.capture, d);
                assert!(
                    (seen - d).length() < 1e-5 && (jacobian - 1.0).abs() < 1e-4,
                    "{proxy:?} {d:?}"
                );
            }
        }
    }

    /// The density of what is drawn evenly at the capture position integrates to 1 at any other point: 1/4π times the mean of
    /// the Jacobian over evenly drawn directions, times 4π.
    #[test]
    fn the_jacobian_integrates_to_one() {
        for proxy in proxies() {
            let p = proxy.capture + Vec3::new(0.4, -0.3, 0.6);
            let n = 256;
            let mut sum = 0.0;
            for k in 0..n * n {
                let u = [(k % n) as f32 + 0.5, (k / n) as f32 + 0.5].map(|x| x / n as f32);
                sum += f64::from(proxy.look_up(p, crate::sampling::uniform_direction(u)).1);
            }
            let mean = sum / (n * n) as f64;
            // Midpoints, with kinks at the box's edges: (1/256)² times the edges' share, and f32.
            assert!((mean - 1.0).abs() < 2e-3, "{proxy:?}: {mean}");
        }
    }

    #[test]
    fn what_is_no_proxy_is_refused() {
        for text in [
            "",
            "box",
            "box:1,2,3",
            "box:0,0,0,1,1,0",
            "box:0,0,0,1,1,1@2,0,0",
            "sphere:0,0,0,-1",
            "sphere:0,0,0,1@0,0,1",
            "sphere:0,0,0,nan",
            "cone:0,0,0,1",
            "box:0,0,0,1,1,inf",
        ] {
            assert!(text.parse::<Proxy>().is_err(), "{text}");
        }
    }
}
