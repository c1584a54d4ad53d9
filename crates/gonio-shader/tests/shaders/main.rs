//! Shaders against the same functions in Rust.

// Helpers of tests may unwrap as tests may.
#![allow(clippy::unwrap_used)]

mod bad_input;
mod brdf_files;
mod builtins;
mod control_flow;
mod expressions;
mod glsl;
mod integers;
mod numbers;
mod whole;

use gonio_shader::{Settings, Shader, ShaderError, ShaderModule};
use std::path::Path;

/// A reflection function in a language that the name's extension tells.
fn load(name: &str, text: &str) -> Result<Shader, ShaderError> {
    Shader::new(Path::new(name), None, text, &Settings::default())
}

/// A text of WGSL.
fn wgsl(text: &str) -> ShaderModule {
    ShaderModule::new(Path::new("test.wgsl"), None, text).unwrap()
}

/// Runs `name` of a text of WGSL.
fn call(module: &ShaderModule, name: &str, inputs: &[f64]) -> Vec<f64> {
    let program = module.program(name, 100_000).unwrap();
    let mut outputs = vec![0.0; program.outputs()];
    program.run(&[], inputs, &mut outputs).unwrap();
    outputs
}

/// Whether two numbers differ by at most `tolerance` of the larger or of 1e-3, or are both NaN, or the same infinity.
fn near(a: f64, b: f64, tolerance: f64) -> bool {
    a == b
        || (a.is_nan() && b.is_nan())
        || (a - b).abs() <= tolerance * a.abs().max(b.abs()).max(1e-3)
}
