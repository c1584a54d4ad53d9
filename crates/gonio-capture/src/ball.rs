//! [`Ball`], a mirrored ball as a camera sees it: pixels to directions and back.
//!
//! The camera stands at the origin of its frame and looks along −z, +x to its right and +y up. A pixel's coordinates grow
//! to the right and downwards; (0, 0) is the picture's top left corner, and the centre of its first pixel (½, ½).
//!
//! With the ball's radius as the unit of length and its centre at distance D, the outline is the cone of half-angle
//! α = asin(1/D) around the direction of the centre: an ellipse unless the ball is in the middle of the picture. In the
//! plane of the camera, the centre and a point of the ball whose normal leans by β from the axis towards the camera,
//!
//! ```text
//! ε = atan2(sin β, D − cos β)     angle at the camera
//! β + ε                           angle of incidence
//! γ = 2 β + ε                     angle between the mirrored direction and the axis
//! ```
//!
//! so that γ grows from 0 (the camera sees itself) to π − α at the rim. A cone of half-angle α behind the ball is not seen.
//! From infinitely far away ε = 0, D = ∞ and α = 0.

use crate::CaptureError;
use gonio_num::{Real, Vec3};
use std::f64::consts::PI;

type Vec = Vec3<f64>;

/// How the camera maps directions to pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Parallel rays: a camera infinitely far away.
    Orthographic,
    /// All rays pass through one point.
    Perspective {
        /// Focal length \[pixels].
        focal: f64,
        /// Where the optical axis meets the picture \[pixels].
        principal: [f64; 2],
    },
}

impl Projection {
    /// The unit direction of the light that arrives at a pixel, away from the camera.
    fn ray(&self, [x, y]: [f64; 2]) -> Vec {
        match *self {
            Self::Orthographic => Vec3::new(0.0, 0.0, -1.0),
            Self::Perspective { focal, principal } => {
                Vec3::new((x - principal[0]) / focal, (principal[1] - y) / focal, -1.0).normalize()
            }
        }
    }
}

/// What a pixel of the ball shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirrored {
    /// Where the light comes from; unit, camera frame.
    pub direction: Vec3<f64>,
    /// Cosine of the angle of incidence at the ball, in \[0, 1].
    pub cos: f64,
}

/// Where the ball shows a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Pixel coordinates.
    pub pixel: [f64; 2],
    /// Cosine of the angle of incidence at the ball, in \[0, 1].
    pub cos: f64,
    /// Pixels per radian of the mirrored direction, away from the axis: 0 at the rim.
    pub radial: f64,
    /// Pixels per radian of the mirrored direction, around the axis.
    pub tangential: f64,
}

/// A mirrored ball in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    projection: Projection,
    centre: [f64; 2],
    radius: f64,
    /// From the ball to the camera.
    axis: Vec,
    tangent: Vec,
    bitangent: Vec,
    /// Of the ball's centre, in units of its radius.
    distance: f64,
}

impl Ball {
    /// - `centre`: pixel at which the ball's centre is seen; for a ball beside the optical axis *not* the centre of its
    ///   outline
    /// - `radius`: of the outline \[pixels] if the ball were in the middle, f tan α; > 0
    pub fn new(projection: Projection, centre: [f64; 2], radius: f64) -> Self {
        let axis = -projection.ray(centre);
        let right = Vec3::new(1.0, 0.0, 0.0);
        let tangent = (right - axis * axis.dot(right)).normalize();
        let distance = match projection {
            Projection::Orthographic => f64::INFINITY,
            // sin α = tan α / √(1 + tan²α)
            Projection::Perspective { focal, .. } => (1.0 + (focal / radius).powi(2)).sqrt(),
        };
        Self {
            projection,
            centre,
            radius,
            axis,
            tangent,
            bitangent: axis.cross(tangent),
            distance,
        }
    }

    /// The camera's projection.
    pub fn projection(&self) -> Projection {
        self.projection
    }
    /// The pixel at which the ball's centre is seen.
    pub fn centre(&self) -> [f64; 2] {
        self.centre
    }
    /// Radius of the outline \[pixels] if the ball were in the middle of the picture.
    pub fn radius(&self) -> f64 {
        self.radius
    }
    /// Distance of the camera from the ball's centre, in radii of the ball; ∞ for an orthographic camera.
    pub fn distance(&self) -> f64 {
        self.distance
    }
    /// The unit direction from the ball to the camera, in the camera's frame.
    pub fn towards_camera(&self) -> Vec3<f64> {
        self.axis
    }
    /// Half-angle \[rad] of the cone behind the ball that is not seen, and of the ball itself seen from the camera.
    pub fn blind_angle(&self) -> f64 {
        Real::asin(1.0 / self.distance)
    }

    /// Signed distance \[pixels] of a pixel from the outline, positive outside; exact for an orthographic camera, else
    /// to first order in the distance from the optical axis.
    pub fn outside(&self, pixel: [f64; 2]) -> f64 {
        match self.projection {
            Projection::Orthographic => {
                (pixel[0] - self.centre[0]).hypot(pixel[1] - self.centre[1]) - self.radius
            }
            Projection::Perspective { focal, .. } => {
                let ray = self.projection.ray(pixel);
                let angle = ray.cross(self.axis).length().atan2(-ray.dot(self.axis));
                focal * (Real::tan(angle.min(1.5)) - self.radius / focal)
            }
        }
    }

    /// The pixel of the outline at the angle `t` \[rad] around the axis, from the camera's right towards its up.
    pub fn outline(&self, t: f64) -> [f64; 2] {
        let (s, c) = Real::sin_cos(t);
        match self.projection {
            Projection::Orthographic => [
                self.centre[0] + self.radius * c,
                self.centre[1] - self.radius * s,
            ],
            Projection::Perspective { focal, .. } => {
                let across = self.tangent * c + self.bitangent * s;
                self.pixel(across * (self.radius / focal) - self.axis)
            }
        }
    }

    /// The pixel at which a point is seen, in the camera's frame.
    fn pixel(&self, point: Vec) -> [f64; 2] {
        match self.projection {
            Projection::Orthographic => [
                self.centre[0] + self.radius * point.x,
                self.centre[1] - self.radius * point.y,
            ],
            Projection::Perspective { focal, principal } => {
                let k = focal / (-point.z).max(1e-9);
                [principal[0] + k * point.x, principal[1] - k * point.y]
            }
        }
    }

    /// The ball's unit outward normal at a pixel, in the camera's frame; `None` outside its outline.
    pub fn normal(&self, pixel: [f64; 2]) -> Option<Vec3<f64>> {
        match self.projection {
            Projection::Orthographic => {
                let x = (pixel[0] - self.centre[0]) / self.radius;
                let y = (self.centre[1] - pixel[1]) / self.radius;
                let z2 = 1.0 - x * x - y * y;
                (z2 >= 0.0).then(|| Vec3::new(x, y, z2.sqrt()))
            }
            Projection::Perspective { .. } => {
                let ray = self.projection.ray(pixel);
                let ball = -self.axis * self.distance;
                let along = ray.dot(ball);
                let h2 = along * along - (self.distance * self.distance - 1.0);
                (h2 >= 0.0 && along > 0.0).then(|| ray * (along - h2.sqrt()) - ball)
            }
        }
    }

    /// What the ball shows at a pixel; `None` outside its outline.
    pub fn mirrored(&self, pixel: [f64; 2]) -> Option<Mirrored> {
        let normal = self.normal(pixel)?;
        let ray = self.projection.ray(pixel);
        let k = ray.dot(normal);
        Some(Mirrored {
            direction: (ray - normal * (2.0 * k)).normalize(),
            cos: (-k).clamp(0.0, 1.0),
        })
    }

    /// Where the ball shows the unit `direction`; `None` for the blind cone behind it.
    pub fn place(&self, direction: Vec3<f64>) -> Option<Place> {
        let along = direction.dot(self.axis);
        let across = direction - self.axis * along;
        let sin_gamma = across.length();
        let gamma = sin_gamma.atan2(along);
        if gamma > PI - self.blind_angle() {
            return None;
        }
        let across = if sin_gamma > 1e-12 {
            across * (1.0 / sin_gamma)
        } else {
            self.tangent
        };
        let beta = self.beta(gamma);
        let (sin, cos) = Real::sin_cos(beta);
        let normal = self.axis * cos + across * sin;
        let (epsilon, slope, apparent) = match self.projection {
            // ρ sin β is the distance from the centre, and β = γ/2.
            Projection::Orthographic => (0.0, self.radius * cos / 2.0, self.radius * sin),
            Projection::Perspective { focal, .. } => {
                let epsilon = self.epsilon(beta);
                let turn = self.epsilon_slope(beta);
                (
                    epsilon,
                    focal * turn / (2.0 + turn),
                    focal * Real::sin(epsilon),
                )
            }
        };
        let point = match self.projection {
            Projection::Orthographic => normal,
            Projection::Perspective { .. } => normal - self.axis * self.distance,
        };
        Some(Place {
            pixel: self.pixel(point),
            cos: Real::cos(beta + epsilon).clamp(0.0, 1.0),
            radial: slope.max(0.0),
            tangential: if sin_gamma > 1e-6 {
                apparent / sin_gamma
            } else if along > 0.0 {
                slope
            } else {
                f64::INFINITY
            },
        })
    }

    fn epsilon(&self, beta: f64) -> f64 {
        let (s, c) = Real::sin_cos(beta);
        s.atan2(self.distance - c)
    }

    /// dε/dβ = (D cos β − 1) / (D² − 2 D cos β + 1)
    fn epsilon_slope(&self, beta: f64) -> f64 {
        let (d, c) = (self.distance, Real::cos(beta));
        (d * c - 1.0) / (d * d - 2.0 * d * c + 1.0)
    }

    /// The normal's angle for the mirrored angle γ: the root of 2 β + ε(β) = γ, by Newton's method. The left side has a
    /// slope between 2 and 2 + 1/(D − 1) and one sign of curvature, so from the chord's root it converges in a few steps.
    fn beta(&self, gamma: f64) -> f64 {
        if self.distance.is_infinite() {
            return 0.5 * gamma;
        }
        let last = Real::acos(1.0 / self.distance);
        let mut beta = last * gamma / (PI - self.blind_angle());
        for _ in 0..12 {
            let step = (2.0 * beta + self.epsilon(beta) - gamma) / (2.0 + self.epsilon_slope(beta));
            beta = (beta - step).clamp(0.0, last);
            if step.abs() < 1e-14 {
                break;
            }
        }
        beta
    }
}

/// Reads the ball's place as people give it: `x,y,radius` of its outline \[pixels].
///
/// # Errors
/// [`CaptureError::Parameter`] unless it is three finite numbers with a positive radius.
pub fn parse_circle(text: &str) -> Result<[f64; 3], CaptureError> {
    let numbers: Option<std::vec::Vec<f64>> = text
        .split(',')
        .map(|n| n.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
        .collect();
    match numbers.as_deref() {
        Some(&[x, y, r]) if r > 0.0 => Ok([x, y, r]),
        _ => Err(CaptureError::parameter(
            "ball",
            text,
            "x,y,radius in pixels, such as 2048,1980.5,1930",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_env::Layout;
    use gonio_radiometry::sequence::Rng;

    fn cameras() -> [Ball; 4] {
        let lens = |focal| Projection::Perspective {
            focal,
            principal: [320.0, 240.0],
        };
        [
            Ball::new(Projection::Orthographic, [300.0, 250.0], 200.0),
            Ball::new(lens(2000.0), [320.0, 240.0], 200.0),
            Ball::new(lens(500.0), [420.0, 150.0], 120.0),
            // From two radii away, α = 30°.
            Ball::new(lens(300.0), [320.0, 240.0], 300.0 / 3.0_f64.sqrt()),
        ]
    }

    fn directions(name: &str, n: usize) -> impl Iterator<Item = Vec> {
        let mut rng = Rng::from_name(name);
        (0..n).map(move |_| {
            let z = 2.0 * rng.next_f64() - 1.0;
            let (s, c) = Real::sin_cos(2.0 * PI * rng.next_f64());
            let r = (1.0 - z * z).sqrt();
            Vec3::new(r * c, r * s, z)
        })
    }

    /// Both ways are computed differently: by Newton's method on angles, and by a ray's hit on the sphere. The rim costs half
    /// the digits, as the derivative of γ by the pixel diverges there like 1/√: 1e-16^(1/2) = 1e-8, times some rounding.
    #[test]
    fn directions_come_back_from_their_pixels() {
        for ball in cameras() {
            let mut seen = 0;
            for d in directions("directions come back", 2000) {
                let Some(place) = ball.place(d) else {
                    let angle = Real::acos(d.dot(ball.towards_camera()));
                    assert!(angle > PI - ball.blind_angle());
                    continue;
                };
                let Some(hit) = ball.mirrored(place.pixel) else {
                    continue;
                };
                seen += 1;
                assert!(
                    (hit.direction - d).length() < 1e-6,
                    "{ball:?} {d:?} {hit:?}"
                );
                assert!((hit.cos - place.cos).abs() < 1e-6);
            }
            // A cone of 30° is 6.7 % of the sphere.
            assert!(seen > 1800, "{seen}");
        }
    }

    #[test]
    fn orthographic_is_the_layout_of_the_same_name() {
        let ball = Ball::new(Projection::Orthographic, [0.5, 0.5], 0.5);
        for d in directions("layout", 200) {
            let place = ball.place(d).unwrap().pixel;
            let uv = Layout::MirrorBall.uv(d);
            assert!((place[0] - uv[0]).abs() < 1e-12 && (place[1] - uv[1]).abs() < 1e-12);
        }
    }

    /// At half the distance to the rim nothing is singular: differences over 1e-5 rad have an error of order 1e-10, relative,
    /// and 1e-11 of rounding.
    #[test]
    fn scales_are_derivatives() {
        for ball in cameras().into_iter().filter(|b| b.centre == [320.0, 240.0]) {
            let h = 1e-5;
            let at = |gamma: f64, phi: f64| {
                let (s, c) = Real::sin_cos(gamma);
                let (sp, cp) = Real::sin_cos(phi);
                ball.place(Vec3::new(s * cp, s * sp, c)).unwrap()
            };
            for gamma in [0.3, 1.0, 1.7] {
                let middle = at(gamma, 0.4);
                let between = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
                let radial =
                    between(at(gamma + h, 0.4).pixel, at(gamma - h, 0.4).pixel) / (2.0 * h);
                let tangential = between(at(gamma, 0.4 + h).pixel, at(gamma, 0.4 - h).pixel)
                    / (2.0 * h * Real::sin(gamma));
                let Projection::Perspective { focal, .. } = ball.projection else {
                    continue;
                };
                // A picture's plane stretches angles by 1/cos² away from its middle, and by 1/cos around it.
                let tan = between(middle.pixel, ball.centre) / focal;
                let cos2 = 1.0 / (1.0 + tan * tan);
                assert!(
                    (radial * cos2 / middle.radial - 1.0).abs() < 1e-7,
                    "{radial} {middle:?}"
                );
                assert!((tangential * cos2.sqrt() / middle.tangential - 1.0).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn the_outline_is_where_nothing_is_outside() {
        for ball in cameras() {
            for k in 0..16 {
                let p = ball.outline(f64::from(k));
                assert!(ball.outside(p).abs() < 1e-9, "{ball:?}");
                let c = ball.centre;
                let inner = [c[0] + 0.999 * (p[0] - c[0]), c[1] + 0.999 * (p[1] - c[1])];
                let outer = [c[0] + 1.001 * (p[0] - c[0]), c[1] + 1.001 * (p[1] - c[1])];
                assert!(ball.mirrored(inner).is_some() && ball.outside(inner) < 0.0);
                assert!(ball.mirrored(outer).is_none() && ball.outside(outer) > 0.0);
            }
        }
    }

    #[test]
    fn a_far_camera_is_orthographic() {
        let far = Ball::new(
            Projection::Perspective {
                focal: 1e7,
                principal: [0.0, 0.0],
            },
            [0.0, 0.0],
            100.0,
        );
        let parallel = Ball::new(Projection::Orthographic, [0.0, 0.0], 100.0);
        // ε ≤ α = 1e-5 rad.
        for d in directions("far", 100).filter(|d| d.z > -0.99) {
            let (p, q) = (
                far.place(d).unwrap().pixel,
                parallel.place(d).unwrap().pixel,
            );
            assert!((p[0] - q[0]).hypot(p[1] - q[1]) < 100.0 * 2e-5);
        }
    }

    #[test]
    fn circles_are_read() {
        assert_eq!(parse_circle("1, 2.5,3").unwrap(), [1.0, 2.5, 3.0]);
        for bad in ["", "1,2", "1,2,0", "1,2,inf", "a,b,c", "1,2,3,4"] {
            assert!(parse_circle(bad).is_err(), "{bad}");
        }
    }
}
