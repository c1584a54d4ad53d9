use super::*;
use crate::light::Light;
use crate::light::choice::{power, shares};
use crate::light::tree::tests::{everything, receiver};
use crate::{Material, Scene, SceneBuilder, Shape};
use gonio_brdf::ModelSpec;
use gonio_num::Affine3;
use gonio_radiometry::sequence::Rng;

/// The black light of [`everything`] comes before the directional one and the shapes that shine.
fn black(scene: &Scene) -> u32 {
    let is_black =
        |l: &Light| matches!(l, Light::Point { intensity, .. } if *intensity == [0.0; 3]);
    scene.lights.iter().position(is_black).unwrap() as u32
}

/// The probability of each light, which is the same at all points.
fn probabilities(scene: &Scene, choice: LightChoice, rng: &mut Rng) -> Vec<f64> {
    let lights = scene.lights.by(choice);
    let at = [receiver(rng), receiver(rng)];
    (0..scene.lights.len() as u32)
        .map(|l| {
            let [a, b] = at.map(|at| lights.probability(&at, l));
            assert_eq!(a, b);
            f64::from(a)
        })
        .collect()
}

/// 1/n each, and in proportion to power; 0 for a black light. Roundings: 2⁻²⁴ of each probability, 2⁻³² of a table that counts in that, and of
/// as many lights together.
#[test]
fn probabilities_are_what_they_are_called() {
    let scene = everything("probabilities_are_what_they_are_called", 60);
    let mut rng = Rng::from_name("probabilities_are_what_they_are_called");
    let powers: Vec<f64> = (scene.lights.iter())
        .map(|l| power(l, &scene.geometry))
        .collect();
    let black = black(&scene) as usize;
    let count = (powers.len() - 1) as f64;
    let total: f64 = powers.iter().sum();
    for choice in [LightChoice::Power, LightChoice::Uniform] {
        let found = probabilities(&scene, choice, &mut rng);
        assert_eq!(found[black], 0.0);
        let unit = 1.0 / f64::from(u32::MAX);
        for (i, (p, power)) in found.iter().zip(&powers).enumerate() {
            let expected = match choice {
                _ if i == black => 0.0,
                LightChoice::Uniform => 1.0 / count,
                _ => power / total,
            };
            let bound = expected / (1 << 23) as f64 + count * unit;
            assert!(
                (p - expected).abs() <= bound,
                "{choice:?}, {i}: {p} {expected}"
            );
        }
        let sum: f64 = found.iter().sum();
        assert!((sum - 1.0).abs() < 1e-6, "{choice:?}: {sum}");
    }
}

/// How often each light is chosen: of those that are expected a hundred times or more, none is more than 5.5 standard deviations off (4e-8,
/// two-sided, of at most 63 lights for each of two choices: 5e-6). The control: the probabilities of the other choice.
#[test]
fn lights_are_chosen_as_often_as_said() {
    let scene = everything("lights_are_chosen_as_often_as_said", 60);
    let mut rng = Rng::from_name("lights_are_chosen_as_often_as_said");
    let count = 300_000;
    for (choice, other) in [
        (LightChoice::Power, LightChoice::Uniform),
        (LightChoice::Uniform, LightChoice::Power),
    ] {
        let mut observed = vec![0_u32; scene.lights.len()];
        for _ in 0..count {
            let at = receiver(&mut rng);
            let (light, probability) = scene.lights.by(choice).choose(&at, rng.next_f32()).unwrap();
            let same = scene.lights.by(choice).probability(&at, light.index());
            assert_eq!(probability, same);
            observed[light.index() as usize] += 1;
        }
        assert_eq!(observed[black(&scene) as usize], 0);
        let largest_deviation = |expected: &[f64]| {
            let mut largest: f64 = 0.0;
            for (&found, p) in observed.iter().zip(expected) {
                let mean = p * f64::from(count);
                if mean >= 100.0 {
                    let deviation = (f64::from(found) - mean) / (mean * (1.0 - p)).sqrt();
                    largest = largest.max(deviation.abs());
                }
            }
            largest
        };
        let off = largest_deviation(&probabilities(&scene, choice, &mut rng));
        assert!(off < 5.5, "{choice:?}: {off}");
        let control = largest_deviation(&probabilities(&scene, other, &mut rng));
        assert!(control > 5.5, "{choice:?}: the control passed: {control}");
    }
}

/// A light next to another one that is 10⁴⁰ times as strong has one of the 2³² parts of the table, and is found there.
#[test]
fn no_light_that_shines_is_impossible() {
    let mut builder = SceneBuilder::new("faint");
    for intensity in [1e-20, 1e20, 0.0] {
        builder.light(Light::Point {
            position: Vec3::new(0.0, 1.0, 0.0),
            intensity: [intensity; 3],
        });
    }
    let floor = builder.shape(Shape::Rectangle);
    let spec = ModelSpec::parse("lambertian").unwrap();
    let grey = builder.material(Material::new("grey", &spec).unwrap());
    builder.instance(floor, Affine3::identity(), grey);
    let scene = builder.build().unwrap();
    let lights = scene.lights.by(LightChoice::Power);
    let at = Receiver {
        p: Vec3::zero(),
        error: 0.0,
        normal: Vec3::zero(),
    };
    let of = |l| lights.probability(&at, l);
    assert_eq!([0, 1, 2].map(of), [2.0_f32.powi(-32), 1.0, 0.0]);
    // Numbers below 2⁻²⁴ are this one with other digits, by the point.
    let mut rng = Rng::from_name("no_light_that_shines_is_impossible");
    let mut found = [0; 2];
    for _ in 0..100_000 {
        let at = receiver(&mut rng);
        let (light, probability) = lights.choose(&at, 0.0).unwrap();
        assert_eq!(probability, of(light.index()));
        found[light.index() as usize] += 1;
    }
    // One of 256 of them: 391 ± 20, here within five of those.
    assert!((291..491).contains(&found[0]), "{found:?}");
    assert_eq!(
        shares(&[1e-60, 1.0, 0.0, f64::NAN]),
        [f32::MIN_POSITIVE, 1.0, 0.0, 0.0]
    );
}
