//! Recorded functions as the text of each language.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

use gonio_num::expr::{
    Expr, Field, Function, Language, Output, Parameter, RecordError, record, record_simplified,
    source,
};
use gonio_num::{Real, Table1, Vec3};

static T1: Table1 = Table1 {
    name: "albedo",
    data: &[0.5, -1.0, 3.0],
};

/// A bit of everything: vectors, a scalar product, limits, a choice, a constant by name, a table, an angle.
fn shade() -> Function {
    let parameters = [
        Parameter::vector("wi"),
        Parameter::vector("wo"),
        Parameter::scalar("roughness").fixed([0.3, 0.0, 0.0]),
        Parameter::colour("tint").fixed([1.0, 0.5, 0.25]),
        Parameter::scalar("unused").fixed([7.0, 0.0, 0.0]),
    ];
    record_simplified("m_shade", &parameters, |p| {
        let (wi, wo) = (p.vector("wi"), p.vector("wo"));
        let alpha = p.scalar("roughness").sq();
        let h = wi + wo;
        let x = (h.dot(h) * alpha).saturate();
        let angle = wi.y.atan2(wi.x);
        let f = p.vector("tint") * (Expr::table1(&T1, x) * angle * alpha);
        let up = Expr::zero().lt(wi.z) & Expr::zero().lt(wo.z);
        Output::Struct {
            name: "m_result".into(),
            fields: vec![
                Field::colour("weight", Vec3::select(up, f, Vec3::zero())),
                Field::scalar("pdf", x),
            ],
        }
    })
    .unwrap()
}

fn text(language: Language) -> String {
    let comments = |name: &str| vec![format!("the {name}")];
    let source = source(&[&shade()], language, "m_", &comments).unwrap();
    assert!(!source.constants.contains("unused"), "{}", source.constants);
    source.text()
}

#[test]
fn glsl() {
    let expected = "\
// the roughness
const float m_roughness = 0.3;
// the tint
const vec3 m_tint = vec3(1.0, 0.5, 0.25);

const float m_albedo[3] = float[3](
    0.5, -1.0, 3.0
);

// Linear interpolation in m_albedo, x clamped to [0, 1].
float m_albedo_at(float x) {
    float p = clamp(x, 0.0, 1.0) * 2.0;
    int i = int(min(p, 1.0));
    float w = p - float(i);
    return m_albedo[i] * (1.0 - w) + m_albedo[i + 1] * w;
}

// The angle of (x, y); 0 at the origin.
float m_atan2(float y, float x) {
    return x == 0.0 && y == 0.0 ? 0.0 : atan(y, x);
}

struct m_result {
    vec3 weight;
    float pdf;
};

m_result m_shade(vec3 wi, vec3 wo) {
    // What follows from the parameters alone.
    float v1 = m_roughness * m_roughness;

    vec3 v2 = wi + wo;
    float v3 = clamp(dot(v2, v2) * v1, 0.0, 1.0);
    m_result result;
    result.weight = wi.z > 0.0 && wo.z > 0.0 ? m_tint * (m_albedo_at(v3) * m_atan2(wi.y, wi.x) * v1) : vec3(0.0);
    result.pdf = v3;
    return result;
}
";
    let found = text(Language::Glsl);
    assert_eq!(found, expected, "{found}");
}

#[test]
fn each_language_has_its_own_words() {
    for (language, words) in [
        (
            Language::Wgsl,
            vec![
                "const m_tint: vec3f = vec3f(1.0, 0.5, 0.25);",
                "const m_albedo = array<f32, 3>(",
                "fn m_shade(wi: vec3f, wo: vec3f) -> m_result {",
                "let v2 = wi + wo;",
                "var result: m_result;",
                "select(vec3f(0.0), v4, wi.z > 0.0 && wo.z > 0.0)",
            ],
        ),
        (
            Language::Hlsl,
            vec![
                "static const float3 m_tint = float3(1.0, 0.5, 0.25);",
                "static const float m_albedo[3] = {",
                "m_result m_shade(float3 wi, float3 wo) {",
                "atan2(y, x)",
                // No constructor from one number.
                "v4 : float3(0.0, 0.0, 0.0)",
            ],
        ),
        (
            Language::Msl,
            vec![
                "constant float3 m_tint = float3(1.0f, 0.5f, 0.25f);",
                "constant float m_albedo[3] = {",
                "inline m_result m_shade(float3 wi, float3 wo) {",
                "clamp(dot(v2, v2) * v1, 0.0f, 1.0f)",
            ],
        ),
        (
            Language::Osl,
            vec![
                "#define m_tint color(1.0, 0.5, 0.25)",
                // A macro's components are reached through a local value, and arrays are local.
                "    color tint = m_tint;",
                "    float m_albedo[3] = {",
                "    color weight;",
                "m_result m_shade(vector wi, vector wo) {",
                "m_atan2(wi[1], wi[0])",
                "int i = (int)(min(p, 1.0));",
            ],
        ),
    ] {
        let text = text(language);
        for word in words {
            assert!(text.contains(word), "{word}\n{text}");
        }
    }
}

#[test]
fn what_has_no_effect_is_left_out() {
    let parameters = [Parameter::scalar("x"), Parameter::scalar("y")];
    let formula = |x: Expr, y: Expr| {
        let zero = Expr::zero();
        let limited = x.max(Expr::lit(0.5)).max(zero);
        (x * zero + y - zero) + -limited - -(-(y * zero - x)) + (y + y + y) * Expr::lit(1.0 / 3.0)
    };
    let exact = record("f", &parameters, |p| formula(p.scalar("x"), p.scalar("y"))).unwrap();
    let simple =
        record_simplified("f", &parameters, |p| formula(p.scalar("x"), p.scalar("y"))).unwrap();
    assert!(simple.operations() < exact.operations());
    let body = "fn f(x: f32, y: f32) -> f32 {\n    return y - max(x, 0.5) + x + y;\n}\n";
    assert_eq!(simple.wgsl(), body);
    for (x, y) in [(0.25, 3.0), (-2.0, 0.5), (7.0, -1.0)] {
        let (a, b) = (exact.evaluate(&[x, y])[0], simple.evaluate(&[x, y])[0]);
        assert!((a - b).abs() <= 1e-6 * a.abs().max(1.0), "{a} {b}");
    }
}

/// Two vectors that need components of each other are put together from numbers.
#[test]
fn vectors_that_need_each_other() {
    let function = record(
        "f",
        &[Parameter::vector("a"), Parameter::scalar("s")],
        |p| {
            let (a, s) = (p.vector("a"), p.scalar("s"));
            // Each component is a product of the one before.
            let x = a.x * s;
            let y = x * s;
            let z = y * s;
            Vec3::new(x, y, z)
        },
    )
    .unwrap();
    let text = function.wgsl();
    assert!(text.contains("vec3f("), "{text}");
    assert_eq!(function.evaluate(&[3.0, 0.0, 0.0, 2.0]), [6.0, 12.0, 24.0]);
}

#[test]
fn what_a_language_has_not_is_refused() {
    let x = [Parameter::scalar("x")];
    let array = record("f", &x, |p| [p.scalar("x"), Expr::one()]).unwrap();
    let none = |_: &str| Vec::new();
    for language in Language::ALL {
        let found = source(&[&array], language, "", &none);
        match language {
            Language::Wgsl => assert!(found.unwrap().text().contains("-> array<f32, 2>")),
            Language::Glsl => assert!(found.unwrap().text().contains("float[2] f(float x)")),
            _ => assert!(matches!(found, Err(RecordError::ArrayReturned { .. }))),
        }
    }
    let named = record("vector", &x, |p| p.scalar("x")).unwrap();
    assert!(source(&[&named], Language::Glsl, "", &none).is_ok());
    let refused = source(&[&named], Language::Osl, "", &none).unwrap_err();
    assert!(
        refused.to_string().contains("no word that OSL reserves"),
        "{refused}"
    );
    // A constant with two values.
    let fixed = |v: f32| {
        let p = [Parameter::scalar("c").fixed([v; 3])];
        record(&format!("f{v}"), &p, |p| p.scalar("c")).unwrap()
    };
    let (a, b) = (fixed(1.0), fixed(2.0));
    let refused = source(&[&a, &b], Language::Glsl, "", &none);
    assert!(matches!(refused, Err(RecordError::Duplicate { .. })));
}
