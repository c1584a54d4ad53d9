//! Areas, and points chosen on surfaces.

use super::scenes::*;
use crate::geometry::Shape;
use crate::mesh::TriangleMesh;
use crate::{Geometry, Ray};
use gonio_num::{Affine3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

fn skew() -> Affine3<f32> {
    Affine3::scale(Vec3::new(0.5, 3.0, -2.0))
        .then(&Affine3::rotation(Vec3::new(0.6, 0.0, 0.8), 0.9))
        .then(&Affine3::translation(Vec3::new(1.0, 2.0, 3.0)))
}

#[test]
fn areas_are_right() {
    let id = Affine3::identity();
    for (shape, m, area) in [
        (Shape::Sphere, id, 4.0 * PI),
        (Shape::Sphere, Affine3::scale(Vec3::splat(-3.0)), 36.0 * PI),
        (Shape::Rectangle, id, 4.0),
        (Shape::Rectangle, skew(), 4.0 * 1.5),
        (Shape::Disk, skew(), PI * 1.5),
        // A prolate spheroid of axes 1, 1, 2: 2π (1 + (2/e) asin e), e = √(3)/2.
        (
            Shape::Sphere,
            Affine3::scale(Vec3::new(1.0, 1.0, 2.0)),
            2.0 * PI * (1.0 + 2.0 / 0.75f64.sqrt() * 0.75f64.sqrt().asin()),
        ),
        // And one of axes 100, 100, 1: 2π (a² + c² atanh(e)/e), e² = 1 − c²/a².
        (
            Shape::Sphere,
            Affine3::scale(Vec3::new(100.0, 100.0, 1.0)),
            {
                let e = (1.0f64 - 1e-4).sqrt();
                2.0 * PI * (1e4 + e.atanh() / e)
            },
        ),
    ] {
        let found = f64::from(one(shape, m).area(0));
        assert!((found / area - 1.0).abs() < 1e-4, "{found} against {area}");
    }
}

/// Every chosen point lies on the surface, a ray finds it there with the same normal, and ∫ 1/pdf is the area.
fn check(shape: Shape, m: Affine3<f32>, name: &str) {
    let g = one(shape, m);
    let area = f64::from(g.area(0));
    let mut random = Random::named(name);
    let (mut sum, mut squares, n) = (0.0, 0.0, 4000);
    for _ in 0..n {
        let s = g.sample_area(0, [random.unit(), random.unit()], random.unit());
        assert!((s.ng.length() - 1.0).abs() < 1e-5 && s.pdf_area > 0.0);
        let ray = Ray::new(s.p + s.ng * 0.01, -s.ng);
        let hit = g.intersect(&ray).unwrap();
        let p = g.surface(&ray, &hit);
        assert!((p.p - s.p).length() < 1e-4, "{name}: {s:?} {p:?}");
        let pdf = g.pdf_area(&p);
        assert!((pdf / s.pdf_area - 1.0).abs() < 1e-2, "{name}");
        let w = 1.0 / f64::from(s.pdf_area);
        sum += w;
        squares += w * w;
    }
    let mean = sum / f64::from(n);
    let spread = ((squares / f64::from(n) - mean * mean).max(0.0) / f64::from(n)).sqrt();
    // Five standard errors, or the rounding of a constant density.
    assert!(
        (mean - area).abs() <= 5.0 * spread + 1e-4 * area,
        "{name}: {mean} ± {spread} against {area}"
    );
}

#[test]
fn chosen_points_lie_on_the_surface_with_their_density() {
    check(Shape::Sphere, Affine3::identity(), "sphere");
    check(Shape::Sphere, skew(), "ellipsoid");
    check(Shape::Rectangle, skew(), "rectangle");
    check(Shape::Disk, skew(), "disk");
    let mesh = Shape::Mesh(Arc::new(bumpy_sphere(12, 9, 0.1)));
    check(mesh.clone(), Affine3::identity(), "mesh");
    check(mesh, skew(), "placed mesh");
}

/// The two halves of a shape get points by their areas: a binomial test at five standard deviations.
fn share(g: &Geometry, expected: f64, name: &str, in_half: impl Fn(Vec3<f32>) -> bool) -> f64 {
    let mut random = Random::named(name);
    let n = 40_000;
    let mut count = 0;
    for _ in 0..n {
        let s = g.sample_area(0, [random.unit(), random.unit()], random.unit());
        count += u32::from(in_half(s.p));
    }
    let sigma = (f64::from(n) * expected * (1.0 - expected)).sqrt();
    (f64::from(count) - f64::from(n) * expected).abs() / sigma
}

#[test]
fn points_are_spread_by_area() {
    let g = one(Shape::Disk, Affine3::identity());
    let inner = |p: Vec3<f32>| p.x * p.x + p.y * p.y < 0.25;
    assert!(share(&g, 0.25, "disk by radius", inner) < 5.0);
    // The control: a wrong share by 5 % is noticed.
    assert!(share(&g, 0.25 * 1.05, "disk by radius", inner) > 5.0);
    let cap = |p: Vec3<f32>| p.y > 0.5;
    let sphere = one(Shape::Sphere, Affine3::identity());
    assert!(share(&sphere, 0.25, "sphere cap", cap) < 5.0);
    // A large, a small and a degenerate triangle.
    let mesh = TriangleMesh {
        positions: vec![
            Vec3::new(0.0, 0.0, 0.0),
            Vec3::new(3.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(-1.0, 0.0, 0.0),
        ],
        indices: vec![[0, 0, 1], [0, 1, 2], [0, 2, 3], [1, 1, 1]],
        ..Default::default()
    };
    let g = of_mesh(mesh);
    assert!(share(&g, 0.25, "triangles", |p| p.x < 0.0) < 5.0);
    for u in [0.0, 0.5, 0.999_999_94] {
        let s = g.sample_area(0, [u, u], u);
        assert!(s.pdf_area == 0.5 && s.primitive != 0 && s.primitive != 3);
    }
}
