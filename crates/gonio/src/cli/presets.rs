//! `gonio brdf list --presets`.

use super::brdf::{COLUMNS, wrapped};
use super::failure::Failure;
use super::terminal::{print, print_json};
use gonio_brdf::preset::{self, PresetSet};
use gonio_brdf::{ModelInfo, ModelSpec, registry};
use serde_json::json;

/// The sets of a model, or of every one, in JSON.
pub(super) fn in_json(sets: &[PresetSet]) -> serde_json::Value {
    let set = |s: &PresetSet| json!({"model": s.model, "set": s.name, "summary": s.summary, "presets": s.presets});
    sets.iter().map(set).collect()
}

/// The sets of a model and of its aliases. The aliases have the model's metals too: those are named once.
pub(super) fn sets_of(info: &ModelInfo) -> Vec<PresetSet> {
    let mut sets = preset::sets_of(info.name);
    for alias in info.aliases {
        for set in preset::sets_of(alias.name) {
            if sets.iter().all(|known| known.presets != set.presets) {
                sets.push(set);
            }
        }
    }
    sets
}

/// How many presets there are, by name of model or alias, and how to list them: lines without their ends.
pub(super) fn counted(info: &ModelInfo) -> Vec<String> {
    let mut lines: Vec<(&str, usize, &str)> = Vec::new();
    for set in sets_of(info) {
        let first = set.presets.first().copied().unwrap_or_default();
        match lines.iter_mut().find(|(model, ..)| *model == set.model) {
            Some((_, count, _)) => *count += set.presets.len(),
            None => lines.push((set.model, set.presets.len(), first)),
        }
    }
    let line = |(model, count, first): (&str, usize, &str)| {
        format!("{count} presets, as {model}@{first}: gonio brdf list --presets {model}")
    };
    lines.into_iter().map(line).collect()
}

/// What `MODEL@NAME…` stands for, and where it is from.
pub(super) fn explained(text: &str, spec: &ModelSpec) -> String {
    let (model, rest) = text.split_once('@').unwrap_or((text, ""));
    let preset = rest.split([':', '(']).next().unwrap_or(rest).trim();
    let (wanted, word) = match preset.split_once('/') {
        Some((set, word)) => (Some(set), word),
        None => (None, preset),
    };
    let set = preset::sets_of(model.trim())
        .into_iter()
        .find(|set| wanted.is_none_or(|name| name == set.name) && set.presets.contains(&word));
    let from = set.map_or(String::new(), |s| format!(" ({}: {})", s.name, s.summary));
    format!("{text}{from} is {spec}")
}

/// `gonio brdf list --presets [MODEL]`; no model: the sets of every one.
pub(super) fn list(model: &str, as_json: bool) -> Result<(), Failure> {
    let all = model.is_empty();
    let sets = if all {
        registry::models().iter().flat_map(sets_of).collect()
    } else {
        registry::find(model)?;
        preset::sets_of(model)
    };
    if as_json {
        return print_json(&in_json(&sets));
    }
    if sets.is_empty() {
        return Err(Failure::usage(format!("`{model}` has no presets"))
            .with_help("'gonio brdf list --presets' names the models that have"));
    }
    let mut text = String::new();
    if all {
        let name = |s: &PresetSet| format!("{}@{}", s.model, s.name);
        let width = sets.iter().map(|s| name(s).len()).max().unwrap_or(0);
        for set in &sets {
            text += &format!(
                "{:width$}  {:3}  {}\n",
                name(set),
                set.presets.len(),
                set.summary
            );
        }
        text += "\ngonio brdf list --presets MODEL names them. MODEL@NAME is one of them, the first\nset's where several have it; MODEL@SET/NAME says which.\n";
        return print(&text);
    }
    for (k, set) in sets.iter().enumerate() {
        let gap = if k == 0 { "" } else { "\n" };
        let title = format!("{}@{}/…: {}", set.model, set.name, set.summary);
        text += &format!("{gap}{}\n", wrapped(&title, 2));
        text += &columns(&set.presets);
    }
    print(&text)
}

/// Words in columns, sorted downwards, two spaces before each.
fn columns(words: &[&str]) -> String {
    let width = words.iter().map(|w| w.len()).max().unwrap_or(0) + 2;
    let across = (COLUMNS / width).max(1);
    let down = words.len().div_ceil(across);
    let mut text = String::new();
    for row in 0..down {
        let line: String = words
            .iter()
            .skip(row)
            .step_by(down)
            .map(|w| format!("  {w:0$}", width - 2))
            .collect();
        text += &format!("{}\n", line.trim_end());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_stand_in_columns() {
        let words = ["a", "b", "c", "d", "e", &"f".repeat(24)];
        let text = columns(&words);
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 2);
        assert!(lines[0].starts_with("  a ") && lines[1].starts_with("  b "));
        assert!(lines.iter().all(|l| l.len() <= COLUMNS));
        assert_eq!(columns(&[]), "");
    }
}
