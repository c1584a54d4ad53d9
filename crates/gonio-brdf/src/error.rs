//! [`BrdfError`], what can be wrong with a model's description or a table's file.

use std::path::PathBuf;

/// Why a reflection function could not be made.
#[derive(Debug, thiserror::Error)]
pub enum BrdfError {
    /// No model has this name.
    #[error("unknown reflection function `{name}`")]
    UnknownModel {
        /// The name as found.
        name: String,
        /// The nearest known name, if one is near.
        suggestion: Option<String>,
    },
    /// The model has no preset of this name.
    #[error("`{model}` has no preset `{name}`")]
    UnknownPreset {
        /// The model, or the alias.
        model: String,
        /// The preset's name as found.
        name: String,
        /// The nearest known preset of the model, if one is near.
        suggestion: Option<String>,
        /// Other models that have a preset of this name.
        elsewhere: Vec<&'static str>,
    },
    /// The model has no parameter of this name.
    #[error("`{model}` has no parameter `{name}`")]
    UnknownParameter {
        /// The model.
        model: String,
        /// The parameter's name as found.
        name: String,
        /// The nearest known parameter, if one is near.
        suggestion: Option<String>,
    },
    /// A parameter's value is not one it may have.
    #[error("parameter `{parameter}` of `{model}` is {found}; expected {expected}")]
    Parameter {
        /// The model.
        model: String,
        /// The parameter.
        parameter: String,
        /// What was found.
        found: String,
        /// What is allowed.
        expected: String,
    },
    /// The description is not of the form `name:key=value,…`.
    #[error("cannot read `{text}` at column {column}: expected {expected}")]
    Syntax {
        /// The whole description.
        text: String,
        /// Where, counting characters from 1.
        column: usize,
        /// What should stand there.
        expected: String,
    },
    /// The model exists but cannot do what was asked of it.
    #[error("{what}")]
    Unsupported {
        /// What, and why.
        what: String,
    },
    /// Shader code can't be made.
    #[error("cannot write shader code: {0}")]
    Record(#[from] gonio_num::expr::RecordError),
    /// A table's file is not what it should be.
    #[error("{}: {place}: found {found}, expected {expected}", path.display())]
    Format {
        /// The file.
        path: PathBuf,
        /// Where in the file.
        place: String,
        /// What was found.
        found: String,
        /// What was expected.
        expected: String,
    },
    /// A check got no answer.
    #[error("no verdict: {0}")]
    NoAnswer(#[from] gonio_verify::SubjectFailed),
    /// A shader is not what it should be.
    #[error(transparent)]
    Shader(#[from] gonio_shader::ShaderError),
    /// The user stopped it.
    #[error("stopped")]
    Interrupted,
    /// A file could not be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
}

impl BrdfError {
    /// One line that helps to correct the mistake, where there is one.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::UnknownModel { suggestion, .. } => Some(match suggestion {
                Some(s) => format!("did you mean `{s}`?"),
                None => format!("known are: {}", crate::registry::names().join(", ")),
            }),
            Self::UnknownPreset {
                model,
                name,
                suggestion,
                elsewhere,
            } => Some(match suggestion {
                _ if !elsewhere.is_empty() => {
                    let word = name.rsplit('/').next().unwrap_or(name).trim();
                    let all: Vec<_> = elsewhere.iter().map(|m| format!("{m}@{word}")).collect();
                    format!("there are {}", all.join(", "))
                }
                Some(s) => format!("did you mean `{model}@{s}`?"),
                None if crate::preset::sets_of(model).is_empty() => {
                    format!("`{model}` has no presets; `gonio brdf list --presets` names the models that have")
                }
                None => format!("`gonio brdf list --presets {model}` lists them"),
            }),
            Self::UnknownParameter {
                model, suggestion, ..
            } => Some(match suggestion {
                Some(s) => format!("did you mean `{s}`?"),
                None if *model == crate::model::shader::INFO.name => {
                    "`gonio brdf show FILE` lists the parameters that a shader declares".into()
                }
                None => match crate::registry::find(model) {
                    Ok(info) if !info.parameters.is_empty() => {
                        let names: Vec<_> = info.parameters.iter().map(|p| p.name).collect();
                        format!("`{model}` has: {}", names.join(", "))
                    }
                    _ => format!("`{model}` has no parameters"),
                },
            }),
            // The words of a choice are in the message already.
            Self::Parameter {
                model,
                parameter,
                found,
                ..
            } => {
                let info = crate::registry::find(model).ok()?;
                let parameter = info.parameters.iter().find(|p| p.name == parameter)?;
                let crate::Kind::Choice { options, .. } = parameter.kind else {
                    return None;
                };
                let near =
                    crate::registry::suggest(found.trim_matches('`'), options.iter().copied())?;
                Some(format!("did you mean `{near}`?"))
            }
            Self::Shader(error) => error.help.clone(),
            Self::Syntax { .. } => {
                Some("write a model as name:key=value,key=value; a colour as r/g/b, #rrggbb or one number".into())
            }
            _ => None,
        }
    }
}
