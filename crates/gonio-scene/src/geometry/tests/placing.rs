//! Instances: maps of all kinds, orientation, attributes, and what is refused.

use super::scenes::*;
use crate::geometry::Shape;
use crate::mesh::TriangleMesh;
use crate::{Geometry, Ray, SceneError};
use gonio_num::{Affine3, Vec3};
use std::sync::Arc;

fn v(x: f32, y: f32, z: f32) -> Vec3<f32> {
    Vec3::new(x, y, z)
}

fn close(a: Vec3<f32>, b: Vec3<f32>) {
    assert!((a - b).length() < 2e-6, "{a:?} against {b:?}");
}

#[test]
fn a_placed_mesh_is_met_where_the_moved_mesh_is() {
    let mut random = Random::named("a_placed_mesh_is_met_where_the_moved_mesh_is");
    let mesh = bumpy_sphere(20, 16, 0.1);
    for sign in [1.0, -1.0] {
        let m = Affine3::scale(v(0.5, 2.0 * sign, 1.5))
            .then(&Affine3::rotation(v(0.0, 0.6, 0.8), 0.7))
            .then(&Affine3::translation(v(1.0, -2.0, 0.5)));
        let placed = one(Shape::Mesh(Arc::new(mesh.clone())), m);
        let mut moved = mesh.clone();
        for p in &mut moved.positions {
            *p = m.to_f64().transform_point(p.to_f64()).to_f32();
        }
        let moved = of_mesh(moved);
        let mut hits = 0;
        for _ in 0..2000 {
            let ray = Ray::new(random.point() * 4.0, random.direction());
            let (a, b) = (placed.intersect(&ray), moved.intersect(&ray));
            // Rays within rounding of an edge or of the outline may differ.
            if let (Some(a), Some(b)) = (a, b)
                && a.primitive == b.primitive
            {
                hits += 1;
                assert!((a.t - b.t).abs() < 1e-4 * b.t.max(1.0), "{a:?} {b:?}");
                let (s, r) = (placed.surface(&ray, &a), moved.surface(&ray, &b));
                assert!((s.p - r.p).length() < 1e-4);
                // The moved mesh of a mirroring map is wound the other way; the placed one keeps its outside.
                assert!((s.ng - r.ng * sign).length() < 1e-3);
            }
        }
        assert!(hits > 100);
    }
}

#[test]
fn outside_stays_outside_under_mirroring() {
    for shape in [
        Shape::Sphere,
        Shape::Mesh(Arc::new(bumpy_sphere(12, 8, 0.0))),
    ] {
        for s in [v(1.0, 1.0, 1.0), v(-1.0, 1.0, 1.0), v(-2.0, -1.0, -0.5)] {
            let g = one(shape.clone(), Affine3::scale(s));
            let ray = Ray::new(v(0.05, 0.03, 5.0), v(0.0, 0.0, -1.0));
            let hit = g.intersect(&ray).unwrap();
            let p = g.surface(&ray, &hit);
            assert!(p.ng.z > 0.5 && p.ns.dot(p.ng) > 0.0, "{p:?}");
        }
    }
}

#[test]
fn an_ellipsoid_is_met_on_its_axes() {
    let g = one(
        Shape::Sphere,
        Affine3::scale(v(1.0, 2.0, 3.0)).then(&Affine3::translation(v(10.0, 0.0, 0.0))),
    );
    let ray = Ray::new(v(10.0, 0.0, 10.0), v(0.0, 0.0, -1.0));
    let hit = g.intersect(&ray).unwrap();
    assert_eq!(hit.t, 7.0);
    let p = g.surface(&ray, &hit);
    close(p.ng, v(0.0, 0.0, 1.0));
    assert_eq!(p.uv[1], 0.0);
    assert_eq!(g.bounds().max, g.bounds().max.max(v(11.0, 2.0, 3.0)));
    assert!((g.bounds().max - v(11.0, 2.0, 3.0)).length() < 1e-4);
    let across = Ray::new(v(10.0, -5.0, 0.0), v(0.0, 1.0, 0.0));
    assert_eq!(g.intersect(&across).unwrap().t, 3.0);
}

#[test]
fn flat_shapes_know_their_coordinates() {
    for (shape, corner_hit) in [(Shape::Rectangle, true), (Shape::Disk, false)] {
        let g = one(shape, Affine3::identity());
        let ray = Ray::new(v(0.5, -0.25, 2.0), v(0.0, 0.0, -1.0));
        let p = g.surface(&ray, &g.intersect(&ray).unwrap());
        assert_eq!(p.uv, [0.75, 0.625]);
        close(p.p, v(0.5, -0.25, 0.0));
        close(p.ng, v(0.0, 0.0, 1.0));
        close(p.tangent, v(1.0, 0.0, 0.0));
        close(p.bitangent(), v(0.0, 1.0, 0.0));
        let corner = Ray::new(v(0.9, 0.9, -1.0), v(0.0, 0.0, 1.0));
        assert_eq!(g.occluded(&corner), corner_hit);
    }
}

#[test]
fn attributes_are_interpolated() {
    let mesh = TriangleMesh {
        positions: vec![v(0.0, 0.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 2.0, 0.0)],
        normals: vec![v(0.0, 0.0, 3.0), v(1.0, 0.0, 1.0), v(0.0, 0.0, 0.0)],
        // The image lies upright on the triangle: u along x, v against y.
        uvs: vec![[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]],
        uvs1: vec![[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]],
        colours: vec![
            [1.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, 1.0],
            [0.0, 0.0, 1.0, 0.0],
        ],
        indices: vec![[0, 1, 2]],
        ..Default::default()
    };
    let ray = Ray::new(v(0.5, 1.0, 1.0), v(0.0, 0.0, -1.0));
    let at = |mesh: &TriangleMesh, m: Affine3<f32>, ray: &Ray| {
        let g = one(Shape::Mesh(Arc::new(mesh.clone())), m);
        let hit = g.intersect(ray).unwrap();
        g.surface(ray, &hit)
    };
    let p = at(&mesh, Affine3::identity(), &ray);
    assert_eq!((p.uv, p.uv1), ([0.25, 0.5], [1.0, 2.0]));
    assert_eq!(p.colour, [0.25, 0.25, 0.5, 0.5]);
    let slope = std::f32::consts::FRAC_1_SQRT_2;
    close(p.ns, v(0.25 * slope, 0.0, 0.75 + 0.25 * slope).normalize());
    close(p.ng, v(0.0, 0.0, 1.0));
    assert!(p.tangent.x > 0.9 && p.bitangent().y > 0.999);

    // Mirrored along x: the normal stays up, the image turns round, and so does its handedness.
    let mirror = Affine3::scale(v(-1.0, 1.0, 1.0));
    let back = Ray::new(v(-0.5, 1.0, 1.0), v(0.0, 0.0, -1.0));
    let q = at(&mesh, mirror, &back);
    close(q.ng, v(0.0, 0.0, 1.0));
    assert!(q.tangent.x < -0.9 && q.bitangent().y > 0.999);
    assert_eq!(q.bitangent_sign, -p.bitangent_sign);

    // Normals that point away from the winding's side are turned; ones that cancel give way to the triangle's own.
    let mut turned = mesh.clone();
    turned.normals = vec![v(0.0, 0.0, -1.0); 3];
    close(at(&turned, Affine3::identity(), &ray).ns, v(0.0, 0.0, 1.0));
    let mut none = mesh.clone();
    none.normals = vec![v(0.0, 0.0, 0.0); 3];
    close(at(&none, Affine3::identity(), &ray).ns, v(0.0, 0.0, 1.0));

    let mut given = mesh.clone();
    given.tangents = vec![[0.0, 1.0, 0.0, -1.0]; 3];
    let p = at(&given, Affine3::identity(), &ray);
    assert!(p.tangent.y > 0.999 && p.bitangent().x > 0.9);
}

#[test]
fn what_cannot_be_placed_is_refused_by_its_index() {
    let mesh = |m: TriangleMesh| Shape::Mesh(Arc::new(m));
    let whole = bumpy_sphere(4, 3, 0.0);
    let id = Affine3::identity();
    let refused =
        |shapes: Vec<Shape>, instances: Vec<_>| Geometry::build(shapes, instances).unwrap_err();
    for (m, word) in [
        (Affine3::scale(v(1.0, 0.0, 1.0)), "flattens"),
        (Affine3::scale(v(1.0, f32::NAN, 1.0)), "not finite"),
        (Affine3::translation(v(1e20, 0.0, 0.0)), "beyond"),
    ] {
        let e = refused(vec![Shape::Sphere], vec![instance(0, id), instance(0, m)]);
        assert!(matches!(e, SceneError::Instance { instance: 1, .. }));
        assert!(e.to_string().contains(word), "{e}");
    }
    let e = refused(vec![Shape::Sphere], vec![instance(3, id)]);
    assert!(e.to_string().contains("shape 3"), "{e}");

    let mut broken = whole.clone();
    broken.positions[5].z = f32::NAN;
    let e = refused(vec![mesh(whole.clone()), mesh(broken)], vec![]);
    assert!(e.to_string().contains("shape 1, vertex 5"), "{e}");
    let mut broken = whole.clone();
    broken.indices[2][1] = 999;
    let e = refused(vec![mesh(broken)], vec![]).to_string();
    assert!(e.contains("triangle 2") && e.contains("999"), "{e}");
}

#[test]
fn degenerate_triangles_are_counted_and_not_met() {
    let mut mesh = bumpy_sphere(8, 6, 0.0);
    let sound = mesh.indices.len();
    mesh.indices.extend([[0, 0, 1], [1, 1, 1], [2, 3, 2]]);
    let g = of_mesh(mesh);
    assert_eq!((g.triangle_count(), g.degenerate_count()), (sound, 3));
    assert!(g.tree_bytes() > 0);
}

#[test]
fn shapes_of_one_mesh_share_its_tree() {
    let mesh = Arc::new(bumpy_sphere(40, 30, 0.0));
    let shape = || Shape::Mesh(mesh.clone());
    let once = Geometry::build(vec![shape()], vec![instance(0, Affine3::identity())]).unwrap();
    let twice = Geometry::build(
        vec![shape(), shape()],
        vec![
            instance(0, Affine3::identity()),
            instance(1, Affine3::translation(v(5.0, 0.0, 0.0))),
        ],
    )
    .unwrap();
    assert_eq!(once.tree_bytes(), twice.tree_bytes());
}
