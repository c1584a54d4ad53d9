//! GLSL: implicit conversions, `out` arguments, uniform variables, overloads, macros.

use super::load;
use gonio_num::Vec3;
use gonio_shader::ParameterKind;

const TEXT: &str = "#version 450
// A comment with uniform float nothing;
#define PI 3.14159265
#define SQR(x) ((x)*(x))
layout(constant_id = 3) const float other = 0.5; // 0..2 the other
layout(binding = 0) uniform float rough = 0.25; // 0..1 how rough
uniform vec3 tint; // = 0.5/0.25/1 0..1 the colour
uniform bool on = true;
uniform int count = 2; // 0..9
const float table[3] = float[3](1.0, 2.0, 4.0);

float twice(float x) { return 2 * x; }
vec3 twice(vec3 x) { return 2 * x; }
void change(inout vec3 x, out float y) { x *= 2.0; y = x.x; }

vec3 eval(vec3 wi, vec3 wo) {
    vec3 a = wi;
    float y;
    change(a, y);
    a[1] = mix(1, 3, wi.z);
    float s = 0;
    for (int i = 0; i < count; ++i) s += table[i];
    do { s -= 0.25; } while (s > 2.5);
    vec3 b = on ? twice(a) : a;
    if (!on && wi.z < 2) return vec3(0);
    return b * twice(y) * rough + vec3(other) * SQR(s) + tint / PI;
}
float eval_pdf(vec3 wi, vec3 wo) { return wi.z; }
";

#[test]
fn what_people_write_is_read() {
    let shader = load("a.glsl", TEXT).unwrap();
    let names: Vec<_> = shader
        .parameters()
        .iter()
        .map(|p| (p.name.as_str(), p.kind))
        .collect();
    assert_eq!(
        names,
        [
            ("other", ParameterKind::Number),
            ("rough", ParameterKind::Number),
            ("tint", ParameterKind::Colour),
            ("on", ParameterKind::Switch),
            ("count", ParameterKind::Integer),
        ]
    );
    assert_eq!(shader.defaults(), [0.5, 0.25, 0.5, 0.25, 1.0, 1.0, 2.0]);
    assert_eq!(shader.parameters()[1].meaning, "how rough");
    let w = Vec3::new(0.6, 0.0, 0.8);
    let found = shader.eval(&shader.defaults(), w, w);
    // y = 1.2; a = (1.2, 2.6, 1.6); s = 1 + 2 − 2·0.25 = 2.5.
    let pi = f64::from(std::f32::consts::PI);
    let expected = [
        2.4 * 2.4 * 0.25 + 0.5 * 6.25 + 0.5 / pi,
        5.2 * 2.4 * 0.25 + 0.5 * 6.25 + 0.25 / pi,
        3.2 * 2.4 * 0.25 + 0.5 * 6.25 + 1.0 / pi,
    ];
    for k in 0..3 {
        assert!(
            super::near(found[k], expected[k], 1e-12),
            "{found:?} {expected:?}"
        );
    }
    let off = [0.5, 0.25, 0.5, 0.25, 1.0, 0.0, 2.0];
    assert_eq!(shader.eval(&off, w, w), [0.0; 3]);
    // A name without a prefix has no `_pdf` beside it.
    assert!(!shader.has_pdf());
}

#[test]
fn directions_are_drawn_through_arguments_or_structures() {
    let arguments = load(
        "a.glsl",
        "vec3 my_eval(vec3 wi, vec3 wo) { return wi; }
         float my_pdf(vec3 wi, vec3 wo) { return wi.z; }
         vec3 my_sample(vec3 wo, vec3 u, out vec3 wi, out float pdf, out bool delta) { wi = u; pdf = 2.0; delta = u.x > 0.5; return wo; }",
    )
    .unwrap();
    let structure = load(
        "a.wgsl",
        "struct Drawn { pdf: f32, weight: f32, wi: vec3f, delta: f32 }
         fn eval(wi: vec3f, wo: vec3f) -> f32 { return wi.z; }
         fn pdf(wi: vec3f, wo: vec3f) -> f32 { return wi.z; }
         fn sample(wo: vec3f, u: vec3f) -> Drawn { return Drawn(2.0, wo.z, u, select(0.0, 1.0, u.x > 0.5)); }",
    )
    .unwrap();
    let wo = Vec3::new(0.6, 0.0, 0.8);
    for (shader, weight) in [(&arguments, [0.6, 0.0, 0.8]), (&structure, [0.8; 3])] {
        assert!(shader.has_pdf() && shader.has_sample());
        assert_eq!(shader.pdf(&[], wo, wo), Some(0.8));
        for (x, delta) in [(0.25, false), (0.75, true)] {
            let s = shader.sample(&[], wo, [x, 0.5, 0.125]).unwrap();
            assert_eq!(s.wi.to_array(), [x, 0.5, 0.125]);
            assert_eq!((s.weight, s.pdf, s.delta), (weight, 2.0, delta));
        }
    }
    assert_eq!(structure.eval(&[], wo, wo), [0.8; 3]);
}

/// A function is chosen by its name, or by the prefix of its name.
#[test]
fn one_of_several_functions() {
    let text = "fn a_eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(1.0); }
        fn b_eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(2.0); }
        fn b_pdf(wi: vec3f, wo: vec3f) -> f32 { return 3.0; }";
    let of = |entry: Option<&str>| {
        let settings = gonio_shader::Settings {
            entry: entry.map(str::to_owned),
            ..Default::default()
        };
        gonio_shader::Shader::new(std::path::Path::new("a.wgsl"), None, text, &settings)
    };
    let up = Vec3::new(0.0, 0.0, 1.0);
    for entry in ["b", "b_eval"] {
        let shader = of(Some(entry)).unwrap();
        assert_eq!(shader.eval(&[], up, up), [2.0; 3]);
        assert_eq!(shader.pdf(&[], up, up), Some(3.0));
    }
    let error = of(None).unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.wgsl: found `a_eval`, `b_eval`, expected one function to evaluate"
    );
    assert_eq!(error.help.as_deref(), Some("choose one by entry=a_eval"));
}
