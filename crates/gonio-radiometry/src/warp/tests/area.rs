//! The warps to flat shapes: disk and triangle.

use super::*;
use crate::warp::*;
use std::f64::consts::FRAC_1_PI;

#[test]
fn disk_samples_are_uniform() {
    assert_distributed(
        "disk_samples_are_uniform",
        |u| uniform_disk(u).map(|x| 0.5 * x + 0.5),
        |x, y| 4.0 * uniform_disk_density([2.0 * x - 1.0, 2.0 * y - 1.0]),
        0.002,
    );
}

#[test]
fn triangle_samples_are_uniform() {
    assert_distributed(
        "triangle_samples_are_uniform",
        |u| {
            let [b0, b1, _] = uniform_triangle(u);
            [b0, b1]
        },
        |x, y| uniform_triangle_density([x, y, 1.0 - x - y]),
        0.002,
    );
}

#[test]
fn disk_and_triangle_are_inverted() {
    for u in squares("disk_and_triangle_are_inverted", 10_000) {
        let disk = uniform_disk_inverse(uniform_disk(u));
        let triangle = uniform_triangle_inverse(uniform_triangle(u));
        for k in 0..2 {
            assert!((disk[k] - u[k]).abs() < 1e-14, "{u:?}");
            assert!((triangle[k] - u[k]).abs() < 1e-15, "{u:?}");
        }
    }
}

/// Where the concentric map sends the marks of the square.
#[test]
fn the_concentric_map_keeps_its_marks() {
    let near = |u: [f64; 2], [x, y]: [f64; 2]| {
        let p: [f64; 2] = uniform_disk(u);
        assert!(
            (p[0] - x).abs() < 1e-15 && (p[1] - y).abs() < 1e-15,
            "{u:?} {p:?}"
        );
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    near([0.5, 0.5], [0.0, 0.0]);
    near([1.0, 0.5], [1.0, 0.0]);
    near([0.0, 0.5], [-1.0, 0.0]);
    near([0.5, 1.0], [0.0, 1.0]);
    near([0.5, 0.0], [0.0, -1.0]);
    near([1.0, 1.0], [half, half]);
    near([0.0, 0.0], [-half, -half]);
    near([1.0, 0.0], [half, -half]);
    near([0.75, 0.5], [0.5, 0.0]);
    assert_eq!(uniform_disk_inverse([0.0, 0.0]), [0.5, 0.5]);
    assert_eq!(uniform_disk_density([0.6, 0.7]), FRAC_1_PI);
    assert_eq!(uniform_disk_density([0.8, 0.7]), 0.0);
}

#[test]
fn borders_stay_in_the_shape() {
    let ends = [0.0, 0.25, 0.5, 1.0 - 1.0 / 16_777_216.0, 1.0];
    for u in ends.iter().flat_map(|&a| ends.iter().map(move |&b| [a, b])) {
        let [x, y] = uniform_disk::<f32>(u);
        assert!(x.hypot(y) <= 1.0 + f32::EPSILON);
        let b = uniform_triangle::<f32>(u);
        assert!(b.iter().all(|c| (0.0..=1.0).contains(c)), "{u:?}");
        assert!((b[0] + b[1] + b[2] - 1.0).abs() <= f32::EPSILON);
        assert_eq!(uniform_triangle_density(b), 2.0);
    }
    assert_eq!(uniform_triangle_density([0.7, 0.6, -0.3]), 0.0);
}
