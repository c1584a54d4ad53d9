//! `examples/ci`: the shader passes, and the report beside it is the one that it makes.

use crate::support::Place;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ci")
}

fn text(name: &str) -> String {
    std::fs::read_to_string(folder().join(name)).unwrap()
}

/// The command of the workflow files.
const CHECK: &str = "gonio brdf check metal.wgsl --junit report.xml --html report.html";

/// The page without its plots: how they are drawn is no matter of the verdict.
fn without_plots(page: &str) -> String {
    let mut rest = page;
    let mut kept = String::new();
    while let Some((before, after)) = rest.split_once("<svg xmlns") {
        kept += before;
        rest = after.split_once("</svg>").unwrap().1;
    }
    kept + rest
}

/// With `GONIO_UPDATE=1` in the environment the report is written anew instead.
#[test]
fn the_report_is_the_one_that_the_check_makes() {
    let place = Place::new();
    place.write("metal.wgsl", text("metal.wgsl"));
    let words: Vec<&str> = CHECK.split(' ').skip(1).collect();
    place.good(&words);
    let made = String::from_utf8(place.read("report.html")).unwrap();
    if std::env::var_os("GONIO_UPDATE").is_some() {
        std::fs::write(folder().join("report.html"), &made).unwrap();
        return;
    }
    assert_eq!(made.matches("<svg xmlns").count(), 2);
    assert!(
        without_plots(&made) == without_plots(&text("report.html")),
        "examples/ci/report.html is out of date: GONIO_UPDATE=1 cargo test -p gonio --test command ci"
    );
}

/// A fault of the kind that is easily made and hard to see: the cosine is in `eval` already.
#[test]
fn a_broken_shader_fails_with_a_report() {
    let place = Place::new();
    let broken = text("metal.wgsl").replace("visibility(wi, wo));", "visibility(wi, wo) * wi.z);");
    assert_ne!(broken, text("metal.wgsl"));
    place.write("metal.wgsl", broken);
    let mut words: Vec<&str> = CHECK.split(' ').skip(1).collect();
    words.extend(["--effort", "quick"]);
    let said = place.gonio(&words);
    assert_eq!(said.code, 1, "{said:?}");
    let xml = String::from_utf8(place.read("report.xml")).unwrap();
    let tree = roxmltree::Document::parse(&xml).unwrap();
    let failed: Vec<_> = tree
        .descendants()
        .filter(|n| n.has_tag_name("failure"))
        .filter_map(|n| n.attribute("type"))
        .collect();
    assert_eq!(failed, ["reciprocity"]);
}

#[test]
fn workflows_run_the_check() {
    for name in ["github-workflow.yml", "gitlab-ci.yml"] {
        assert!(
            text(name).lines().any(|line| line.ends_with(CHECK)),
            "{name}"
        );
    }
}
