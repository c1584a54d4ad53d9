//! The rules of the house: floors, and files that a person can read.

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A file longer than this is to be split.
const LONGEST_FILE: usize = 600;

/// Fails if a crate depends, at run time, on a crate of its own floor or of a higher one.
///
/// The floor is `package.metadata.gonio.floor` of each crate's manifest.
pub fn floors() -> Result<(), String> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps"])
        .output()
        .map_err(|e| format!("cargo metadata does not run: {e}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let metadata: Value =
        serde_json::from_slice(&output.stdout).map_err(|e| format!("cargo metadata: {e}"))?;
    let upward = upward_edges(&metadata)?;
    if upward.is_empty() {
        println!("floors: every dependency points downward");
        Ok(())
    } else {
        Err(format!(
            "dependencies that do not point downward:\n  {}",
            upward.join("\n  ")
        ))
    }
}

/// The edges of `cargo metadata` that don't lead to a lower floor, in words.
fn upward_edges(metadata: &Value) -> Result<Vec<String>, String> {
    let packages = metadata["packages"]
        .as_array()
        .ok_or("cargo metadata lists no packages")?;
    let mut floor = BTreeMap::new();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        match package["metadata"]["gonio"]["floor"].as_u64() {
            Some(number) => {
                floor.insert(name, number);
            }
            None if name == "xtask" => {}
            None => {
                return Err(format!(
                    "{name}: no package.metadata.gonio.floor in its manifest"
                ));
            }
        }
    }
    let mut upward = Vec::new();
    for package in packages {
        let name = package["name"].as_str().unwrap_or_default();
        let Some(own) = floor.get(name) else { continue };
        for dependency in package["dependencies"].as_array().into_iter().flatten() {
            let is_test_only = dependency["kind"] == "dev";
            let other = dependency["name"].as_str().unwrap_or_default();
            if let Some(theirs) = floor.get(other)
                && theirs >= own
                && !is_test_only
            {
                upward.push(format!("{name} (floor {own}) → {other} (floor {theirs})"));
            }
        }
    }
    Ok(upward)
}

/// Fails if a source file of the repository, in Rust or TypeScript, is longer than [`LONGEST_FILE`] lines.
pub fn files() -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut sources = Vec::new();
    for folder in [
        "crates",
        "xtask",
        "examples",
        "fuzz",
        "web/src",
        "web/tests",
    ] {
        collect(&root.join(folder), &mut sources).map_err(|e| format!("{folder}: {e}"))?;
    }
    let mut long = Vec::new();
    for path in &sources {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let lines = text.lines().count();
        if lines > LONGEST_FILE {
            long.push(format!("{}: {lines} lines", path.display()));
        }
    }
    if long.is_empty() {
        println!(
            "files: {} sources, none longer than {LONGEST_FILE} lines",
            sources.len()
        );
        Ok(())
    } else {
        Err(format!(
            "files longer than {LONGEST_FILE} lines:\n  {}",
            long.join("\n  ")
        ))
    }
}

fn collect(folder: &Path, into: &mut Vec<PathBuf>) -> std::io::Result<()> {
    if !folder.is_dir() {
        return Ok(());
    }
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            if path.file_name().is_some_and(|name| name != "target") {
                collect(&path, into)?;
            }
        } else if path
            .extension()
            .is_some_and(|e| ["rs", "ts", "tsx"].iter().any(|known| e == *known))
        {
            into.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn package(name: &str, floor: u64, on: &str, kind: Option<&str>) -> Value {
        json!({ "name": name, "metadata": { "gonio": { "floor": floor } },
                "dependencies": [{ "name": on, "kind": kind }] })
    }

    #[test]
    fn an_upward_edge_is_found() {
        let down =
            json!({ "packages": [package("a", 0, "libm", None), package("b", 1, "a", None)] });
        assert_eq!(upward_edges(&down), Ok(vec![]));
        let up = json!({ "packages": [package("a", 0, "b", None), package("b", 1, "a", None)] });
        assert_eq!(
            upward_edges(&up),
            Ok(vec!["a (floor 0) → b (floor 1)".to_owned()])
        );
        let beside =
            json!({ "packages": [package("a", 1, "b", None), package("b", 1, "libm", None)] });
        assert_eq!(upward_edges(&beside).map(|v| v.len()), Ok(1));
        let test_only =
            json!({ "packages": [package("a", 0, "b", Some("dev")), package("b", 1, "a", None)] });
        assert_eq!(upward_edges(&test_only), Ok(vec![]));
        let unknown = json!({ "packages": [{ "name": "c", "dependencies": [] }] });
        assert!(upward_edges(&unknown).is_err());
    }
}
