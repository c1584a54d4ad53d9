//! The book's page on calibration says what is found; and so every fault is caught by its property.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

#[path = "../examples/calibrate/page.rs"]
mod page;

use gonio_verify::specimen;

#[test]
fn the_page_is_up_to_date() {
    let page = page::page().unwrap();
    // A checkout may have other line ends.
    let found = std::fs::read_to_string(page::page_file())
        .unwrap_or_default()
        .replace("\r\n", "\n");
    assert!(
        page == found,
        "run `cargo run --release -p gonio-verify --example calibrate`; the page should be\n{page}"
    );
}

/// The promise: a suite fails what is right in fewer than one of ten thousand.
#[test]
fn the_last_calibration_keeps_the_promise() {
    let text = std::fs::read_to_string(page::found_file()).unwrap();
    let found: page::Found = serde_json::from_str(&text).unwrap();
    assert!(found.short.upper_bound() < 1e-4, "{:?}", found.short);
    assert_eq!(found.quick.failures(), 0, "{:?}", found.quick);
    // Of the functions that there are, and no others.
    let functions = specimen::right().len() as u64;
    assert!(
        found.short.runs.is_multiple_of(functions) && found.quick.runs.is_multiple_of(functions)
    );
    // The control: three failures would not keep it.
    let worse = gonio_verify::statistics::clopper_pearson_upper(3, found.short.runs, 0.05);
    assert!(worse > 1e-4, "{worse}");
}
