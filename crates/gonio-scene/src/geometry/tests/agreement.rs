//! The tree against every triangle one by one, and the kernels against each other, bit by bit.

use super::scenes::*;
use crate::geometry::kernel::{Kernel, Portable};
use crate::geometry::nearest::Nearest;
use crate::geometry::triangle::{LANES, TriangleBlock, TriangleRay};
use crate::geometry::{Geometry, Shape};
use crate::mesh::TriangleMesh;
use crate::{Hit, Ray};
use gonio_num::{Affine3, Vec3};
use proptest::prelude::*;
use std::sync::Arc;

/// Every triangle, one after the other.
fn one_by_one(mesh: &TriangleMesh, ray: &Ray) -> Option<Hit> {
    let mut nearest = Nearest::none(ray.t_max);
    let exact = TriangleRay::new(ray.origin, ray.direction);
    for i in 0..mesh.indices.len() {
        if mesh.is_degenerate(i) {
            continue;
        }
        let mut block = TriangleBlock::vacant();
        block.set(i % LANES, mesh.corners(i), i as u32);
        let mask = Portable.triangles(&block, &exact, f32::INFINITY);
        if mask != 0
            && let Some(c) = exact.cross(&block, i % LANES)
        {
            nearest.offer(c.t, 0, i as u32, c.u, c.v);
        }
    }
    nearest.hit()
}

/// Rays of all kinds: any, along an axis, within a coordinate plane, starting on a vertex's coordinates, bounded.
pub(super) fn ray(random: &mut Random, mesh: &TriangleMesh) -> Ray {
    let mut origin = (random.point() * 1.5).to_array();
    let mut direction = random.direction().to_array();
    let vertex = mesh.positions[random.below(mesh.positions.len())].to_array();
    match random.below(5) {
        0 => {
            let axis = random.below(3);
            let sign = random.signed();
            direction = [0.0; 3];
            direction[axis] = if sign < 0.0 { -1.0 } else { 1.0 };
        }
        1 => direction[random.below(3)] = if random.signed() < 0.0 { -0.0 } else { 0.0 },
        _ => {}
    }
    match random.below(4) {
        0 => origin[random.below(3)] = vertex[random.below(3)],
        1 => {
            let axis = random.below(3);
            origin[axis] = vertex[axis];
        }
        _ => {}
    }
    let mut ray = Ray::new(origin.into(), direction.into());
    if random.below(4) == 0 {
        ray.t_max = random.unit() * 2.0;
    }
    ray
}

pub(super) fn bits(h: Option<Hit>) -> Option<[u32; 5]> {
    h.map(|h| {
        [
            h.t.to_bits(),
            h.instance,
            h.primitive,
            h.u.to_bits(),
            h.v.to_bits(),
        ]
    })
}

fn agree(geometry: &Geometry, mesh: &TriangleMesh, ray: &Ray) {
    let truth = bits(one_by_one(mesh, ray));
    assert_eq!(bits(geometry.intersect_portable(ray)), truth, "{ray:?}");
    assert_eq!(bits(geometry.intersect(ray)), truth, "{ray:?}");
    assert_eq!(geometry.occluded_portable(ray), truth.is_some(), "{ray:?}");
    assert_eq!(geometry.occluded(ray), truth.is_some(), "{ray:?}");
}

#[test]
fn the_tree_finds_what_a_search_one_by_one_finds() {
    let mut random = Random::named("the_tree_finds_what_a_search_one_by_one_finds");
    for (count, size) in [(1, 1.0), (7, 0.5), (60, 0.5), (400, 0.1), (400, 1e-3)] {
        let mesh = soup(&mut random, count, size);
        let geometry = of_mesh(mesh.clone());
        let mut hits = 0;
        for _ in 0..3000 {
            let ray = ray(&mut random, &mesh);
            agree(&geometry, &mesh, &ray);
            hits += usize::from(geometry.occluded(&ray));
        }
        assert!(hits > 0 || size < 0.01, "{count} triangles never hit");
    }
}

#[test]
fn rays_aimed_at_vertices_and_edges_agree_too() {
    let mut random = Random::named("rays_aimed_at_vertices_and_edges_agree_too");
    let mesh = bumpy_sphere(16, 12, 0.1);
    let geometry = of_mesh(mesh.clone());
    for _ in 0..4000 {
        let t = mesh.corners(random.below(mesh.indices.len()));
        let s = random.unit();
        let target = t[0] * s + t[1] * (1.0 - s);
        let origin = random.point() * 2.0;
        agree(&geometry, &mesh, &Ray::new(origin, target - origin));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn any_triangles_any_rays(
        corners in prop::collection::vec(prop::array::uniform3(-4i8..5), 3..60),
        origins in prop::collection::vec(prop::array::uniform3(-6i8..7), 8),
        directions in prop::collection::vec(prop::array::uniform3(-2i8..3), 8),
    ) {
        // Small whole numbers: shared planes, edges, vertices, duplicates and degenerate triangles all the time.
        let at = |a: &[i8; 3]| Vec3::new(f32::from(a[0]), f32::from(a[1]), f32::from(a[2]));
        let mut mesh = TriangleMesh::default();
        for c in corners.chunks_exact(3) {
            let k = mesh.positions.len() as u32;
            mesh.positions.extend(c.iter().map(at));
            mesh.indices.push([k, k + 1, k + 2]);
        }
        let geometry = of_mesh(mesh.clone());
        for (o, d) in origins.iter().zip(&directions) {
            let ray = Ray::new(at(o), at(d));
            if ray.is_valid() {
                agree(&geometry, &mesh, &ray);
            } else {
                prop_assert!(geometry.intersect(&ray).is_none());
            }
        }
    }
}

#[test]
fn rays_that_ask_nothing_hit_nothing() {
    let g = one(Shape::Sphere, Affine3::identity());
    let mesh = of_mesh(bumpy_sphere(8, 6, 0.0));
    let (zero, nan) = (Vec3::new(0.0, 0.0, 0.0), f32::NAN);
    let x = Vec3::new(1.0, 0.0, 0.0);
    for ray in [
        Ray::new(zero, zero),
        Ray::new(zero, Vec3::new(nan, 0.0, 0.0)),
        Ray::new(zero, Vec3::new(f32::INFINITY, 0.0, 0.0)),
        Ray::new(Vec3::new(nan, 0.0, 0.0), x),
        Ray {
            t_max: 0.0,
            ..Ray::new(zero, x)
        },
        Ray {
            t_max: nan,
            ..Ray::new(zero, x)
        },
        Ray {
            t_max: -1.0,
            ..Ray::new(zero, x)
        },
    ] {
        for g in [&g, &mesh] {
            assert_eq!(g.intersect(&ray), None, "{ray:?}");
            assert!(!g.occluded(&ray), "{ray:?}");
        }
    }
    // Extreme ones end, whatever they say.
    for (o, d) in [(3e38, 1.0), (0.0, 1e-45), (0.0, 3e38), (-3e38, 3e38)] {
        let ray = Ray::new(Vec3::new(o, 0.0, 0.0), Vec3::new(d, d, -d));
        for g in [&g, &mesh] {
            assert_eq!(g.intersect(&ray).is_some(), g.occluded(&ray));
            assert_eq!(bits(g.intersect(&ray)), bits(g.intersect_portable(&ray)));
        }
    }
}

#[test]
fn nothing_hits_an_empty_geometry() {
    let ray = Ray::new(Vec3::new(0.0, 0.0, 0.0), Vec3::new(0.0, 0.0, 1.0));
    let none = Geometry::build(vec![], vec![]).unwrap();
    assert!(none.bounds().is_empty() && none.intersect(&ray).is_none());
    let hollow = of_mesh(TriangleMesh::default());
    assert!(hollow.bounds().is_empty() && !hollow.occluded(&ray));
    assert_eq!(hollow.area(0), 0.0);
    assert_eq!(hollow.sample_area(0, [0.5; 2], 0.5).pdf_area, 0.0);
}

#[test]
fn ties_go_to_the_lowest_instance() {
    let mesh = Arc::new(soup(&mut Random::named("ties"), 50, 0.5));
    let copies = (0..20).map(|_| instance(0, Affine3::identity())).collect();
    let g = Geometry::build(vec![Shape::Mesh(mesh.clone())], copies).unwrap();
    let single = of_mesh((*mesh).clone());
    let mut random = Random::named("ties_go_to_the_lowest_instance");
    for _ in 0..500 {
        let ray = ray(&mut random, &mesh);
        assert_eq!(bits(g.intersect(&ray)), bits(single.intersect(&ray)));
    }
    assert_eq!(g.triangle_count(), 20 * single.triangle_count());
}

#[test]
fn a_deep_tree_needs_no_deep_stack() {
    // Boxes nested like dolls make trees as deep as they come.
    let mut mesh = TriangleMesh::default();
    for i in 0..600 {
        let s = 1.07f32.powi(i - 300);
        let k = mesh.positions.len() as u32;
        for p in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            mesh.positions.push(Vec3::from(p) * s);
        }
        mesh.indices.push([k, k + 1, k + 2]);
    }
    let g = of_mesh(mesh.clone());
    let d = Vec3::new(0.6, 0.58, 0.55).normalize();
    for i in 0..100 {
        let scale = 1.2f32.powi(i - 50);
        agree(&g, &mesh, &Ray::new(d * scale, d));
        agree(&g, &mesh, &Ray::new(d * scale, -d));
    }
}
