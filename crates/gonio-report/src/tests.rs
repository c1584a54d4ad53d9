//! Files that other programs read.

use super::*;
use gonio_num::Vec3;
use gonio_verify::{Effort, Outcome, Subject, check};

type Eval = fn(Vec3<f64>, Vec3<f64>) -> [f64; 3];

fn section(name: &str, eval: Eval, expectation: Expectation) -> Section {
    let subject = Subject::new(name, &eval);
    let report = check(&subject, &expectation, Effort::Quick, "report").unwrap();
    let mut section = Section::new(report, expectation);
    section.facts = vec![("<colour>".into(), "\"red\" & 'blue'".into())];
    section.plots = vec![Plot {
        caption: "a & b".into(),
        svg: "<svg viewBox=\"0 0 1 1\"></svg>".into(),
    }];
    section
}

/// One that fails, one that passes, and one that declares what it lacks.
fn document() -> Document {
    let diffuse: Eval = |wi, wo| [if wi.z > 0.0 && wo.z > 0.0 { 0.3 } else { 0.0 }; 3];
    let lopsided: Eval = |wi, wo| {
        [if wi.z > 0.0 && wo.z > 0.0 {
            0.2 * wo.z
        } else {
            0.0
        }; 3]
    };
    let not_reciprocal = Expectation {
        reciprocal: false,
        ..Expectation::PHYSICAL
    };
    Document {
        sections: vec![
            section("lopsided:k=0.2,<b>", lopsided, Expectation::PHYSICAL),
            section("diffuse", diffuse, Expectation::PHYSICAL),
            section("declared", lopsided, not_reciprocal),
        ],
        command: "gonio brdf check --exec 'a & b'".into(),
        version: "1.2.3".into(),
    }
}

#[test]
fn junit_has_a_case_for_each_property() {
    let document = document();
    let xml = junit(&document);
    let tree = roxmltree::Document::parse(&xml).unwrap();
    let root = tree.root_element();
    assert!(root.has_tag_name("testsuites"));
    let suites: Vec<_> = root.children().filter(|n| n.is_element()).collect();
    assert_eq!(suites.len(), 3);
    let number = |node: &roxmltree::Node, name: &str| -> usize {
        node.attribute(name).unwrap().parse().unwrap()
    };
    for (suite, section) in suites.iter().zip(&document.sections) {
        assert_eq!(
            suite.attribute("name"),
            Some(section.report.subject.as_str())
        );
        let cases: Vec<_> = suite
            .children()
            .filter(|n| n.has_tag_name("testcase"))
            .collect();
        assert_eq!(cases.len(), section.report.verdicts.len());
        assert_eq!(cases.len(), number(suite, "tests"));
        for (case, v) in cases.iter().zip(&section.report.verdicts) {
            assert_eq!(case.attribute("name"), Some(v.property.name()));
            // No full stop, which would cut the name in two.
            assert!(!case.attribute("classname").unwrap().contains('.'));
            let children: Vec<_> = case.children().filter(|n| n.is_element()).collect();
            let expected = match v.outcome {
                Outcome::Pass | Outcome::Information => None,
                Outcome::Fail => Some("failure"),
                Outcome::Declared | Outcome::Allowed => Some("system-out"),
                Outcome::NotApplicable => Some("skipped"),
            };
            assert_eq!(children.first().map(|n| n.tag_name().name()), expected);
        }
    }
    for (name, least) in [("tests", 30), ("failures", 1), ("skipped", 3)] {
        let sum: usize = suites.iter().map(|s| number(s, name)).sum();
        assert_eq!(number(&root, name), sum);
        assert!(sum >= least, "{name}");
    }
    let failure = tree
        .descendants()
        .find(|n| n.has_tag_name("failure"))
        .unwrap();
    assert!(failure.attribute("message").unwrap().contains("bound"));
    assert!(failure.text().unwrap().contains("wo  θ"));
}

#[test]
fn html_needs_nothing_else() {
    let document = document();
    let page = html(&document);
    for word in [
        "<script", "<link", "http:", "https:", "url(", "@import", "<b>,", "a & b",
    ] {
        assert!(!page.contains(word), "{word}");
    }
    for word in [
        "<title>FAIL · 3 reflection functions</title>",
        "lopsided:k=0.2,&lt;b&gt;",
        "&lt;colour&gt;",
        "&quot;red&quot; &amp; &#39;blue&#39;",
        "prefers-color-scheme: dark",
        "@media print",
        "Where it is worst",
        "gonio brdf check --exec &#39;a &amp; b&#39;",
        "class=\"pair\"",
        "Made by Gonio 1.2.3",
    ] {
        assert!(page.contains(word), "{word}");
    }
    assert_eq!(page, html(&document));
    // One function has a page without a table of contents.
    let one = Document {
        sections: document.sections[1..2].to_vec(),
        ..document
    };
    let page = html(&one);
    assert!(page.contains("<title>PASS · diffuse</title>") && !page.contains("<details"));
    assert!(page.contains("It is as it declares"));
}

/// Every element that is opened is closed, in order: what follows the doctype is also XML, but for elements that HTML leaves open.
#[test]
fn html_is_well_formed() {
    let page = html(&document());
    let body = page
        .split_once("<body>")
        .unwrap()
        .1
        .split_once("</body>")
        .unwrap()
        .0;
    roxmltree::Document::parse(body.trim()).unwrap();
}
