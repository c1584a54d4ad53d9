//! The book's pages about models say what the code says.

#[path = "../examples/model_pages/page.rs"]
mod page;

use std::collections::BTreeSet;
use std::fs;

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
    for (name, _) in page::pages().unwrap() {
        assert!(summary.contains(&format!("(models/{name})")), "{name}");
    }
}
