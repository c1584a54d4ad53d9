//! Presets: each means what was fitted, and wrong names are told.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

mod formulas;
mod plausible;

use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec, Value, preset};
use gonio_num::Vec3;

fn model(text: &str) -> Model<f64, 3> {
    ModelSpec::parse(text).unwrap().build().unwrap()
}

fn tilted(theta_deg: f64, phi_deg: f64) -> Vec3<f64> {
    let (t, p) = (theta_deg.to_radians(), phi_deg.to_radians());
    Vec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos())
}

/// Light and viewer: near the mirror direction, off it, and on the same side.
fn pairs() -> [(Vec3<f64>, Vec3<f64>); 4] {
    [
        (tilted(30.0, 10.0), tilted(35.0, 185.0)),
        (tilted(70.0, 0.0), tilted(60.0, 170.0)),
        (tilted(20.0, 40.0), tilted(50.0, 300.0)),
        (tilted(50.0, 0.0), tilted(45.0, 15.0)),
    ]
}

#[test]
fn every_preset_is_read_built_and_printed() {
    let (mut fits, mut sets) = (0, 0);
    for set in preset::sets() {
        assert!(set.presets.is_sorted() && !set.summary.is_empty());
        if set.name == "metal" {
            continue;
        }
        sets += 1;
        fits += set.presets.len();
        for name in &set.presets {
            let text = format!("{}@{}/{name}", set.model, set.name);
            let spec = ModelSpec::parse(&text).unwrap();
            assert_eq!(ModelSpec::parse(&spec.to_string()).unwrap(), spec, "{text}");
            assert!(spec.part(set.model).is_some(), "{text}");
            let model: Model<f32, 3> = spec.build().unwrap();
            for (wi, wo) in pairs() {
                let f = model.eval(wi.to_f32(), wo.to_f32());
                assert!(
                    f.iter().all(|x| x.is_finite() && *x >= 0.0),
                    "{text}: {f:?}"
                );
            }
        }
    }
    // Ngan et al. fitted 86 materials with six of these models, Löw et al. 100 twice with two, of which three have slope scales above
    // 1, and once with two; Bagher et al. 100.
    assert!(
        sets >= 13 && fits >= 6 * 86 + 400 - 3 + 300,
        "{sets} {fits}"
    );
}

#[test]
fn further_values_overrule() {
    let spec = ModelSpec::parse("ward@gold-paint:alpha=0.3").unwrap();
    assert_eq!(spec.value("alpha"), Some(Value::Number(0.3)));
    let pairs = [("alpha", "0.3")];
    assert_eq!(
        ModelSpec::from_pairs("ward@gold-paint", pairs).unwrap(),
        spec
    );
    // In a sum it is the named model that takes them.
    let spec = ModelSpec::parse("cook-torrance@gold-paint:alpha=0.3").unwrap();
    assert_eq!(spec.name, "sum");
    let part = spec.part("cook-torrance").unwrap();
    assert_eq!(part.value("alpha"), Some(Value::Number(0.3)));
    // In lists, as any model.
    let spec = ModelSpec::parse("mix(0.2, ward@gold-paint, alpha=0.3, ggx@silver)").unwrap();
    assert_eq!(
        spec.part("ward").unwrap().value("alpha"),
        Some(Value::Number(0.3))
    );
}

#[test]
fn a_bare_name_means_the_first_set_that_has_it() {
    let spec = |text: &str| ModelSpec::parse(text).unwrap();
    assert_eq!(
        spec("cook-torrance@gold-paint"),
        spec("cook-torrance@ngan/gold-paint")
    );
    // Ngan et al. didn't fit this one.
    assert_eq!(
        spec("cook-torrance@two-layer-gold"),
        spec("cook-torrance@low-e2/two-layer-gold")
    );
    // A material of the database and a metal have this name.
    assert_eq!(
        spec("cook-torrance@chrome"),
        spec("cook-torrance@ngan/chrome")
    );
    assert_eq!(
        spec("cook-torrance@metal/chrome"),
        spec("cook-torrance:metal=chrome")
    );
    assert_eq!(spec("ggx@gold"), spec("ggx:metal=gold"));
    assert_eq!(
        spec("ggx@gold:roughness=0.1"),
        spec("ggx:metal=gold,roughness=0.1")
    );
}

#[test]
fn wrong_names_are_told() {
    for (text, message, help) in [
        (
            "ward@gold-pain",
            "`ward` has no preset `gold-pain`",
            "did you mean `ward@gold-paint`?",
        ),
        (
            "cook-torrance@low-e1/gold-pain",
            "no preset `low-e1/gold-pain`",
            "did you mean `cook-torrance@low-e1/gold-paint`?",
        ),
        // Not fitted with GGX: who has it is told.
        (
            "ggx@gold-paint",
            "`ggx` has no preset `gold-paint`",
            "ward@gold-paint",
        ),
        (
            "ggx@golt",
            "`ggx` has no preset `golt`",
            "did you mean `ggx@gold`?",
        ),
        (
            "ward@xyzzy",
            "no preset `xyzzy`",
            "gonio brdf list --presets ward",
        ),
        (
            "lambertian@xyzzy",
            "no preset `xyzzy`",
            "`lambertian` has no presets",
        ),
        (
            "wart@gold-paint",
            "unknown reflection function `wart`",
            "did you mean `ward`?",
        ),
        ("ward@gold-paint:alpha=2", "`alpha`", ""),
        ("ward@gold-paint(mirror)", "takes no other models", ""),
        ("ward@", "no preset ``", ""),
    ] {
        let error: BrdfError = ModelSpec::parse(text).unwrap_err();
        let found = format!("{error}; {}", error.help().unwrap_or_default());
        assert!(
            found.contains(message) && found.contains(help),
            "{text}: {found}"
        );
    }
}
