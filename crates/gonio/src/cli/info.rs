//! `gonio info`: how a picture or a part of one came to be.

use super::failure::Failure;
use super::render::product::{GROUPS, MATERIALS, is_part};
use super::summary::rejected_in_words;
use super::terminal::{print, print_json};
use gonio_image::{Image, Layers};
use gonio_render::part::{self, Header};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "Examples:\n  \
    gonio info room.exr\n  \
    gonio info room.exr --json\n  \
    gonio info samples-0-16.gonio")]
pub(super) struct Arguments {
    /// A picture (.exr, .hdr, .png, …), a part (.gonio), or a checkpoint
    file: PathBuf,
    /// Print it as JSON
    #[arg(long)]
    json: bool,
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = look(&arguments.file)?;
    if arguments.json {
        return print_json(&found);
    }
    let width = found.keys().map(|k| k.len()).max().unwrap_or(0);
    let mut text = String::new();
    for (key, value) in &found {
        match value {
            Value::Object(inner) => {
                for (name, value) in inner {
                    text += &format!("{:width$}  {name}: {}\n", key, plain(value));
                }
            }
            other => text += &format!("{key:width$}  {}\n", plain(other)),
        }
    }
    print(&text)
}

/// A value without the marks of JSON.
fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Array(all) => all.iter().map(plain).collect::<Vec<_>>().join(", "),
        other => other.to_string(),
    }
}

/// Names and values, in the order in which they are printed.
fn look(path: &Path) -> Result<Map<String, Value>, Failure> {
    if is_part(path) || part::is_one(path) {
        return Ok(of_part(&part::open(path)?.header));
    }
    let is_exr = super::destination::extension(path) == "exr";
    if !is_exr {
        let image = Image::read(path)?;
        let mut found = Map::new();
        found.insert("size".into(), size(image.width, image.height));
        return Ok(found);
    }
    let layers = Layers::read_exr(path)?;
    let mut found = Map::new();
    found.insert("size".into(), size(layers.width, layers.height));
    let mut channels: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for channel in &layers.channels {
        let (layer, component) = channel.name.rsplit_once('.').unwrap_or(("", &channel.name));
        channels.entry(layer).or_default().push(component);
    }
    let channels: Vec<String> = channels
        .into_iter()
        .map(|(layer, components)| match layer {
            "" => components.concat(),
            _ => format!("{layer}.{}", components.concat()),
        })
        .collect();
    found.insert("channels".into(), json!(channels));
    for (name, value) in &layers.metadata {
        let list = match name.as_str() {
            GROUPS | MATERIALS => serde_json::from_str(value).ok(),
            _ => None,
        };
        found.insert(name.clone(), list.unwrap_or_else(|| json!(value)));
    }
    Ok(found)
}

fn of_part(header: &Header) -> Map<String, Value> {
    let rejected = header.rejected();
    let mut found = Map::new();
    let mut add = |key: &str, value: Value| found.insert(key.into(), value);
    add("size", size(header.width as usize, header.height as usize));
    add("samples", json!(format!("{}:{}", header.first, header.end)));
    add("of", json!(header.of));
    add("scene", json!(header.scene));
    add("rays", json!(header.rays.total()));
    add("seconds", json!(header.seconds));
    add("rejectedSamples", json!(rejected.count));
    add("rejectedInLayers", json!(rejected.in_layers));
    if let Some(first) = &rejected.first {
        let words = rejected_in_words(first, &header.names.materials);
        add("firstRejectedSample", json!(words));
    }
    add("layers", json!(header.kept.to_string()));
    add("materials", json!(header.names.materials));
    add("groups", json!(header.names.groups));
    let identity: BTreeMap<&str, &str> = header.identity.properties().collect();
    add("identity", json!(identity));
    found
}

fn size(width: usize, height: usize) -> Value {
    json!(format!("{width}x{height}"))
}
