//! Domains from tiny to huge, in single precision against double.

use super::*;
use crate::warp::*;
use gonio_num::Real;

fn to_f32(u: [f64; 2]) -> [f32; 2] {
    u.map(|x| x as f32)
}

/// The farthest that single precision strays from double over random u, and whether all is finite.
fn strays(
    name: &str,
    single: impl Fn([f32; 2]) -> Vec3<f32>,
    double: impl Fn([f64; 2]) -> Vec3<f64>,
) -> f64 {
    squares(name, 2000)
        .map(|u| {
            let u = to_f32(u);
            let w = single(u);
            assert!(w.is_finite(), "{name} at {u:?}");
            (w.to_f64() - double(u.map(f64::from))).length()
        })
        .fold(0.0, f64::max)
}

/// A triangle of relative size s seen in single precision: the sample is off by roundings of unit vectors (6e-8 each), never
/// by a multiple of the triangle.
#[test]
fn spherical_triangles_of_every_size() {
    for size in [1.0f32, 0.1, 1e-2, 1e-3, 1e-4] {
        let at = |x: f32, y: f32| Vec3::new(0.2 + size * x, -0.4 + size * y, 0.9).normalize();
        let triangle = [at(0.0, 0.0), at(1.0, 0.1), at(0.3, 0.8)];
        let exact = triangle.map(Vec3::to_f64);
        let off = strays(
            "spherical_triangles_of_every_size",
            |u| spherical_triangle(u, triangle),
            |u| spherical_triangle(u, exact),
        );
        assert!(off < 1e-6, "size {size}: {off}");
        for u in squares("spherical_triangles_of_every_size", 500) {
            let w = spherical_triangle(to_f32(u), triangle);
            let back = spherical_triangle_inverse(w, triangle);
            // One rounding of the direction, relative to the size, magnified by 1/u₁ towards the vertex b.
            let allowed = 1e-6 + 4e-7 / f64::from(size) / u[1].max(1e-3).sqrt().min(1.0).powi(2);
            let moved = (f64::from(back[0]) - u[0])
                .abs()
                .max((f64::from(back[1]) - u[1]).abs());
            assert!(moved < 4.0 * allowed, "size {size} {u:?}: {moved}");
        }
    }
}

#[test]
fn triangles_without_area_give_a_vertex() {
    let (a, b) = (Vec3::new(0.6f32, 0.0, 0.8), Vec3::new(0.0f32, 0.6, 0.8));
    for triangle in [[a, a, a], [a, b, a], [a, b, b], [a, a, b]] {
        let w = spherical_triangle([0.3, 0.6], triangle);
        assert!(w.is_finite() && (w.length() - 1.0).abs() < 1e-6);
        assert_eq!(spherical_triangle_density(w, triangle), 0.0);
        assert!(
            spherical_triangle_inverse(w, triangle)
                .iter()
                .all(|x| x.is_finite())
        );
    }
}

#[test]
fn spherical_rectangles_of_every_size() {
    for size in [100.0f32, 1.0, 0.1, 1e-2, 1e-3] {
        let (low, from) = (Vec3::new(0.4f32, -0.3, 1.1), Vec3::zero());
        let (ex, ey) = (Vec3::new(size, 0.0, 0.0), Vec3::new(0.0, 0.7 * size, 0.0));
        let single = SphericalRectangle::new(low, ex, ey, from);
        let double = SphericalRectangle::new(low.to_f64(), ex.to_f64(), ey.to_f64(), from.to_f64());
        let off = strays(
            "spherical_rectangles_of_every_size",
            |u| single.sample(u).normalize(),
            |u| double.sample(u).normalize(),
        );
        // A few roundings of 6e-8. Towards the horizon 1 − c² ≈ (z/x)² is a difference of numbers near 1: 6e-8 (x/z)².
        let allowed = if size > 1.0 { 1e-3 } else { 2e-6 };
        assert!(off < allowed, "size {size}: {off}");
        let ratio = f64::from(single.solid_angle()) / double.solid_angle();
        // A(x1) − A(x0) loses what the strips have in common.
        assert!(
            (ratio - 1.0).abs() < 1e-6 + 5e-7 / f64::from(size),
            "size {size}: {ratio}"
        );
    }
}

#[test]
fn a_rectangle_seen_from_its_plane_is_finite() {
    for from in [
        Vec3::new(3.0f32, 0.2, 0.0),
        Vec3::new(0.5, 0.5, 0.0),
        Vec3::zero(),
    ] {
        let unit = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(0.0, 1.0, 0.0)];
        let seen = SphericalRectangle::new(Vec3::zero(), unit[0], unit[1], from);
        assert!(seen.solid_angle() >= 0.0 && seen.density().is_finite());
        for u in squares("a_rectangle_seen_from_its_plane_is_finite", 100) {
            let p = seen.sample(to_f32(u));
            assert!(p.is_finite() && seen.inverse(p).iter().all(|x| x.is_finite()));
        }
    }
}

/// What lies across the axis.
fn flat<R: Real>(w: Vec3<R>) -> Vec3<R> {
    Vec3::new(w.x, w.y, R::zero())
}

/// A cap of 6e-9 sr: the sines keep their digits, though every cosine rounds to 1.
#[test]
fn narrow_cones_and_lobes_keep_their_digits() {
    let height = 1e-9f32;
    let off = strays(
        "narrow cap",
        |u| flat(uniform_cap(u, height)),
        |u| flat(uniform_cap(u, height.into())),
    );
    assert!(off < 1e-6 * f64::from(height).sqrt() * 1.5, "{off}");
    for p in [10.0f32, 1e3, 1e5, 1e7] {
        let off = strays(
            "narrow lobe",
            |u| cosine_power_hemisphere(u, p),
            |u| cosine_power_hemisphere(u, p.into()),
        );
        // A few roundings of the azimuth (|2π| · 6e-8) and of the radius, which is about √(2·17/p) at most, and of z.
        let radius = (34.0 / f64::from(p)).sqrt().min(1.0);
        assert!(off < 2e-6 * radius + 1e-7, "{p}: {off}");
        for u in squares("narrow lobe", 500) {
            let w = cosine_power_hemisphere(to_f32(u), p);
            let exact = cosine_power_hemisphere_density(w.to_f64(), f64::from(p));
            let found = f64::from(cosine_power_hemisphere_density(w, p));
            if exact > 1e-3 {
                // (p + 1) ln cosθ is at most about 17, rounded to some 1e-7 of itself.
                assert!(
                    (found / exact - 1.0).abs() < 1e-4,
                    "{p} {u:?}: {found} {exact}"
                );
            }
            let back = cosine_power_hemisphere_inverse(w, p);
            assert!((f64::from(back[0]) - u[0]).abs() < 1e-5);
        }
    }
}

/// Single precision agrees with double everywhere else.
#[test]
fn single_precision_agrees_with_double() {
    let name = "single_precision_agrees_with_double";
    assert!(strays(name, uniform_sphere, uniform_sphere) < 1e-6);
    assert!(strays(name, uniform_hemisphere, uniform_hemisphere) < 1e-6);
    assert!(strays(name, cosine_hemisphere, cosine_hemisphere) < 2e-6);
    assert!(
        strays(
            name,
            |u| uniform_cone(u, -0.3),
            |u| uniform_cone(u, f64::lit((-0.3f32).into()))
        ) < 1e-6
    );
}
