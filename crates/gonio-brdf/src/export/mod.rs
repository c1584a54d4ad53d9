//! Models as complete, commented shader code: what `gonio brdf export` prints.
//!
//! The formulas are recorded from the source that is evaluated here, as in [`crate::record`], with the model's parameters as named
//! constants that a reader may change, where that is possible without making the code much longer.

mod effect;
mod header;
mod parameters;

use crate::record::{FunctionKind, recorded};
use crate::{Brdf, BrdfError, Model, ModelSpec};
use gonio_num::expr::{Language, source};
use parameters::Editable;

/// A model that can be written as shader code, and which of its parameters stand in it by name.
#[derive(Debug)]
pub struct Export<'a> {
    spec: &'a ModelSpec,
    model: Model<f32, 3>,
    editable: Editable,
}

/// How a model is written.
#[derive(Debug, Clone, Copy)]
pub struct Style<'a> {
    /// The language.
    pub language: Language,
    /// Which functions, in the order in which they are written; each at most once.
    pub functions: &'a [FunctionKind],
    /// What all names begin with, so that several models can live in one shader: `ggx` gives `ggx_eval`.
    pub name: &'a str,
    /// The command that makes this text again, for its first comment.
    pub command: &'a str,
}

impl<'a> Export<'a> {
    /// The model that `spec` describes.
    ///
    /// # Errors
    /// If it can't be built or recorded; see [`obstacle`].
    pub fn new(spec: &'a ModelSpec) -> Result<Self, BrdfError> {
        let model = spec.build()?;
        Ok(Self {
            spec,
            editable: Editable::of(spec, &model)?,
            model,
        })
    }

    /// The names of the parameters that a reader of the code may change there, each behind [`Style::name`] and `_`. A function that one
    /// has no effect on doesn't have it.
    pub fn parameters(&self) -> Vec<&str> {
        self.editable.names()
    }

    /// The text: a comment on what it is, the parameters, tables and helpers, and the functions.
    ///
    /// # Errors
    /// If the style's name begins none in the language ([`Language::refuses`]).
    pub fn text(&self, style: &Style<'_>) -> Result<String, BrdfError> {
        let Style { language, name, .. } = *style;
        if let Some(why) = language.refuses(name) {
            let title = language.name().to_uppercase();
            return Err(BrdfError::Unsupported {
                what: format!("`{name}` can't begin names in {title}: {why}"),
            });
        }
        let mut functions = Vec::new();
        for kind in style.functions {
            let name = format!("{name}_{}", kind.name());
            functions.push(recorded(&self.model, *kind, &name, &self.editable)?);
        }
        let all: Vec<_> = functions.iter().collect();
        let comments = |name: &str| self.editable.comment(name);
        let source = source(&all, language, &format!("{name}_"), &comments)?;

        let mut text = header::header(self, style, &source.constants);
        text += header::preamble(language);
        for (title, part) in [
            ("Parameters", &source.constants),
            ("Declarations", &source.declarations),
        ] {
            if !part.is_empty() {
                text += &header::section(title);
                text += part.trim_end();
                text += "\n\n";
            }
        }
        text += &header::section("Functions");
        for (kind, function) in style.functions.iter().zip(&source.functions) {
            for line in header::about(*kind, name, Brdf::<f32, 3>::transmits(&self.model)) {
                text += &format!("// {line}\n");
            }
            text += function;
            text.push('\n');
        }
        text.truncate(text.trim_end().len());
        Ok(text + "\n")
    }
}

/// Why a model can't be written as shader code, and what to do instead; nothing if it can.
pub fn obstacle(spec: &ModelSpec) -> Option<(String, String)> {
    if spec.name == "table" {
        return Some((
            "a measured table can't be written as shader code: it is searched in memory, not computed".into(),
            "upload the table as a texture, or export a model that resembles it ('gonio brdf list --presets' names fits to \
             measured materials)"
                .into(),
        ));
    }
    if spec.name == "shader" {
        return Some((
            "a shader that was read from a file can't be exported: it is shader code already"
                .into(),
            "use the file itself".into(),
        ));
    }
    if spec.word("interreflection") == "random-walk" {
        return Some((
            format!(
                "`{}` with interreflection=random-walk can't be written as shader code: its lobe is traced, not computed",
                spec.name
            ),
            "export it with interreflection=kulla-conty, which resembles the walk in closed form"
                .into(),
        ));
    }
    let parts = spec.values.values().filter_map(|value| match value {
        crate::Value::Models(models) => Some(models.iter()),
        _ => None,
    });
    parts.flatten().find_map(obstacle)
}
