//! The texts: valid, whole, and readable.

use super::*;
use naga::ShaderStage;
use naga::front::{glsl, wgsl};
use naga::valid::{Capabilities, ValidationFlags, Validator};

fn validate(module: &naga::Module, text: &str) {
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(module)
        .unwrap_or_else(|e| panic!("{}\n{text}", e.emit_to_string(text)));
}

#[test]
fn wgsl_and_glsl_are_valid() {
    for spec in showcase() {
        let export = Export::new(&spec).unwrap();
        let code = text(&export, Language::Wgsl, "m");
        let module = wgsl::parse_str(&code)
            .unwrap_or_else(|e| panic!("{}\n{code}", e.emit_to_string(&code)));
        validate(&module, &code);
        let code = text(&export, Language::Glsl, "m");
        let text = format!("#version 450\n{code}\nvoid main() {{}}\n");
        let module = glsl::Frontend::default()
            .parse(&glsl::Options::from(ShaderStage::Fragment), &text)
            .unwrap_or_else(|e| panic!("{}\n{text}", e.emit_to_string(&text)));
        validate(&module, &text);
    }
}

/// The header names the choices that the code was written with, and only what has an effect.
#[test]
fn the_header_says_what_is_in_effect() {
    let settled = |spec: &str| {
        let spec = ModelSpec::parse(spec).unwrap();
        let text = text(&Export::new(&spec).unwrap(), Language::Wgsl, "m");
        let after = text.split("Settled when").nth(1).unwrap_or_default();
        after.split("//\n").next().unwrap().to_owned()
    };
    // A metal's reflectance is a conductor's although `schlick` is the default, and `eta` has no effect.
    let gold = settled("ggx:metal=gold");
    assert!(
        gold.contains("metal=gold") && gold.contains("fresnel=conductor"),
        "{gold}"
    );
    assert!(
        !gold.contains("schlick") && !gold.contains("eta="),
        "{gold}"
    );
    assert!(settled("ggx").contains("fresnel=schlick"));
    // On unless it is switched off.
    assert!(settled("rough-dielectric").contains("interreflection=kulla-conty"));
    // A part's choices stand with it.
    let sum = settled("sum(lambertian, ggx:metal=gold)");
    assert!(sum.contains("fresnel=conductor"), "{sum}");
    // There is none to make.
    assert_eq!(settled("lambertian"), "");
}
