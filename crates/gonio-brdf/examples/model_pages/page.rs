//! The book's pages about models, made of the registry, of the comments above the formulas, and of what the models do.

mod lobe;
mod picture;
mod verdicts;
mod words;

use gonio_brdf::{Declares, Kind, ModelInfo, ModelSpec, ParameterInfo, preset, registry, showcase};
use picture::Picture;
use std::path::{Path, PathBuf};

/// Said at the top of each page.
const NOTE: &str = "<!-- Made by `cargo run -p gonio-brdf --example model_pages`: change the model's source instead. -->";

/// The folder of the pages.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../book/src/models")
}

/// Every page and picture: file name and text.
///
/// # Errors
/// A model whose source has no comment above its structure, or that fails its check, in words.
pub fn pages() -> Result<Vec<(String, String)>, String> {
    let variants = showcase();
    let models: Vec<_> = registry::models()
        .iter()
        .map(|info| (info, variants.iter().find(|spec| spec.name == info.name)))
        .collect();
    // The checks take their time: the even models beside the odd ones.
    let every_second = |first: usize| {
        let chosen = models.iter().skip(first).step_by(2);
        chosen
            .map(|(info, example)| files(info, *example))
            .collect::<Result<Vec<_>, _>>()
    };
    let (even, odd) = std::thread::scope(|scope| {
        let odd = scope.spawn(|| every_second(1));
        (every_second(0), odd.join())
    });
    let odd = odd.map_err(|_| "a check panicked".to_owned())?;
    let mut pages = vec![("README.md".to_owned(), index())];
    pages.extend(even?.into_iter().chain(odd?).flatten());
    Ok(pages)
}

/// The page of a model and its picture. A table and a shader have no example, so no picture: they come from files.
fn files(info: &ModelInfo, example: Option<&ModelSpec>) -> Result<Vec<(String, String)>, String> {
    let picture = example
        .map(picture::draw)
        .transpose()
        .map_err(|e| format!("{}: {e}", info.name))?;
    let page = page(info, example, picture.as_ref())?;
    let mut files = vec![(format!("{}.md", info.name), page)];
    if let Some(picture) = picture {
        files.push((format!("{}.svg", info.name), picture.svg));
    }
    Ok(files)
}

fn index() -> String {
    let mut text = format!(
        "# Models\n\n{NOTE}\n\nEach page is made from the model's entry in the registry and from the comment above its formula. \
         `gonio brdf list` prints the same list, `gonio brdf show NAME` the parameters.\n\n| model | what it is |\n|---|---|\n"
    );
    for info in registry::models() {
        text += &format!("| [`{0}`]({0}.md) | {1} |\n", info.name, cell(info.summary));
    }
    text + "\nHow a model is written on a command line or in a scene: [Describing a model](../describing-a-model.md).\n"
}

fn page(
    info: &ModelInfo,
    example: Option<&ModelSpec>,
    picture: Option<&Picture>,
) -> Result<String, String> {
    let file = source_file(info);
    let mut text = format!(
        "# {}\n\n{NOTE}\n\n{}.\n\n## Equation\n\n{}\n\nSource: {}.\n\nIn the code: `crates/gonio-brdf/src/model/{file}`. ",
        info.name,
        capitalised(info.summary),
        comment_above_the_structure(&file)?,
        info.paper
    );
    text += if info.recordable {
        "The formula can be written as shader code.\n"
    } else {
        "It cannot be written as shader code.\n"
    };
    if let Some(picture) = picture {
        text += &format!(
            "\n## Lobes\n\n![Polar curves of {0}]({0}.svg)\n\n{1}\n",
            info.name, picture.caption
        );
    }
    text += "\n## Parameters\n\n| name | values | default | meaning |\n|---|---|---|---|\n";
    for parameter in info.parameters {
        text += &format!(
            "| `{}` | {} | {} | {} |\n",
            parameter.name,
            cell(&parameter.expected()),
            default(parameter),
            cell(parameter.meaning)
        );
    }
    if let Some(name) = info.positional {
        text += &format!("\nA value without a name sets `{name}`.\n");
    }
    if info.parameters.iter().any(ParameterInfo::is_continuous) {
        text += "\nIn a scene, textures can drive its numbers and colours.\n";
    }
    if !info.aliases.is_empty() {
        text += "\n## Other names\n\n| name | sets |\n|---|---|\n";
        for alias in info.aliases {
            let preset: Vec<String> = alias
                .preset
                .iter()
                .map(|(key, value)| format!("`{key}={value}`"))
                .collect();
            let preset = if preset.is_empty() {
                "nothing: the same model".into()
            } else {
                preset.join(", ")
            };
            text += &format!("| `{}` | {preset} |\n", alias.name);
        }
    }
    let verdicts = match example {
        Some(example) => verdicts::section(info, example)?,
        None => String::new(),
    };
    Ok(text + &presets(info) + &declared(info) + &verdicts + &commands(info, example))
}

/// The sets of presets of the model and of its aliases; those that an alias shares with the model once.
fn presets(info: &ModelInfo) -> String {
    let mut sets = preset::sets_of(info.name);
    for alias in info.aliases {
        for set in preset::sets_of(alias.name) {
            if sets.iter().all(|known| known.presets != set.presets) {
                sets.push(set);
            }
        }
    }
    if sets.is_empty() {
        return String::new();
    }
    let mut text =
        "\n## Presets\n\nBy [name](../presets.md):\n\n| set | presets | such as |\n|---|---|---|\n"
            .to_owned();
    for set in sets {
        text += &format!(
            "| {} (`{}`) | {} | `{}@{}` |\n",
            cell(set.summary),
            set.name,
            set.presets.len(),
            set.model,
            set.presets.first().copied().unwrap_or_default()
        );
    }
    text
}

/// The model's source in the folder of the models: a file of its name, or the first of a folder of its name.
fn source_file(info: &ModelInfo) -> String {
    let name = info.name.replace('-', "_");
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/model");
    if models.join(&name).is_dir() {
        format!("{name}/mod.rs")
    } else {
        format!("{name}.rs")
    }
}

/// The documentation comment of the structure in a model's source: its equation.
fn comment_above_the_structure(file: &str) -> Result<String, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("src/model")
        .join(file);
    let source = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut comment: Vec<&str> = Vec::new();
    for line in source.lines() {
        if let Some(words) = line.strip_prefix("///") {
            comment.push(words.strip_prefix(' ').unwrap_or(words));
        } else if line.starts_with("pub struct ") && !comment.is_empty() {
            // Rustdoc's links have no target here: [`Name`] becomes `Name`.
            return Ok(comment.join("\n").replace("[`", "`").replace("`]", "`"));
        } else if !line.starts_with("#[") {
            comment.clear();
        }
    }
    Err(format!(
        "{}: no comment above a `pub struct`",
        path.display()
    ))
}

fn default(parameter: &ParameterInfo) -> String {
    match (parameter.default_value(), parameter.kind) {
        (Some(value), _) => format!("`{value}`"),
        (None, Kind::Path | Kind::Models) => "to be given".into(),
        (None, _) => "none".into(),
    }
}

/// The declared properties: of the defaults, and of each variant that differs from them.
fn declared(info: &ModelInfo) -> String {
    let mut rows: Vec<(String, Declares)> = Vec::new();
    let mut add = |name: String, declares: Declares| {
        let first = rows.is_empty();
        if first || rows.iter().all(|(_, known)| *known != declares) {
            rows.push((name, declares));
        }
    };
    let variants = showcase();
    for spec in variants.iter().filter(|s| s.name == info.name) {
        add(format!("`{spec}`"), (info.declares)(spec));
    }
    if let Ok(spec) = ModelSpec::new(info.name) {
        add(format!("`{spec}`"), (info.declares)(&spec));
        // The ends of each range, one parameter at a time.
        for parameter in info.parameters {
            let (Kind::Number { low, high, .. } | Kind::Colour { low, high, .. }) = parameter.kind
            else {
                continue;
            };
            for end in [low, high] {
                let mut spec = spec.clone();
                if spec
                    .set(parameter.name, gonio_brdf::Value::Number(end))
                    .is_ok()
                {
                    add(format!("`{spec}`"), (info.declares)(&spec));
                }
            }
        }
    }
    let mut text = "\n## Declared properties\n\nThey depend on the parameters: the first row and each that differs from the rows above \
                    it. `gonio brdf check` holds the model to them; a property that is declared to be missing is measured and printed.\n\n\
                    | description | reciprocal | conserves energy | isotropic | albedo at most |\n|---|---|---|---|---|\n"
        .to_owned();
    let word = |holds: bool| if holds { "yes" } else { "not declared" };
    for (name, d) in rows {
        let bound = if d.albedo_bound.is_finite() {
            format!("{:.4}", d.albedo_bound)
        } else {
            "no bound known".into()
        };
        text += &format!(
            "| {name} | {} | {} | {} | {bound} |\n",
            word(d.reciprocal),
            word(d.energy_conserving),
            word(d.isotropic)
        );
    }
    text
}

fn commands(info: &ModelInfo, example: Option<&ModelSpec>) -> String {
    let Some(example) = example.map(ModelSpec::to_string) else {
        return format!(
            "\n## Try it\n\nGive a file: `{}:{}=…`, as in [Describing a model](../describing-a-model.md).\n",
            info.name,
            info.positional.unwrap_or("file")
        );
    };
    // A shell takes parentheses and spaces for its own.
    let example = if example.contains(['(', ' ']) {
        format!("'{example}'")
    } else {
        example
    };
    format!(
        "\n## Try it\n\n```sh\ngonio brdf check {example}\ngonio brdf eval {example} --wi 30,0 --wo 45,180\ngonio render --material \
         {example}\n```\n"
    )
}

/// Text for a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters
        .next()
        .map(|first| first.to_uppercase().chain(letters).collect())
        .unwrap_or_default()
}
