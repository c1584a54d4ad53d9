//! Models as shader code.
//!
//! The formulas are recorded from the same source that is evaluated here. The model's parameters become constants of
//! the function. WGSL is what is printed; naga makes GLSL, HLSL, MSL and SPIR-V of it.

use crate::{Brdf, BrdfError, Model};
use gonio_num::Real;
use gonio_num::Vec3;
use gonio_num::expr::{Expr, Field, Function, Output, Parameter, record};

/// Records `fn name(wi: vec3<f32>, wo: vec3<f32>) -> vec3<f32>`, f in sr⁻¹ without the cosine.
///
/// # Errors
/// If the model cannot be recorded ([`Model::is_recordable`]), or `name` is no name in WGSL.
pub fn record_eval(model: &Model<f32, 3>, name: &str) -> Result<Function, BrdfError> {
    check(model)?;
    Ok(record(name, &pair(), |p| {
        let [r, g, b] = expressions(model).eval(p.vector("wi"), p.vector("wo"));
        Vec3::new(r, g, b)
    })?)
}

/// Records `fn name(wi: vec3<f32>, wo: vec3<f32>) -> f32`, the density in sr⁻¹ of sampling wi given wo.
///
/// # Errors
/// As [`record_eval`].
pub fn record_pdf(model: &Model<f32, 3>, name: &str) -> Result<Function, BrdfError> {
    check(model)?;
    Ok(record(name, &pair(), |p| {
        expressions(model).pdf(p.vector("wi"), p.vector("wo"))
    })?)
}

/// Records `fn name(wo: vec3<f32>, u: vec3<f32>) -> name_result`, a structure of `wi` and `weight` (`vec3<f32>`), `pdf` and
/// `delta` (`f32`; 1 for a discrete direction).
///
/// # Errors
/// As [`record_eval`].
pub fn record_sample(model: &Model<f32, 3>, name: &str) -> Result<Function, BrdfError> {
    check(model)?;
    let parameters = [Parameter::vector("wo"), Parameter::vector("u")];
    Ok(record(name, &parameters, |p| {
        let s = expressions(model).sample(p.vector("wo"), p.vector("u").to_array());
        let [r, g, b] = s.weight;
        Output::Struct {
            name: format!("{name}_result"),
            fields: vec![
                Field::vector("wi", s.wi),
                Field::vector("weight", Vec3::new(r, g, b)),
                Field::scalar("pdf", s.pdf),
                Field::scalar("delta", Expr::from_mask(s.delta)),
            ],
        }
    })?)
}

fn pair() -> [Parameter; 2] {
    [Parameter::vector("wi"), Parameter::vector("wo")]
}

/// The model with its numbers as constants of the recording.
fn expressions(model: &Model<f32, 3>) -> Model<Expr, 3> {
    model.cast(&|x| Expr::lit(f64::from(x)))
}

fn check(model: &Model<f32, 3>) -> Result<(), BrdfError> {
    if model.is_recordable() {
        return Ok(());
    }
    Err(BrdfError::Unsupported {
        what: format!(
            "`{}` cannot be written as shader code: a table in memory is searched, not computed",
            model.info().name
        ),
    })
}
