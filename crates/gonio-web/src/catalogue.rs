//! The registry, for the page's lists and sliders.

use crate::answer::Answer;
use crate::describe::parameter;
use gonio_brdf::measured::format::FORMATS;
use gonio_brdf::{ModelInfo, ModelSpec, preset, registry, showcase};
use gonio_num::expr::Language;
use serde_json::{Value, json};

/// Every model, format and language.
pub(crate) fn catalogue() -> Answer {
    let examples = showcase();
    let models: Vec<Value> = (registry::models().iter())
        .map(|info| model(info, &examples))
        .collect();
    let measured: Vec<Value> = (FORMATS.iter())
        .map(|f| json!({ "extension": f.extension, "name": f.name, "summary": f.summary }))
        .collect();
    let languages: Vec<Value> = (Language::ALL.iter())
        .map(|l| {
            json!({
                "name": l.name(),
                "label": l.name().to_uppercase(),
                "extension": l.extensions()[0],
            })
        })
        .collect();
    Answer::new(
        json!({
            "version": env!("CARGO_PKG_VERSION"),
            "models": models,
            "measured": measured,
            "languages": languages,
        }),
        Vec::new(),
    )
}

fn model(info: &ModelInfo, examples: &[ModelSpec]) -> Value {
    let parameters: Vec<Value> = (info.parameters.iter())
        .map(|p| parameter(p, None))
        .collect();
    let aliases: Vec<Value> = (info.aliases.iter())
        .map(|a| json!({ "name": a.name, "sets": a.preset }))
        .collect();
    // A preset's description, as `MODEL@SET/NAME` where the bare name is another set's.
    let names = std::iter::once(info.name).chain(info.aliases.iter().map(|a| a.name));
    let mut presets: Vec<String> = Vec::new();
    for set in names.flat_map(preset::sets_of) {
        for word in set.presets {
            let bare = format!("{}@{word}", set.model);
            if presets.contains(&bare) {
                presets.push(format!("{}@{}/{word}", set.model, set.name));
            } else {
                presets.push(bare);
            }
        }
    }
    let example = examples.iter().find(|spec| spec.name == info.name);
    json!({
        "name": info.name,
        "summary": info.summary,
        "paper": info.paper,
        "parameters": parameters,
        "positional": info.positional,
        "aliases": aliases,
        "recordable": info.recordable,
        "presets": presets,
        "example": example.map(ToString::to_string),
    })
}
