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
