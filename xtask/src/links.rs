//! What the documents of the repository point to: links, pages of the book, paths of the code.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Fails if a Markdown file links to a file that does not exist, names a path of a crate that does not exist, or if a page of
/// the book is not in its summary.
pub fn links() -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut documents = Vec::new();
    collect(&root, &mut documents).map_err(|e| format!("{}: {e}", root.display()))?;
    let mut broken = Vec::new();
    let mut count = 0;
    for path in &documents {
        let text = std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let folder = path.parent().unwrap_or(&root);
        let shown = path.strip_prefix(&root).unwrap_or(path).display();
        for (line, target) in relative_links(&text) {
            count += 1;
            if !folder.join(&target).exists() {
                broken.push(format!("{shown}:{line}: {target}"));
            }
        }
        for (line, named) in paths_of_crates(&text) {
            count += 1;
            if !root.join(&named).exists() {
                broken.push(format!("{shown}:{line}: {named}"));
            }
        }
    }
    broken.extend(pages_outside_the_summary(&root.join("book/src"))?);
    if broken.is_empty() {
        println!(
            "links: {} documents, {count} links and paths, none broken",
            documents.len()
        );
        Ok(())
    } else {
        Err(format!(
            "links and paths to nothing:\n  {}",
            broken.join("\n  ")
        ))
    }
}

/// Every Markdown file of the repository.
fn collect(folder: &Path, into: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() {
            let made = ["target", "node_modules", "dist"].contains(&&*name);
            if !name.starts_with('.') && !made && !path.join("book.toml").exists() {
                collect(&path, into)?;
            } else if path.join("book.toml").exists() {
                // Beside its source a book has what was made of it.
                collect(&path.join("src"), into)?;
            }
        } else if path.extension().is_some_and(|e| e == "md") {
            into.push(path);
        }
    }
    into.sort();
    Ok(())
}

/// The lines outside fenced blocks, numbered from 1.
fn prose(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut inside = false;
    text.lines().enumerate().filter_map(move |(k, line)| {
        let fence = line.trim_start().starts_with("```");
        inside ^= fence;
        (!inside && !fence).then_some((k + 1, line))
    })
}

/// The targets of `[…](target)` that are files of the repository, without what follows `#`.
fn relative_links(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        for rest in line.split("](").skip(1) {
            let target = rest.split([')', ' ']).next().unwrap_or_default();
            let file = target.split('#').next().unwrap_or_default();
            if !file.is_empty() && !target.contains("://") && !target.starts_with("mailto:") {
                found.push((number, file.to_owned()));
            }
        }
    }
    found
}

/// The paths in backticks that begin with `crates/` or with the folder of a crate. Patterns (`*`, `{`, `NAME`) are left out.
fn paths_of_crates(text: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    for (number, line) in prose(text) {
        for span in line.split('`').skip(1).step_by(2) {
            let is_path = span.starts_with("crates/")
                || span.starts_with("gonio-") && span.contains("/src")
                || span.starts_with("gonio-") && span.contains("/tests");
            let pattern =
                |c: char| !(c.is_ascii_lowercase() || c.is_ascii_digit() || "/_-.".contains(c));
            if is_path && !span.contains(pattern) {
                let path = match span.strip_prefix("crates/") {
                    Some(_) => span.to_owned(),
                    None => format!("crates/{span}"),
                };
                found.push((number, path));
            }
        }
    }
    found
}

/// The pages of the book that its summary does not list.
fn pages_outside_the_summary(source: &Path) -> Result<Vec<String>, String> {
    let summary = source.join("SUMMARY.md");
    let text =
        std::fs::read_to_string(&summary).map_err(|e| format!("{}: {e}", summary.display()))?;
    let listed: BTreeSet<PathBuf> = relative_links(&text)
        .into_iter()
        .map(|(_, target)| source.join(target))
        .collect();
    let mut pages = Vec::new();
    collect(source, &mut pages).map_err(|e| format!("{}: {e}", source.display()))?;
    Ok(pages
        .iter()
        .filter(|page| **page != summary && !listed.contains(*page))
        .map(|page| format!("{} is not in SUMMARY.md", page.display()))
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_are_found_outside_code() {
        let text = "See [a](a.md#part) and ![b](b/c.png \"title\").\n```\n[no](no.md)\n```\n\
                    [web](https://example.org) [here](#here)\n[d](d.md)";
        let expected = [(1, "a.md"), (1, "b/c.png"), (6, "d.md")];
        assert_eq!(
            relative_links(text),
            expected.map(|(line, file)| (line, file.to_owned()))
        );
    }

    #[test]
    fn paths_of_crates_are_found_and_patterns_left_out() {
        let text = "`gonio-num/src/real.rs` and `crates/gonio`, `gonio render`, `crates/*/README.md`, `crates/gonio-brdf/src/model/NAME.rs`";
        let expected = [(1, "crates/gonio-num/src/real.rs"), (1, "crates/gonio")];
        assert_eq!(
            paths_of_crates(text),
            expected.map(|(line, path)| (line, path.to_owned()))
        );
    }

    #[test]
    fn a_page_that_nobody_lists_is_found() {
        let folder = std::env::temp_dir().join(format!("gonio-xtask-links-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("SUMMARY.md"), "- [One](one.md)\n").unwrap();
        std::fs::write(folder.join("one.md"), "one").unwrap();
        std::fs::write(folder.join("two.md"), "two").unwrap();
        let found = pages_outside_the_summary(&folder);
        std::fs::remove_dir_all(&folder).unwrap();
        let found = found.unwrap();
        assert!(found.len() == 1 && found[0].contains("two.md"), "{found:?}");
    }
}
