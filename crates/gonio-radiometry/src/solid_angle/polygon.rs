//! Solid angles of triangles, rectangles and polygons.

use gonio_num::{Real, Vec3};

/// The solid angle (sr) of the spherical triangle with unit vertices, in [0, 2π], whichever way it turns.
///
/// tan(Ω/2) = |det(a, b, c)| / (1 + a·b + b·c + c·a)
///
/// The determinant is taken from differences of vertices, so that tiny triangles keep their digits; half-space triangles
/// and beyond have a negative denominator, which the two-argument arctangent knows. Degenerate triangles: 0 (2π for three
/// vertices on a great circle that go round it).
///
/// Source: Van Oosterom and Strackee 1983, "The Solid Angle of a Plane Triangle", eq. 8.
#[inline(always)]
pub fn triangle<R: Real>(triangle: [Vec3<R>; 3]) -> R {
    signed_triangle(triangle).abs()
}

/// As [`triangle`], with the sign of det(a, b, c).
#[inline(always)]
fn signed_triangle<R: Real>([a, b, c]: [Vec3<R>; 3]) -> R {
    let det = a.dot((b - a).cross(c - a));
    let denominator = R::one() + a.dot(b) + b.dot(c) + c.dot(a);
    R::lit(2.0) * det.atan2(denominator)
}

/// The solid angle (sr) of the flat triangle with these vertices seen from `from`, in [0, 2π]. A vertex at `from` counts as
/// lying nowhere: the result is then not a solid angle, but finite.
#[inline(always)]
pub fn triangle_from<R: Real>(vertices: [Vec3<R>; 3], from: Vec3<R>) -> R {
    let [a, b, c] = vertices;
    triangle([
        unit_or_zero(a - from),
        unit_or_zero(b - from),
        unit_or_zero(c - from),
    ])
}

/// The solid angle (sr) of the flat rectangle `corner` + s `edge_x` + t `edge_y`, s and t in [0, 1], seen from `from`, in
/// [0, 2π]: its two triangles. The edges need not be perpendicular (a parallelogram).
///
/// [`SphericalRectangle`](crate::warp::SphericalRectangle) samples it.
#[inline(always)]
pub fn rectangle<R: Real>(corner: Vec3<R>, edge_x: Vec3<R>, edge_y: Vec3<R>, from: Vec3<R>) -> R {
    let a = unit_or_zero(corner - from);
    let b = unit_or_zero(corner + edge_x - from);
    let c = unit_or_zero(corner + edge_x + edge_y - from);
    let d = unit_or_zero(corner + edge_y - from);
    triangle([a, b, c]) + triangle([a, c, d])
}

/// The solid angle (sr) of the spherical polygon with these unit vertices, in order: the signed sum of a fan of triangles,
/// so the polygon need not be convex. Fewer than three vertices: 0.
///
/// The polygon must lie in an open half-space of the first vertex (no vertex opposite to it), and not cross itself.
pub fn polygon<R: Real>(vertices: &[Vec3<R>]) -> R {
    let mut sum = R::zero();
    if let [first, rest @ ..] = vertices {
        for side in rest.windows(2) {
            sum = sum + signed_triangle([*first, side[0], side[1]]);
        }
    }
    sum.abs()
}

/// `v` scaled to length 1; a zero vector stays zero.
#[inline(always)]
fn unit_or_zero<R: Real>(v: Vec3<R>) -> Vec3<R> {
    v * v.length().max(R::lit(1e-37)).recip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::Rng;
    use crate::warp::uniform_sphere;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI, TAU};

    fn axis(i: usize) -> Vec3<f64> {
        let mut v = [0.0; 3];
        v[i] = 1.0;
        v.into()
    }

    #[test]
    fn an_octant_is_half_pi_either_way_round() {
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        assert!((triangle([x, y, z]) - FRAC_PI_2).abs() < 1e-15);
        assert!((triangle([x, z, y]) - FRAC_PI_2).abs() < 1e-15);
        assert!((triangle_from([x * 3.0, y * 5.0, z], Vec3::zero()) - FRAC_PI_2).abs() < 1e-15);
    }

    #[test]
    fn a_tetrahedrons_faces_make_the_sphere() {
        let corners = [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0],
        ]
        .map(|v| Vec3::from(v).normalize());
        let each = triangle([corners[0], corners[1], corners[2]]);
        assert!((each - PI).abs() < 1e-14);
    }

    /// Wide around +z: the three vertices just above the horizon bound all but a ring of the hemisphere.
    #[test]
    fn nearly_a_hemisphere_is_nearly_two_pi() {
        let at = |phi: f64, z: f64| {
            let s = (1.0 - z * z).sqrt();
            Vec3::new(s * Real::cos(phi), s * Real::sin(phi), z)
        };
        let wide = |z| triangle([at(0.0, z), at(TAU / 3.0, z), at(2.0 * TAU / 3.0, z)]);
        assert!(wide(1e-6) < TAU && wide(1e-6) > TAU - 2e-5);
        assert_eq!(wide(0.0), TAU);
    }

    /// A tiny triangle is flat: Ω → A, with a relative error of the order of its area.
    #[test]
    fn tiny_triangles_keep_their_digits() {
        for size in [1e-3, 1e-6, 1e-9, 1e-12] {
            let a = axis(2);
            let b = Vec3::new(size, 0.0, 1.0).normalize();
            let c = Vec3::new(0.0, size, 1.0).normalize();
            let ratio = triangle([a, b, c]) / (0.5 * size * size);
            assert!((ratio - 1.0).abs() < size * size + 1e-15, "{size}: {ratio}");
        }
        // The same in single precision, where 1 − cos would be 0.
        let size = 1e-5f32;
        let corner = |x: f32, y: f32| Vec3::new(x, y, 1.0f32).normalize();
        let ratio = triangle([corner(0.0, 0.0), corner(size, 0.0), corner(0.0, size)])
            / (0.5 * size * size);
        assert!((ratio - 1.0).abs() < 1e-5);
    }

    #[test]
    fn degenerate_triangles_are_nothing() {
        let (x, y) = (axis(0), axis(1));
        assert_eq!(triangle([x, x, y]), 0.0);
        assert_eq!(triangle([x, x, x]), 0.0);
        assert!(triangle_from([Vec3::zero(), x, y], Vec3::zero()).is_finite());
    }

    #[test]
    fn a_cubes_faces_make_the_sphere_from_any_inner_point() {
        let from = Vec3::new(0.3, -0.7, 0.45);
        let mut sum = 0.0;
        for i in 0..3 {
            let (s, t) = (axis((i + 1) % 3) * 2.0, axis((i + 2) % 3) * 2.0);
            let low = Vec3::splat(-1.0);
            sum += rectangle(low, s, t, from) + rectangle(low + axis(i) * 2.0, s, t, from);
        }
        assert!((sum - 4.0 * PI).abs() < 1e-13);
    }

    #[test]
    fn a_concave_polygon_is_what_its_triangles_leave() {
        let corner = |x: f64, y: f64| Vec3::new(x, y, 1.0).normalize();
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(|(x, y)| corner(x, y));
        let notch = corner(0.5, 0.3);
        let concave = [square[0], notch, square[1], square[2], square[3]];
        let expected = polygon(&square) - triangle([square[0], notch, square[1]]);
        assert!((polygon(&concave) - expected).abs() < 1e-15);
        assert_eq!(polygon(&square[..2]), 0.0);
        assert_eq!(polygon::<f64>(&[]), 0.0);
    }

    /// Monte Carlo: the share of uniform directions inside, within 5 standard deviations (one in two million).
    #[test]
    fn the_share_of_directions_inside_is_the_solid_angle() {
        let mut rng = Rng::from_name("the_share_of_directions_inside_is_the_solid_angle");
        for _ in 0..8 {
            let [a, b, c] = [0; 3].map(|_| uniform_sphere([rng.next_f64(), rng.next_f64()]));
            let sign = a.dot(b.cross(c)).signum();
            let n = 20_000;
            let inside = (0..n)
                .filter(|_| {
                    let w = uniform_sphere([rng.next_f64(), rng.next_f64()]);
                    [(a, b), (b, c), (c, a)]
                        .iter()
                        .all(|(p, q)| w.dot(p.cross(*q)) * sign >= 0.0)
                })
                .count() as f64;
            let share = triangle([a, b, c]) / (4.0 * PI);
            let sigma = (share * (1.0 - share) * f64::from(n)).sqrt();
            assert!((inside - share * f64::from(n)).abs() < 5.0 * sigma + 1.0);
            // The negative control: a solid angle half as large again must be seen to be wrong, where 20 000 directions
            // can tell (half of 1000 is 15 standard deviations).
            let wrong = 1.5 * share * f64::from(n);
            assert!(share < 0.05 || (inside - wrong).abs() > 5.0 * sigma);
        }
    }

    proptest! {
        #[test]
        fn splitting_a_triangle_keeps_its_solid_angle(
            u in prop::array::uniform6(0.001..0.999f64), t in 0.01..0.99f64,
        ) {
            let a = uniform_sphere([u[0], u[1]]);
            let b = uniform_sphere([u[2], u[3]]);
            let c = uniform_sphere([u[4], u[5]]);
            prop_assume!(a.dot(b) > -0.99 && b.dot(c) > -0.99 && c.dot(a) > -0.99);
            let m = (b * (1.0 - t) + c * t).normalize();
            let whole = triangle([a, b, c]);
            let parts = triangle([a, b, m]) + triangle([a, m, c]);
            prop_assert!((whole - parts).abs() < 1e-12);
        }
    }
}
