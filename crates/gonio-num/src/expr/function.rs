//! [`record`] and what it takes and gives.

use super::tape::{self, Graph, Id};
use super::{Expr, Handle, evaluate, names, print};
use crate::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Why a formula can't be recorded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// [`record`] was called inside the body of another recording on the same thread.
    #[error("a recording can't start inside the body of another one on the same thread")]
    Nested,
    /// A name that WGSL, or the printer, doesn't allow.
    #[error(
        "`{name}` can't be a name in shader code: expected a letter, then letters, digits or `_`, no word \
         that WGSL reserves and no `gonio_` in front"
    )]
    Name {
        /// The name found.
        name: String,
    },
    /// Two things with the same name.
    #[error("two things are named `{name}` in the same shader code")]
    Duplicate {
        /// The name found twice.
        name: String,
    },
    /// A table without at least two samples in each direction, or with a number of samples other than width × height.
    #[error(
        "table `{name}` has {samples} samples: expected at least 2 along each axis, and width × height"
    )]
    TableSize {
        /// The table's name.
        name: String,
        /// How many samples it has.
        samples: usize,
    },
    /// A table with a NaN or an infinity.
    #[error("sample {index} of table `{name}` is {value}: expected a finite number")]
    TableValue {
        /// The table's name.
        name: String,
        /// The sample's index.
        index: usize,
        /// What stands there.
        value: f32,
    },
    /// An array or structure without a value.
    #[error("the function `{name}` returns nothing: expected at least one value")]
    NoOutput {
        /// The function's name.
        name: String,
    },
}

/// A parameter of a recorded function.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameter {
    name: String,
    is_vector: bool,
}

impl Parameter {
    /// A number, `f32`.
    pub fn scalar(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            is_vector: false,
        }
    }

    /// A vector, `vec3<f32>`.
    pub fn vector(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            is_vector: true,
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(super) fn wgsl_type(&self) -> &'static str {
        if self.is_vector { "vec3<f32>" } else { "f32" }
    }

    /// The texts of its components.
    pub(super) fn components(&self) -> Vec<String> {
        if self.is_vector {
            ["x", "y", "z"]
                .map(|c| format!("{}.{c}", self.name))
                .to_vec()
        } else {
            vec![self.name.clone()]
        }
    }
}

/// The parameters' values, as expressions, inside the body of a recording.
#[derive(Debug)]
pub struct Arguments {
    /// By name: whether it is a vector, and the first component.
    found: BTreeMap<String, (bool, u32)>,
}

impl Arguments {
    /// The number named `name`.
    ///
    /// # Panics
    /// If no parameter [`Parameter::scalar`] has this name.
    pub fn scalar(&self, name: &str) -> Expr {
        Self::component(self.find(name, false))
    }

    /// The vector named `name`.
    ///
    /// # Panics
    /// If no parameter [`Parameter::vector`] has this name.
    pub fn vector(&self, name: &str) -> Vec3<Expr> {
        let first = self.find(name, true);
        Vec3::new(
            Self::component(first),
            Self::component(first + 1),
            Self::component(first + 2),
        )
    }

    fn find(&self, name: &str, vector: bool) -> u32 {
        match self.found.get(name) {
            Some((is_vector, first)) if *is_vector == vector => *first,
            _ => {
                let kind = if vector { "vector" } else { "scalar" };
                let known: Vec<&str> = self.found.keys().map(String::as_str).collect();
                panic!(
                    "no {kind} parameter is named `{name}`; there are: {}",
                    known.join(", ")
                )
            }
        }
    }

    fn component(index: u32) -> Expr {
        Expr(tape::with(|t| Handle::new(t.parameter(index), t.recording)))
    }
}

/// What a recorded function returns.
#[derive(Debug, Clone)]
pub enum Output {
    /// `f32`.
    Scalar(Expr),
    /// `vec3<f32>`.
    Vector(Vec3<Expr>),
    /// `array<f32, N>`.
    Array(Vec<Expr>),
    /// A structure, which is declared too.
    Struct {
        /// Its name.
        name: String,
        /// Its members, in order.
        fields: Vec<Field>,
    },
}

/// A member of a structure that a recorded function returns.
#[derive(Debug, Clone)]
pub struct Field {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: FieldValue,
}

/// The value of a [`Field`].
#[derive(Debug, Clone)]
pub enum FieldValue {
    /// `f32`.
    Scalar(Expr),
    /// `vec3<f32>`.
    Vector(Vec3<Expr>),
}

impl Field {
    /// A member of type `f32`.
    pub fn scalar(name: impl Into<String>, value: Expr) -> Self {
        Self {
            name: name.into(),
            value: FieldValue::Scalar(value),
        }
    }

    /// A member of type `vec3<f32>`.
    pub fn vector(name: impl Into<String>, value: Vec3<Expr>) -> Self {
        Self {
            name: name.into(),
            value: FieldValue::Vector(value),
        }
    }
}

impl From<Expr> for Output {
    fn from(x: Expr) -> Self {
        Self::Scalar(x)
    }
}

impl From<Vec3<Expr>> for Output {
    fn from(v: Vec3<Expr>) -> Self {
        Self::Vector(v)
    }
}

impl<const N: usize> From<[Expr; N]> for Output {
    fn from(a: [Expr; N]) -> Self {
        Self::Array(a.to_vec())
    }
}

impl Output {
    fn expressions(&self) -> Vec<Expr> {
        match self {
            Self::Scalar(x) => vec![*x],
            Self::Vector(v) => v.to_array().to_vec(),
            Self::Array(a) => a.clone(),
            Self::Struct { fields, .. } => fields
                .iter()
                .flat_map(|f| match f.value {
                    FieldValue::Scalar(x) => vec![x],
                    FieldValue::Vector(v) => v.to_array().to_vec(),
                })
                .collect(),
        }
    }

    pub(super) fn ids(&self) -> Vec<Id> {
        self.expressions().iter().map(|x| x.0.id).collect()
    }

    pub(super) fn wgsl_type(&self) -> String {
        match self {
            Self::Scalar(_) => "f32".into(),
            Self::Vector(_) => "vec3<f32>".into(),
            Self::Array(a) => format!("array<f32, {}>", a.len()),
            Self::Struct { name, .. } => name.clone(),
        }
    }
}

/// A recorded formula: shader code, and a graph that can be evaluated.
#[derive(Debug, Clone)]
pub struct Function {
    /// Its name in the shader code.
    pub name: String,
    /// Complete WGSL: the function and all that it needs (tables, structures). To have several functions in one shader,
    /// see [`module`].
    pub wgsl: String,
    declarations: BTreeMap<String, String>,
    text: String,
    parameters: Vec<Parameter>,
    graph: Graph,
    outputs: Vec<Id>,
}

impl Function {
    /// The parameters, in order.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// The function's value, run on `f32`: what the recorded formula over `f32` gives, to the bit.
    ///
    /// `arguments` are the parameters in order, a vector as three numbers; so is the result.
    ///
    /// # Panics
    /// If the number of arguments is wrong.
    pub fn evaluate(&self, arguments: &[f32]) -> Vec<f32> {
        let expected: usize = self.parameters.iter().map(|p| p.components().len()).sum();
        assert!(
            arguments.len() == expected,
            "`{}` takes {expected} numbers, not {}",
            self.name,
            arguments.len()
        );
        evaluate::evaluate(&self.graph, arguments, &self.outputs)
    }
}

/// Runs `body` once on expressions and gives the function that it computes.
///
/// # Errors
/// If a name isn't allowed or stands for two things, a table can't be used, nothing is returned, or a recording is already going
/// on on this thread.
///
/// # Panics
/// If `body` does; the recording then ends, and another may start. See [`Expr`] and [`Arguments`].
pub fn record<O: Into<Output>>(
    name: &str,
    parameters: &[Parameter],
    body: impl FnOnce(&Arguments) -> O,
) -> Result<Function, RecordError> {
    let mut known = BTreeSet::new();
    for n in std::iter::once(name).chain(parameters.iter().map(Parameter::name)) {
        names::check(n)?;
        if !known.insert(n.to_owned()) {
            return Err(RecordError::Duplicate { name: n.into() });
        }
    }
    let mut found = BTreeMap::new();
    let mut component = 0;
    for p in parameters {
        found.insert(p.name.clone(), (p.is_vector, component));
        component += p.components().len() as u32;
    }

    let recording = tape::Recording::start()?;
    let output: Output = body(&Arguments { found }).into();
    // Refuses values of other recordings and of closed loops, as every other use does.
    for x in output.expressions() {
        tape::with(|t| t.check_use(x.0.id(t.recording)));
    }
    let tape = recording.finish();

    if let Some(error) = tape.error {
        return Err(error);
    }
    let mut also_known = Vec::new();
    for table in tape.graph.table_names() {
        also_known.extend([table.to_owned(), format!("{table}_at")]);
    }
    if let Output::Struct { name, fields } = &output {
        names::check(name)?;
        also_known.push(name.clone());
        let mut members = BTreeSet::new();
        for f in fields {
            names::check(&f.name)?;
            if !members.insert(&f.name) {
                return Err(RecordError::Duplicate {
                    name: f.name.clone(),
                });
            }
        }
    }
    for n in also_known {
        if known.contains(&n) {
            return Err(RecordError::Duplicate { name: n });
        }
        known.insert(n);
    }
    let outputs = output.ids();
    if outputs.is_empty() {
        return Err(RecordError::NoOutput { name: name.into() });
    }

    let printed = print::print(&tape.graph, name, parameters, &output, known);
    let mut wgsl = joined(&printed.declarations);
    wgsl.push_str(&printed.function);
    Ok(Function {
        name: name.into(),
        wgsl,
        declarations: printed.declarations,
        text: printed.function,
        parameters: parameters.to_vec(),
        graph: tape.graph,
        outputs,
    })
}

/// WGSL of several functions together; what more than one of them needs is declared once.
///
/// # Errors
/// If two functions, or two different declarations, have the same name.
pub fn module(functions: &[&Function]) -> Result<String, RecordError> {
    let mut declarations = BTreeMap::new();
    let mut texts: BTreeMap<&str, &str> = BTreeMap::new();
    for f in functions {
        for (name, text) in &f.declarations {
            let before = declarations.insert(name.clone(), text.clone());
            if before.is_some_and(|b| b != *text) {
                return Err(RecordError::Duplicate { name: name.clone() });
            }
        }
        if texts.insert(&f.name, &f.text).is_some() {
            let name = f.name.clone();
            return Err(RecordError::Duplicate { name });
        }
    }
    if let Some(name) = texts.keys().find(|name| declarations.contains_key(**name)) {
        return Err(RecordError::Duplicate {
            name: (*name).into(),
        });
    }
    let mut wgsl = joined(&declarations);
    for f in functions {
        wgsl.push_str(&f.text);
        wgsl.push('\n');
    }
    Ok(wgsl)
}

fn joined(declarations: &BTreeMap<String, String>) -> String {
    let mut text = String::new();
    for declaration in declarations.values() {
        text.push_str(declaration);
        text.push('\n');
    }
    text
}
