//! Many rays at once have the answers of each alone, to the bit, however the scene is searched.

use super::agreement::{bits, ray};
use super::scenes::{Random, bumpy_sphere, instance, one, soup};
use crate::geometry::coherence::are_coherent;
use crate::geometry::nearest::Nearest;
use crate::geometry::{Geometry, Shape, kernel::Portable};
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
            // As a camera has them, too: those are walked one by one.
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
