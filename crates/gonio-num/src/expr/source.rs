//! Recorded functions as the text of a module.

use super::language::{Constants, Dialect, Type};
use super::print::{self, Job};
use super::{Function, Language, Parameter, RecordError, names};
use std::collections::{BTreeMap, BTreeSet};

/// The parts of a module, each of them complete lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The fixed parameters that a function needs, in order.
    pub constants: String,
    /// Tables, helper functions and structures.
    pub declarations: String,
    /// The functions, as they were given.
    pub functions: Vec<String>,
}

impl Source {
    /// The parts one after the other.
    pub fn text(&self) -> String {
        let mut text = self.constants.clone();
        if !text.is_empty() {
            text.push('\n');
        }
        text += &self.declarations;
        text + &self.functions.join("\n")
    }
}

/// The functions in a language. What more than one of them needs is declared once.
///
/// - `prefix`: stands in front of the names of tables, helpers and fixed parameters, so that several modules can live in one file. The
///   names of functions and structures are taken as they are
/// - `comments`: the lines of the comment on the fixed parameter of a name
///
/// # Errors
/// If two functions, or two different declarations, have the same name; if a name is a word of the language; if a function returns
/// an array where that can't be written.
pub fn source(
    functions: &[&Function],
    language: Language,
    prefix: &str,
    comments: &dyn Fn(&str) -> Vec<String>,
) -> Result<Source, RecordError> {
    let d = language.dialect();
    let taken = check(functions, language, prefix)?;
    let mut declarations = BTreeMap::new();
    let mut texts = Vec::new();
    let mut used = BTreeSet::new();
    for f in functions {
        let mut locals = taken.clone();
        locals.extend(f.parameters.iter().map(|p| p.name.clone()));
        let printed = print::print(Job {
            dialect: d,
            prefix,
            graph: &f.graph,
            name: &f.name,
            parameters: &f.parameters,
            returned: &f.returned,
            taken: locals,
        });
        for (name, text) in printed.declarations {
            let before = declarations.insert(name.clone(), text.clone());
            if before.is_some_and(|b| b != text) {
                return Err(RecordError::Duplicate { name });
            }
        }
        used.extend(printed.fixed.iter().map(|p| f.parameters[*p].name.clone()));
        texts.push(printed.function);
    }

    let mut constants = String::new();
    let mut written = BTreeSet::new();
    for p in functions.iter().flat_map(|f| &f.parameters) {
        if used.contains(&p.name) && p.fixed.is_some() && written.insert(&p.name) {
            for line in comments(&p.name) {
                constants += &format!("// {line}\n");
            }
            constants += &format!("{}\n", constant(d, prefix, p));
        }
    }
    let mut all = String::new();
    for declaration in declarations.values() {
        all += declaration;
        all.push('\n');
    }
    Ok(Source {
        constants,
        declarations: all,
        functions: texts,
    })
}

/// The line of a fixed parameter.
fn constant(d: &Dialect, prefix: &str, p: &Parameter) -> String {
    let [x, y, z] = p.fixed.unwrap_or_default().map(|x| d.number(x));
    let value = match p.kind {
        Type::Number | Type::Truth => x,
        kind => d.vector(kind, [&x, &y, &z]),
    };
    let (name, kind) = (format!("{prefix}{}", p.name), d.type_name(p.kind));
    match d.constants {
        Constants::Const => format!("const {name}: {kind} = {value};"),
        Constants::Keyword(word) => format!("{word} {kind} {name} = {value};"),
        Constants::Macro => format!("#define {name} {value}"),
    }
}

/// WGSL of several functions together; what more than one of them needs is declared once.
///
/// # Errors
/// As [`source`].
pub fn module(functions: &[&Function]) -> Result<String, RecordError> {
    let source = source(functions, Language::Wgsl, "", &|_| Vec::new())?;
    Ok(source.text())
}

/// The names that the functions take, which are fit for the language and stand for one thing each.
pub(super) fn check(
    functions: &[&Function],
    language: Language,
    prefix: &str,
) -> Result<BTreeSet<String>, RecordError> {
    let mut taken = BTreeSet::new();
    let mut take = |name: &str| match taken.insert(name.to_owned()) {
        true => Ok(()),
        false => Err(RecordError::Duplicate { name: name.into() }),
    };
    let mut fixed: BTreeMap<&str, &Parameter> = BTreeMap::new();
    for f in functions {
        names::check(language, &f.name)?;
        take(&f.name)?;
        for p in f.parameters.iter().filter(|p| p.fixed.is_some()) {
            if fixed.insert(&p.name, p).is_none_or(|before| before == p) {
                continue;
            }
            let name = p.name.clone();
            return Err(RecordError::Duplicate { name });
        }
        if f.returned.is_array && !matches!(language, Language::Wgsl | Language::Glsl) {
            let name = f.name.clone();
            return Err(RecordError::ArrayReturned { name, language });
        }
    }
    for name in fixed.keys() {
        take(&format!("{prefix}{name}"))?;
    }
    let structures: BTreeSet<&str> = functions
        .iter()
        .filter_map(|f| Some(f.returned.structure.as_ref()?.name.as_str()))
        .collect();
    let tables: BTreeSet<&str> = functions
        .iter()
        .flat_map(|f| f.graph.table_names())
        .collect();
    for name in structures {
        names::check(language, name)?;
        take(name)?;
    }
    for name in tables {
        take(&format!("{prefix}{name}"))?;
        take(&format!("{prefix}{name}_at"))?;
    }
    for f in functions {
        for p in f.parameters.iter().filter(|p| p.fixed.is_none()) {
            names::check(language, &p.name)?;
            if taken.contains(&p.name) {
                let name = p.name.clone();
                return Err(RecordError::Duplicate { name });
            }
        }
    }
    Ok(taken)
}
