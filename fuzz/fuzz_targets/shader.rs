//! Bytes as a shader: the first one chooses the language, the rest is the text. Whatever can be compiled is run.
#![no_main]

use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};
use gonio_shader::{Language, Settings, Shader, ShaderModule};
use std::path::Path;
use std::sync::Once;

/// Operations that the loops of one evaluation may make.
const STEPS: u64 = 2000;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    static QUIET: Once = Once::new();
    // The fuzzer ends at any panic. Those of the parser are caught, on a thread of its own, and are errors.
    QUIET.call_once(|| {
        let end = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name() != Some("shader parser") {
                end(info);
            }
        }));
    });
    let Some((first, text)) = bytes.split_first() else {
        return;
    };
    let Ok(text) = std::str::from_utf8(text) else {
        return;
    };
    let language = match first {
        b'w' => Language::Wgsl,
        b'g' => Language::Glsl,
        _ => Language::Brdf,
    };
    let path = Path::new("fuzz.shader");
    let module = match ShaderModule::new(path, Some(language), text) {
        Ok(module) => module,
        Err(error) => return assert_eq!(error.path, path),
    };
    for name in module.function_names() {
        let Ok(program) = module.program(&name, STEPS) else {
            continue;
        };
        run(&program, &module, 0.5f64);
        run(&program, &module, 0.5f32);
        run(&program, &module, Lanes::<16>::splat(0.5));
    }
    let settings = Settings {
        steps: STEPS,
        ..Settings::default()
    };
    if let Ok(shader) = Shader::new(path, Some(language), text, &settings) {
        let up = Vec3::new(0.0, 0.0, 1.0);
        shader.eval(&shader.defaults(), up, up);
        shader.sample(&shader.defaults(), up, [0.25, 0.5, 0.75]);
    }
});

/// Runs a function with all its arguments the same.
fn run<R: gonio_shader::ShaderNumber + Real>(
    program: &gonio_shader::Program,
    module: &ShaderModule,
    x: R,
) {
    let parameters = module.parameters().iter();
    let parameters: usize = parameters.map(|p| p.components()).sum();
    let mut outputs = vec![x; program.outputs()];
    let _ = program.run(&vec![x; parameters], &vec![x; program.inputs()], &mut outputs);
}
