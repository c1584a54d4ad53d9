//! Flat rectangles, uniform by the solid angle they subtend: the directions to a rectangular light.

use gonio_num::{Real, Vec3};

/// A rectangle as seen from a point, with a map of the unit square onto it that is uniform by solid angle.
///
/// Along the first edge, the solid angle of the strip [x₀, x] is A(x) − A(x₀), where A(x) = asin(c h₁) − asin(c h₀),
/// c = x/√(x² + z²) and hᵢ = yᵢ/√(yᵢ² + z²); inverted, c = sin A / √(h₀² + h₁² − 2 h₀ h₁ cos A). Within the line of that x,
/// y/√(x² + y² + z²) is uniform.
///
/// Source: Ureña, Fajardo and King 2013, "An Area-Preserving Parametrization for Spherical Rectangles". The formulas here
/// are rearranged so that differences of nearly equal angles are never taken: in `f32` points are good to a few roundings of
/// the distance, and to 6e-8 (x/z)² of it towards the horizon of a rectangle much wider than it is far.
///
/// ```
/// use gonio_num::Vec3;
/// use gonio_radiometry::warp::SphericalRectangle;
/// // The face of a cube seen from the centre: a sixth of the sphere.
/// let face = SphericalRectangle::new(
///     Vec3::new(-1.0, -1.0, 1.0), Vec3::new(2.0, 0.0, 0.0), Vec3::new(0.0, 2.0, 0.0), Vec3::zero(),
/// );
/// assert!((face.solid_angle() - 4.0 * std::f64::consts::PI / 6.0).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SphericalRectangle<R: Real> {
    from: Vec3<R>,
    /// Unit axes along the edges and across the plane, away from the point.
    x_axis: Vec3<R>,
    y_axis: Vec3<R>,
    z_axis: Vec3<R>,
    /// The rectangle is [x0, x1] × [y0, y1] at distance z > 0 in these axes.
    x0: R,
    x1: R,
    y0: R,
    y1: R,
    z: R,
    /// Sines of the elevations of y0 and y1 over the x axis, and their difference.
    h0: R,
    h1: R,
    h_difference: R,
    /// A(x0), and the solid angle A(x1) − A(x0).
    a0: R,
    solid_angle: R,
}

impl<R: Real> SphericalRectangle<R> {
    /// The rectangle `corner` + s `edge_x` + t `edge_y`, s and t in [0, 1], seen from `from`. Lengths in one unit.
    ///
    /// - `edge_x`, `edge_y`: perpendicular, neither zero
    ///
    /// From a point in the rectangle's plane the distance counts as 1e-6 of the longer edge: the solid angle is then that of
    /// a point just off the plane.
    #[inline(always)]
    pub fn new(corner: Vec3<R>, edge_x: Vec3<R>, edge_y: Vec3<R>, from: Vec3<R>) -> Self {
        let (width, height) = (edge_x.length(), edge_y.length());
        let x_axis = edge_x / width;
        let y_axis = edge_y / height;
        let normal = x_axis.cross(y_axis);
        let to = corner - from;
        let distance = to.dot(normal);
        let z_axis = normal * R::one().copysign(distance);
        let z = distance.abs().max(width.max(height) * R::lit(1e-6));
        let (x0, y0) = (to.dot(x_axis), to.dot(y_axis));
        let (x1, y1) = (x0 + width, y0 + height);
        let (r0, r1) = ((y0 * y0 + z * z).sqrt(), (y1 * y1 + z * z).sqrt());
        let (h0, h1) = (y0 / r0, y1 / r1);
        // Of the same sign: (h1² − h0²)/(h1 + h0), with y1² − y0² as a product.
        let same_side = R::zero().lt(y0 * y1);
        let sum = R::select(same_side, h0 + h1, R::one());
        let scale = z / (r0 * r1);
        let h_difference = R::select(same_side, scale * scale * height * (y0 + y1) / sum, h1 - h0);
        let mut rectangle = Self {
            from,
            x_axis,
            y_axis,
            z_axis,
            x0,
            x1,
            y0,
            y1,
            z,
            h0,
            h1,
            h_difference,
            a0: R::zero(),
            solid_angle: R::zero(),
        };
        rectangle.a0 = rectangle.strip(x0);
        rectangle.solid_angle = (rectangle.strip(x1) - rectangle.a0).max(R::zero());
        rectangle
    }

    /// A(x): the solid angle of [0, x] × [y0, y1], signed as x, in (−π, π).
    #[inline(always)]
    fn strip(&self, x: R) -> R {
        let Self { h0, h1, z, .. } = *self;
        let across2 = x * x + z * z;
        let c = x / across2.sqrt();
        let q0 = self.cosine(across2, self.y0);
        let q1 = self.cosine(across2, self.y1);
        // sin(α1 − α0) = c (h1 q0 − h0 q1), which for h of one sign is c (h1² − h0²)/(h1 q0 + h0 q1).
        let same_side = R::zero().lt(h0 * h1);
        let sum = R::select(same_side, h1 * q0 + h0 * q1, R::one());
        let difference = R::select(
            same_side,
            self.h_difference * (h0 + h1) / sum,
            h1 * q0 - h0 * q1,
        );
        (c * difference).atan2(q0 * q1 + c * c * h0 * h1)
    }

    /// √(1 − c²h²) = z √(x² + y² + z²) / √((x² + z²)(y² + z²)).
    #[inline(always)]
    fn cosine(&self, across2: R, y: R) -> R {
        let z = self.z;
        z * ((across2 + y * y) / (across2 * (y * y + z * z))).sqrt()
    }

    /// The solid angle that the rectangle subtends (sr), in [0, 2π].
    #[inline(always)]
    pub fn solid_angle(&self) -> R {
        self.solid_angle
    }

    /// A point of the rectangle whose direction from the point of view is uniform by solid angle.
    #[inline(always)]
    pub fn sample(&self, u: [R; 2]) -> Vec3<R> {
        let Self { h0, h1, z, .. } = *self;
        let (sin_a, cos_a) = (self.a0 + u[0] * self.solid_angle).sin_cos();
        // h0² + h1² − 2 h0 h1 cos A = (h1 − h0)² + 2 h0 h1 (1 − cos A), with 1 − cos A = sin²A / (1 + cos A).
        let near = R::zero().lt(cos_a);
        let versine = R::select(
            near,
            sin_a * sin_a / R::select(near, R::one() + cos_a, R::one()),
            R::one() - cos_a,
        );
        let d = self.h_difference;
        let norm2 = d * d + R::lit(2.0) * h0 * h1 * versine;
        let tiny = R::lit(1e-37);
        let rest = (norm2 - sin_a * sin_a).max(tiny);
        let x = (z * sin_a / rest.sqrt()).clamp(self.x0, self.x1);

        let across2 = x * x + z * z;
        let (g0, g1) = (self.rise(across2, self.y0), self.rise(across2, self.y1));
        let g = u[1].lerp(g0, g1);
        let level = ((R::one() - g) * (R::one() + g)).max(tiny);
        let y = (g * (across2 / level).sqrt()).clamp(self.y0, self.y1);
        self.from + self.x_axis * x + self.y_axis * y + self.z_axis * z
    }

    /// y/√(x² + y² + z²).
    #[inline(always)]
    fn rise(&self, across2: R, y: R) -> R {
        y / (across2 + y * y).sqrt()
    }

    /// Density of the direction to [`sample`](Self::sample) (sr⁻¹): 1/Ω for a point of the rectangle.
    #[inline(always)]
    pub fn density(&self) -> R {
        self.solid_angle.max(R::lit(1e-37)).recip()
    }

    /// The u in [0, 1]² that [`sample`](Self::sample) maps to the point `p` of the rectangle.
    #[inline(always)]
    pub fn inverse(&self, p: Vec3<R>) -> [R; 2] {
        let to = p - self.from;
        let x = to.dot(self.x_axis).clamp(self.x0, self.x1);
        let y = to.dot(self.y_axis).clamp(self.y0, self.y1);
        let tiny = R::lit(1e-37);
        let u0 = (self.strip(x) - self.a0) / self.solid_angle.max(tiny);
        let across2 = x * x + self.z * self.z;
        let (g0, g1) = (self.rise(across2, self.y0), self.rise(across2, self.y1));
        let u1 = (self.rise(across2, y) - g0) / (g1 - g0).max(tiny);
        [u0.saturate(), u1.saturate()]
    }
}
