//! Models as shader code, function by function.
//!
//! The formulas are recorded from the same source that is evaluated here. The model's parameters become constants of
//! the function. [`gonio_num::expr::source()`] prints them; [`crate::export`] makes complete, commented modules of them.

use crate::{Brdf, BrdfError, Model};
use gonio_num::Real;
use gonio_num::Vec3;
use gonio_num::expr::{
    Arguments, Expr, Field, Function, Output, Parameter, RecordError, record, record_simplified,
};

/// One of the functions that a model is written as.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FunctionKind {
    /// [`Brdf::eval`].
    Eval,
    /// [`Brdf::pdf`].
    Pdf,
    /// [`Brdf::sample`].
    Sample,
}

impl FunctionKind {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Eval, Self::Pdf, Self::Sample];

    /// Its name: `eval`, `pdf` or `sample`.
    pub fn name(self) -> &'static str {
        ["eval", "pdf", "sample"][self as usize]
    }

    fn parameters(self) -> [Parameter; 2] {
        match self {
            Self::Eval | Self::Pdf => ["wi", "wo"].map(Parameter::vector),
            Self::Sample => ["wo", "xi"].map(Parameter::vector),
        }
    }

    /// What it gives for `model` and these arguments.
    fn output(self, model: &Model<Expr, 3>, name: &str, p: &Arguments) -> Output {
        let colour = |[r, g, b]: [Expr; 3]| Vec3::new(r, g, b);
        match self {
            Self::Eval => Output::Colour(colour(model.eval(p.vector("wi"), p.vector("wo")))),
            Self::Pdf => model.pdf(p.vector("wi"), p.vector("wo")).into(),
            Self::Sample => {
                let s = model.sample(p.vector("wo"), p.vector("xi").to_array());
                Output::Struct {
                    name: format!("{name}_result"),
                    fields: vec![
                        Field::vector("wi", s.wi),
                        Field::colour("weight", colour(s.weight)),
                        Field::scalar("pdf", s.pdf),
                        Field::scalar("delta", Expr::from_mask(s.delta)),
                    ],
                }
            }
        }
    }
}

/// Parameters of a model that stand in the code by name.
pub(crate) trait Named {
    /// Them, each with its value.
    fn parameters(&self) -> Vec<Parameter>;
    /// Sets them in the model to what `value` gives for their names, and for whether they are colours.
    fn set(&self, model: &mut Model<Expr, 3>, value: &dyn Fn(&str, bool) -> [Expr; 3]);
}

/// Records `fn name(wi: vec3f, wo: vec3f) -> vec3f`, f in sr⁻¹ without the cosine.
///
/// # Errors
/// If the model cannot be recorded ([`Model::is_recordable`]), or `name` is no name in WGSL.
pub fn record_eval(model: &Model<f32, 3>, name: &str) -> Result<Function, BrdfError> {
    exact(model, FunctionKind::Eval, name)
}

/// Records `fn name(wi: vec3f, wo: vec3f) -> f32`, the density in sr⁻¹ of sampling wi given wo.
///
/// # Errors
/// As [`record_eval`].
pub fn record_pdf(model: &Model<f32, 3>, name: &str) -> Result<Function, BrdfError> {
    exact(model, FunctionKind::Pdf, name)
}

/// Records `fn name(wo: vec3f, xi: vec3f) -> name_result`, a structure of `wi` and `weight` (`vec3f`), `pdf` and
/// `delta` (`f32`; 1 for a discrete direction).
///
/// # Errors
/// As [`record_eval`].
pub fn record_sample(model: &Model<f32, 3>, name: &str) -> Result<Function, BrdfError> {
    exact(model, FunctionKind::Sample, name)
}

fn exact(model: &Model<f32, 3>, kind: FunctionKind, name: &str) -> Result<Function, BrdfError> {
    check(model)?;
    Ok(record(name, &kind.parameters(), |p| {
        kind.output(&expressions(model), name, p)
    })?)
}

/// Records a function for people to read, with the parameters in `named` by name.
pub(crate) fn recorded(
    model: &Model<f32, 3>,
    kind: FunctionKind,
    name: &str,
    named: &impl Named,
) -> Result<Function, BrdfError> {
    check(model)?;
    let mut parameters = kind.parameters().to_vec();
    parameters.extend(named.parameters());
    let function: Result<Function, RecordError> = record_simplified(name, &parameters, |p| {
        let mut model = expressions(model);
        named.set(&mut model, &|name, is_colour| match is_colour {
            true => p.vector(name).to_array(),
            false => [p.scalar(name); 3],
        });
        kind.output(&model, name, p)
    });
    Ok(function?)
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
