//! Files of shaders, each read once, and the parameters that they declare.

use crate::parameter::join;
use crate::{BrdfError, Kind, ModelSpec, ParameterInfo, Value};
use gonio_shader::{Language, Parameter, ParameterKind, Settings, Shader, ShaderError};
use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// A shader that was read, as it then stood in its file.
#[derive(Debug, Clone)]
pub(crate) struct Loaded {
    text: String,
    pub shader: Shader,
    /// What it declares, for the life of the program as that of every other model: once for each version of a file that is read.
    pub parameters: &'static [ParameterInfo],
}

type Cache = HashMap<(String, Option<String>, u64), Loaded>;

/// What has been read, by file, entry and bound on steps.
static CACHE: Mutex<Option<Cache>> = Mutex::new(None);

/// The path of the shader that a model's name is, if it is one: by its extension, or by the content of a file that exists.
pub(crate) fn path(name: &str, folder: &Path) -> Option<String> {
    let file = join(folder, name);
    let path = Path::new(&file);
    let is_shader = match Language::of_extension(path)? {
        Language::Wgsl | Language::Glsl => true,
        // `.brdf` is an extension of measurements, too.
        Language::Brdf => !path.is_file() || begins_with(path, "analytic"),
    };
    is_shader.then_some(file)
}

fn begins_with(path: &Path, word: &str) -> bool {
    use std::io::Read;
    let mut head = Vec::new();
    let read = std::fs::File::open(path).map(|f| f.take(256).read_to_end(&mut head));
    matches!(read, Ok(Ok(_)))
        && String::from_utf8_lossy(&head)
            .trim_start()
            .starts_with(word)
}

/// The file that the description names, and how it is to be read.
fn source(spec: &ModelSpec) -> Option<(String, Settings)> {
    let Some(Value::Path(file)) = spec.values.get("file") else {
        return None;
    };
    let entry = match spec.values.get("entry") {
        Some(Value::Choice(name)) => Some(name.clone()),
        _ => None,
    };
    let steps = spec.number("step_limit").unwrap_or(0.0) as u64;
    Some((file.clone(), Settings { entry, steps }))
}

/// The shader of a description; `None` if that names no file yet.
pub(crate) fn load(spec: &ModelSpec) -> Result<Option<Loaded>, BrdfError> {
    let Some((file, settings)) = source(spec) else {
        return Ok(None);
    };
    let path = Path::new(&file);
    let text = gonio_shader::read_text(path)?;
    let key = (file.clone(), settings.entry.clone(), settings.steps);
    let known = {
        let cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
        let found = cache.as_ref().and_then(|c| c.get(&key));
        found.filter(|loaded| loaded.text == text).cloned()
    };
    if let Some(known) = known {
        return Ok(Some(known));
    }
    let shader = Shader::new(path, None, &text, &settings)?;
    let mut parameters = Vec::new();
    for parameter in shader.parameters() {
        if crate::model::shader::INFO
            .parameters
            .iter()
            .any(|p| p.name == parameter.name)
        {
            return Err(ShaderError {
                path: path.into(),
                place: None,
                message: format!(
                    "parameter `{}` has the name of one that every shader has: file, entry or step_limit",
                    parameter.name
                ),
                help: None,
            }
            .into());
        }
        parameters.push(declared(parameter));
    }
    let loaded = Loaded {
        text,
        shader,
        parameters: Box::leak(parameters.into_boxed_slice()),
    };
    let mut cache = CACHE.lock().unwrap_or_else(PoisonError::into_inner);
    cache
        .get_or_insert_with(HashMap::new)
        .insert(key, loaded.clone());
    Ok(Some(loaded))
}

/// A shader's parameter as one of the registry's.
fn declared(p: &Parameter) -> ParameterInfo {
    let (low, high) = (p.low, p.high);
    let kind = match p.kind {
        ParameterKind::Colour => Kind::Colour {
            low,
            high,
            default: Some(p.default),
        },
        _ => Kind::Number {
            unit: "",
            low,
            high,
            default: Some(p.default[0]),
        },
    };
    let meaning = match (p.meaning.as_str(), p.kind) {
        ("", ParameterKind::Integer) => "a whole number",
        ("", ParameterKind::Switch) => "0 or 1",
        ("", _) => "the shader doesn't say",
        (meaning, _) => meaning,
    };
    ParameterInfo {
        name: p.name.clone().leak(),
        kind,
        meaning: meaning.to_owned().leak(),
    }
}
