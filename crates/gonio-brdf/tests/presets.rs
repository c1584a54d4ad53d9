//! Presets: each means what was fitted, and wrong names are told.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec, Value, preset};
use gonio_num::Vec3;
use std::f64::consts::PI;

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
    // Ngan et al. fitted 86 materials with six of these models, Löw et al. 100 twice with two; three have slope scales above 1.
    assert!(sets >= 10 && fits >= 6 * 86 + 400 - 3, "{sets} {fits}");
}

/// What a fit's formula needs of a pair of directions, by textbook vectors and angles.
struct Angles {
    cos_i: f64,
    cos_o: f64,
    /// Between half vector and normal.
    cos_h: f64,
    /// Between half vector and either direction.
    cos_d: f64,
    /// ωi.x ωr.x + ωi.y ωr.y.
    across: f64,
}

fn angles(wi: Vec3<f64>, wo: Vec3<f64>) -> Angles {
    let h = (wi + wo).normalize();
    Angles {
        cos_i: wi.z,
        cos_o: wo.z,
        cos_h: h.z,
        cos_d: h.dot(wi),
        across: wi.x * wo.x + wi.y * wo.y,
    }
}

/// V-grooves (Torrance & Sparrow 1967).
fn grooves(a: &Angles) -> f64 {
    let g = |cos: f64| 2.0 * a.cos_h * cos / a.cos_d;
    f64::min(1.0, g(a.cos_i).min(g(a.cos_o)))
}

fn schlick(a: &Angles, f0: f64) -> f64 {
    f0 + (1.0 - f0) * (1.0 - a.cos_d).powi(5)
}

/// Fresnel's equations as Cook & Torrance 1982 write them.
fn cook(a: &Angles, n: f64) -> f64 {
    let c = a.cos_d;
    let g = (n * n + c * c - 1.0).sqrt();
    let ratio = (g - c) / (g + c);
    let other = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    0.5 * ratio * ratio * (1.0 + other * other)
}

fn gaussian(a: &Angles, m: f64) -> f64 {
    let tan2 = 1.0 / (a.cos_h * a.cos_h) - 1.0;
    (-tan2 / (m * m)).exp()
}

/// Each set against the published formula with the published numbers of one material, `gold-paint`, written out here on their own.
#[test]
fn presets_mean_what_was_fitted() {
    /// Name, factors of the channels, kd, ks, and the lobe for ks = 1.
    type Case = (
        &'static str,
        [f64; 3],
        [f64; 3],
        [f64; 3],
        fn(&Angles) -> f64,
    );
    // The scales of the database's channels, which Ngan's numbers don't have.
    let channels = [1.0, 1.15, 1.66];
    let plain = [1.0; 3];
    let cases: [Case; 10] = [
        (
            "ward@ngan/gold-paint",
            channels,
            [0.161, 0.0758, 0.0169],
            [0.132, 0.0924, 0.041],
            |a| {
                let m = 0.234;
                gaussian(a, m) / (4.0 * PI * m * m * (a.cos_i * a.cos_o).sqrt())
            },
        ),
        (
            "ward-duer@ngan/gold-paint",
            channels,
            [0.177, 0.0853, 0.0189],
            [0.0691, 0.0502, 0.025],
            |a| {
                let m = 0.223;
                gaussian(a, m) / (4.0 * PI * m * m * a.cos_i * a.cos_o)
            },
        ),
        (
            "blinn-phong@ngan/gold-paint",
            channels,
            [0.164, 0.0796, 0.0205],
            [0.0392, 0.0265, 0.0107],
            |a| 38.8 / (2.0 * PI) * a.cos_h.powf(36.8),
        ),
        (
            "lafortune@ngan/gold-paint",
            channels,
            [0.173, 0.0838, 0.0202],
            [0.209, 0.147, 0.0657],
            |a| {
                let base = -0.595 * a.across + 0.541 * a.cos_i * a.cos_o;
                16.3 / (2.0 * PI) * (base.max(0.0) / 0.595).powf(14.3)
            },
        ),
        (
            "ashikhmin-shirley@ngan/gold-paint",
            channels,
            [0.171, 0.0812, 0.0169],
            [0.156, 0.114, 0.0565],
            |a| {
                34.1 / (8.0 * PI) * a.cos_h.powf(33.1) * schlick(a, 0.538)
                    / (a.cos_d * a.cos_i.max(a.cos_o))
            },
        ),
        (
            "ashikhmin-shirley@low-e1/gold-paint",
            plain,
            [0.1737, 0.0979, 0.0326],
            [0.23105, 0.18735, 0.11748],
            |a| {
                40.260526 / (8.0 * PI) * a.cos_h.powf(39.260526) * cook(a, 4.99104)
                    / (a.cos_d * a.cos_i.max(a.cos_o))
            },
        ),
        (
            "ashikhmin-shirley@low-e2/gold-paint",
            plain,
            [0.1709, 0.0965, 0.0331],
            [0.23245, 0.18687, 0.11383],
            |a| {
                38.772817 / (8.0 * PI) * a.cos_h.powf(37.772817) * cook(a, 5.14385)
                    / (a.cos_d * a.cos_i.max(a.cos_o))
            },
        ),
        (
            "cook-torrance@ngan/gold-paint",
            channels,
            [0.176, 0.0848, 0.0187],
            [0.159, 0.115, 0.0572],
            |a| {
                let m = 0.214;
                let d = gaussian(a, m) / (PI * m * m * a.cos_h.powi(4));
                d * grooves(a) * schlick(a, 0.409) / (PI * a.cos_i * a.cos_o)
            },
        ),
        (
            "cook-torrance@low-e1/gold-paint",
            plain,
            [0.1805, 0.1032, 0.0355],
            [0.03493, 0.02844, 0.01807],
            |a| {
                let m = 0.202744;
                let d = gaussian(a, m) / (m * m * a.cos_h.powi(4));
                d * grooves(a) * cook(a, 7.3218) / (PI * a.cos_i * a.cos_o)
            },
        ),
        (
            "cook-torrance@low-e2/gold-paint",
            plain,
            [0.1774, 0.1017, 0.0358],
            [0.0363, 0.02928, 0.01804],
            |a| {
                let m = 0.206591;
                let d = gaussian(a, m) / (m * m * a.cos_h.powi(4));
                d * grooves(a) * cook(a, 7.23324) / (PI * a.cos_i * a.cos_o)
            },
        ),
    ];
    for (name, channels, diffuse, specular, lobe) in cases {
        let model = model(name);
        for (wi, wo) in pairs() {
            let a = angles(wi, wo);
            let f = model.eval(wi, wo);
            for k in 0..3 {
                let expected = channels[k] * (diffuse[k] / PI + specular[k] * lobe(&a));
                // Products are kept to six digits.
                assert!(
                    (f[k] - expected).abs() < 1e-5 * expected,
                    "{name}: {} {expected}",
                    f[k]
                );
            }
        }
    }
}

/// Ten fits of one material agree on it: near the mirror direction, and far from the lobe, where it is diffuse. A lobe that is
/// normalised otherwise than it was when it was fitted would be 4 or π times as bright; without the scales of the channels Ngan's
/// blue would be 1.66 times too dark.
#[test]
fn fits_of_one_material_look_alike() {
    let names: Vec<String> = preset::sets()
        .iter()
        .filter(|set| set.presets.contains(&"gold-paint"))
        .map(|set| format!("{}@{}/gold-paint", set.model, set.name))
        .collect();
    assert!(names.len() >= 10);
    for (wi, wo, most) in [
        (tilted(35.0, 0.0), tilted(35.0, 180.0), 1.4),
        (tilted(45.0, 0.0), tilted(30.0, 20.0), 1.4),
    ] {
        let values: Vec<[f64; 3]> = names.iter().map(|n| model(n).eval(wi, wo)).collect();
        for k in 0..3 {
            let low = values.iter().map(|f| f[k]).fold(f64::INFINITY, f64::min);
            let high = values.iter().map(|f| f[k]).fold(0.0, f64::max);
            assert!(high / low < most, "{names:?}: {values:?}");
        }
    }
}

/// Over all materials: the diffuse reflectances that Ngan et al. and Löw et al. found are the same in the median, in each channel.
#[test]
fn channels_have_the_databases_scales() {
    let diffuse = |text: &str| {
        let spec = ModelSpec::parse(text).unwrap();
        match spec.part("ashikhmin-shirley").unwrap().value("diffuse") {
            Some(Value::Colour(c)) => c,
            other => panic!("{other:?}"),
        }
    };
    let sets = preset::sets_of("ashikhmin-shirley");
    let ngan = sets.iter().find(|s| s.name == "ngan").unwrap();
    for k in 0..3 {
        let mut ratios: Vec<f64> = ngan
            .presets
            .iter()
            .map(|name| {
                let a = diffuse(&format!("ashikhmin-shirley@ngan/{name}"));
                let b = diffuse(&format!("ashikhmin-shirley@low-e2/{name}"));
                (a, b)
            })
            .filter(|(_, b)| b.iter().all(|x| *x > 0.03))
            .map(|(a, b)| a[k] / b[k])
            .collect();
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        // 37 materials; half of the ratios are within 2 % of the median.
        assert!(
            (median - 1.0).abs() < 0.05,
            "{k}: {median} of {}",
            ratios.len()
        );
    }
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
