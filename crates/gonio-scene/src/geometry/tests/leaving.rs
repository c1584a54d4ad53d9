//! Rays that leave a surface don't meet it again, and shadow rays don't meet their target.

use super::scenes::*;
use crate::geometry::Shape;
use crate::mesh::TriangleMesh;
use crate::{Geometry, Ray, SurfacePoint};
use gonio_num::{Affine3, Vec3};
use std::sync::Arc;

/// A direction on the given side of a normal, anything from along it to grazing at 1 : 1000.
fn away(random: &mut Random, n: Vec3<f32>) -> Vec3<f32> {
    loop {
        let flat = random.direction();
        let lift = if random.below(2) == 0 { 1.0 } else { 1e-3 };
        let across = flat - n * n.dot(flat);
        let d = (across + n * (random.unit() * lift)).normalize();
        if d.dot(n) > 1e-3 * 0.01 {
            return d;
        }
    }
}

fn point(g: &Geometry, ray: &Ray) -> Option<SurfacePoint> {
    g.intersect(ray).map(|hit| g.surface(ray, &hit))
}

/// Leaves a convex surface, outwards, `count` times.
fn never_returns(g: &Geometry, random: &mut Random, count: usize, what: &str) {
    let (centre, radius) = (g.bounds().centre(), g.bounds().radius());
    let mut tried = 0;
    while tried < count {
        let from = centre + random.direction() * (radius * 3.0);
        let to = centre + random.point() * (radius * 0.5);
        let Some(s) = point(g, &Ray::new(from, (to - from).normalize())) else {
            continue;
        };
        tried += 1;
        let d = away(random, s.ng);
        let again = point(g, &s.spawn_ray(d));
        assert!(
            again.is_none(),
            "{what}: {s:?} left along {d:?}, met {again:?}"
        );
    }
}

/// One flat square of two triangles with the given edge and middle.
fn square(size: f32, centre: Vec3<f32>) -> TriangleMesh {
    let (x, z) = (
        Vec3::new(size, 0.0, 0.0),
        Vec3::new(0.3 * size, 0.2 * size, size),
    );
    TriangleMesh {
        positions: vec![
            centre - x - z,
            centre + x - z,
            centre + x + z,
            centre - x + z,
        ],
        indices: vec![[0, 2, 1], [0, 3, 2]],
        ..Default::default()
    }
}

fn map(random: &mut Random, scale: f32, shift: f32) -> Affine3<f32> {
    let s = Vec3::new(
        0.3 + random.unit(),
        0.3 + random.unit(),
        -0.3 - random.unit(),
    ) * scale;
    Affine3::scale(s)
        .then(&Affine3::rotation(random.direction(), 3.0 * random.unit()))
        .then(&Affine3::translation(random.direction() * shift))
}

#[test]
fn leaving_rays_do_not_meet_what_they_leave() {
    let mut random = Random::named("leaving_rays_do_not_meet_what_they_leave");
    for shift in [0.0, 1.0, 1e3, 1e5] {
        for scale in [1e-3f32, 1.0, 1e3] {
            if shift > 1e4 * scale {
                continue; // Single precision can't place a shape so far off with any shape left.
            }
            let what = format!("scale {scale}, shift {shift}");
            for shape in [Shape::Sphere, Shape::Rectangle, Shape::Disk] {
                let g = one(shape, map(&mut random, scale, shift));
                never_returns(&g, &mut random, 400, &what);
            }
            let placed = Shape::Mesh(Arc::new(square(1.0, Vec3::new(0.0, 0.0, 0.0))));
            let g = one(placed, map(&mut random, scale, shift));
            never_returns(&g, &mut random, 400, &format!("{what}, placed square"));
            let g = of_mesh(square(scale, random.direction() * shift));
            never_returns(&g, &mut random, 400, &format!("{what}, square"));
        }
    }
    // A tiny triangle's neighbourhood on a huge one.
    let g = of_mesh(square(1e6, Vec3::new(3.0, 2.0, 1.0)));
    never_returns(&g, &mut random, 1000, "huge square");
    // A mesh modelled far from its own origin and moved back.
    let far = Vec3::new(1e4, 2e4, -3e4);
    let shape = Shape::Mesh(Arc::new(square(1.0, far)));
    let g = one(shape, Affine3::translation(-far));
    never_returns(&g, &mut random, 1000, "moved back");
}

#[test]
fn without_the_offset_rays_do_return() {
    // The control: rays that start at p itself meet the sphere again now and then.
    let mut random = Random::named("without_the_offset_rays_do_return");
    let g = one(
        Shape::Sphere,
        Affine3::translation(Vec3::new(300.0, -200.0, 100.0)),
    );
    let centre = g.bounds().centre();
    let mut met = 0;
    for _ in 0..2000 {
        let from = centre + random.direction() * 5.0;
        let ray = Ray::new(from, (centre - from).normalize());
        let s = point(&g, &ray).unwrap();
        met += usize::from(g.occluded(&Ray::new(s.p, away(&mut random, s.ng))));
    }
    assert!(met > 20, "{met}");
}

#[test]
fn surface_points_lie_on_the_surface_within_their_error() {
    let mut random = Random::named("surface_points_lie_on_the_surface_within_their_error");
    for shift in [0.0, 10.0, 1e4] {
        let m = map(&mut random, 2.0, shift);
        let g = one(Shape::Sphere, m);
        let back = m.to_f64().inverse().unwrap();
        for _ in 0..500 {
            let c = g.bounds().centre();
            let from = c + random.direction() * 20.0;
            let Some(s) = point(&g, &Ray::new(from, (c - from).normalize())) else {
                continue;
            };
            // In object space the distance to the unit sphere; the map stretches by at most 2.6.
            let off = (back.transform_point(s.p.to_f64()).length() - 1.0).abs();
            assert!(off * 2.6 <= f64::from(s.error), "{off} > {}", s.error);
            let frame = [s.ns, s.tangent, s.bitangent()];
            for (i, a) in frame.iter().enumerate() {
                for (j, b) in frame.iter().enumerate() {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    assert!((a.dot(*b) - unit).abs() < 1e-6);
                }
            }
        }
    }
}

#[test]
fn shadow_rays_stop_short_of_their_target() {
    let mut random = Random::named("shadow_rays_stop_short_of_their_target");
    for shift in [0.0, 1e3] {
        let at = Affine3::translation(Vec3::new(shift, 0.0, -shift));
        let light = Affine3::rotation(Vec3::new(1.0, 0.0, 0.0), 2.0)
            .then(&Affine3::translation(Vec3::new(0.0, 3.0, 0.0)))
            .then(&at);
        // The light reaches √2 from its middle, the floor comes no nearer than 1.6.
        let around = Affine3::scale(Vec3::splat(1.5)).then(&light);
        let floor = Affine3::rotation(Vec3::new(1.0, 0.0, 0.0), -1.2).then(&at);
        let g = Geometry::build(
            vec![Shape::Rectangle, Shape::Sphere],
            vec![instance(0, floor), instance(0, light), instance(1, around)],
        )
        .unwrap();
        let open = Geometry::build(
            vec![Shape::Rectangle],
            vec![instance(0, floor), instance(0, light)],
        )
        .unwrap();
        for _ in 0..2000 {
            let u = [random.unit(), random.unit()];
            let a = open.sample_area(0, u, 0.0);
            let from = a.p + a.ng;
            let s = point(&open, &Ray::new(from, (a.p - from).normalize())).unwrap();
            let target = open.sample_area(1, [random.unit(), random.unit()], 0.0);
            let ray = s.spawn_ray_to(target.p);
            assert!(!open.occluded(&ray), "{s:?} to {target:?}");
            // With a sphere around the light in between there is something in the way.
            assert!(g.occluded(&ray));
            assert!(!open.occluded(&s.spawn_ray_to(s.p)));
        }
    }
}
