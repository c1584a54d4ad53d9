//! Projected solid angles: ∫ cosθ dω over a shape, the part above the horizon of a surface element.
//!
//! Under uniform radiance L from the shape the element's irradiance is E = L · (projected solid angle) (7); the form
//! factor (view factor) from the element to the shape is the projected solid angle / π. The hemisphere has π.
//!
//! These are reference values, in `f64`. Lengths in one unit; normals unit vectors.

use gonio_num::{Real, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Of a flat polygon with these vertices in order (either turn), from the element at `from` with unit normal `normal`.
///
/// Lambert's formula ½ |Σ γᵢ Γᵢ·n|, γᵢ the angle an edge subtends and Γᵢ the unit normal of its plane through the element.
/// The polygon is first cut at the element's horizon; what is below counts nothing. The polygon is convex, or at least the
/// part above the horizon is one piece. Fewer than three vertices: 0; at most π.
///
/// Source: Lambert 1760, "Photometria"; cut and summed as in Baum, Rushmeier and Winget 1989.
pub fn polygon(vertices: &[Vec3<f64>], from: Vec3<f64>, normal: Vec3<f64>) -> f64 {
    let above = clip(vertices, from, normal);
    let mut sum = 0.0;
    for (i, &a) in above.iter().enumerate() {
        let b = above[(i + 1) % above.len()];
        let cross = a.cross(b);
        let sine = cross.length();
        if sine > 0.0 {
            sum += Real::atan2(sine, a.dot(b)) * cross.dot(normal) / sine;
        }
    }
    0.5 * sum.abs()
}

/// The part of the polygon, relative to `from`, in the half-space of `normal`: Sutherland and Hodgman 1974.
fn clip(vertices: &[Vec3<f64>], from: Vec3<f64>, normal: Vec3<f64>) -> Vec<Vec3<f64>> {
    let mut kept = Vec::with_capacity(vertices.len() + 1);
    for (i, &vertex) in vertices.iter().enumerate() {
        let a = vertex - from;
        let b = vertices[(i + 1) % vertices.len()] - from;
        let (height_a, height_b) = (a.dot(normal), b.dot(normal));
        if height_a >= 0.0 {
            kept.push(a);
        }
        if (height_a < 0.0) != (height_b < 0.0) {
            kept.push(a + (b - a) * (height_a / (height_a - height_b)));
        }
    }
    kept
}

/// Of the rectangle (parallelogram) `corner` + s `edge_x` + t `edge_y`, s and t in [0, 1]: its [`polygon()`].
pub fn rectangle(
    corner: Vec3<f64>,
    edge_x: Vec3<f64>,
    edge_y: Vec3<f64>,
    from: Vec3<f64>,
    normal: Vec3<f64>,
) -> f64 {
    let far = corner + edge_x + edge_y;
    polygon(
        &[corner, corner + edge_x, far, corner + edge_y],
        from,
        normal,
    )
}

/// Of a rectangle of sides `a`, `b` in a plane parallel to the element at `distance` > 0, one corner straight over the
/// element.
///
/// With A = a/d, B = b/d: ½ [A/√(1+A²) atan(B/√(1+A²)) + B/√(1+B²) atan(A/√(1+B²))]. Four such make any rectangle.
///
/// Source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-3.
pub fn rectangle_parallel_at_corner(a: f64, b: f64, distance: f64) -> f64 {
    let slant_a = (distance * distance + a * a).sqrt();
    let slant_b = (distance * distance + b * b).sqrt();
    0.5 * (a / slant_a * Real::atan2(b, slant_a) + b / slant_b * Real::atan2(a, slant_b))
}

/// Of a rectangle in a plane perpendicular to the element: it stands at `distance` > 0 on the element's horizon, one edge
/// of length `width` on that horizon from the foot of the perpendicular, and is `height` high.
///
/// With r² = d² + h²: ½ [atan(w/d) − d/r · atan(w/r)].
///
/// Source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-5.
pub fn rectangle_perpendicular_at_corner(width: f64, height: f64, distance: f64) -> f64 {
    let r = (distance * distance + height * height).sqrt();
    0.5 * (Real::atan2(width, distance) - distance / r * Real::atan2(width, r))
}

/// Of a disk of radius `radius` in a plane parallel to the element at `distance` > 0, its centre `offset` to the side.
///
/// With s = a² + d² + r²: (π/2) [1 − (a² + d² − r²)/√(s² − 4 a² r²)]; on the axis π r²/(r² + d²).
///
/// Source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-13.
pub fn disk_parallel(radius: f64, distance: f64, offset: f64) -> f64 {
    let (r2, d2, a2) = (radius * radius, distance * distance, offset * offset);
    // √(s² − 4a²r²) as a product that doesn't cancel; 1 − p/q = (q² − p²)/(q (q + p)) where p > 0.
    let q = ((d2 + (offset - radius).powi(2)) * (d2 + (offset + radius).powi(2))).sqrt();
    let p = a2 + d2 - r2;
    if q == 0.0 {
        return 0.0;
    }
    let share = if p > 0.0 {
        4.0 * r2 * d2 / (q * (q + p))
    } else {
        1.0 - p / q
    };
    FRAC_PI_2 * share
}

/// Of a sphere of radius `radius` > 0 whose centre is at `distance` ≥ `radius` in a direction at the angle of cosine
/// `cos_centre` from the element's normal; the part below the horizon counts nothing.
///
/// Wholly above the horizon π (r/d)² cosβ. Cut by it, with h = d/r, x = √(h² − 1), y = −x cotβ:
/// (cosβ acos y − x sinβ √(1 − y²))/h² + atan(sinβ √(1 − y²)/x). From inside the sphere: π.
///
/// Source: Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", B-43.
pub fn sphere(radius: f64, distance: f64, cos_centre: f64) -> f64 {
    if distance < radius {
        return PI;
    }
    let cos = cos_centre.clamp(-1.0, 1.0);
    let s = radius / distance;
    if cos >= s {
        return PI * s * s * cos;
    }
    if cos <= -s {
        return 0.0;
    }
    let sin = ((1.0 - cos) * (1.0 + cos)).sqrt();
    let x = ((1.0 - s) * (1.0 + s)).sqrt() / s;
    let y = (-x * cos / sin).clamp(-1.0, 1.0);
    let root = sin * ((1.0 - y) * (1.0 + y)).sqrt();
    s * s * (cos * Real::acos(y) - x * root) + Real::atan2(root, x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quadrature::{Tolerance, adaptive};
    use crate::solid_angle::jacobian::solid_angle_per_area;
    use gonio_num::Frame;
    use proptest::prelude::*;

    /// ∫ max(cosθ, 0) dω over the parallelogram by quadrature over its area.
    fn by_area(corner: Vec3<f64>, ex: Vec3<f64>, ey: Vec3<f64>, normal: Vec3<f64>) -> f64 {
        let across = ex.cross(ey);
        let (area, face) = (across.length(), across.normalize());
        let tolerance = Tolerance {
            absolute: 1e-7,
            ..Tolerance::default()
        };
        let integral = adaptive::rectangle([0.0, 0.0], [1.0, 1.0], &tolerance, |[s, t]| {
            let p = corner + ex * s + ey * t;
            let cos = (p.dot(normal) / p.length()).max(0.0);
            [cos * area * solid_angle_per_area(p, face)]
        });
        assert!(integral.converged);
        integral.value[0]
    }

    #[test]
    fn rectangles_agree_with_the_polygon() {
        let (a, b, d) = (0.7, 1.9, 1.2);
        let up = Vec3::new(0.0, 0.0, 1.0);
        let parallel = rectangle(
            Vec3::new(0.0, 0.0, d),
            Vec3::new(a, 0.0, 0.0),
            Vec3::new(0.0, b, 0.0),
            Vec3::zero(),
            up,
        );
        assert!((parallel - rectangle_parallel_at_corner(a, b, d)).abs() < 1e-14);
        let standing = rectangle(
            Vec3::new(d, 0.0, 0.0),
            Vec3::new(0.0, a, 0.0),
            Vec3::new(0.0, 0.0, b),
            Vec3::zero(),
            up,
        );
        assert!((standing - rectangle_perpendicular_at_corner(a, b, d)).abs() < 1e-14);
        // Four huge corners overhead are the whole hemisphere.
        let quarter = rectangle_parallel_at_corner(1e9, 1e9, 1.0);
        assert!((4.0 * quarter - PI).abs() < 1e-8);
    }

    #[test]
    fn a_polygon_through_the_horizon_counts_above_only() {
        let (corner, ex) = (Vec3::new(1.0, -1.0, -0.8), Vec3::new(0.0, 2.0, 0.0));
        let (ey, up) = (Vec3::new(0.3, 0.0, 2.0), Vec3::new(0.0, 0.0, 1.0));
        let found = rectangle(corner, ex, ey, Vec3::zero(), up);
        assert!((found - by_area(corner, ex, ey, up)).abs() < 1e-6);
        assert_eq!(rectangle(corner, ex, ey, Vec3::zero() + up * 5.0, up), 0.0);
        assert_eq!(polygon(&[], Vec3::zero(), up), 0.0);
    }

    #[test]
    fn a_disk_is_a_polygon_of_many_corners() {
        let up = Vec3::new(0.0, 0.0, 1.0);
        for (r, d, a) in [(1.0, 2.0, 0.0), (1.0, 0.5, 0.7), (2.0, 1.0, 5.0)] {
            let n = 4000;
            let rim: Vec<_> = (0..n)
                .map(|i| {
                    let phi = 2.0 * PI * f64::from(i) / f64::from(n);
                    Vec3::new(a + r * Real::cos(phi), r * Real::sin(phi), d)
                })
                .collect();
            // A polygon of n corners lacks about 2π²/(3n²) of the disk's area: 4e-7.
            let found = disk_parallel(r, d, a);
            assert!((polygon(&rim, Vec3::zero(), up) / found - 1.0).abs() < 1e-6);
        }
        assert!((disk_parallel(1.0, 2.0, 0.0) - PI / 5.0).abs() < 1e-15);
        assert_eq!(disk_parallel(0.0, 1.0, 3.0), 0.0);
        // In the disk's plane, inside it: everything above; outside: nothing.
        assert!((disk_parallel(1.0, 0.0, 0.5) - PI).abs() < 1e-15);
        assert_eq!(disk_parallel(1.0, 0.0, 1.5), 0.0);
    }

    #[test]
    fn a_sphere_through_the_horizon_is_its_cap_above() {
        for (r, d, cos) in [
            (1.0, 2.0, 0.8),
            (1.0, 2.0, 0.3),
            (1.0, 2.0, 0.0),
            (1.0, 2.0, -0.3),
            (1.0, 1.01, 0.5),
            (1.0, 1.01, -0.9),
        ] {
            // Over the cone of directions that hit the sphere, uniform in height and azimuth.
            let s: f64 = r / d;
            let height = s * s / (1.0 + (1.0 - s * s).sqrt());
            let axis = Vec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
            let frame = Frame::from_normal(axis);
            let tolerance = Tolerance {
                absolute: 1e-6,
                ..Tolerance::default()
            };
            let integral = adaptive::rectangle([0.0, 0.0], [1.0, 1.0], &tolerance, |u| {
                let w = frame.to_world(crate::warp::uniform_cap(u, height));
                [w.z.max(0.0) * 2.0 * PI * height]
            });
            let found = sphere(r, d, cos);
            assert!((found - integral.value[0]).abs() < 1e-5, "{r} {d} {cos}");
        }
        assert_eq!(sphere(1.0, 2.0, -0.6), 0.0);
        assert_eq!(sphere(1.0, 0.5, 0.1), PI);
        assert!((sphere(1.0, 1.0, 1.0) - PI).abs() < 1e-15);
        assert!(sphere(1.0, 1.0, -1.0).abs() < 1e-15);
        // Continuous where the horizon begins to cut, on both sides.
        for edge in [0.5, -0.5] {
            let jump: f64 = sphere(1.0, 2.0, edge + 1e-9) - sphere(1.0, 2.0, edge - 1e-9);
            assert!(jump.abs() < 1e-8);
        }
    }

    proptest! {
        #[test]
        fn the_parts_of_a_polygon_add_up(
            x in -2.0..2.0f64, y in -2.0..2.0f64, z in -2.0..2.0f64, t in 0.1..0.9f64, tilt in 0.0..3.1f64,
        ) {
            let normal = Vec3::new(Real::sin(tilt), 0.0, Real::cos(tilt));
            let (corner, ex, ey) = (Vec3::new(x, y, z), Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.0, 1.0, 0.7));
            prop_assume!(corner.dot(ex.cross(ey)).abs() > 1e-3);
            let from = Vec3::zero();
            let whole = rectangle(corner, ex, ey, from, normal);
            let parts = rectangle(corner, ex * t, ey, from, normal)
                + rectangle(corner + ex * t, ex * (1.0 - t), ey, from, normal);
            prop_assert!((whole - parts).abs() < 1e-12);
            prop_assert!((0.0..=PI).contains(&whole));
        }
    }
}
