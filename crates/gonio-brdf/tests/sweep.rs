//! Models are as they declare all over their space of parameters.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

use gonio_brdf::{CheckOptions, ModelSpec, space, sweep};
use gonio_verify::{Effort, Property, Range, Settings};

fn spec(text: &str) -> ModelSpec {
    ModelSpec::parse(text).unwrap()
}

#[test]
fn the_space_is_what_the_description_leaves_open() {
    let axes = space(&spec("ggx:roughness=0.3")).unwrap();
    let named = |name: &str| axes.iter().find(|a| a.name == name);
    assert!(named("roughness").is_none() && named("distribution").is_none());
    let anisotropy = named("anisotropy").unwrap();
    assert!(!anisotropy.optional, "{anisotropy:?}");
    // It has no effect unless it is set, and then excludes the index of refraction.
    assert!(named("metal").unwrap().optional);
    let Range::Words(metals) = &named("metal").unwrap().range else {
        panic!("a metal is a word")
    };
    assert!(metals.iter().any(|m| m == "gold"));
}

#[test]
fn parts_of_composites_are_swept_with_them() {
    let names = |text: &str| -> Vec<String> {
        let axes = space(&spec(text)).unwrap();
        axes.into_iter().map(|a| a.name).collect()
    };
    assert_eq!(
        names("sum(lambertian, eon:0.3)"),
        ["lambertian.reflectance", "eon.roughness", "eon.albedo"]
    );
    assert_eq!(
        names("sum(lambertian, lambertian:0.2)"),
        ["lambertian1.reflectance"]
    );
    assert!(names("coat(scaled(0.5, ggx))").contains(&"scaled.torrance-sparrow.roughness".into()));

    // The control: each part conserves energy by itself, both together don't.
    let text = "sum(lambertian, phong:specular=0.5,diffuse=0)";
    let found = sweep(&spec(text), 12, &CheckOptions::new(Effort::Quick)).unwrap();
    let energy = found.worst(Property::EnergyConservation).unwrap();
    assert!(energy.verdict.figure > 1.3, "{energy:?}");
    // The worst point is one of a part.
    assert!(
        energy.at.contains("lambertian:reflectance=1"),
        "{}",
        energy.at
    );
    assert!(spec(&energy.at).build::<f64, 3>().is_ok());
}

#[test]
fn cheap_models_hold_everywhere() {
    for text in ["lambertian", "phong", "eon", "ward"] {
        let found = sweep(&spec(text), 24, &CheckOptions::new(Effort::Quick)).unwrap();
        assert!(found.passed(), "{}", found.table(false));
        assert_eq!(found.points + found.skipped, 24);
        // The worst point is a description that stands by itself.
        let energy = found.worst(Property::EnergyConservation).unwrap();
        assert!(spec(&energy.at).build::<f64, 3>().is_ok(), "{}", energy.at);
    }
}

#[test]
fn values_that_exclude_each_other_are_left_out() {
    let found = sweep(
        &spec("ggx:metal=gold"),
        12,
        &CheckOptions::new(Effort::Quick),
    )
    .unwrap();
    assert!(found.passed(), "{}", found.table(false));
    assert!(
        found.points > 4 && found.skipped > 0,
        "{}",
        found.table(false)
    );
}

/// The control: what absorbs exceeds a bound on its loss, and most where it absorbs the most.
#[test]
fn a_bound_is_held_at_every_point() {
    let options = CheckOptions {
        settings: Settings {
            loss_bound: Some(0.5),
            ..Settings::new(Effort::Quick)
        },
        ..CheckOptions::new(Effort::Quick)
    };
    let found = sweep(&spec("lambertian"), 16, &options).unwrap();
    assert!(!found.passed() && found.failed.len() < found.points);
    let loss = found.worst(Property::EnergyLoss).unwrap();
    assert!((loss.verdict.figure - 1.0).abs() < 1e-9, "{loss:?}");
    assert!(loss.at.contains("reflectance=0"), "{}", loss.at);
}
