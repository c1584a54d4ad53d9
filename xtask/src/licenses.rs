//! The licences of the crates that the explorer's WebAssembly carries, for `licenses.txt` of its site.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;

/// Texts one after the other, each under the crates that it belongs to: what `package` is compiled from for `target`, without what only
/// runs at build time.
///
/// # Errors
/// If `cargo metadata` fails, or a text can't be read.
pub fn of(root: &Path, package: &str, target: &str) -> Result<String, String> {
    let mut command = Command::new("cargo");
    command
        .args(["metadata", "--format-version", "1", "--filter-platform"])
        .arg(target)
        .current_dir(root);
    let out = command.output().map_err(|e| format!("{command:?}: {e}"))?;
    if !out.status.success() {
        let words = String::from_utf8_lossy(&out.stderr);
        return Err(format!("{command:?}: {}", words.trim()));
    }
    let metadata: Value =
        serde_json::from_slice(&out.stdout).map_err(|e| format!("{command:?}: {e}"))?;
    let mut names: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for found in linked(&metadata, package)? {
        // Gonio's own crates are under the site's licence.
        if found["source"].is_null() {
            continue;
        }
        let word = |key: &str| found[key].as_str().unwrap_or("");
        let name = format!("{} {} ({})", word("name"), word("version"), word("license"));
        let folder = Path::new(word("manifest_path")).parent();
        let folder = folder.ok_or_else(|| format!("{name}: its manifest lies in no folder"))?;
        let text = text(folder)?.unwrap_or_else(|| {
            format!(
                "Its package has no text of the licence: see {}",
                word("repository")
            )
        });
        names.entry(text).or_default().push(name);
    }
    let mut parts: Vec<String> = names
        .into_iter()
        .map(|(text, names)| format!("{}\n\n{text}", names.join("\n")))
        .collect();
    parts.sort();
    parts.push("The standard library of Rust (MIT OR Apache-2.0)\n\nhttps://www.rust-lang.org/policies/licenses".into());
    Ok(parts.join(&format!("\n\n{}\n\n", "-".repeat(80))))
}

/// The packages that are linked into `package`, itself among them.
fn linked<'a>(metadata: &'a Value, package: &str) -> Result<Vec<&'a Value>, String> {
    let by_id = |list: &'a Value| -> BTreeMap<&'a str, &'a Value> {
        let entries = list.as_array().into_iter().flatten();
        entries
            .filter_map(|entry| Some((entry["id"].as_str()?, entry)))
            .collect()
    };
    let packages = by_id(&metadata["packages"]);
    let nodes = by_id(&metadata["resolve"]["nodes"]);
    let root = packages.iter().find(|(_, p)| p["name"] == package);
    let (root, _) = root.ok_or_else(|| format!("there is no package {package}"))?;
    let mut waiting = vec![*root];
    let mut seen = BTreeSet::new();
    while let Some(id) = waiting.pop() {
        if runs_at_build_time(packages[id]) || !seen.insert(id) {
            continue;
        }
        for dependency in nodes[id]["deps"].as_array().into_iter().flatten() {
            let mut kinds = dependency["dep_kinds"].as_array().into_iter().flatten();
            if kinds.any(|k| k["kind"].is_null())
                && let Some(id) = dependency["pkg"].as_str()
            {
                waiting.push(id);
            }
        }
    }
    Ok(seen.into_iter().map(|id| packages[id]).collect())
}

fn runs_at_build_time(package: &Value) -> bool {
    let targets = package["targets"].as_array().into_iter().flatten();
    targets
        .flat_map(|target| target["kind"].as_array().into_iter().flatten())
        .any(|kind| kind == "proc-macro")
}

/// The licence's text in a package's folder: where there is a choice, that of the MIT licence, the shortest to comply with.
fn text(folder: &Path) -> Result<Option<String>, String> {
    let failed = |e: std::io::Error| format!("{}: {e}", folder.display());
    let mut files = BTreeSet::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().to_lowercase();
        let known = ["license", "licence", "copying", "unlicense", "notice"];
        if known.iter().any(|start| name.starts_with(start)) && entry.path().is_file() {
            files.insert((!name.contains("mit"), entry.path()));
        }
    }
    let mit = files.iter().any(|(other, _)| !other);
    let mut texts = Vec::new();
    for (_, file) in files.iter().filter(|(other, _)| !(mit && *other)) {
        let read = std::fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()))?;
        texts.push(read.replace("\r\n", "\n").trim().to_owned());
    }
    Ok((!texts.is_empty()).then(|| texts.join("\n\n")))
}
