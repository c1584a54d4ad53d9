//! Closed meshes don't leak, wherever a ray is aimed.

use super::scenes::*;
use crate::mesh::TriangleMesh;
use crate::{Geometry, Ray};
use gonio_num::Vec3;

/// A point of the mesh where triangles meet: a vertex, or a point of an edge, rounded.
fn seam(random: &mut Random, mesh: &TriangleMesh) -> Vec3<f32> {
    let c = mesh.corners(random.below(mesh.indices.len()));
    let k = random.below(3);
    match random.below(3) {
        0 => c[k],
        1 => (c[k] + c[(k + 1) % 3]) * 0.5,
        _ => {
            let s = random.unit();
            c[k] * s + c[(k + 1) % 3] * (1.0 - s)
        }
    }
}

fn leaks(geometry: &Geometry, mesh: &TriangleMesh, random: &mut Random, count: usize) -> usize {
    let mut leaks = 0;
    for i in 0..count {
        let target = seam(random, mesh);
        // From well inside outwards the ray must meet something: the mesh is closed. From outside through the seam to a
        // point well inside it must too.
        let inside = random.point() * 0.3;
        let ray = if i % 2 == 0 {
            Ray::new(inside, (target - inside).normalize())
        } else {
            let outside = target + (target - inside) * (0.5 + 3.0 * random.unit());
            let way = inside - outside;
            Ray {
                origin: outside,
                direction: way.normalize(),
                t_max: way.length(),
            }
        };
        leaks += usize::from(geometry.intersect(&ray).is_none());
        leaks += usize::from(!geometry.occluded(&ray));
    }
    leaks
}

#[test]
fn no_ray_slips_between_triangles() {
    let mut random = Random::named("no_ray_slips_between_triangles");
    for (columns, rows, bump) in [(3, 3, 0.0), (16, 12, 0.05), (200, 100, 0.03)] {
        let mesh = bumpy_sphere(columns, rows, bump);
        let geometry = of_mesh(mesh.clone());
        assert_eq!(leaks(&geometry, &mesh, &mut random, 40_000), 0);
    }
}

#[test]
fn a_box_with_whole_coordinates_does_not_leak_at_its_edges() {
    // Axis-parallel faces and rays through exact edges and corners: all edge functions are exactly 0 there.
    let mut mesh = TriangleMesh::default();
    for i in 0..8u8 {
        let pick = |bit: u8| if i & bit == 0 { -1.0 } else { 1.0 };
        mesh.positions.push(Vec3::new(pick(1), pick(2), pick(4)));
    }
    for [a, b, c, d] in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        mesh.indices.push([a, b, c]);
        mesh.indices.push([a, c, d]);
    }
    let geometry = of_mesh(mesh.clone());
    for i in -8..=8i8 {
        for j in -8..=8i8 {
            for (axis, sign) in [
                (0, 1.0),
                (0, -1.0),
                (1, 1.0),
                (1, -1.0),
                (2, 1.0),
                (2, -1.0),
            ] {
                let mut origin = [0.0; 3];
                let mut direction = [0.0; 3];
                direction[axis] = sign;
                origin[(axis + 1) % 3] = f32::from(i) / 8.0;
                origin[(axis + 2) % 3] = f32::from(j) / 8.0;
                let within = Ray::new(origin.into(), direction.into());
                assert!(geometry.intersect(&within).is_some(), "{within:?}");
                origin[axis] = -3.0 * sign;
                let across = Ray::new(origin.into(), direction.into());
                assert_eq!(geometry.intersect(&across).map(|h| h.t), Some(2.0));
            }
        }
    }
    let mut random = Random::named("a_box_with_whole_coordinates");
    assert_eq!(leaks(&geometry, &mesh, &mut random, 20_000), 0);
}

#[test]
fn a_mesh_far_from_the_origin_does_not_leak() {
    let mut mesh = bumpy_sphere(40, 30, 0.05);
    let centre = Vec3::new(1000.0, -2000.0, 500.0);
    for p in &mut mesh.positions {
        *p += centre;
    }
    let geometry = of_mesh(mesh.clone());
    let mut random = Random::named("a_mesh_far_from_the_origin_does_not_leak");
    for _ in 0..20_000 {
        let inside = centre + random.point() * 0.3;
        let target = seam(&mut random, &mesh);
        let ray = Ray::new(inside, (target - inside).normalize());
        assert!(geometry.intersect(&ray).is_some(), "{ray:?}");
        // The long way: from the world's origin.
        let long = Ray::new(Vec3::new(0.0, 0.0, 0.0), inside.normalize());
        assert!(geometry.occluded(&long));
    }
}

#[test]
fn a_hole_does_leak() {
    // The control: with one triangle missing the same rays do find the hole.
    let mut mesh = bumpy_sphere(16, 12, 0.05);
    let closed = mesh.clone();
    mesh.indices.remove(100);
    let geometry = of_mesh(mesh);
    let mut random = Random::named("a_hole_does_leak");
    assert!(leaks(&geometry, &closed, &mut random, 40_000) > 0);
}
