//! Shaders cut off anywhere, and texts of chance: an error or a function, never a panic.

use super::load;
use proptest::prelude::*;

const WGSL: &str = "override r: f32 = 0.3; // 0..1 rough
struct S { wi: vec3f, weight: vec3f, pdf: f32 }
fn eval(wi: vec3f, wo: vec3f) -> vec3f { var s = 0.0; for (var i = 0; i < 3; i++) { s += wi[i] * r; } return vec3f(s); }
fn sample(wo: vec3f, u: vec3f) -> S { return S(u, wo, 1.0); }";

const GLSL: &str = "uniform float r = 0.3; // 0..1 rough
vec3 eval(vec3 wi, vec3 wo) { float s = 0.0; for (int i = 0; i < 3; i++) { s += wi[i] * r; } return vec3(s); }";

const BRDF: &str = "analytic\n::begin parameters\nfloat r 0 1 0.3\ncolor c 1 0.5 0\n::end parameters\n::begin shader\nvec3 BRDF(vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y) { return c * dot(L, N) * r; }\n::end shader\n";

fn try_it(name: &str, text: &str) {
    if let Ok(shader) = load(name, text) {
        let up = gonio_num::Vec3::new(0.0, 0.0, 1.0);
        shader.eval(&shader.defaults(), up, up);
    }
}

#[test]
fn cut_off_at_every_byte() {
    for (name, text) in [("a.wgsl", WGSL), ("a.glsl", GLSL), ("a.brdf", BRDF)] {
        load(name, text).unwrap();
        for end in (0..text.len()).step_by(3) {
            try_it(name, &text[..end]);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn with_signs_changed(places in prop::collection::vec((0usize..400, 0u8..128), 1..6)) {
        for (name, text) in [("a.wgsl", WGSL), ("a.glsl", GLSL), ("a.brdf", BRDF)] {
            let mut bytes = text.as_bytes().to_vec();
            for &(at, byte) in &places {
                let at = at % bytes.len();
                bytes[at] = byte;
            }
            try_it(name, std::str::from_utf8(&bytes).unwrap());
        }
    }
}
