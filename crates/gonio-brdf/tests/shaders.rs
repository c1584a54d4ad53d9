//! Shaders as models, and models as shaders.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

use gonio_brdf::record::{record_eval, record_pdf, record_sample};
use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec, ParameterSlot, check, showcase};
use gonio_num::expr::module;
use gonio_num::{Real, Vec3};
use gonio_radiometry::sequence::Rng;
use gonio_shader::{Settings, Shader};
use gonio_verify::{Effort, Outcome, Property};
use std::path::{Path, PathBuf};

fn example(name: &str) -> String {
    let path: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../examples/shaders")
        .join(name);
    path.to_str().unwrap().to_owned()
}

fn vector<R: Real>(w: [f64; 3]) -> Vec3<R> {
    Vec3::new(R::lit(w[0]), R::lit(w[1]), R::lit(w[2]))
}

/// Directions above the horizon and some below, grazing ones among them.
fn directions(name: &str, count: usize) -> Vec<[f64; 3]> {
    let mut rng = Rng::from_name(name);
    (0..count)
        .map(|k| {
            let z = match k % 8 {
                0 => 1.0,
                1 => 0.02,
                2 => -0.5,
                _ => 0.05 + 0.95 * rng.next_f64(),
            };
            let (r, phi) = ((1.0f64 - z * z).sqrt(), 6.3 * rng.next_f64());
            [r * phi.cos(), r * phi.sin(), z]
        })
        .collect()
}

/// Whether two numbers agree but for roundings of f32: recorded formulas are those of the model, so few differ at all. Terms that cancel
/// leave errors of the size of what they cancel in, which `scale` stands for.
fn agree(a: f32, b: f32, scale: f32) -> bool {
    a == b || (a - b).abs() <= 1e-5 * a.abs().max(b.abs()).max(1e-3 * scale)
}

/// The WGSL that is recorded of each model, read again, is the model: its value, its density and what it draws.
#[test]
fn exported_models_are_the_models() {
    let wi = directions("exports wi", 12);
    let wo = directions("exports wo", 12);
    let mut rng = Rng::from_name("exports u");
    let mut seen = 0;
    for spec in showcase() {
        let model: Model<f32, 3> = spec.build().unwrap();
        if !model.is_recordable() {
            continue;
        }
        let functions = [
            record_eval(&model, "x_eval").unwrap(),
            record_pdf(&model, "x_pdf").unwrap(),
            record_sample(&model, "x_sample").unwrap(),
        ];
        let text = module(&[&functions[0], &functions[1], &functions[2]]).unwrap();
        let path = Path::new("recorded.wgsl");
        let shader = Shader::new(path, None, &text, &Settings::default())
            .unwrap_or_else(|e| panic!("{spec}: {e}"));
        for (wi, wo) in wi.iter().zip(&wo) {
            let (i, o) = (vector::<f32>(*wi), vector(*wo));
            let (f, expected) = (shader.eval(&[], i, o), model.eval(i, o));
            let scale = expected.into_iter().fold(0.0, f32::max);
            for k in 0..3 {
                assert!(
                    agree(f[k], expected[k], scale),
                    "{spec}: {f:?} {expected:?} at {i:?} {o:?}"
                );
            }
            let (pdf, expected) = (shader.pdf(&[], i, o).unwrap(), model.pdf(i, o));
            assert!(
                agree(pdf, expected, expected),
                "{spec}: pdf {pdf} {expected}"
            );
            let u = [rng.next_f32(), rng.next_f32(), rng.next_f32()];
            let (s, expected) = (shader.sample(&[], o, u).unwrap(), model.sample(o, u));
            let (a, b) = (s.wi.to_array(), expected.wi.to_array());
            for k in 0..3 {
                assert!(agree(a[k], b[k], 1.0), "{spec}: wi {a:?} {b:?}");
                assert!(
                    agree(s.weight[k], expected.weight[k], 1.0),
                    "{spec}: weight"
                );
            }
            assert!(
                agree(s.pdf, expected.pdf, expected.pdf),
                "{spec}: {} {}",
                s.pdf,
                expected.pdf
            );
            assert_eq!(s.delta, expected.delta, "{spec}");
        }
        seen += 1;
    }
    assert!(seen > 40, "{seen}");
}

/// The example in WGSL is the registry's own white metal, but for its constants of 32 bits.
#[test]
fn the_example_in_wgsl_is_the_model_of_torrance_and_sparrow() {
    let shader: Model<f64, 3> = ModelSpec::parse(&format!(
        "{}:roughness=0.4,f0_red=1,f0_green=1,f0_blue=1",
        example("ggx.wgsl")
    ))
    .unwrap()
    .build()
    .unwrap();
    let native: Model<f64, 3> = ModelSpec::parse(
        "torrance-sparrow:distribution=ggx,roughness=0.4,f0=1,interreflection=none",
    )
    .unwrap()
    .build()
    .unwrap();
    for (wi, wo) in directions("ggx wi", 40)
        .into_iter()
        .zip(directions("ggx wo", 40))
    {
        let (wi, wo) = (vector::<f64>(wi), vector(wo));
        let (f, expected) = (shader.eval(wi, wo), native.eval(wi, wo));
        let (pdf, expected_pdf) = (shader.pdf(wi, wo), native.pdf(wi, wo));
        for k in 0..3 {
            assert!(
                (f[k] - expected[k]).abs() <= 1e-6 * expected[k],
                "{f:?} {expected:?}"
            );
        }
        assert!(
            (pdf - expected_pdf).abs() <= 1e-6 * expected_pdf,
            "{pdf} {expected_pdf}"
        );
    }
}

#[test]
fn the_examples_pass_their_check() {
    for text in [
        example("ggx.wgsl"),
        example("ggx.wgsl") + ":roughness=0.1",
        example("blinn-phong.glsl") + ":exponent=8",
        example("minnaert.brdf"),
        example("minnaert.brdf") + ":lambert=1",
    ] {
        let report = check(&ModelSpec::parse(&text).unwrap(), Effort::Quick).unwrap();
        assert!(report.passed(), "{report}");
    }
}

/// A shader in a folder of its own.
fn written(name: &str, text: &str) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    let path = path.to_str().unwrap().to_owned();
    (folder, path)
}

/// What a rendering is kept from, a check sees: light from below, and what is no number.
#[test]
fn a_check_sees_the_shader_as_it_is() {
    let body = "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(0.2); }";
    let (_folder, path) = written("below.wgsl", body);
    let spec = ModelSpec::parse(&path).unwrap();
    let model: Model<f64, 3> = spec.build().unwrap();
    let (up, down) = (vector([0.0, 0.0, 1.0]), vector([0.0, 0.0, -1.0]));
    assert_eq!(model.eval(down, up), [0.0; 3]);
    let report = check(&spec, Effort::Quick).unwrap();
    assert!(!report.passed(), "{report}");
    assert!(report.to_string().contains("horizon"), "{report}");

    let body = "fn eval(wi: vec3f, wo: vec3f) -> vec3f {
        if wi.z <= 0.0 || wo.z <= 0.0 { return vec3f(0.0); }
        return vec3f(0.2 * (wi.z - wi.z) / (wi.z - wi.z)); }";
    let (_folder, path) = written("nan.wgsl", body);
    let report = check(&ModelSpec::parse(&path).unwrap(), Effort::Quick).unwrap();
    assert!(!report.passed(), "{report}");
}

/// A pdf that is not that of `sample` is found; so is a weight.
#[test]
fn a_check_sees_wrong_sampling() {
    let good = std::fs::read_to_string(example("ggx.wgsl")).unwrap();
    for (from, to) in [
        ("(2.0 * (wo.z + root(wo)))", "(1.5 * (wo.z + root(wo)))"),
        ("let masking = wi.z *", "let masking = 1.2 * wi.z *"),
    ] {
        let (_folder, path) = written("broken.wgsl", &good.replace(from, to));
        let report = check(&ModelSpec::parse(&path).unwrap(), Effort::Quick).unwrap();
        assert!(!report.passed(), "{from}: {report}");
    }
}

#[test]
fn descriptions_of_shaders() {
    let path = example("minnaert.brdf");
    let spec = ModelSpec::parse(&format!("{path}:k=2,albedo=0.5/0.25/1")).unwrap();
    assert_eq!(spec.name, "shader");
    let names: Vec<_> = spec.parameters().unwrap().iter().map(|p| p.name).collect();
    assert_eq!(
        names,
        ["file", "entry", "step_limit", "albedo", "k", "lambert"]
    );
    // What is printed is read again, in whatever order its keys stand.
    assert_eq!(ModelSpec::parse(&spec.to_string()).unwrap(), spec);
    let given = ModelSpec::from_pairs(
        "shader",
        [("k", "2"), ("albedo", "0.5/0.25/1"), ("file", &path)],
    );
    assert_eq!(given.unwrap(), spec);
    let sum = ModelSpec::parse(&format!("sum(lambertian:0.1, {path}:k=2)")).unwrap();
    let model: Model<f64, 3> = sum.build().unwrap();
    let up = vector([0.0, 0.0, 1.0]);
    // 0.1/π and albedo/π.
    let pi = std::f64::consts::PI;
    assert!((model.eval(up, up)[0] - 0.6 / pi).abs() < 1e-7);
    for text in [
        format!("coat(roughness=0.2, {path})"),
        format!("mix(0.5, {path}, mirror)"),
    ] {
        ModelSpec::parse(&text).unwrap().build::<f32, 3>().unwrap();
    }
    for (text, expected) in [
        (format!("{path}:kk=2"), "`shader` has no parameter `kk`"),
        (
            format!("{path}:k=9"),
            "parameter `k` of `shader` is `9`; expected a number from 1 to 3",
        ),
        ("/nowhere/x.wgsl".into(), "/nowhere/x.wgsl: No such file"),
    ] {
        let error = ModelSpec::parse(&text)
            .and_then(|s| s.build::<f32, 3>())
            .unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    let folder = Path::new(&path).parent().unwrap();
    assert_eq!(
        ModelSpec::parse_in("minnaert.brdf:k=2,albedo=0.5/0.25/1", folder).unwrap(),
        spec
    );
}

#[test]
fn a_shader_without_end_is_an_error_when_it_is_built() {
    let (_folder, path) = written(
        "endless.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n  var x = wi;\n  while x.z < 2.0 { x.x += 1.0; }\n  return x;\n}",
    );
    let spec = ModelSpec::parse(&format!("{path}:step_limit=1000")).unwrap();
    let error = spec.build::<f64, 3>().unwrap_err();
    assert!(matches!(error, BrdfError::Shader(_)));
    assert!(
        error
            .to_string()
            .ends_with("`eval` did not end after 1000 steps, in the loop at line 3")
    );
    // One that ends for most directions fails when it doesn't.
    let (_folder, path) = written(
        "sometimes.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n  var x = wi;\n  while x.z == 1.0 { x.x += 1.0; }\n  return x;\n}",
    );
    let spec = ModelSpec::parse(&format!("{path}:step_limit=1000")).unwrap();
    let model: Model<f64, 3> = spec.build().unwrap();
    let up = vector([0.0, 0.0, 1.0]);
    assert!(model.failure().is_none());
    assert!(model.eval(up, up)[0].is_nan());
    assert!(model.failure().is_some());
    // The check says so instead of a verdict.
    assert!(
        check(&spec, Effort::Quick)
            .unwrap_err()
            .to_string()
            .contains("did not end")
    );
}

/// A file that has changed is read again.
#[test]
fn a_changed_file_is_another_shader() {
    let text = |x: &str| {
        format!(
            "override a{x}: f32 = {x}; fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ return vec3f(a{x}); }}"
        )
    };
    let (_folder, path) = written("changing.wgsl", &text("1"));
    let up = vector([0.0, 0.0, 1.0]);
    let value = || {
        ModelSpec::parse(&path)
            .unwrap()
            .build::<f64, 3>()
            .unwrap()
            .eval(up, up)[0]
    };
    assert_eq!(value(), 1.0);
    let old = ModelSpec::parse(&format!("{path}:a1=0.5")).unwrap();
    std::fs::write(&path, text("2")).unwrap();
    assert_eq!(value(), 2.0);
    assert!(matches!(
        old.build::<f64, 3>(),
        Err(BrdfError::UnknownParameter { .. })
    ));
}

/// A texture can drive a parameter that the shader declares.
#[test]
fn parameters_can_be_driven() {
    let spec = ModelSpec::parse(&example("blinn-phong.glsl")).unwrap();
    let mut single: Model<f32, 3> = spec.build().unwrap();
    let slot = ParameterSlot::of(&spec, "diffuse").unwrap();
    single.set_parameter(slot, [0.5, 2.0, 0.25]);
    let given = ModelSpec::parse(&format!(
        "{}:diffuse=0.5/1/0.25",
        example("blinn-phong.glsl")
    ));
    let given: Model<f32, 3> = given.unwrap().build().unwrap();
    let (wi, wo) = (vector([0.48, 0.0, 0.877_268_5]), vector([0.0, 0.6, 0.8]));
    assert_eq!(single.eval(wi, wo), given.eval(wi, wo));
    assert!(ParameterSlot::of(&spec, "entry").is_err());
    assert!(ParameterSlot::of(&spec, "diffus").is_err());
}

/// A density without sampling, or sampling without a density, isn't used, and said so.
#[test]
fn half_a_sampling_is_left_aside() {
    let eval = "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(0.1); }\n";
    for (text, warned) in [
        ("fn pdf(wi: vec3f, wo: vec3f) -> f32 { return 7.0; }", true),
        (
            "struct S { wi: vec3f, weight: vec3f, pdf: f32 }\nfn sample(wo: vec3f, u: vec3f) -> S { return S(wo, wo, 7.0); }",
            true,
        ),
        ("", false),
    ] {
        let (_folder, path) = written("half.wgsl", &format!("{eval}{text}"));
        let model: Model<f64, 3> = ModelSpec::parse(&path).unwrap().build().unwrap();
        assert_eq!(!model.warnings().is_empty(), warned);
        let up = vector([0.0, 0.0, 1.0]);
        assert!((model.pdf(up, up) - std::f64::consts::FRAC_1_PI).abs() < 1e-15);
        let s = model.sample(up, [0.3, 0.6, 0.1]);
        // f cosθ over cosθ/π.
        assert!((s.weight[0] - 0.1 * std::f64::consts::PI).abs() < 1e-7);
    }
}

/// BRDF Explorer asks for directions above the surface only; a shader in another language is taken as it is.
#[test]
fn only_files_of_brdf_explorer_are_dark_below() {
    let horizon = |path: &str| {
        let spec = ModelSpec::parse(path).unwrap();
        let report = check(&spec, Effort::Quick).unwrap();
        let verdict = report.verdict(Property::Horizon).unwrap();
        verdict.outcome
    };
    let (_folder, path) = written(
        "lambert.brdf",
        "analytic\n::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return vec3(0.3); }\n::end shader\n",
    );
    assert_eq!(horizon(&path), Outcome::Pass);
    let (_folder, path) = written(
        "lambert.glsl",
        "vec3 eval(vec3 wi, vec3 wo) { return vec3(0.3); }",
    );
    assert_eq!(horizon(&path), Outcome::Fail);
}
