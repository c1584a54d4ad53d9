//! Spherical triangles, uniform by solid angle: the directions to a triangular light.

use crate::solid_angle;
use gonio_num::{Real, Vec3};

/// A direction of the spherical triangle with unit vertices a, b, c, uniform by solid angle.
///
/// Arvo's construction: the point c′ of the side a–c with Ω(a, b, c′) = u₀ Ω, then a point of the arc from b to c′, uniform by
/// height over b. Here c′ comes from tan(Ω/2) = det(a, b, c′) / (1 + a·b + b·c′ + c′·a), which is linear in the tangent of
/// half the angle from a to c′; with differences of vertices instead of differences of angles it holds for tiny
/// triangles (in `f32` down to the rounding of the vertices) and for ones up to a hemisphere.
///
/// - `triangle`: unit vectors in either order of turning, no two opposite
///
/// A triangle without area gives one of its vertices. Sources: Arvo 1995, "Stratified Sampling of Spherical Triangles";
/// the tangent: Van Oosterom and Strackee 1983.
#[inline(always)]
pub fn spherical_triangle<R: Real>(u: [R; 2], triangle: [Vec3<R>; 3]) -> Vec3<R> {
    let [a, b, _] = triangle;
    let side = Side::new(triangle);
    let half_area = u[0] * R::lit(0.5) * solid_angle::triangle(triangle);
    let (sin, cos) = half_area.sin_cos();
    // tan(t/2) = n / m for the angle t from a to c′.
    let n = sin * side.one_plus_ab;
    let m = side.det * cos - sin * side.b_along;
    let norm = n * n + m * m;
    let flat = norm.le(R::lit(1e-37));
    let inverse = R::select(flat, R::one(), norm).recip();
    let cos_t = R::select(flat, R::one(), (m * m - n * n) * inverse);
    let sin_t = R::select(flat, R::zero(), R::lit(2.0) * n * m * inverse);
    let c = a * cos_t + side.along * sin_t;

    // 1 − b·c′ from the chord; the direction from b to c′ across b.
    let chord = c - b;
    let height = R::lit(0.5) * chord.length_squared();
    let across = chord + b * height;
    let length2 = across.length_squared();
    let across = across * length2.max(R::lit(1e-37)).sqrt().recip();
    let below = u[1] * height;
    let sin = (below * (R::lit(2.0) - below)).safe_sqrt();
    b * (R::one() - below) + across * sin
}

/// Density of [`spherical_triangle`] at the unit direction `w` (sr⁻¹): 1/Ω inside, 0 outside and for a triangle without
/// area. Whoever knows that w is inside needs only [`solid_angle::triangle`].
#[inline(always)]
pub fn spherical_triangle_density<R: Real>(w: Vec3<R>, triangle: [Vec3<R>; 3]) -> R {
    let [a, b, c] = triangle;
    let turn = det(a, b, c);
    let sign = R::one().copysign(turn);
    let inside = R::zero().le(det(a, b, w) * sign)
        & R::zero().le(det(b, c, w) * sign)
        & R::zero().le(det(c, a, w) * sign);
    let omega = solid_angle::triangle(triangle);
    let sized = R::zero().lt(omega);
    let density = R::select(sized, omega, R::one()).recip();
    R::select(inside & sized, density, R::zero())
}

/// The u in [0, 1]² that [`spherical_triangle`] maps to `w`; u₀ is unspecified at w = b.
#[inline(always)]
pub fn spherical_triangle_inverse<R: Real>(w: Vec3<R>, triangle: [Vec3<R>; 3]) -> [R; 2] {
    let [a, b, c] = triangle;
    let tiny = R::lit(1e-37);
    let side = Side::new(triangle);
    let sign = R::one().copysign(det(a, b, c));
    // c′ = a cos t + e sin t lies in the plane of b and w, whose normal is b × w.
    let normal = b.cross(w - b);
    let sin_t = (normal.dot(a - b) * sign).max(R::zero());
    let cos_t = -(normal.dot(side.along) * sign);
    let length = (sin_t * sin_t + cos_t * cos_t).max(tiny).sqrt();
    let (sin_t, cos_t) = (sin_t / length, cos_t / length);
    let denominator = side.one_plus_ab * (R::one() + cos_t) + sin_t * side.b_along;
    let area = R::lit(2.0) * (sin_t * side.det).atan2(denominator);
    let u0 = area / solid_angle::triangle(triangle).max(tiny);

    let c = a * cos_t + side.along * sin_t;
    let u1 = (w - b).length_squared() / (c - b).length_squared().max(tiny);
    [u0.saturate(), u1.saturate()]
}

/// The side a–c as seen from b: c′ = a cos t + `along` sin t.
struct Side<R: Real> {
    /// Unit, across a, towards c.
    along: Vec3<R>,
    /// |det(a, b, along)|.
    det: R,
    /// b · along.
    b_along: R,
    /// 1 + a·b.
    one_plus_ab: R,
}

impl<R: Real> Side<R> {
    #[inline(always)]
    fn new([a, b, c]: [Vec3<R>; 3]) -> Self {
        let half = R::lit(0.5);
        let chord = c - a;
        let along = chord + a * (half * chord.length_squared());
        let along = along * along.length_squared().max(R::lit(1e-37)).sqrt().recip();
        let ab = b - a;
        Self {
            along,
            det: a.dot(ab.cross(along)).abs(),
            b_along: ab.dot(along),
            one_plus_ab: R::lit(2.0) - half * ab.length_squared(),
        }
    }
}

/// det(a, b, c), from the edges that leave a.
#[inline(always)]
fn det<R: Real>(a: Vec3<R>, b: Vec3<R>, c: Vec3<R>) -> R {
    a.dot((b - a).cross(c - a))
}
