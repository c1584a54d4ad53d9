//! Files of BRDF Explorer.

use super::load;
use gonio_num::Vec3;
use gonio_shader::ParameterKind;

const TEXT: &str = "analytic

# a comment
::begin parameters
float roughness 0.01 1.0 0.5
color tint .8 .5 .25
bool anisotropic 1
float outside 0 1 2
::end parameters

::begin note
whatever
::end note

::begin shader
const float PI = 3.14159265358979323846;
float sqr(float x) { return x*x; }
vec3 BRDF( vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y )
{
    float c = dot(L, N);
    if (c < 0 || dot(V, N) < 0) return vec3(0);
    float along = anisotropic ? dot(L, X) : 0;
    return tint * sqr(roughness) / PI + vec3(along, dot(L, Y), max(0, c)) + outside;
}
::end shader
";

#[test]
fn parameters_and_frame() {
    let shader = load("a.brdf", TEXT).unwrap();
    let p = shader.parameters();
    assert_eq!(p.len(), 4);
    assert_eq!(
        (p[0].name.as_str(), p[0].low, p[0].high),
        ("roughness", 0.01, 1.0)
    );
    assert_eq!(
        (p[1].kind, p[1].default),
        (ParameterKind::Colour, [0.8, 0.5, 0.25])
    );
    assert_eq!((p[2].kind, p[2].default[0]), (ParameterKind::Switch, 1.0));
    // A default outside its own range widens it.
    assert_eq!((p[3].low, p[3].high), (0.0, 2.0));
    assert_eq!(shader.warnings(), ["section `note` is left out"]);
    let (wi, wo) = (Vec3::new(0.48, 0.6, 0.64), Vec3::new(0.0, 0.0, 1.0));
    let f = shader.eval(&shader.defaults(), wi, wo);
    let d = 0.25 / f64::from(std::f32::consts::PI);
    let expected = [
        0.8 * d + 0.48 + 2.0,
        0.5 * d + 0.6 + 2.0,
        0.25 * d + 0.64 + 2.0,
    ];
    for k in 0..3 {
        assert!(super::near(f[k], expected[k], 1e-12), "{f:?} {expected:?}");
    }
    let isotropic = [0.5, 0.8, 0.5, 0.25, 0.0, 2.0];
    assert!(super::near(
        shader.eval(&isotropic, wi, wo)[0],
        expected[0] - 0.48,
        1e-12
    ));
    let below = Vec3::new(0.6, 0.0, -0.8);
    assert_eq!(shader.eval(&shader.defaults(), below, wo), [0.0; 3]);
}

#[test]
fn wrong_headers_are_named_with_their_line() {
    for (text, expected) in [
        (
            "isotropic\n",
            "a.brdf:1:1: found `isotropic`, expected `analytic`: the first line of a function of BRDF Explorer",
        ),
        (
            "analytic\n::begin parameters\nfloat a 0 1\n",
            "a.brdf:3:1: found 2 numbers, expected `float NAME MIN MAX DEFAULT`",
        ),
        (
            "analytic\n::begin parameters\n float a 0 x 1\n",
            "a.brdf:3:2: found `x`, expected a number",
        ),
        (
            "analytic\n::begin parameters\nfloat a 1 0 1\n",
            "a.brdf:3:1: found the range 1 to 0, expected the smaller end first",
        ),
        (
            "analytic\n::begin parameters\nint a 0 1 1\n",
            "a.brdf:3:1: found `int`, expected `float`, `color` or `bool`",
        ),
        (
            "analytic\n::begin parameters\nbool 1a 0\n",
            "a.brdf:3:1: found `1a`, expected a parameter's name",
        ),
        (
            "analytic\n::begin parameters\nbool a 0\nbool a 1\n",
            "a.brdf:4:1: parameter `a` is declared twice",
        ),
        (
            "analytic\n::begin shader\n::begin shader\n",
            "a.brdf:3:1: section `shader` begins inside section `shader`",
        ),
        (
            "analytic\n::end shader\n",
            "a.brdf:2:1: section `shader` ends without having begun",
        ),
        (
            "analytic\n::begin shader\n::end parameters\n",
            "a.brdf:3:1: found the end of `parameters`, expected `::end shader`",
        ),
        (
            "analytic\n::begin shader\nfloat f;",
            "a.brdf:3:9: found the end of the file, expected `::end shader`",
        ),
        (
            "analytic\n",
            "a.brdf:2:1: found no section `shader`: expected `::begin shader`, GLSL with a function BRDF, `::end shader`",
        ),
        (
            "analytic\n::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) {\n  return x;\n}\n::end shader",
            "a.brdf:4:10: unknown variable: x",
        ),
        (
            "analytic\n::begin shader\nvec3 BRDF(vec3 L, vec3 V) { return L; }\n::end shader",
            "a.brdf:3:1: found `vec3 BRDF(vec3 L, vec3 V)`, expected `vec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y)`",
        ),
        (
            "analytic\n::begin shader\nvec3 f(vec3 L) { return L; }\n::end shader",
            "a.brdf: found `f`, `main`, expected a function `BRDF`",
        ),
    ] {
        assert_eq!(
            load("a.brdf", text).unwrap_err().to_string(),
            expected,
            "{text}"
        );
    }
}

/// What people write in these files: chains of conditions, a function of their own that has a built-in one's name, variables that hide functions and
/// parameters, whole numbers where others are meant.
#[test]
fn the_style_of_the_explorer() {
    let text = "analytic\n::begin parameters\nbool a 0\nbool b 1\nfloat f0 0 1 .25\n::end parameters\n::begin shader\n\
        vec3 reflect(vec3 I, vec3 N) { return 2*dot(I,N)*N - I; }\n\
        float phi(float f0) { float phi = f0 * 2; return phi < 0 ? 1-phi : phi; }\n\
        vec3 BRDF( vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y )\n\
        { vec3 v = a ? X : b ? reflect(L, N) : vec3(0); return (a ? vec3(v[0]) : v) + phi(f0) / 2 + .5 * f0; }\n\
        ::end shader";
    let shader = load("a.brdf", text).unwrap();
    let (wi, wo) = (Vec3::new(0.48, 0.6, 0.64), Vec3::new(0.0, 0.0, 1.0));
    let f = shader.eval(&shader.defaults(), wi, wo);
    // The mirror image about N, and 0.25 + 0.125.
    let expected = [-0.48 + 0.375, -0.6 + 0.375, 0.64 + 0.375];
    for k in 0..3 {
        assert!(super::near(f[k], expected[k], 1e-12), "{f:?} {expected:?}");
    }
}
