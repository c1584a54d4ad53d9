use super::*;
use crate::light::choice::Choice;
use crate::light::{LightChoice, LightSamples, LightTarget, SpotCone, WHOLE};
use crate::{Material, Ray, Scene, SceneBuilder, Shape, Surfaces, TriangleMesh};
use gonio_brdf::ModelSpec;
use gonio_env::{Environment, Guide};
use gonio_num::{Affine3, Real, Vectors};
use gonio_radiometry::sequence::Rng;
use gonio_radiometry::warp::uniform_sphere;
use std::sync::Arc;

fn point_of(rng: &mut Rng, size: f32) -> Vec3<f32> {
    Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * (2.0 * size) - Vec3::splat(size)
}

fn direction(rng: &mut Rng) -> Vec3<f32> {
    uniform_sphere([rng.next_f32(), rng.next_f32()])
}

/// Anywhere around the lights, among them as well; facing some way, or all ways.
pub(in crate::light) fn receiver(rng: &mut Rng) -> Receiver {
    let faces = rng.next_f32() < 0.8;
    let normal = direction(rng);
    Receiver {
        p: point_of(rng, 6.0),
        error: 1e-6,
        normal: if faces { normal } else { Vec3::zero() },
    }
}

/// Lights of every kind, of very different sizes, radiances and orientations, a few of them one beside the other.
pub(in crate::light) fn everything(name: &str, count: usize) -> Scene {
    let mut rng = Rng::from_name(name);
    let mut builder = SceneBuilder::new(name);
    let fin = TriangleMesh {
        positions: [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ]
        .map(Into::into)
        .to_vec(),
        // The third triangle has no area.
        indices: vec![[0, 1, 2], [0, 2, 3], [0, 1, 1], [1, 3, 2]],
        ..TriangleMesh::default()
    };
    let shapes = [
        Shape::Sphere,
        Shape::Rectangle,
        Shape::Disk,
        Shape::Mesh(Arc::new(fin)),
    ]
    .map(|s| builder.shape(s));
    for k in 0..count {
        let position = point_of(&mut rng, 5.0);
        let size = 0.02 + 2.0 * rng.next_f32() * rng.next_f32() * rng.next_f32();
        let turn = Affine3::rotation(direction(&mut rng), 6.0 * rng.next_f32());
        let uneven = if k % 3 == 0 { 0.3 } else { 1.0 };
        let scale = Affine3::scale(Vec3::new(size, size * uneven, size));
        let mut lamp = Material::new(
            "lamp",
            &ModelSpec::parse("lambertian:reflectance=0").unwrap(),
        )
        .unwrap();
        let strength = 10.0_f32.powi((6.0 * rng.next_f32()) as i32 - 3);
        lamp.emission.radiance = [strength, 0.7 * strength, 0.0];
        lamp.double_sided = k % 4 == 1;
        match k % 6 {
            4 => builder.light(Light::Point {
                position,
                intensity: [strength; 3],
            }),
            5 => builder.light(Light::Spot {
                position,
                direction: direction(&mut rng),
                intensity: [strength; 3],
                cone: SpotCone::new(0.2, 0.2 + rng.next_f32()).unwrap(),
            }),
            kind => {
                let material = builder.material(lamp);
                let placed = scale.then(&turn).then(&Affine3::translation(position));
                builder.instance(shapes[kind], placed, material);
            }
        }
    }
    builder.light(Light::Point {
        position: Vec3::zero(),
        intensity: [0.0; 3],
    });
    builder.light(Light::Directional {
        direction: Vec3::new(0.0, -1.0, 0.0),
        irradiance: [0.5; 3],
    });
    builder.environment(Environment::uniform([0.1; 3]));
    builder.build().unwrap()
}

fn tree_of(scene: &Scene) -> &LightTree {
    match scene.lights.by(LightChoice::Tree).choice {
        Choice::Tree { tree, .. } => tree,
        other => panic!("no tree: {other:?}"),
    }
}

#[test]
fn probabilities_sum_to_one() {
    for count in [2, 7, 8, 9, 150] {
        let scene = everything(&format!("probabilities {count}"), count);
        let tree = tree_of(&scene);
        let mut rng = Rng::from_name("probabilities_sum_to_one");
        for _ in 0..50 {
            let at = receiver(&mut rng);
            let each = |l: &Leaf| tree.probability(&at, l.light, l.primitive);
            let total: f64 = tree.leaves.iter().map(each).sum();
            // Roundings: 2⁻⁵³ for each of a few factors of each leaf.
            assert!(total < 1.0 + 1e-12, "{total}");
            // What is missing are numbers that end without a light: at most one interval for each leaf, whose ends the grid may miss.
            let grid = 20_000;
            let ends = (0..grid).filter(|&k| {
                let u = (f64::from(k) + 0.5) / f64::from(grid);
                tree.choose(&at, u).is_none()
            });
            let share = ends.count() as f64 / f64::from(grid);
            let missed = (tree.leaves.len() + 1) as f64 / f64::from(grid);
            assert!((1.0 - total - share).abs() < missed, "{total} {share}");
            let by_light: f64 = (0..scene.lights.len() as u32)
                .map(|l| f64::from(scene.lights.by(LightChoice::Tree).probability(&at, l)))
                .sum();
            assert!(by_light < 1.0 + 1e-5);
        }
    }
}

/// How often each leaf is chosen, at several points: of those that are expected a hundred times or more, none is more than 5.5 standard deviations
/// off (4e-8, two-sided, a leaf of at most 60 at each of 20 points: 5e-5). The control: expectations of a point beside it.
#[test]
fn lights_are_chosen_as_often_as_said() {
    const POINTS: usize = 20;
    let scene = everything("lights_are_chosen_as_often_as_said", 60);
    let tree = tree_of(&scene);
    let mut rng = Rng::from_name("lights_are_chosen_as_often_as_said");
    let count = 100_000;
    let mut told_apart = 0;
    for _ in 0..POINTS {
        let at = receiver(&mut rng);
        // One more than there are leaves: no light.
        let none = tree.leaves.len();
        let mut observed = vec![0_u32; none + 1];
        for _ in 0..count {
            let u = f64::from(rng.next_f32());
            match tree.choose(&at, u) {
                Some(found) => {
                    let leaf = tree.leaf(found.light, found.primitive).unwrap();
                    let same = tree.probability(&at, found.light, found.primitive);
                    assert!((same / found.probability - 1.0).abs() < 1e-12);
                    assert!((0.0..1.0).contains(&found.rest));
                    let place = tree.leaves.iter().position(|l| std::ptr::eq(l, leaf));
                    observed[place.unwrap()] += 1;
                }
                None => observed[none] += 1,
            }
        }
        let largest_deviation = |at: &Receiver| {
            let each = |l: &Leaf| tree.probability(at, l.light, l.primitive);
            let mut expected: Vec<f64> = tree.leaves.iter().map(each).collect();
            expected.push((1.0 - expected.iter().sum::<f64>()).max(0.0));
            let mut largest: f64 = 0.0;
            for (&found, p) in observed.iter().zip(expected) {
                let mean = p * f64::from(count);
                if mean >= 100.0 {
                    let deviation = (f64::from(found) - mean) / (mean * (1.0 - p)).sqrt().max(1e-9);
                    largest = largest.max(deviation.abs());
                }
            }
            largest
        };
        let off = largest_deviation(&at);
        assert!(off < 5.5, "{off} at {at:?}");
        let beside = Receiver {
            p: at.p + Vec3::splat(0.3),
            ..at
        };
        told_apart += usize::from(largest_deviation(&beside) > 5.5);
    }
    assert!(told_apart > POINTS * 3 / 4, "{told_apart}");
}

/// Where a light sends light to the side that a point faces, its probability is not 0, with margins for what the leaves of this test leave
/// out: light that grazes the surface or the lamp. The control: the point turned around, where many lights must be impossible.
#[test]
fn no_light_that_arrives_is_impossible() {
    let (mut lit, mut impossible) = (0, 0);
    for count in [3, 40, 300] {
        let scene = everything(&format!("arrives {count}"), count);
        let tree = tree_of(&scene);
        let mut rng = Rng::from_name("no_light_that_arrives_is_impossible");
        for _ in 0..20_000 {
            let at = receiver(&mut rng);
            let leaf = &tree.leaves[(rng.next_u32() as usize) % tree.leaves.len()];
            let u = [rng.next_f32(), rng.next_f32()];
            let which = (leaf.light, leaf.primitive);
            let from = (at.p, at.error);
            let sample = (scene.lights).sample_one(Guide::Luminance, which, from, 0.5, u);
            let Some(sample) = sample else { continue };
            if at.normal != Vec3::zero() && sample.wi.dot(at.normal) <= 0.0 {
                continue;
            }
            lit += 1;
            let p = tree.probability(&at, leaf.light, leaf.primitive);
            assert!(p > 0.0, "{which:?} at {at:?}: {sample:?}");
            let turned = Receiver {
                normal: -at.normal,
                ..at
            };
            impossible += u32::from(tree.probability(&turned, leaf.light, leaf.primitive) == 0.0);
        }
    }
    assert!(lit > 10_000 && impossible > lit / 10, "{lit} {impossible}");
}

/// Mean and variance of the estimate of the irradiance, red and green added, from the side that a point faces.
fn irradiance(
    lights: (&Scene, LightChoice),
    at: &Receiver,
    rng: &mut Rng,
    count: u32,
) -> (f64, f64) {
    let (scene, choice) = lights;
    let lights = scene.lights.by(choice);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..count {
        let (select, u) = (rng.next_f32(), [rng.next_f32(), rng.next_f32()]);
        let value = lights.sample(at, select, u).map_or(0.0, |s| {
            let end = match s.target {
                LightTarget::Point(p) => (p - at.p).length() * 0.999,
                LightTarget::Infinite => f32::INFINITY,
            };
            let mut ray = Ray::new(at.p, s.wi);
            ray.t_max = end;
            let light = f64::from(s.radiance[0] + s.radiance[1]) / f64::from(s.pdf);
            let hidden = scene.occluded(&ray);
            if hidden {
                0.0
            } else {
                light * f64::from(s.wi.dot(at.normal).max(0.0))
            }
        });
        sum += value;
        squares += value * value;
    }
    let n = f64::from(count);
    let mean = sum / n;
    (mean, (squares / n - mean * mean).max(0.0))
}

/// The tree against the uniform choice, whose expectation is the same: z of the difference at many points, within 4.5 (7e-6 a test, of
/// 40), and less variance in the geometric mean. Of 120 lights one has a hundredth of the samples, which deviate by some ten times the mean: by 4 % of it
/// in 60,000. The controls: half as much again isn't the same at most points.
#[test]
fn the_tree_has_the_expectation_of_the_uniform_choice_and_less_variance() {
    let scene = everything("the expectation", 120);
    let (tree, uniform) = (LightChoice::Tree, LightChoice::Uniform);
    assert!(scene.lights.by(tree).asks_for_normals());
    assert!(!scene.lights.by(uniform).asks_for_normals());
    let mut rng = Rng::from_name("the tree has the expectation");
    let (mut told_apart, mut log_ratio, mut points) = (0, 0.0, 0);
    while points < 40 {
        let at = Receiver {
            normal: direction(&mut rng),
            ..receiver(&mut rng)
        };
        let count = 60_000;
        let (a, va) = irradiance((&scene, tree), &at, &mut rng, count);
        let (b, vb) = irradiance((&scene, uniform), &at, &mut rng, count);
        if vb == 0.0 {
            continue;
        }
        points += 1;
        let error = ((va + vb) / f64::from(count)).sqrt();
        assert!((a - b).abs() < 4.5 * error, "{a} {b} ± {error} at {at:?}");
        told_apart += u32::from((1.5 * a - b).abs() > 4.5 * error);
        log_ratio += Real::ln(va / vb);
    }
    let ratio = Real::exp(log_ratio / f64::from(points));
    println!("variance with the tree / uniform: {ratio:.3}");
    assert!(told_apart > 20, "{told_apart}");
    assert!(ratio < 0.5, "{ratio}");
}

/// Lights at one place, and lights on a line: every split is as good as another.
#[test]
fn lights_that_nothing_tells_apart_are_still_a_tree() {
    let mut builder = SceneBuilder::new("same place");
    for k in 0..50 {
        builder.light(Light::Point {
            position: Vec3::new(1.0, 2.0, if k < 30 { 3.0 } else { k as f32 }),
            intensity: [1.0; 3],
        });
    }
    let floor = builder.shape(Shape::Rectangle);
    let spec = ModelSpec::parse("lambertian").unwrap();
    let grey = builder.material(Material::new("grey", &spec).unwrap());
    builder.instance(floor, Affine3::identity(), grey);
    let scene = builder.build().unwrap();
    let at = Receiver {
        p: Vec3::new(1.0, 2.0, 3.0),
        error: 0.0,
        normal: Vec3::zero(),
    };
    for p in [at.p, Vec3::zero(), Vec3::splat(1e6)] {
        let at = Receiver { p, ..at };
        let total: f64 = (0..50)
            .map(|l| tree_of(&scene).probability(&at, l, WHOLE))
            .sum();
        assert!((total - 1.0).abs() < 1e-12, "{total}");
    }
}

/// Any number of points together find what each finds alone: lights, densities, directions and radiances, to the bit.
#[test]
fn many_points_sample_what_each_samples() {
    let (tree, power, uniform) = (LightChoice::Tree, LightChoice::Power, LightChoice::Uniform);
    for (choice_of_light, lights, points) in [
        (tree, 900, 1000),
        (tree, 900, 1),
        (tree, 12, 500),
        (power, 900, 1000),
        (power, 12, 500),
        (uniform, 900, 1000),
        (uniform, 900, 1),
        (uniform, 12, 500),
    ] {
        let mut rng = Rng::from_name("many_points_sample_what_each_samples");
        let scene = everything("many_points_sample_what_each_samples", lights);
        let lights = scene.lights.by(choice_of_light);
        let (mut from, mut normals) = (Surfaces::default(), Vectors::default());
        from.resize(points);
        normals.resize(points);
        let receivers: Vec<Receiver> = (0..points).map(|_| receiver(&mut rng)).collect();
        for (i, at) in receivers.iter().enumerate() {
            from.p.set(i, at.p);
            from.error[i] = at.error;
            normals.set(i, at.normal);
        }
        let mut column = || -> Vec<f32> { (0..points).map(|_| rng.next_f32()).collect() };
        let (choice, u, v) = (column(), column(), column());
        let mut found = LightSamples::default();
        // Twice: what the first call leaves behind has no part in the second.
        for _ in 0..2 {
            let guide = Guide::Luminance;
            lights.sample_many(guide, &from, &normals, &choice, [&u, &v], &mut found);
        }
        let mut carrying = 0;
        for (i, at) in receivers.iter().enumerate() {
            let one = lights.sample(at, choice[i], [u[i], v[i]]);
            let Some(one) = one else {
                assert_eq!(found.pdf[i], 0.0, "{i}");
                continue;
            };
            carrying += 1;
            assert_eq!((found.light[i], found.pdf[i]), (one.light, one.pdf), "{i}");
            assert_eq!(found.wi.get(i), one.wi, "{i}");
            assert_eq!(found.delta[i], one.delta, "{i}");
            assert_eq!([0, 1, 2].map(|c| found.radiance[c][i]), one.radiance, "{i}");
            match one.target {
                LightTarget::Infinite => assert!(found.infinite[i], "{i}"),
                LightTarget::Point(p) => {
                    assert_eq!((found.infinite[i], found.target.get(i)), (false, p), "{i}");
                }
            }
        }
        assert!(points == 1 || carrying > points / 3, "{carrying}");
    }
}
