//! The words around exported code.

use super::effect::option_in_effect;
use super::{Export, Style};
use crate::record::FunctionKind;
use crate::{Brdf, Kind, ModelSpec, Value};
use gonio_num::expr::Language;

/// Columns that a comment takes at most.
pub(super) const COLUMNS: usize = 100;

/// The comment that the text begins with.
pub(super) fn header(export: &Export<'_>, style: &Style<'_>, constants: &str) -> String {
    let Export {
        spec,
        model,
        editable,
    } = export;
    let info = model.info();
    let mut lines = wrapped(
        &format!("{}: {}", info.name, info.summary),
        COLUMNS - 3,
        "  ",
    );
    lines.push(String::new());
    lines.push("A bidirectional reflectance distribution function (BRDF) in".into());
    lines.push(format!("{}, written by", describe(style.language)));
    lines.push(format!("  {}", style.command));
    lines.push(format!("with Gonio {}.", env!("CARGO_PKG_VERSION")));
    lines.push(String::new());
    lines.extend(wrapped(
        &format!("Source: {}", info.paper),
        COLUMNS - 3,
        "  ",
    ));
    lines.push(String::new());
    lines.push("Conventions".into());
    let conventions = [
        "wi points to the light and wo to the viewer. Both leave the surface, have unit length, and are given in the local frame: \
         x and y along the surface, z along its normal.",
        match Brdf::<f32, 3>::transmits(model) {
            true => {
                "Directions with z < 0 lie inside the body. Radiance is what is scattered: it grows with the square of the index."
            }
            false => "Where z <= 0 for either direction the function is 0.",
        },
        "Values are in 1/sr and linear RGB, without the cosine: reflected radiance is f * light * abs(wi.z).",
    ];
    for text in conventions {
        lines.extend(wrapped(&format!("  {text}"), COLUMNS - 3, "  "));
    }
    let fixed = fixed(spec);
    if !fixed.is_empty() || !editable.left_out.is_empty() {
        lines.push(String::new());
        lines.push("Settled when this was written; to change it, export again".into());
    }
    for words in [&fixed, &editable.left_out] {
        if !words.is_empty() {
            let text = format!("  {}", words.join(", "));
            lines.extend(wrapped(&text, COLUMNS - 3, "  "));
        }
    }
    if !constants.is_empty() && editable.switched_off {
        lines.push(String::new());
        lines.push("A parameter that is 0 and was not given is left out: give it, as in name=0, to have it below.".into());
    }
    lines.push(String::new());
    lines.push("SPDX-License-Identifier: MIT OR Apache-2.0".into());
    let mut text = String::new();
    for line in lines {
        text += format!("// {line}").trim_end();
        text.push('\n');
    }
    text.push('\n');
    text
}

/// The choices of a description and of its parts that have an effect.
fn fixed(spec: &ModelSpec) -> Vec<String> {
    let Ok(info) = spec.info() else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for p in info.parameters {
        match (p.kind, spec.value(p.name)) {
            (Kind::Choice { .. }, _) => {
                all.extend(option_in_effect(spec, p).map(|word| format!("{}={word}", p.name)));
            }
            (Kind::Models, Some(Value::Models(models))) => {
                for part in &models {
                    let inner = fixed(part);
                    let inner = match inner.is_empty() {
                        true => String::new(),
                        false => format!(" ({})", inner.join(", ")),
                    };
                    all.push(format!("{}{inner}", part.name));
                }
            }
            _ => {}
        }
    }
    all
}

fn describe(language: Language) -> &'static str {
    match language {
        Language::Wgsl => "WGSL",
        Language::Glsl => "GLSL (3.30, ES 3.00, or later)",
        Language::Hlsl => "HLSL",
        Language::Msl => "Metal Shading Language",
        Language::Osl => "Open Shading Language",
    }
}

/// What the language needs in front of everything.
pub(super) fn preamble(language: Language) -> &'static str {
    match language {
        Language::Msl => "#include <metal_stdlib>\nusing namespace metal;\n\n",
        _ => "",
    }
}

/// A heading.
pub(super) fn section(title: &str) -> String {
    let line = format!("// ---- {title} ");
    format!("{line}{}\n\n", "-".repeat(COLUMNS - line.chars().count()))
}

/// The comment on a function.
pub(super) fn about(kind: FunctionKind, name: &str, transmits: bool) -> Vec<String> {
    let text = match kind {
        FunctionKind::Eval if transmits => {
            "f(wi, wo) in 1/sr, reflection and transmission. Discrete (mirror) parts are not seen here."
        }
        FunctionKind::Eval => "f(wi, wo) in 1/sr. Discrete (mirror) parts are not seen here.",
        FunctionKind::Pdf => &format!(
            "The density per solid angle, in 1/sr, with which {name}_sample draws wi for this wo."
        ),
        FunctionKind::Sample => {
            "Draws wi for this wo from xi, three random numbers in [0, 1): weight = f * abs(wi.z) / pdf. Where pdf is 0 nothing was \
             drawn. Where delta is 1 the direction is discrete, as a mirror's, and pdf its probability."
        }
    };
    wrapped(text, COLUMNS - 3, "")
}

/// `text` in lines of at most this many columns, broken at spaces; the second and later ones begin with `indent`.
pub(super) fn wrapped(text: &str, columns: usize, indent: &str) -> Vec<String> {
    let start = text.len() - text.trim_start().len();
    let mut lines = Vec::new();
    let mut line = text[..start].to_owned();
    let mut empty = true;
    for word in text.split_whitespace() {
        let length = line.chars().count() + 1 + word.chars().count();
        if !empty && length > columns {
            lines.push(std::mem::replace(&mut line, indent.into()));
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line += word;
        empty = false;
    }
    lines.push(line);
    lines
}
