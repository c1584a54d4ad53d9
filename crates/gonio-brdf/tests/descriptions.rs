//! Descriptions in words: what is read, and the errors.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

mod common;

use gonio_brdf::{BrdfError, Model, ModelSpec, Value};

fn error(text: &str) -> BrdfError {
    match ModelSpec::parse(text) {
        Err(e) => e,
        Ok(spec) => spec
            .build::<f32, 3>()
            .map(|_| ())
            .expect_err(&format!("{text} must be refused")),
    }
}

#[test]
fn reads_back_what_it_prints() {
    let mut specs = common::one_at_a_time();
    specs.extend(common::random("descriptions", 10));
    for spec in specs {
        let text = spec.to_string();
        assert_eq!(ModelSpec::parse(&text).unwrap(), spec, "{text}");
    }
}

#[test]
fn sums_and_products() {
    let spec = ModelSpec::parse(
        "sum(phong:exponent=50,diffuse=0.1, scaled(0.5, ggx:f0=1/0.8/0.3), mirror, specular=1)",
    );
    // The last piece would belong to `mirror`, which has no such parameter.
    assert!(matches!(spec, Err(BrdfError::UnknownParameter { .. })));
    let spec = ModelSpec::parse("sum(lambertian:0.4, phong:exponent=50,diffuse=0.1)").unwrap();
    let Some(Value::Models(parts)) = spec.value("parts") else {
        panic!("{spec:?}")
    };
    assert_eq!(parts.len(), 2);
    assert_eq!(parts[1].values.len(), 2);
    let Model::Sum(sum) = spec.build::<f32, 3>().unwrap() else {
        panic!("{spec:?}")
    };
    assert!(matches!(sum.parts[1], Model::Phong(_)));
}

#[test]
fn aliases_and_positional_values() {
    assert_eq!(
        ModelSpec::parse("ggx:roughness=0.5").unwrap(),
        ModelSpec::parse("torrance-sparrow:distribution=ggx,roughness=0.5").unwrap()
    );
    assert_eq!(
        ModelSpec::parse("lambertian:#ffffff")
            .unwrap()
            .value("reflectance"),
        Some(Value::Colour([1.0; 3]))
    );
    let pairs = [("roughness", "0.2"), ("metal", "aluminum")];
    let spec = ModelSpec::from_pairs("beckmann", pairs).unwrap();
    assert_eq!(
        spec.value("distribution"),
        Some(Value::Choice("beckmann".into()))
    );
}

#[test]
fn errors_name_the_parameter_the_value_and_the_range() {
    for (text, parts) in [
        ("ggx:roughness=-1", vec!["roughness", "-1", "from 0 to 1"]),
        ("ggx:roughness=NaN", vec!["roughness", "NaN", "from 0 to 1"]),
        (
            "ggx:roughness=rough",
            vec!["roughness", "rough", "from 0 to 1"],
        ),
        (
            "lambertian:reflectance=1.5/0/0",
            vec!["reflectance", "1.5/0/0", "from 0 to 1"],
        ),
        (
            "ggx:metal=golt",
            vec!["metal", "golt", "did you mean `gold`"],
        ),
        (
            "ggx:fresnel=none,f0=0.5",
            vec!["f0", "only fresnel=schlick or f82-tint uses it"],
        ),
        ("ggx:eta=1.5", vec!["k", "both eta and k"]),
        ("ggx:metal=gold,k=2", vec!["metal", "not both"]),
        ("ggx:alpha_x=0.1", vec!["alpha_y", "both"]),
        ("ggx:alpha=0.1,roughness=0.2", vec!["alpha", "not both"]),
        ("sum()", vec!["parts", "at least one"]),
        ("scaled(2)", vec!["of", "exactly one"]),
        ("scaled(-1, mirror)", vec!["factor", "-1"]),
        ("ggx:roughness", vec!["column 5", "key=value"]),
        ("", vec!["column 1", "name"]),
        ("sum(mirror", vec!["`)`"]),
        ("mirror(lambertian)", vec!["takes no other models"]),
        ("table", vec!["file", "path"]),
        ("table:/nowhere/x.binary", vec!["/nowhere/x.binary"]),
    ] {
        let error = error(text);
        let message = format!("{error}; {}", error.help().unwrap_or_default());
        for part in parts {
            assert!(message.contains(part), "{text}: {message}");
        }
    }
}

#[test]
fn did_you_mean() {
    assert_eq!(
        error("lambertain").help().unwrap(),
        "did you mean `lambertian`?"
    );
    assert_eq!(
        error("ggx:rougness=1").help().unwrap(),
        "did you mean `roughness`?"
    );
    assert!(error("zzz").help().unwrap().contains("oren-nayar"));
}

#[test]
fn colours_need_three_components() {
    let red = ModelSpec::parse("lambertian:1/0/0").unwrap();
    assert!(matches!(
        red.build::<f32, 4>(),
        Err(BrdfError::Unsupported { .. })
    ));
    assert!(
        ModelSpec::parse("lambertian:0.3")
            .unwrap()
            .build::<f32, 4>()
            .is_ok()
    );
}
