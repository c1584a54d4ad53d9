//! Files of Disney's BRDF Explorer: a header with parameters, and a function in GLSL.
//!
//! ```text
//! analytic
//! ::begin parameters
//! float NAME MIN MAX DEFAULT
//! color NAME R G B
//! bool NAME 0|1
//! ::end parameters
//! ::begin shader
//! vec3 BRDF( vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y ) { … }
//! ::end shader
//! ```
//!
//! Lines beginning with `#` are comments, in the header and, as BRDF Explorer reads them, in the shader.

use crate::ShaderError;
use crate::parameter::{ParameterKind, number};
use crate::source::Source;

/// A parameter of the header.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Declared {
    pub name: String,
    pub kind: ParameterKind,
    pub default: [f64; 3],
    pub range: (f64, f64),
}

/// What a file has.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// GLSL in which each line of the shader is where it is in the file.
    pub code: String,
    pub parameters: Vec<Declared>,
    /// What was left out.
    pub warnings: Vec<String>,
}

/// Reads a file. Errors stand at lines of `source`.
pub(crate) fn read(source: &Source) -> Result<Header, ShaderError> {
    let text = source.text.as_str();
    let mut parameters: Vec<Declared> = Vec::new();
    let mut warnings = Vec::new();
    let mut lines: Vec<&str> = Vec::new();
    let mut section: Option<&str> = None;
    let mut shader_at = None;
    let mut byte = 0;
    for (k, raw) in text.split('\n').enumerate() {
        let start = byte;
        byte += raw.len() + 1;
        let line = raw.trim();
        let mut kept = "";
        let fail = |message: String| {
            let column = raw.len() - raw.trim_start().len();
            Err(source.error_at(start + column, message))
        };
        let mut words = line.split_whitespace();
        let first = words.next().unwrap_or("");
        if k == 0 {
            if first != "analytic" {
                return fail(format!(
                    "found `{first}`, expected `analytic`: the first line of a function of BRDF Explorer"
                ));
            }
        } else if line.is_empty() || line.starts_with('#') {
        } else if first == "::begin" {
            let name = words.next().unwrap_or("");
            if let Some(open) = section {
                return fail(format!("section `{name}` begins inside section `{open}`"));
            }
            match name {
                "shader" if shader_at.is_some() => {
                    return fail("found a second section `shader`".into());
                }
                "shader" => shader_at = Some(k),
                "parameters" => {}
                other => warnings.push(format!("section `{other}` is left out")),
            }
            section = Some(name);
        } else if first == "::end" {
            let name = words.next().unwrap_or("");
            if section != Some(name) {
                return fail(match section {
                    Some(open) => format!("found the end of `{name}`, expected `::end {open}`"),
                    None => format!("section `{name}` ends without having begun"),
                });
            }
            section = None;
        } else {
            match section {
                Some("shader") => kept = raw.trim_end_matches('\r'),
                Some("parameters") => match parameter(line) {
                    Ok(p) if parameters.iter().any(|q| q.name == p.name) => {
                        return fail(format!("parameter `{}` is declared twice", p.name));
                    }
                    Ok(p) => parameters.push(p),
                    Err(message) => return fail(message),
                },
                _ => {}
            }
        }
        lines.push(kept);
    }
    if let Some(open) = section {
        return Err(source.error_at(
            text.len(),
            format!("found the end of the file, expected `::end {open}`"),
        ));
    }
    let Some(shader_at) = shader_at else {
        return Err(source.error_at(
            text.len(),
            "found no section `shader`: expected `::begin shader`, GLSL with a function BRDF, `::end shader`",
        ));
    };
    let declarations: String = parameters.iter().map(declaration).collect();
    let code: Vec<&str> = lines
        .iter()
        .enumerate()
        .map(|(k, line)| {
            if k == shader_at {
                declarations.as_str()
            } else if k == 0 {
                "#version 450"
            } else {
                line
            }
        })
        .collect();
    Ok(Header {
        code: code.join("\n"),
        parameters,
        warnings,
    })
}

/// The variable that a parameter is for the shader.
fn declaration(p: &Declared) -> String {
    let ty = match p.kind {
        ParameterKind::Colour => "vec3",
        ParameterKind::Switch => "bool",
        _ => "float",
    };
    format!("{ty} {};", p.name)
}

/// Reads a line of the section `parameters`.
fn parameter(line: &str) -> Result<Declared, String> {
    let mut words = line.split_whitespace();
    let kind = words.next().unwrap_or("");
    let name = words.next().unwrap_or("");
    let is_name = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
        && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if !is_name {
        return Err(format!("found `{name}`, expected a parameter's name"));
    }
    let mut numbers = Vec::new();
    for word in words.take(3) {
        // BRDF Explorer reads as far as there is a number: `1.f` is one.
        let found = number(word.trim_end_matches(['f', 'F', ';', ',']));
        numbers.push(found.ok_or_else(|| format!("found `{word}`, expected a number"))?);
    }
    let (kind, default, range) = match (kind, numbers.as_slice()) {
        ("float", &[low, high, default]) => {
            if low > high {
                return Err(format!(
                    "found the range {low} to {high}, expected the smaller end first"
                ));
            }
            // A default outside its own range is one that the file's author uses.
            let range = (low.min(default), high.max(default));
            (ParameterKind::Number, [default; 3], range)
        }
        ("color", &[r, g, b]) => {
            let high = r.max(g).max(b).max(1.0);
            (
                ParameterKind::Colour,
                [r, g, b],
                (r.min(g).min(b).min(0.0), high),
            )
        }
        ("bool", &[value, ..]) => {
            let value = if value == 0.0 { 0.0 } else { 1.0 };
            (ParameterKind::Switch, [value; 3], (0.0, 1.0))
        }
        ("float" | "color" | "bool", found) => {
            let form = match kind {
                "float" => "float NAME MIN MAX DEFAULT",
                "color" => "color NAME R G B",
                _ => "bool NAME 0|1",
            };
            return Err(format!("found {} numbers, expected `{form}`", found.len()));
        }
        _ => {
            return Err(format!(
                "found `{kind}`, expected `float`, `color` or `bool`"
            ));
        }
    };
    Ok(Declared {
        name: name.to_owned(),
        kind,
        default,
        range,
    })
}
