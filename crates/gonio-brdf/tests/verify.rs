//! Every model is held to what it declares, by `gonio-verify`.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

mod common;

use gonio_brdf::{Declares, ModelSpec, check, registry};
use gonio_verify::{Effort, Outcome, Property};

fn passes(text: &str) {
    let spec = ModelSpec::parse(text).unwrap();
    let report = check(&spec, Effort::Quick).unwrap();
    assert!(report.passed(), "{report}");
}

#[test]
fn defaults_of_every_model() {
    for info in registry::models() {
        if let Some(spec) = common::base(info) {
            passes(&spec.to_string());
        }
    }
}

#[test]
fn microfacets_of_every_kind() {
    for distribution in ["ggx", "beckmann", "blinn-phong"] {
        for (masking, more) in [
            ("v-cavity", "roughness=0.6,metal=copper"),
            ("smith", "alpha_x=0.15,alpha_y=0.6,rotation_deg=30"),
            (
                "smith-correlated",
                "roughness=0.9,ior=1.5,interreflection=none",
            ),
        ] {
            passes(&format!(
                "torrance-sparrow:distribution={distribution},masking={masking},{more}"
            ));
        }
    }
}

/// A white furnace: with F = 1 and interreflection the albedo of every direction is 1 but for the tables' accuracy, and
/// never more.
#[test]
fn white_furnace() {
    for text in [
        "ggx:fresnel=none,roughness=0.55",
        "ggx:fresnel=none,roughness=1,masking=smith",
        "beckmann:fresnel=none,roughness=0.85",
        "cook-torrance:fresnel=none,roughness=0.7",
    ] {
        let report = check(&ModelSpec::parse(text).unwrap(), Effort::Quick).unwrap();
        assert!(report.passed(), "{report}");
        let verdict = report.verdict(Property::EnergyConservation).unwrap();
        assert!(verdict.figure > 0.998, "{report}");
    }
}

#[test]
fn what_is_declared_costs_and_is_seen() {
    for (text, property) in [
        (
            "phong:normalisation=published,exponent=1,specular=1",
            Property::EnergyConservation,
        ),
        ("toon", Property::Reciprocity),
        ("ggx:anisotropy=0.8", Property::Isotropy),
        ("gltf:roughness=0", Property::EnergyConservation),
    ] {
        let report = check(&ModelSpec::parse(text).unwrap(), Effort::Quick).unwrap();
        assert!(report.passed(), "{report}");
        assert_eq!(
            report.verdict(property).unwrap().outcome,
            Outcome::Declared,
            "{report}"
        );
    }
}

#[test]
fn declarations_follow_the_parameters() {
    let declares = |text: &str| ModelSpec::parse(text).unwrap().declares().unwrap();
    assert_eq!(declares("lambertian:0.5"), Declares::physical(0.5));
    assert!(declares("phong:diffuse=0.5,specular=0.5").energy_conserving);
    assert!(!declares("phong:diffuse=0.6,specular=0.5").energy_conserving);
    assert!(!declares("phong:normalisation=published,exponent=0").energy_conserving);
    assert!(declares("sum(lambertian:0.5, mirror:0.5)").energy_conserving);
    assert!(!declares("sum(lambertian:0.5, mirror:0.6)").energy_conserving);
    assert!(declares("scaled(0.5, sum(lambertian:1, mirror:1))").energy_conserving);
    assert!(!declares("scaled(0.5, toon)").reciprocal);
    assert!(!declares("ggx:alpha_x=0.1,alpha_y=0.2").isotropic);
    assert!(!declares("torrance-sparrow:distribution=blinn-phong").energy_conserving);
    assert!(declares("gltf:metallic=1").energy_conserving);
}
