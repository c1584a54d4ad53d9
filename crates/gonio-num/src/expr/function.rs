//! [`record`] and what it takes and gives.

use super::language::{Dialect, Type};
use super::source;
use super::tape::{self, Graph, Id};
use super::vectors::{Value, Vectors};
use super::{Expr, Handle, Language, evaluate, names};
use crate::Vec3;
use std::collections::{BTreeMap, BTreeSet};

/// Why a formula can't be recorded.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RecordError {
    /// [`record`] was called inside the body of another recording on the same thread.
    #[error("a recording can't start inside the body of another one on the same thread")]
    Nested,
    /// A name that the language, or the printer, doesn't allow.
    #[error(
        "`{name}` can't be a name in shader code: expected a letter, then letters, digits or `_`, no word \
         that {} reserves and no `gonio_` in front", .language.name().to_uppercase()
    )]
    Name {
        /// The name found.
        name: String,
        /// The language that is printed.
        language: Language,
    },
    /// A function that returns an array, in a language whose functions can't.
    #[error("the function `{name}` returns an array, which no function of {} can", .language.name().to_uppercase())]
    ArrayReturned {
        /// The function's name.
        name: String,
        /// The language.
        language: Language,
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
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    pub(super) name: String,
    pub(super) kind: Type,
    /// Its value, if it is a constant of the module that reads like a parameter.
    pub(super) fixed: Option<[f32; 3]>,
}

impl Parameter {
    /// A number.
    pub fn scalar(name: impl Into<String>) -> Self {
        Self::new(name, Type::Number)
    }

    /// A vector.
    pub fn vector(name: impl Into<String>) -> Self {
        Self::new(name, Type::Vector)
    }

    /// A colour: three numbers, which most languages call a vector too.
    pub fn colour(name: impl Into<String>) -> Self {
        Self::new(name, Type::Colour)
    }

    fn new(name: impl Into<String>, kind: Type) -> Self {
        Self {
            name: name.into(),
            kind,
            fixed: None,
        }
    }

    /// The parameter as a named constant of the module instead of an argument of the function, for a reader to change. A number takes
    /// the first component. It stands in the text only where the function needs it.
    #[must_use]
    pub fn fixed(self, value: [f32; 3]) -> Self {
        Self {
            fixed: Some(value),
            ..self
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How many numbers it is.
    pub(super) fn width(&self) -> usize {
        if self.is_vector() { 3 } else { 1 }
    }

    fn is_vector(&self) -> bool {
        matches!(self.kind, Type::Vector | Type::Colour)
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

    /// The vector or colour named `name`.
    ///
    /// # Panics
    /// If no parameter [`Parameter::vector`] or [`Parameter::colour`] has this name.
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
    /// A number.
    Scalar(Expr),
    /// A vector.
    Vector(Vec3<Expr>),
    /// A colour: three numbers, which most languages call a vector too.
    Colour(Vec3<Expr>),
    /// An array of numbers, in WGSL and GLSL.
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
    /// A number.
    Scalar(Expr),
    /// A vector.
    Vector(Vec3<Expr>),
    /// A colour.
    Colour(Vec3<Expr>),
}

impl Field {
    /// A number.
    pub fn scalar(name: impl Into<String>, value: Expr) -> Self {
        Self {
            name: name.into(),
            value: FieldValue::Scalar(value),
        }
    }

    /// A vector.
    pub fn vector(name: impl Into<String>, value: Vec3<Expr>) -> Self {
        Self {
            name: name.into(),
            value: FieldValue::Vector(value),
        }
    }

    /// A colour.
    pub fn colour(name: impl Into<String>, value: Vec3<Expr>) -> Self {
        Self {
            name: name.into(),
            value: FieldValue::Colour(value),
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
            Self::Vector(v) | Self::Colour(v) => v.to_array().to_vec(),
            Self::Array(a) => a.clone(),
            Self::Struct { fields, .. } => fields
                .iter()
                .flat_map(|f| match f.value {
                    FieldValue::Scalar(x) => vec![x],
                    FieldValue::Vector(v) | FieldValue::Colour(v) => v.to_array().to_vec(),
                })
                .collect(),
        }
    }

    fn returned(&self) -> Returned {
        let one = |x: &Expr| (Type::Number, vec![x.0.id]);
        let three = |kind: Type, v: &Vec3<Expr>| (kind, v.to_array().map(|x| x.0.id).to_vec());
        let parts = match self {
            Self::Scalar(x) => vec![one(x)],
            Self::Vector(v) => vec![three(Type::Vector, v)],
            Self::Colour(v) => vec![three(Type::Colour, v)],
            Self::Array(a) => a.iter().map(one).collect(),
            Self::Struct { fields, .. } => fields
                .iter()
                .map(|f| match &f.value {
                    FieldValue::Scalar(x) => one(x),
                    FieldValue::Vector(v) => three(Type::Vector, v),
                    FieldValue::Colour(v) => three(Type::Colour, v),
                })
                .collect(),
        };
        let structure = match self {
            Self::Struct { name, fields } => Some(Structure {
                name: name.clone(),
                fields: fields.iter().map(|f| f.name.clone()).collect(),
            }),
            _ => None,
        };
        Returned {
            parts,
            structure,
            is_array: matches!(self, Self::Array(_)),
        }
    }
}

/// What a function returns, by the places of its numbers on the tape.
#[derive(Debug, Clone)]
pub(super) struct Returned {
    parts: Vec<(Type, Vec<Id>)>,
    pub structure: Option<Structure>,
    pub is_array: bool,
}

/// The name of a structure, and those of its members.
#[derive(Debug, Clone)]
pub(super) struct Structure {
    pub name: String,
    pub fields: Vec<String>,
}

impl Returned {
    pub fn ids(&self) -> Vec<Id> {
        self.parts.iter().flat_map(|(_, ids)| ids.clone()).collect()
    }

    /// The vectors among its parts.
    pub fn vectors(&self) -> Vec<([Id; 3], Type)> {
        let three = |(kind, ids): &(Type, Vec<Id>)| match ids.as_slice() {
            [x, y, z] => Some(([*x, *y, *z], *kind)),
            _ => None,
        };
        self.parts.iter().filter_map(three).collect()
    }

    /// Its parts as values to be printed; `vectors` were found from [`Returned::vectors`].
    pub fn values(&self, vectors: &Vectors<'_>) -> Vec<Value> {
        let value = |(kind, ids): &(Type, Vec<Id>)| match ids.as_slice() {
            [x, y, z] => Value::Three(vectors.known([*x, *y, *z], *kind)),
            ids => Value::One(ids[0]),
        };
        self.parts.iter().map(value).collect()
    }

    pub fn type_name(&self, d: &Dialect) -> String {
        match &self.structure {
            Some(structure) => structure.name.clone(),
            None if self.is_array => d.array(self.parts.len()),
            None => d.type_name(self.parts[0].0).into(),
        }
    }

    /// The declaration of the structure that is called `name`.
    pub fn declaration(&self, d: &Dialect, name: &str) -> String {
        let fields = self.structure.iter().flat_map(|s| &s.fields);
        let mut text = format!("struct {name} {{\n");
        for (field, (kind, _)) in fields.zip(&self.parts) {
            let end = if d.is_wgsl() { "," } else { ";" };
            text += &format!("    {}{end}\n", d.typed(d.type_name(*kind), field));
        }
        text + if d.is_wgsl() { "}\n" } else { "};\n" }
    }
}

/// A recorded formula: shader code, and a graph that can be evaluated.
#[derive(Debug, Clone)]
pub struct Function {
    /// Its name in the shader code.
    pub name: String,
    pub(super) parameters: Vec<Parameter>,
    pub(super) graph: Graph,
    pub(super) returned: Returned,
}

impl Function {
    /// The parameters, in order.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// Complete WGSL: the function and all that it needs (tables, structures). For several functions in one shader and for other
    /// languages, see [`source`](super::source()).
    pub fn wgsl(&self) -> String {
        source::module(&[self]).expect("invariant: the names were checked when it was recorded")
    }

    /// How many operations it takes; those in a loop count once.
    pub fn operations(&self) -> usize {
        self.graph.operations(&self.returned.ids())
    }

    /// The function's value, run on `f32`: what the recorded formula over `f32` gives, to the bit.
    ///
    /// `arguments` are the parameters in order but for the fixed ones, a vector as three numbers; so is the result.
    ///
    /// # Panics
    /// If the number of arguments is wrong.
    pub fn evaluate(&self, arguments: &[f32]) -> Vec<f32> {
        let asked = self.parameters.iter().filter(|p| p.fixed.is_none());
        let expected: usize = asked.map(Parameter::width).sum();
        assert!(
            arguments.len() == expected,
            "`{}` takes {expected} numbers, not {}",
            self.name,
            arguments.len()
        );
        let mut given = arguments.iter();
        let mut all = Vec::new();
        for p in &self.parameters {
            match p.fixed {
                Some(value) => all.extend(&value[..p.width()]),
                None => all.extend(given.by_ref().take(p.width())),
            }
        }
        evaluate::evaluate(&self.graph, &all, &self.returned.ids())
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
    record_as(name, parameters, body, false)
}

/// As [`record`], for people to read: what has no effect on a finite number is left out, such as x·0, x + 0 and limits within limits. The
/// values are those of the formula but for the sign of a zero, and the last digit of a mean of three equal numbers.
///
/// # Errors
/// As [`record`].
///
/// # Panics
/// As [`record`].
pub fn record_simplified<O: Into<Output>>(
    name: &str,
    parameters: &[Parameter],
    body: impl FnOnce(&Arguments) -> O,
) -> Result<Function, RecordError> {
    record_as(name, parameters, body, true)
}

fn record_as<O: Into<Output>>(
    name: &str,
    parameters: &[Parameter],
    body: impl FnOnce(&Arguments) -> O,
    simplify: bool,
) -> Result<Function, RecordError> {
    let check = |name: &str| names::check(Language::Wgsl, name);
    let mut known = BTreeSet::new();
    for n in std::iter::once(name).chain(parameters.iter().map(Parameter::name)) {
        check(n)?;
        if !known.insert(n.to_owned()) {
            return Err(RecordError::Duplicate { name: n.into() });
        }
    }
    let mut found = BTreeMap::new();
    let mut component = 0;
    for p in parameters {
        found.insert(p.name.clone(), (p.is_vector(), component));
        component += p.width() as u32;
    }

    let recording = tape::Recording::start(simplify)?;
    let output: Output = body(&Arguments { found }).into();
    // Refuses values of other recordings and of closed loops, as every other use does.
    for x in output.expressions() {
        tape::with(|t| t.check_use(x.0.id(t.recording)));
    }
    let tape = recording.finish();

    if let Some(error) = tape.error {
        return Err(error);
    }
    if let Output::Struct { fields, .. } = &output {
        let mut members = BTreeSet::new();
        for f in fields {
            check(&f.name)?;
            if !members.insert(&f.name) {
                return Err(RecordError::Duplicate {
                    name: f.name.clone(),
                });
            }
        }
    }
    let returned = output.returned();
    if returned.ids().is_empty() {
        return Err(RecordError::NoOutput { name: name.into() });
    }
    let function = Function {
        name: name.into(),
        parameters: parameters.to_vec(),
        graph: tape.graph,
        returned,
    };
    source::check(&[&function], Language::Wgsl, "")?;
    Ok(function)
}
