//! WGSL and GLSL by the evaluator of shaders.

use super::*;
use gonio_brdf::{Kind, Value};
use gonio_shader::{Settings, Shader};
use std::path::Path;

/// What the text gives for the inputs, in single precision.
fn run(text: &str, language: Language, inputs: &[[f32; INPUTS]]) -> Vec<f32> {
    let path = format!("export.{}", language.extensions()[0]);
    let shader = Shader::new(Path::new(&path), None, text, &Settings::default())
        .unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(shader.has_pdf() && shader.has_sample());
    let mut all = Vec::new();
    for a in inputs {
        let wi = Vec3::new(a[0], a[1], a[2]);
        let wo = Vec3::new(a[3], a[4], a[5]);
        all.extend(shader.eval(&[], wi, wo));
        all.extend(shader.pdf(&[], wi, wo));
        let s = shader.sample(&[], wo, [a[6], a[7], a[8]]).unwrap();
        all.extend([s.wi.x, s.wi.y, s.wi.z]);
        all.extend(s.weight);
        all.extend([s.pdf, f32::from(u8::from(s.delta))]);
    }
    assert!(shader.failure().is_none());
    all
}

#[test]
fn evaluated_code_is_the_model() {
    let inputs = inputs("evaluated export");
    let mut wrong = Vec::new();
    for spec in showcase() {
        let export = Export::new(&spec).unwrap();
        for language in [Language::Wgsl, Language::Glsl] {
            let code = text(&export, language, "m");
            let got = run(&code, language, &inputs);
            let found = difference(&spec, &inputs, &got);
            wrong.extend(found.map(|d| format!("{}: {d}", language.name())));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn an_altered_text_is_noticed() {
    let inputs = inputs("altered export");
    let spec = ModelSpec::parse("lambertian").unwrap();
    let export = Export::new(&spec).unwrap();
    for language in [Language::Wgsl, Language::Glsl] {
        let code = text(&export, language, "m");
        // 1/π off by 3e-5.
        let altered = code.replace("0.31830987", "0.31832");
        assert_ne!(code, altered);
        let got = run(&altered, language, &inputs);
        assert!(
            difference(&spec, &inputs, &got).is_some(),
            "{}",
            language.name()
        );
    }
}

/// The text with another value for the constant of a parameter.
fn edited(code: &str, name: &str, value: &Value) -> Option<String> {
    let start = code.find(&format!("const m_{name}: "))?;
    let from = start + code[start..].find("= ")? + 2;
    let to = from + code[from..].find(";\n")?;
    let new = match value {
        Value::Number(x) => format!("{:?}", *x as f32),
        Value::Colour(c) => {
            let [r, g, b] = c.map(|x| format!("{:?}", x as f32));
            format!("vec3f({r}, {g}, {b})")
        }
        _ => return None,
    };
    Some(format!("{}{new}{}", &code[..from], &code[to..]))
}

/// Another value of a parameter that has this one.
fn another(kind: Kind, value: &Value) -> Option<Value> {
    let moved = |x: f64, low: f64, high: f64, t: f64| {
        if high - low > 50.0 {
            (x * (1.0 + t)).clamp(low, high)
        } else {
            x + t * (low + 0.61 * (high - low) - x)
        }
    };
    match (kind, value) {
        (Kind::Number { low, high, .. }, Value::Number(x)) => {
            Some(Value::Number(moved(*x, low, high, 0.5)))
        }
        (Kind::Colour { low, high, .. }, Value::Colour([r, g, b])) => Some(Value::Colour([
            moved(*r, low, high, 0.3),
            moved(*g, low, high, 0.5),
            moved(*b, low, high, 0.7),
        ])),
        _ => None,
    }
}

/// A parameter that is changed in the text gives the model with that value.
#[test]
fn parameters_can_be_edited() {
    let inputs = inputs("edited export");
    let mut count = 0;
    let mut wrong = Vec::new();
    for info in gonio_brdf::registry::models() {
        let Ok(spec) = ModelSpec::parse(info.name) else {
            continue;
        };
        let Ok(export) = Export::new(&spec) else {
            continue;
        };
        let code = text(&export, Language::Wgsl, "m");
        for p in info.parameters {
            let Some(value) = spec.value(p.name).and_then(|v| another(p.kind, &v)) else {
                continue;
            };
            let mut changed = spec.clone();
            changed.set(p.name, value.clone()).unwrap();
            let Some(code) = edited(&code, p.name, &value) else {
                continue;
            };
            if changed.build::<f64, 3>().is_err() {
                continue;
            }
            count += 1;
            let got = run(&code, Language::Wgsl, &inputs);
            wrong.extend(difference(&changed, &inputs, &got));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 60, "{count} parameters can be edited");
}

#[test]
fn parameters_of_parts_can_be_edited() {
    let inputs = inputs("edited parts");
    let spec =
        ModelSpec::parse("sum(lambertian:0.4, lambertian:0.1, burley:reflectance=0.3)").unwrap();
    let export = Export::new(&spec).unwrap();
    assert_eq!(
        export.parameters(),
        [
            "lambertian1_reflectance",
            "lambertian2_reflectance",
            "burley_reflectance",
            "burley_roughness"
        ]
    );
    let code = text(&export, Language::Wgsl, "m");
    let code = edited(&code, "lambertian2_reflectance", &Value::Colour([0.2; 3])).unwrap();
    let code = edited(&code, "burley_roughness", &Value::Number(0.9)).unwrap();
    let changed = "sum(lambertian:0.4, lambertian:0.2, burley:reflectance=0.3,roughness=0.9)";
    let changed = ModelSpec::parse(changed).unwrap();
    let got = run(&code, Language::Wgsl, &inputs);
    assert_eq!(difference(&changed, &inputs, &got), None);
}
