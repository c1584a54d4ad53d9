//! What a function is: its parameters with their values, what it declares, and how it is written elsewhere.

use crate::answer::Answer;
use crate::complaint::Complaint;
use crate::subject::Subject;
use gonio_brdf::export::{Export, Style, obstacle};
use gonio_brdf::measured::{self, LoadOptions, Measured, Select};
use gonio_brdf::record::FunctionKind;
use gonio_brdf::{Brdf, Kind, ModelSpec, ParameterInfo, Value};
use gonio_num::expr::Language;
use serde::Deserialize;
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Of {
    function: String,
}

pub(crate) fn describe(of: Of) -> Result<Answer, Complaint> {
    description(&of.function)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Set {
    function: String,
    values: BTreeMap<String, Option<String>>,
}

/// The function with parameters set from text, or taken away.
pub(crate) fn set(of: Set) -> Result<Answer, Complaint> {
    let mut spec = ModelSpec::open(&of.function)?;
    for (key, text) in &of.values {
        match text {
            Some(text) => spec.set_text(key, text)?,
            None => {
                spec.values.remove(key);
            }
        }
    }
    description(&spec.to_string())
}

/// A parameter as the page shows it, with the value that `spec` has for it.
pub(crate) fn parameter(p: &ParameterInfo, spec: Option<&ModelSpec>) -> serde_json::Value {
    let value = spec.and_then(|s| s.values.get(p.name));
    let number = |v: Option<&Value>| match v {
        Some(Value::Number(x)) => json!(x),
        Some(Value::Colour(c)) => json!(c),
        Some(Value::Models(models)) => {
            json!(models.iter().map(ToString::to_string).collect::<Vec<_>>())
        }
        Some(other) => json!(other.to_string()),
        None => json!(null),
    };
    let default = p.default_value();
    let mut all = json!({
        "name": p.name,
        "meaning": p.meaning,
        "expected": p.expected(),
        "value": number(value.or(default.as_ref())),
        "given": value.is_some(),
    });
    let more = match p.kind {
        Kind::Number {
            unit, low, high, ..
        } => {
            json!({ "kind": "number", "unit": unit, "low": low, "high": high, "default": number(default.as_ref()) })
        }
        Kind::Colour { low, high, .. } => {
            json!({ "kind": "colour", "low": low, "high": high, "default": number(default.as_ref()) })
        }
        Kind::Choice { options, .. } => {
            json!({ "kind": "choice", "options": options, "default": number(default.as_ref()) })
        }
        Kind::Path => json!({ "kind": "path" }),
        Kind::Name => json!({ "kind": "name" }),
        Kind::Models => json!({ "kind": "models" }),
    };
    if let (Some(all), serde_json::Value::Object(more)) = (all.as_object_mut(), more) {
        all.extend(more);
    }
    all
}

fn description(text: &str) -> Result<Answer, Complaint> {
    let subject = Subject::open(text)?;
    let spec = &subject.spec;
    let info = spec.info()?;
    let declares = spec.declares()?;
    let parameters: Vec<_> = (spec.parameters()?.into_iter())
        .map(|p| parameter(p, Some(spec)))
        .collect();
    let written = spec.to_string();
    Ok(Answer::new(
        json!({
            "text": written,
            "model": info.name,
            "summary": info.summary,
            "paper": info.paper,
            "parameters": parameters,
            "declares": {
                "reciprocal": declares.reciprocal,
                "energy_conserving": declares.energy_conserving,
                "isotropic": declares.isotropic,
                "albedo_bound": declares.albedo_bound,
            },
            "transmits": subject.model.transmits(),
            "delta": subject.model.is_delta(),
            "recordable": subject.model.is_recordable(),
            "warnings": subject.model.warnings(),
            "as": {
                "toml": in_toml(&written),
                "command": format!("gonio brdf check {}", quoted(&written)),
                "rust": in_rust(&written),
                "python": in_python(&written),
            },
        }),
        Vec::new(),
    ))
}

/// A material of a scene file.
fn in_toml(text: &str) -> String {
    format!("[[material]]\nname = \"object\"\nmodel = {text:?}\n")
}

/// The library's own call.
fn in_rust(text: &str) -> String {
    format!(
        "use gonio::brdf::{{Brdf, Model, ModelSpec}};\n\nlet model: Model<f64, 3> = ModelSpec::open({text:?})?.build()?;\n"
    )
}

/// What runs the command from Python and reads its answer. The text between quotes is one that JSON, Rust and Python write alike.
fn in_python(text: &str) -> String {
    format!(
        "import json, subprocess\n\nmodel = {text:?}\ncommand = [\"gonio\", \"brdf\", \"eval\", model, \"--wi\", \"45,180\", \"--wo\", \"45,0\", \"--json\"]\nvalue = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)\nprint(value[\"f_per_sr\"])\n"
    )
}

/// As a word of a shell.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || ":=.,/@_+-".contains(c);
    if !text.is_empty() && text.chars().all(plain) {
        return text.into();
    }
    format!("'{}'", text.replace('\'', "'\\''"))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct In {
    function: String,
    language: String,
}

/// The function as shader code.
pub(crate) fn export(of: In) -> Result<Answer, Complaint> {
    let Some(language) = Language::from_name(&of.language) else {
        let all = Language::ALL.map(Language::name).join(", ");
        let message = format!(
            "there is no language `{}`, expected one of {all}",
            of.language
        );
        return Err(Complaint::new(message));
    };
    let spec = ModelSpec::open(&of.function)?;
    if let Some((what, instead)) = obstacle(&spec) {
        return Err(Complaint::new(what).with_help(instead));
    }
    let text = Export::new(&spec)?.text(&Style {
        language,
        functions: &FunctionKind::ALL,
        name: &spec.name.replace('-', "_"),
        command: &format!(
            "gonio brdf export {} --lang {}",
            quoted(&spec.to_string()),
            language.name()
        ),
    })?;
    Ok(Answer::new(json!({ "text": text }), Vec::new()))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct File {
    path: String,
}

/// What a measured file holds.
pub(crate) fn file(of: File) -> Result<Answer, Complaint> {
    let path = Path::new(&of.path);
    let (format, measurement) = measured::read(path)?;
    let options = LoadOptions {
        select: Select::All,
        ..LoadOptions::default()
    };
    let measured = Measured::new(path, measurement, options)?;
    Ok(Answer::new(
        json!({
            "format": format.name,
            "summary": format.summary,
            "metadata": measured.measurement().metadata.entries(),
            "notes": measured.found().notes,
        }),
        Vec::new(),
    ))
}
