//! The book's pages about models say what the code says and show what it does.

#[path = "../examples/model_pages/page.rs"]
mod page;

use gonio_brdf::registry;
use std::collections::BTreeSet;
use std::fs;

/// Pictures are looked at on slow lines, too: bytes.
const LARGEST_PICTURE: usize = 25_000;

#[test]
fn the_pages_are_up_to_date() {
    let folder = page::folder();
    let mut expected = BTreeSet::new();
    for (name, text) in page::pages().unwrap() {
        // A checkout may have other line ends.
        let found = fs::read_to_string(folder.join(&name))
            .unwrap_or_default()
            .replace("\r\n", "\n");
        assert!(
            found == text,
            "book/src/models/{name} is not up to date: run `cargo run -p gonio-brdf --example model_pages`"
        );
        if name.ends_with(".svg") {
            assert!(text.len() < LARGEST_PICTURE, "{name}: {}", text.len());
        }
        expected.insert(name);
    }
    let present: BTreeSet<String> = fs::read_dir(&folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    assert_eq!(present, expected, "pages of models that don't exist");
}

#[test]
fn every_page_is_in_the_summary() {
    let summary = fs::read_to_string(page::folder().join("../SUMMARY.md")).unwrap();
    for name in registry::names().into_iter().chain(["README"]) {
        assert!(summary.contains(&format!("(models/{name}.md)")), "{name}");
    }
}
