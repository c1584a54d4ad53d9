//! What every warp to directions must do.

use super::*;
use crate::quadrature::ProductRule;
use crate::warp::*;
use gonio_num::Real;
use std::f64::consts::{PI, TAU};

fn corner(x: f64, y: f64, z: f64) -> Vec3<f64> {
    Vec3::new(x, y, z).normalize()
}

/// Calls `check` for each family with each of a few parameters.
fn for_each_warp(mut check: impl FnMut(&Directions)) {
    check(&Directions {
        name: "uniform hemisphere",
        map: &uniform_hemisphere,
        density: &uniform_hemisphere_density,
        inverse: &uniform_hemisphere_inverse,
    });
    check(&Directions {
        name: "uniform sphere",
        map: &uniform_sphere,
        density: &uniform_sphere_density,
        inverse: &uniform_sphere_inverse,
    });
    check(&Directions {
        name: "cosine hemisphere",
        map: &cosine_hemisphere,
        density: &cosine_hemisphere_density,
        inverse: &cosine_hemisphere_inverse,
    });
    for cos_max in [-1.0, -0.4, 0.0, 0.6] {
        check(&Directions {
            name: &format!("cone of cosine {cos_max}"),
            map: &|u| uniform_cone(u, cos_max),
            density: &|w| uniform_cone_density(w, cos_max),
            inverse: &|w| uniform_cone_inverse(w, cos_max),
        });
    }
    for p in [0.0, 1.0, 7.5, 40.0] {
        check(&Directions {
            name: &format!("cosine to the power {p}"),
            map: &|u| cosine_power_hemisphere(u, p),
            density: &|w| cosine_power_hemisphere_density(w, p),
            inverse: &|w| cosine_power_hemisphere_inverse(w, p),
        });
    }
    for (name, triangle) in triangles() {
        check(&Directions {
            name: &format!("{name} spherical triangle"),
            map: &|u| spherical_triangle(u, triangle),
            density: &|w| spherical_triangle_density(w, triangle),
            inverse: &|w| spherical_triangle_inverse(w, triangle),
        });
    }
    for (name, edges) in rectangles() {
        let [low, ex, ey] = edges;
        let from = Vec3::new(0.3, -0.1, 0.2);
        let rectangle = SphericalRectangle::new(low + from, ex, ey, from);
        let normal = ex.cross(ey);
        // The point of the rectangle's plane in direction w, and whether it lies in the rectangle.
        let hit = |w: Vec3<f64>| {
            let p = w * (low.dot(normal) / w.dot(normal));
            let s = (p - low).dot(ex) / ex.length_squared();
            let t = (p - low).dot(ey) / ey.length_squared();
            let ahead = w.dot(normal) * low.dot(normal) > 0.0;
            let inside = (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t);
            (p, ahead && inside)
        };
        check(&Directions {
            name: &format!("{name} spherical rectangle"),
            map: &|u| (rectangle.sample(u) - from).normalize(),
            density: &|w| if hit(w).1 { rectangle.density() } else { 0.0 },
            inverse: &|w| rectangle.inverse(hit(w).0 + from),
        });
    }
}

fn triangles() -> [(&'static str, [Vec3<f64>; 3]); 4] {
    [
        (
            "octant",
            [
                corner(1.0, 0.0, 0.0),
                corner(0.0, 1.0, 0.0),
                corner(0.0, 0.0, 1.0),
            ],
        ),
        (
            "clockwise",
            [
                corner(1.0, 0.2, 0.3),
                corner(-0.2, 0.1, 1.0),
                corner(0.1, 1.0, -0.4),
            ],
        ),
        (
            "sliver",
            [
                corner(1.0, 0.1, 0.3),
                corner(-0.8, 0.9, 0.3),
                corner(0.9, 0.35, 0.3),
            ],
        ),
        (
            "nearly hemispherical",
            [
                corner(1.0, 0.0, 0.05),
                corner(-0.5, 0.9, 0.05),
                corner(-0.5, -0.8, 0.05),
            ],
        ),
    ]
}

fn rectangles() -> [(&'static str, [Vec3<f64>; 3]); 4] {
    let v = Vec3::new;
    [
        (
            "facing",
            [v(-1.0, -1.0, 1.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0)],
        ),
        (
            "far to the side",
            [v(2.0, 3.0, -1.0), v(2.0, 0.0, 0.0), v(0.0, 1.0, 0.0)],
        ),
        (
            "close",
            [v(-0.5, 0.2, 0.05), v(0.0, 0.0, 2.0), v(-3.0, 0.0, 0.0)],
        ),
        (
            "tilted",
            [v(0.5, 0.2, 0.1), v(1.2, 1.6, 0.0), v(-0.8, 0.6, 0.5)],
        ),
    ]
}

/// Directions as points of the square of equal areas: ((1 + z)/2, φ/2π).
fn to_square(w: Vec3<f64>) -> [f64; 2] {
    let turn = Real::atan2(w.y, w.x) / TAU;
    [
        0.5 * (1.0 + w.z),
        if turn < 0.0 { turn + 1.0 } else { turn },
    ]
}

fn from_square(x: f64, y: f64) -> Vec3<f64> {
    let z = 2.0 * x - 1.0;
    let across = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new(across * Real::cos(TAU * y), across * Real::sin(TAU * y), z)
}

#[test]
fn samples_follow_the_density() {
    for_each_warp(|warp| {
        // The midpoint rule of 576 × 576 points crosses the border of a domain in about 1000 of them, of a value of up to a
        // few units each, half of whose errors cancel: 1 %.
        assert_distributed(
            warp.name,
            |u| to_square((warp.map)(u)),
            |x, y| 4.0 * PI * (warp.density)(from_square(x, y)),
            0.01,
        );
    });
}

#[test]
fn smooth_densities_integrate_to_one() {
    let rule = ProductRule::new(64, 4);
    let [cosine, p0, p7, p40, hemisphere] = rule.hemisphere(|w| {
        [
            cosine_hemisphere_density(w),
            cosine_power_hemisphere_density(w, 0.0),
            cosine_power_hemisphere_density(w, 7.0),
            cosine_power_hemisphere_density(w, 40.0),
            uniform_hemisphere_density(w),
        ]
    });
    // The series of ln cosθ is good to 1e-13 of the logarithm, times the power 40.
    for one in [cosine, p0, p7, p40, hemisphere] {
        assert!((one - 1.0).abs() < 1e-11, "{one}");
    }
    let [sphere] = rule.sphere(|w| [uniform_sphere_density(w)]);
    let [cone] = rule.zone(0.6, 1.0, |w| [uniform_cone_density(w, 0.6)]);
    assert!((sphere - 1.0).abs() < 1e-12 && (cone - 1.0).abs() < 1e-12);
    for (_, triangle) in triangles() {
        let centre = spherical_triangle([0.5, 0.5], triangle);
        let whole =
            spherical_triangle_density(centre, triangle) * crate::solid_angle::triangle(triangle);
        assert!((whole - 1.0).abs() < 1e-14);
    }
    for (name, [low, ex, ey]) in rectangles() {
        let rectangle = SphericalRectangle::new(low, ex, ey, Vec3::zero());
        let expected = crate::solid_angle::rectangle(low, ex, ey, Vec3::zero());
        assert!(
            (rectangle.density() * expected - 1.0).abs() < 1e-12,
            "{name}"
        );
    }
}

#[test]
fn densities_vanish_outside() {
    let below = corner(0.3, 0.2, -0.1);
    assert_eq!(uniform_hemisphere_density(below), 0.0);
    assert_eq!(cosine_hemisphere_density(below), 0.0);
    for p in [0.0, 5.0] {
        assert_eq!(cosine_power_hemisphere_density(below, p), 0.0);
    }
    assert_eq!(
        cosine_power_hemisphere_density(corner(1.0, 0.0, 0.0), 5.0),
        0.0
    );
    assert_eq!(uniform_cone_density(corner(1.0, 0.0, 1.0), 0.8), 0.0);
    for (_, triangle) in triangles() {
        let [a, b, c] = triangle;
        assert_eq!(
            spherical_triangle_density(-(a + b + c).normalize(), triangle),
            0.0
        );
    }
    let flat = corner(1.0, 0.0, 0.0);
    assert_eq!(spherical_triangle_density(flat, [flat; 3]), 0.0);
}

#[test]
fn inverses_undo_maps() {
    for_each_warp(|warp| {
        for u in squares(warp.name, 5000) {
            let w = (warp.map)(u);
            assert!((w.length() - 1.0).abs() < 1e-14, "{} at {u:?}", warp.name);
            let back = (warp.inverse)(w);
            // u₀ moves freely where u₁ is tiny: near the vertex b of a triangle and the pole of the others.
            let moved = (back[0] - u[0]).abs().max((back[1] - u[1]).abs());
            assert!(moved < 1e-9, "{} at {u:?} gives {back:?}", warp.name);
        }
    });
}

/// The solid angle that a small square is mapped to is its area over the density: the Jacobian, exactly.
#[test]
fn maps_stretch_by_the_inverse_density() {
    for_each_warp(|warp| {
        for u in squares(warp.name, 200) {
            let h = 1e-4;
            let u = u.map(|x| 0.01 + 0.98 * x);
            if (u[0] - u[1]).abs() < 2.0 * h || (u[0] + u[1] - 1.0).abs() < 2.0 * h {
                continue; // the creases of the concentric map
            }
            let at = |i: f64, j: f64| (warp.map)([u[0] + (i - 0.5) * h, u[1] + (j - 0.5) * h]);
            let (a, b, c, d) = (at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0));
            let omega =
                crate::solid_angle::triangle([a, b, c]) + crate::solid_angle::triangle([a, c, d]);
            let product = omega / (h * h) * (warp.density)((warp.map)(u));
            // Error (h/u)² from the curvature near a pole, and the rounding of a solid angle of h².
            assert!(
                (product - 1.0).abs() < 1e-3,
                "{} at {u:?}: {product}",
                warp.name
            );
        }
    });
}

#[test]
fn the_squares_border_maps_into_the_domain() {
    let ends = [
        0.0,
        1e-12,
        0.5,
        1.0 - 1.0 / 16_777_216.0,
        1.0 - f64::EPSILON / 2.0,
        1.0,
    ];
    for_each_warp(|warp| {
        for u in ends.iter().flat_map(|&a| ends.iter().map(move |&b| [a, b])) {
            let w = (warp.map)(u);
            assert!(
                w.is_finite() && (w.length() - 1.0).abs() < 1e-14,
                "{} {u:?}",
                warp.name
            );
            let density = (warp.density)(w);
            assert!(density.is_finite() && density >= 0.0, "{} {u:?}", warp.name);
            let back = (warp.inverse)(w);
            assert!(
                back.iter().all(|x| (0.0..=1.0).contains(x)),
                "{} {u:?}",
                warp.name
            );
        }
    });
}
