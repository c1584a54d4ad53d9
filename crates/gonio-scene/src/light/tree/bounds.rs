//! [`LightBounds`], what is known of some lights together, and [`LightBounds::importance`], what they may send to a point.

use super::cone::Cone;
use gonio_num::{Real, Vec3};

/// Lights together: a sphere around them, a cone around the axes of what they emit, and their intensity.
///
/// Light leaves a light of axis a at the angle θ to it in proportion to 1 for θ ≤ θo, then cos(θ − θo) up to θ = θo + θe, then not at all:
/// θo = 0 and θe = π/2 is a flat lamp, θo = π anything that shines to all sides.
#[derive(Debug, Clone, Copy)]
pub(super) struct LightBounds<R: Real> {
    pub centre: Vec3<R>,
    /// Above 0.
    pub radius: R,
    pub axis: Vec3<R>,
    pub cos_o: R,
    pub sin_o: R,
    pub cos_e: R,
    /// Times the square of a length, which is the same for all of a tree; 0: no lights.
    pub intensity: R,
    /// −1 if they shine to both sides of a surface, else 1.
    pub back: R,
}

/// The number of coordinates.
pub(super) const COLUMNS: usize = 12;

/// What the cosine of a difference of two angles may be off by: sines are made from cosines, and √(1 − c²) of a c that is off by 2⁻²³ is
/// off by up to √2⁻²² = 4.9e-4; two of them go into it.
const SLACK: f64 = 1e-3;

/// Cosine and sine of max(0, a − b).
#[inline(always)]
fn lessened<R: Real>((cos_a, sin_a): (R, R), (cos_b, sin_b): (R, R)) -> (R, R) {
    let within = cos_b.le(cos_a);
    (
        R::select(within, R::one(), cos_a * cos_b + sin_a * sin_b),
        R::select(within, R::zero(), sin_a * cos_b - cos_a * sin_b),
    )
}

/// With the sine that belongs to it, of an angle in \[0, π].
#[inline(always)]
fn with_sine<R: Real>(cos: R) -> (R, R) {
    (cos, (R::one() - cos * cos).safe_sqrt())
}

/// A cosine that is to be at least `least`, raised so that what roundings have put below isn't lost.
#[inline(always)]
fn from<R: Real>(cos: R, least: R) -> R {
    let slack = R::lit(SLACK);
    R::select(cos.lt(least - slack), R::zero(), cos.max(slack))
}

impl<R: Real> LightBounds<R> {
    /// Bound on the irradiance at `p`, but for what stands in the way: I · cosθ′ · cosθi′ / d² of Conty Estévez & Kulla 2018, eq. 3.
    ///
    /// - `normal`: of the side that light counts from; zero where it counts from all sides
    ///
    /// With θu the half angle of the sphere as seen from p, θ the angle between the axis and the way from the lights to p, and θi that between
    /// the normal and the way to the lights: θ′ = max(0, θ − θo − θu), θi′ = max(0, θi − θu); 0 from θ′ = θe and θi′ = π/2 on. Within the sphere,
    /// d is its radius and both cosines are 1.
    ///
    /// Never 0 where light arrives, roundings included.
    #[inline(always)]
    pub fn importance(&self, p: Vec3<R>, normal: Vec3<R>) -> R {
        let (zero, one) = (R::zero(), R::one());
        let to = self.centre - p;
        let (d2, r2) = (to.length_squared(), self.radius * self.radius);
        let inverse = d2.max(r2).sqrt().recip();
        let wi = to * inverse;
        // An angle of π is larger than any, whatever its sine.
        let sin_u = self.radius * inverse;
        let cos_u = (one - sin_u * sin_u).safe_sqrt();
        let around = (R::select(r2.lt(d2), cos_u, -one), sin_u);
        let along = -self.axis.dot(wi);
        let along = along.max(along * self.back);
        let off_cone = lessened(with_sine(along), (self.cos_o, self.sin_o));
        let (emitted, _) = lessened(off_cone, around);
        let (received, _) = lessened(with_sine(normal.dot(wi)), around);
        // 1 without a normal, 0 with one.
        let anywhere = (one - normal.length_squared() * R::lit(2.0)).max(zero);
        let received = from(received, zero).max(anywhere);
        self.intensity * from(emitted, self.cos_e) * received * (inverse * inverse)
    }
}

impl LightBounds<f32> {
    /// No lights.
    pub const NONE: Self = Self {
        centre: Vec3::new(0.0, 0.0, 0.0),
        radius: 1.0,
        axis: Vec3::new(0.0, 0.0, 1.0),
        cos_o: -1.0,
        sin_o: 0.0,
        cos_e: 0.0,
        intensity: 0.0,
        back: 1.0,
    };

    pub fn new(
        (centre, radius): (Vec3<f32>, f32),
        cone: &Cone,
        spread: f64,
        intensity: f32,
        both_sides: bool,
    ) -> Self {
        let (cos_o, sin_o) = cone.cos_and_sin();
        Self {
            centre,
            radius,
            axis: cone.axis.to_f32(),
            cos_o,
            sin_o,
            cos_e: Real::cos(spread) as f32,
            intensity,
            back: if both_sides { -1.0 } else { 1.0 },
        }
    }

    pub fn columns(&self) -> [f32; COLUMNS] {
        let (c, a) = (self.centre, self.axis);
        [
            c.x,
            c.y,
            c.z,
            self.radius,
            a.x,
            a.y,
            a.z,
            self.cos_o,
            self.sin_o,
            self.cos_e,
            self.intensity,
            self.back,
        ]
    }
}

impl<R: Real> LightBounds<R> {
    /// The opposite of [`LightBounds::columns`].
    #[inline(always)]
    pub fn from_columns(c: [R; COLUMNS]) -> Self {
        Self {
            centre: Vec3::new(c[0], c[1], c[2]),
            radius: c[3],
            axis: Vec3::new(c[4], c[5], c[6]),
            cos_o: c[7],
            sin_o: c[8],
            cos_e: c[9],
            intensity: c[10],
            back: c[11],
        }
    }
}
