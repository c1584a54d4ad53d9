//! Shaders that are wrong: one clear error each.

use super::load;
use gonio_shader::{LARGEST_SOURCE, Settings, Shader};
use std::path::Path;

fn error(name: &str, text: &str) -> String {
    load(name, text).unwrap_err().to_string()
}

#[test]
fn each_mistake_has_its_place() {
    let eval = "fn eval(wi: vec3f, wo: vec3f) -> vec3f";
    for (text, expected) in [
        (format!("{eval} {{\n  let x = ;\n  return wi;\n}}"), "a.wgsl:2:11: expected expression, found \";\""),
        (format!("{eval} {{ return wi; }}\nfn eval2( {{}}"), "a.wgsl:2:11: expected"),
        (format!("{eval} {{ return wi * unknown; }}"), "a.wgsl:1:54: no definition in scope for identifier"),
        (format!("{eval} {{ return wi.x; }}"), "a.wgsl:1:49: the `return` expression does not match the declared return type"),
        ("fn f(x: f32) -> f32 { return f(x); }\nfn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi * f(wo.x); }".into(), "a.wgsl:1:4: declaration of `f` is recursive"),
        ("fn eval(wi: vec3f) -> vec3f { return wi; }".into(), "a.wgsl:1:1: found `fn eval(wi: vec3f) -> vec3f`, expected `fn eval(wi: vec3f, wo: vec3f) -> vec3f`"),
        ("fn eval(wi: vec3f, wo: vec3f) -> vec2f { return wi.xy; }".into(), "a.wgsl:1:1: found `fn eval(wi: vec3f, wo: vec3f) -> vec2f`, expected"),
        (format!("{eval} {{ return wi; }}\nfn pdf(wi: vec3f) -> f32 {{ return 1.0; }}"), "a.wgsl:2:1: found `fn pdf(wi: vec3f) -> f32`, expected `fn pdf(wi: vec3f, wo: vec3f) -> f32`"),
        (format!("{eval} {{ return wi; }}\nfn sample(wo: vec3f, u: vec3f) -> vec3f {{ return u; }}"), "a.wgsl:2:1: found `fn sample(wo: vec3f, u: vec3f) -> vec3f` without wi and pdf, expected"),
        ("fn f() {}".into(), "a.wgsl: found `f`, expected a function `eval`"),
        (String::new(), "a.wgsl: found no function, expected a function `eval`"),
        ("var<workgroup> x: atomic<u32>;\nfn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi * f32(atomicAdd(&x, 1u)); }".into(), "a.wgsl:2:58: atomic operations are not supported"),
        ("@group(0) @binding(0) var t: texture_2d<f32>;\n@group(0) @binding(1) var s: sampler;\nfn eval(wi: vec3f, wo: vec3f) -> vec3f { return textureSampleLevel(t, s, wi.xy, 0.0).xyz; }".into(), "a.wgsl:3:49: textures are not supported"),
        (format!("{eval} {{\n  return dpdx(wi);\n}}"), "a.wgsl:2:10: derivatives (dpdx, dFdx, fwidth, …) need neighbouring pixels: they are not supported"),
        (format!("{eval} {{\n  var a: array<f32, 1000000>;\n  a[1] = 1.0;\n  return wi * a[2];\n}}"), "a.wgsl:2:3: an array of 1000000 elements is too large: a shader may have at most 262144 numbers"),
        (format!("override r: f32 = 2.0; // 0..1 rough\n{eval} {{ return wi * r; }}"), "a.wgsl:1:1: parameter `r` is 2 when not given, outside its range 0..1"),
        (format!("override r: f32 = 2.0; // 3..1 rough\n{eval} {{ return wi * r; }}"), "a.wgsl:1:1: parameter `r`: found the range `3..1`, expected the smaller end first"),
    ] {
        let found = error("a.wgsl", &text);
        assert!(found.starts_with(expected), "{text}\n{found}\n{expected}");
    }
    let eval = "vec3 eval(vec3 wi, vec3 wo)";
    for (text, expected) in [
        (
            format!("{eval} {{\n  return wi + ;\n}}"),
            "a.glsl:2:15: expected `(`, integer literal, float literal or bool literal, found `;`",
        ),
        (
            format!("{eval} {{ return wi * 2 + unknown; }}"),
            "a.glsl:1:47: unknown variable: unknown",
        ),
        (
            format!("float f(float x) {{ return f(x); }}\n{eval} {{ return wi * f(wo.x); }}"),
            "a.glsl:1:27: unknown function 'f'",
        ),
        (
            format!(
                "float f(float x);\nfloat g(float x) {{ return f(x); }}\nfloat f(float x) {{ return g(x); }}\n{eval} {{ return wi * f(wo.x); }}"
            ),
            "a.glsl: a function calls one that is defined below it, or itself",
        ),
        (format!("{eval} {{\n  return dFdx(wi);\n}}"), "a.glsl:2:"),
        (
            "vec3 eval(vec3 wi) { return wi; }".into(),
            "a.glsl:1:1: found `vec3 eval(vec3 wi)`, expected `vec3 eval(vec3 wi, vec3 wo)`",
        ),
    ] {
        let found = error("a.glsl", &text);
        assert!(found.starts_with(expected), "{text}\n{found}\n{expected}");
    }
}

#[test]
fn the_snippet_marks_the_column() {
    let error = load(
        "a.wgsl",
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n\tlet ü = 1 + ;\n}",
    )
    .unwrap_err();
    assert_eq!(error.snippet().unwrap(), "\tlet ü = 1 + ;\n\t            ^");
    let near = load(
        "a.wgsl",
        "fn evil(wi: vec3f, wo: vec3f) -> vec3f { return wi; }",
    )
    .unwrap_err();
    assert_eq!(near.help.as_deref(), Some("did you mean `evil`?"));
}

/// Nesting on which a recursive parser would run out of stack, and texts that would become too long.
#[test]
fn what_is_too_deep_or_too_long_is_refused() {
    let body = |expression: String| {
        format!("fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ return wi * ({expression}); }}")
    };
    for n in [1000, 100_000] {
        let text = body("(".repeat(n) + "1.0" + &")".repeat(n));
        assert!(error("a.wgsl", &text).ends_with("nested more than 128 deep"));
    }
    let text = body("-".repeat(100_000) + "1.0");
    assert!(error("a.wgsl", &text).contains("words and signs without a semicolon"));
    let text = body("wi.x + ".repeat(50_000) + "1.0");
    assert!(error("a.wgsl", &text).contains("words and signs without a semicolon"));
    let text = format!(
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ var s = 0.0; if wi.x < 0.0 {{ s = 1.0; }} {} return wi * s; }}",
        "else if wi.x < 1.0 { s = 2.0; } ".repeat(5000)
    );
    assert!(error("a.wgsl", &text).contains("more than 1000 branches in a row"));
    let text = "x".repeat(LARGEST_SOURCE + 1);
    assert!(error("a.wgsl", &text).contains("expected a shader of at most"));
    // Calls that double: 2³⁰ operations once written out.
    let mut text = String::from("fn f0(x: f32) -> f32 { return x * 1.5; }\n");
    for k in 1..30 {
        text += &format!(
            "fn f{k}(x: f32) -> f32 {{ return f{0}(x) + f{0}(x + 1.0); }}\n",
            k - 1
        );
    }
    text += "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi * f29(wo.x); }";
    assert!(error("a.wgsl", &text).contains("the shader is too long"));
    let mut text = String::from("#define A0 x x\n");
    for k in 1..40 {
        text += &format!("#define A{k} A{0} A{0}\n", k - 1);
    }
    text += "vec3 eval(vec3 wi, vec3 wo) { return A39; }";
    assert!(error("a.glsl", &text).contains("too long a text"));
}

/// As deep and as long as is let through: no overflow of the stack.
#[test]
fn what_is_just_let_through_is_read() {
    let body = |expression: String| {
        format!("fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ return wi * ({expression}); }}")
    };
    let deep = body("(".repeat(100) + "wi.x" + &")".repeat(100));
    load("a.wgsl", &deep).unwrap();
    let long = body("wi.x + ".repeat(4000) + "1.0");
    load("a.wgsl", &long).unwrap();
    let chain = format!(
        "fn eval(wi: vec3f, wo: vec3f) -> vec3f {{ var s = 0.0; if wi.x < 0.0 {{ s = 1.0; }} {} return wi * s; }}",
        "else if wi.x < 1.0 { s = 2.0; } ".repeat(900)
    );
    load("a.wgsl", &chain).unwrap();
    let minus = body("-".repeat(9000) + "wi.x");
    // Whatever comes of it, it comes.
    let _ = load("a.wgsl", &minus);
    let long = format!(
        "vec3 eval(vec3 wi, vec3 wo) {{ return wi * ({}1.0); }}",
        "wi.x + ".repeat(4000)
    );
    load("a.glsl", &long).unwrap();
}

#[test]
fn endless_loops_fail_once_and_at_once_after_that() {
    let text = "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n  var x = wi;\n  while x.x < 2.0 { x.y += 1.0; }\n  return x;\n}";
    let settings = Settings {
        steps: 1000,
        ..Settings::default()
    };
    let shader = Shader::new(Path::new("a.wgsl"), None, text, &settings).unwrap();
    let up = gonio_num::Vec3::new(0.0, 0.0, 1.0);
    assert!(shader.failure().is_none());
    assert!(shader.eval::<f64>(&[], up, up)[0].is_nan());
    assert_eq!(
        shader.failure().unwrap().to_string(),
        "a.wgsl:3:3: `eval` did not end after 1000 steps, in the loop at line 3"
    );
    assert!(shader.eval::<f64>(&[], up, up)[0].is_nan());
}

/// IEEE arithmetic goes on; a check sees what comes of it.
#[test]
fn division_by_zero_is_a_value() {
    let shader = load("a.wgsl", "fn eval(wi: vec3f, wo: vec3f) -> vec3f { let z = wi.x - wi.x; return vec3f(1.0 / z, z / z, -1.0 / z); }").unwrap();
    let up = gonio_num::Vec3::new(0.0, 0.0, 1.0);
    let f = shader.eval::<f64>(&[], up, up);
    assert_eq!((f[0], f[2]), (f64::INFINITY, f64::NEG_INFINITY));
    assert!(f[1].is_nan());
}

#[test]
fn files_that_are_missing_or_no_text() {
    let folder = tempfile::tempdir().unwrap();
    let of = |name: &str| Shader::load(&folder.path().join(name), &Settings::default());
    assert!(
        of("missing.wgsl")
            .unwrap_err()
            .to_string()
            .contains("missing.wgsl: ")
    );
    std::fs::write(folder.path().join("binary.wgsl"), [b'f', b'n', 0xff, 0xfe]).unwrap();
    let error = of("binary.wgsl").unwrap_err().to_string();
    assert!(error.ends_with("byte 2 is not text in UTF-8"), "{error}");
    std::fs::write(
        folder.path().join("large.wgsl"),
        vec![b' '; LARGEST_SOURCE + 1],
    )
    .unwrap();
    assert!(
        of("large.wgsl")
            .unwrap_err()
            .to_string()
            .contains("expected a shader of at most")
    );
}
