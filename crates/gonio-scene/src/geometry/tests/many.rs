//! Many rays at once have the answers of each alone, to the bit, however the scene is searched.

use super::agreement::{bits, ray};
use super::scenes::{Random, bumpy_sphere, instance, one, soup};
use crate::geometry::beam::{self, Asked};
use crate::geometry::coherence::are_coherent;
use crate::geometry::kernel::{Kernel, Portable};
use crate::geometry::nearest::Nearest;
use crate::geometry::{Geometry, Shape};
use crate::{Hit, Ray};
use gonio_num::{Affine3, Vec3, Vectors};
use std::sync::Arc;

fn placed(random: &mut Random, size: f32) -> Affine3<f32> {
    let mut m = Affine3::identity();
    m.x = random.direction() * size;
    m.y = random.direction() * size;
    m.z = random.direction() * size;
    m.origin = random.point();
    m
}

/// A mesh alone; one with shapes; so many of both that a tree stands above them; shapes alone, few and many; nothing.
fn geometries(random: &mut Random) -> Vec<Geometry> {
    let soup = || Shape::Mesh(Arc::new(soup(&mut Random::named("soup"), 500, 0.2)));
    let ball = Shape::Mesh(Arc::new(bumpy_sphere(40, 20, 0.1)));
    let shapes = || vec![soup(), Shape::Sphere, Shape::Rectangle, Shape::Disk];
    let several = |random: &mut Random, counts: [u32; 4]| {
        let mut instances = Vec::new();
        for (shape, count) in counts.iter().enumerate() {
            for _ in 0..*count {
                instances.push(instance(shape as u32, placed(random, 0.3)));
            }
        }
        Geometry::build(shapes(), instances).unwrap()
    };
    vec![
        one(soup(), Affine3::identity()),
        one(ball, placed(random, 0.7)),
        several(random, [1, 3, 2, 1]),
        several(random, [2, 0, 0, 0]),
        several(random, [6, 20, 10, 10]),
        several(random, [0, 200, 0, 0]),
        several(random, [0, 2, 1, 0]),
        several(random, [0, 0, 0, 0]),
    ]
}

#[test]
fn many_rays_at_once_are_each_alone() {
    let mut random = Random::named("many_rays_at_once_are_each_alone");
    let corners = soup(&mut Random::named("soup"), 500, 0.2);
    for (k, geometry) in geometries(&mut random).iter().enumerate() {
        // Fewer than are walked at a time, and more.
        for (count, coherent) in [
            (0, false),
            (1, false),
            (5, false),
            (1000, false),
            (15, true),
            (1003, true),
        ] {
            let mut rays: Vec<Ray> = (0..count).map(|_| ray(&mut random, &corners)).collect();
            // As a camera has them, too: those go together.
            let eye = random.direction() * 3.0;
            if coherent {
                let (mut toward, mut aside) = (-eye.normalize(), random.direction() * 1e-3);
                for ray in &mut rays {
                    toward = (toward + aside).normalize();
                    if random.below(100) == 0 {
                        (toward, aside) = (
                            (random.point() * 0.7 - eye).normalize(),
                            random.direction() * 1e-3,
                        );
                    }
                    (ray.origin, ray.direction) = (eye, toward);
                }
            }
            if count > 5 {
                rays[3].direction = Vec3::zero();
                rays[4].origin.x = f32::NAN;
            }
            let (mut origins, mut directions) = (Vectors::default(), Vectors::default());
            origins.resize(count);
            directions.resize(count);
            for (i, ray) in rays.iter().enumerate() {
                origins.set(i, ray.origin);
                directions.set(i, ray.direction);
            }
            let columns = [&origins, &directions];
            let size = geometry.bounds().max - geometry.bounds().min;
            let told = are_coherent(columns, size.length());
            assert!(count < 1000 || k == 7 || told == coherent, "{k}");
            let ends: Vec<f32> = rays.iter().map(|r| r.t_max).collect();
            let (mut hits, mut occluded) = (Vec::new(), Vec::new());
            geometry.intersect_many(columns, &mut hits);
            geometry.occluded_many(columns, &ends, &mut occluded);
            assert_eq!((hits.len(), occluded.len()), (count, count));
            let mut portable = vec![Nearest::none(f32::INFINITY); count];
            let mut any: Vec<Nearest> = ends.iter().map(|t| Nearest::none(*t)).collect();
            if geometry.simple.shapes.is_empty() {
                geometry.search_many::<Portable, false>(Portable, columns, &mut portable);
                geometry.search_many::<Portable, true>(Portable, columns, &mut any);
            }
            let mut met = 0;
            for (i, ray) in rays.iter().enumerate() {
                let truth = geometry.intersect(&Ray::new(ray.origin, ray.direction));
                let found = |hit: Hit| (hit.t < f32::INFINITY).then_some(hit);
                assert_eq!(bits(found(hits[i])), bits(truth), "{k} {ray:?}");
                assert_eq!(occluded[i], geometry.occluded(ray), "{k} {ray:?}");
                if geometry.simple.shapes.is_empty() {
                    assert_eq!(bits(portable[i].hit()), bits(truth), "{k} {ray:?}");
                    assert_eq!(any[i].found(), occluded[i], "{k} {ray:?}");
                }
                met += usize::from(truth.is_some());
            }
            assert!(
                count < 1000 || coherent || k == 7 || (10..990).contains(&met),
                "{k} {met}"
            );
        }
    }
}

/// The nearest hit of each ray, and whether there is any before its end.
fn through_beams<K: Kernel>(
    kernel: K,
    geometry: &Geometry,
    rays: [&Vectors; 2],
    ends: &[f32],
) -> Vec<(Nearest, Nearest)> {
    let asked = Asked {
        tree: &geometry.trees[0],
        instance: 0,
        placed: &geometry.placed[0],
        bounds: &geometry.bounds,
    };
    let mut nearest = vec![Nearest::none(f32::INFINITY); ends.len()];
    let mut any: Vec<Nearest> = ends.iter().map(|t| Nearest::none(*t)).collect();
    beam::search::<K, false>(kernel, &asked, rays, &mut nearest);
    beam::search::<K, true>(kernel, &asked, rays, &mut any);
    nearest.into_iter().zip(any).collect()
}

/// Beams of a camera, at corners and edges of triangles, along every axis, near and so far away that single precision hardly tells the
/// triangles apart: what a beam leaves out, no ray of it meets alone.
#[test]
fn beams_leave_nothing_out() {
    let mut random = Random::named("beams_leave_nothing_out");
    let (mut met, mut count) = (0, 0);
    for (mesh, far) in [
        (bumpy_sphere(90, 45, 0.1), 0.0),
        (bumpy_sphere(30, 15, 0.1), 3e4),
        (soup(&mut random, 3000, 0.02), 0.0),
        (soup(&mut random, 3000, 0.3), 1e3),
    ] {
        let mut mesh = mesh;
        let offset = random.direction() * far;
        for p in &mut mesh.positions {
            *p += offset;
        }
        let geometry = one(Shape::Mesh(Arc::new(mesh.clone())), Affine3::identity());
        for round in 0..60 {
            let mut toward = random.direction();
            match round % 3 {
                // Nearly along an axis: components of both signs.
                0 => {
                    let axis = random.below(3);
                    let mut d = (random.direction() * 0.02).to_array();
                    d[axis] = if random.signed() < 0.0 { -1.0 } else { 1.0 };
                    toward = Vec3::from(d).normalize();
                }
                // Nearly along a diagonal: the longest component changes.
                1 => {
                    let sign = |random: &mut Random| if random.signed() < 0.0 { -1.0 } else { 1.0 };
                    let d = [0; 3].map(|_| sign(&mut random));
                    toward = (Vec3::from(d) + random.direction() * 0.01).normalize();
                }
                _ => {}
            }
            let eye = offset - toward * (1.5 + 3.0 * random.unit());
            let centre = offset + random.direction() * 0.7;
            let (mut origins, mut directions) = (Vectors::default(), Vectors::default());
            origins.resize(256);
            directions.resize(256);
            let mut ends = Vec::new();
            for i in 0..256 {
                let target = if i % 2 == 0 {
                    let [a, b, c] = mesh.corners(random.below(mesh.indices.len()));
                    let s = random.unit();
                    let on = if i % 4 == 0 { a * s + b * (1.0 - s) } else { c };
                    // Narrow beams and wide ones.
                    if round % 2 == 0 || (on - centre).length() < 0.15 {
                        on
                    } else {
                        centre
                    }
                } else {
                    centre + random.point() * 0.08
                };
                let lens = random.point() * 1e-3;
                origins.set(i, eye + lens);
                directions.set(i, (target - eye).normalize());
                ends.push(if i % 5 == 0 {
                    4.0 * random.unit()
                } else {
                    f32::INFINITY
                });
            }
            let columns = [&origins, &directions];
            let found = through_beams(Portable, &geometry, columns, &ends);
            for i in 0..256 {
                let mut ray = Ray::new(origins.get(i), directions.get(i));
                let truth = geometry.intersect(&ray);
                assert_eq!(bits(found[i].0.hit()), bits(truth), "{far} {ray:?}");
                ray.t_max = ends[i];
                let hidden = geometry.occluded(&ray);
                assert_eq!(found[i].1.found(), hidden, "{far} {ray:?}");
                met += usize::from(truth.is_some());
                count += 1;
            }
            #[cfg(target_arch = "x86_64")]
            if let Some(kernel) = crate::geometry::avx2::Avx2::detect() {
                let fast = through_beams(kernel, &geometry, columns, &ends);
                for (fast, found) in fast.iter().zip(&found) {
                    assert_eq!(bits(fast.0.hit()), bits(found.0.hit()));
                    assert_eq!(fast.1.found(), found.1.found());
                }
            }
        }
    }
    // Both answers are common.
    assert!(met > count / 10 && met < count * 9 / 10, "{met} of {count}");
}
