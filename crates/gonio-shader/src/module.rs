//! [`ShaderModule`], a text that was parsed and validated.

use crate::compile::{self, Fault};
use crate::parameter::{Note, Origin, Parameter, ParameterKind, UNBOUNDED};
use crate::source::{Commented, LARGEST_SOURCE, Language, Source, identifiers, without_comments};
use crate::{Program, ShaderError, brdf_file, glsl, parse};
use naga::valid::ModuleInfo;
use naga::{
    AddressSpace, Expression, Function, Handle, Literal, Module, Scalar, ScalarKind, Type,
    TypeInner, VectorSize,
};
use std::path::Path;
use std::sync::Arc;

/// The shader's text, understood: its functions can be compiled to [`Program`]s.
#[derive(Debug)]
pub struct ShaderModule {
    pub(crate) source: Arc<Source>,
    pub(crate) module: Module,
    info: ModuleInfo,
    parameters: Vec<Parameter>,
    warnings: Vec<String>,
}

impl ShaderModule {
    /// Reads a text. `path` is its name in errors; `language` is guessed if it is `None`.
    ///
    /// # Errors
    /// What is wrong with the text, and where.
    pub fn new(path: &Path, language: Option<Language>, text: &str) -> Result<Self, ShaderError> {
        if text.len() > LARGEST_SOURCE {
            return Err(ShaderError::new(
                path,
                format!(
                    "found {} bytes, expected a shader of at most {LARGEST_SOURCE}",
                    text.len()
                ),
            ));
        }
        let language = language
            .or_else(|| Language::of_extension(path))
            .unwrap_or_else(|| Language::of_text(text));
        let mut source = Source {
            path: path.into(),
            language,
            text: text.into(),
            code: text.into(),
        };
        let mut declared = Vec::new();
        let mut warnings = Vec::new();
        if language == Language::Brdf {
            let header = brdf_file::read(&source)?;
            source.code = header.code;
            declared = header.parameters;
            warnings = header.warnings;
        }
        let commented = without_comments(&source.code, language == Language::Wgsl);
        source.check_nesting(&commented.code)?;
        let mut names = Vec::new();
        if language != Language::Wgsl {
            glsl::check_macros(&source, &commented.code)?;
            let prepared = glsl::uniforms(&source.code, &commented.code);
            source.code = prepared.code;
            names = prepared.names;
            if !identifiers(&commented.code).any(|(_, word)| word == "main") {
                source.code.push_str("\nvoid main() {}\n");
            }
        }
        names.extend(declared.iter().map(|d| d.name.clone()));
        let (module, info) = parse::parse(&source)?;
        let mut this = Self {
            source: Arc::new(source),
            module,
            info,
            parameters: Vec::new(),
            warnings,
        };
        this.parameters = this.find_parameters(&names, &commented)?;
        for parameter in &mut this.parameters {
            if let Some(d) = declared.iter().find(|d| d.name == parameter.name) {
                parameter.kind = d.kind;
                parameter.default = d.default;
                (parameter.low, parameter.high) = d.range;
            }
        }
        Ok(this)
    }

    /// Its language.
    pub fn language(&self) -> Language {
        self.source.language
    }

    /// The parameters that it declares, in order.
    pub fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    /// What was left out of the file.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The functions that it defines, as they are declared.
    pub fn functions(&self) -> Vec<String> {
        let all = self.module.functions.iter();
        all.map(|(_, f)| self.signature(f)).collect()
    }

    /// The names of the functions that it defines.
    pub fn function_names(&self) -> Vec<String> {
        let all = self.module.functions.iter();
        all.filter_map(|(_, f)| f.name.clone()).collect()
    }

    /// Compiles a function by its name. `steps` bounds how many operations its loops may make.
    ///
    /// # Errors
    /// If there is no such function, or it uses what is not supported.
    pub fn program(&self, name: &str, steps: u64) -> Result<Program, ShaderError> {
        let Some(handle) = self.named(name).next() else {
            return Err(self.missing(name));
        };
        self.compile(handle, steps)
    }

    pub(crate) fn compile(
        &self,
        handle: Handle<Function>,
        steps: u64,
    ) -> Result<Program, ShaderError> {
        let name = self.module.functions[handle].name.clone();
        let tape = parse::on_large_stack(&self.source, || {
            compile::compile(&self.module, &self.info, &self.parameters, handle)
        })?;
        let tape = tape.map_err(|fault| self.fault(&fault))?;
        Ok(Program::new(
            name.unwrap_or_default(),
            Arc::clone(&self.source),
            tape,
            steps,
        ))
    }

    /// The functions of a name: GLSL may have several.
    pub(crate) fn named<'a>(
        &'a self,
        name: &'a str,
    ) -> impl Iterator<Item = Handle<Function>> + 'a {
        self.module
            .functions
            .iter()
            .filter(move |(_, f)| f.name.as_deref() == Some(name))
            .map(|(handle, _)| handle)
    }

    /// The error that a function is missing.
    pub(crate) fn missing(&self, name: &str) -> ShaderError {
        let functions = self.module.functions.iter();
        let names: Vec<&str> = functions.filter_map(|(_, f)| f.name.as_deref()).collect();
        let found = match names.as_slice() {
            [] => "no function".to_owned(),
            names => {
                let list: Vec<_> = names.iter().map(|n| format!("`{n}`")).collect();
                list.join(", ")
            }
        };
        let error = ShaderError::new(
            &self.source.path,
            format!("found {found}, expected a function `{name}`"),
        );
        let near = names
            .iter()
            .map(|n| (strsim::jaro_winkler(name, &n.to_lowercase()), n))
            .filter(|(likeness, _)| *likeness >= 0.75)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        match near {
            Some((_, near)) => error.with_help(format!("did you mean `{near}`?")),
            None => error,
        }
    }

    fn fault(&self, fault: &Fault) -> ShaderError {
        match fault.span.to_range() {
            Some(range) => self.source.error_at(range.start, fault.message.clone()),
            None => ShaderError::new(&self.source.path, fault.message.clone()),
        }
    }

    /// An error about a function, at its declaration.
    pub(crate) fn error_at_function(
        &self,
        handle: Handle<Function>,
        message: String,
    ) -> ShaderError {
        let span = self.module.functions.get_span(handle);
        self.fault(&Fault::new(span, message))
    }

    /// A function as it is declared.
    pub(crate) fn signature(&self, f: &Function) -> String {
        let name = f.name.as_deref().unwrap_or("?");
        let wgsl = self.source.language == Language::Wgsl;
        let arguments: Vec<String> = f
            .arguments
            .iter()
            .map(|a| {
                let argument = a.name.as_deref().unwrap_or("_");
                match (&self.module.types[a.ty].inner, wgsl) {
                    (TypeInner::Pointer { base, .. }, true) => {
                        format!("{argument}: ptr<function, {}>", self.type_name(*base))
                    }
                    (TypeInner::Pointer { base, .. }, false) => {
                        format!("out {} {argument}", self.type_name(*base))
                    }
                    (_, true) => format!("{argument}: {}", self.type_name(a.ty)),
                    (_, false) => format!("{} {argument}", self.type_name(a.ty)),
                }
            })
            .collect();
        let arguments = arguments.join(", ");
        match (&f.result, wgsl) {
            (Some(r), true) => format!("fn {name}({arguments}) -> {}", self.type_name(r.ty)),
            (None, true) => format!("fn {name}({arguments})"),
            (Some(r), false) => format!("{} {name}({arguments})", self.type_name(r.ty)),
            (None, false) => format!("void {name}({arguments})"),
        }
    }

    fn type_name(&self, ty: Handle<Type>) -> String {
        let wgsl = self.source.language == Language::Wgsl;
        let ty = &self.module.types[ty];
        let scalar = |s: Scalar| match (s.kind, wgsl) {
            (ScalarKind::Sint, true) => "i32",
            (ScalarKind::Uint, true) => "u32",
            (ScalarKind::Float, true) => "f32",
            (ScalarKind::Sint, false) => "int",
            (ScalarKind::Uint, false) => "uint",
            (ScalarKind::Float, false) => "float",
            _ => "bool",
        };
        match ty.inner {
            TypeInner::Scalar(s) => scalar(s).to_owned(),
            TypeInner::Vector { size, scalar: s } => match (wgsl, s.kind) {
                (true, ScalarKind::Float) => format!("vec{}f", size as u8),
                (true, _) => format!("vec{}<{}>", size as u8, scalar(s)),
                (false, ScalarKind::Float) => format!("vec{}", size as u8),
                (false, ScalarKind::Sint) => format!("ivec{}", size as u8),
                (false, ScalarKind::Uint) => format!("uvec{}", size as u8),
                (false, _) => format!("bvec{}", size as u8),
            },
            TypeInner::Matrix { columns, rows, .. } => {
                format!("mat{}x{}", columns as u8, rows as u8)
            }
            TypeInner::Array { .. } => "an array".to_owned(),
            _ => ty.name.clone().unwrap_or_else(|| "another type".to_owned()),
        }
    }

    // ---- parameters

    /// The parameters: constants that may be overridden, uniform variables, and the global variables of these names.
    fn find_parameters(
        &self,
        names: &[String],
        commented: &Commented,
    ) -> Result<Vec<Parameter>, ShaderError> {
        let mut found = Vec::new();
        for (handle, o) in self.module.overrides.iter() {
            let span = self.module.overrides.get_span(handle);
            let default = match o.init.map(|init| &self.module.global_expressions[init]) {
                None => None,
                Some(Expression::Literal(literal)) => literal_number(*literal).map(|x| [x; 3]),
                // It is computed from others.
                Some(_) => continue,
            };
            let name = o.name.clone().unwrap_or_default();
            let byte = span.to_range().map(|r| r.start);
            let origin = Origin::Override(handle);
            found.push(self.parameter(name, o.ty, origin, default, byte, commented)?);
        }
        for (handle, variable) in self.module.global_variables.iter() {
            let name = variable.name.clone().unwrap_or_default();
            let span = self.module.global_variables.get_span(handle);
            let byte = span.to_range().map(|r| r.start);
            let inner = &self.module.types[variable.ty].inner;
            match (variable.space, inner) {
                (AddressSpace::Uniform, TypeInner::Struct { members, .. }) => {
                    let mut first = 0;
                    for member in members {
                        let name = member.name.clone().unwrap_or_default();
                        let byte = declaration_of(&commented.code, &name);
                        let origin = Origin::Member(handle, first);
                        let p = self.parameter(name, member.ty, origin, None, byte, commented)?;
                        first += p.components();
                        found.push(p);
                    }
                }
                (AddressSpace::Uniform, _) => {
                    let origin = Origin::Global(handle);
                    found.push(self.parameter(name, variable.ty, origin, None, byte, commented)?);
                }
                (AddressSpace::Private, _) if names.contains(&name) => {
                    let default = match variable.init {
                        Some(init) => self.constant_numbers(init),
                        None => None,
                    };
                    let origin = Origin::Global(handle);
                    let p = self.parameter(name, variable.ty, origin, default, byte, commented)?;
                    found.push(p);
                }
                _ => {}
            }
        }
        Ok(found)
    }

    fn parameter(
        &self,
        name: String,
        ty: Handle<Type>,
        origin: Origin,
        default: Option<[f64; 3]>,
        byte: Option<usize>,
        commented: &Commented,
    ) -> Result<Parameter, ShaderError> {
        let at = byte.unwrap_or(0);
        let kind = match self.module.types[ty].inner {
            TypeInner::Scalar(scalar) => match scalar.kind {
                ScalarKind::Float => ParameterKind::Number,
                ScalarKind::Bool => ParameterKind::Switch,
                _ => ParameterKind::Integer,
            },
            TypeInner::Vector {
                size: VectorSize::Tri,
                scalar: Scalar::F32,
            } => ParameterKind::Colour,
            _ => {
                return Err(self.source.error_at(
                    at,
                    format!(
                        "parameter `{name}` is {}, expected a number, a bool or three numbers (a colour)",
                        self.type_name(ty)
                    ),
                ));
            }
        };
        let line = self.source.code[..at.min(self.source.code.len())]
            .matches('\n')
            .count();
        let comment = commented.comments.iter().find(|(l, _)| *l == line);
        let note = match comment {
            Some((_, comment)) if byte.is_some() => Note::parse(comment)
                .map_err(|m| self.source.error_at(at, format!("parameter `{name}`: {m}")))?,
            _ => Note::default(),
        };
        let (low, high) = note.range.unwrap_or(match kind {
            ParameterKind::Switch => (0.0, 1.0),
            _ => (-UNBOUNDED, UNBOUNDED),
        });
        let default = note
            .default
            .or(default)
            .unwrap_or([0.0f64.clamp(low, high); 3]);
        if default[..].iter().any(|x| !(low..=high).contains(x)) {
            let [x, ..] = default;
            return Err(self.source.error_at(
                at,
                format!(
                    "parameter `{name}` is {x} when not given, outside its range {low}..{high}"
                ),
            ));
        }
        Ok(Parameter {
            name,
            kind,
            default,
            low,
            high,
            meaning: note.meaning,
            origin,
        })
    }

    /// The numbers of a constant expression, three times if it is one.
    fn constant_numbers(&self, handle: Handle<Expression>) -> Option<[f64; 3]> {
        match &self.module.global_expressions[handle] {
            Expression::Literal(literal) => literal_number(*literal).map(|x| [x; 3]),
            Expression::Splat { value, .. } => self.constant_numbers(*value),
            Expression::ZeroValue(_) => Some([0.0; 3]),
            Expression::Compose { components, .. } => match components.as_slice() {
                [r, g, b] => Some([
                    self.constant_numbers(*r)?[0],
                    self.constant_numbers(*g)?[0],
                    self.constant_numbers(*b)?[0],
                ]),
                _ => None,
            },
            _ => None,
        }
    }
}

fn literal_number(literal: Literal) -> Option<f64> {
    Some(match literal {
        Literal::F32(x) => f64::from(x),
        Literal::AbstractFloat(x) => x,
        Literal::I32(x) => f64::from(x),
        Literal::U32(x) => f64::from(x),
        Literal::AbstractInt(x) => x as f64,
        Literal::Bool(x) => f64::from(u8::from(x)),
        _ => return None,
    })
}

/// Where a structure's member is declared: the first time that its name is followed by a colon, or by a semicolon.
fn declaration_of(code: &str, name: &str) -> Option<usize> {
    let mut places = identifiers(code).filter(|(_, word)| *word == name);
    places
        .find(|(at, word)| {
            let after = code[at + word.len()..].trim_start();
            after.starts_with(':') || after.starts_with(';')
        })
        .map(|(at, _)| at)
}
