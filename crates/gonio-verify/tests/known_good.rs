//! Right reflection functions pass: no false alarms.

mod support;

use gonio_verify::{Checker, Effort, Expectation, Outcome, Precision, Property, Settings, check};
use support::*;

const BRUSHED: Expectation = Expectation {
    isotropic: false,
    ..Expectation::PHYSICAL
};

fn outcome(r: &gonio_verify::Report, p: Property) -> Outcome {
    r.verdict(p).unwrap().outcome
}

#[test]
fn right_functions_pass_whole() {
    let subjects: Vec<(&str, Box<dyn Reflection>, Expectation)> = vec![
        (
            "lambertian",
            Box::new(Lambertian(1.0)),
            Expectation::PHYSICAL,
        ),
        ("black", Box::new(Lambertian(0.0)), Expectation::PHYSICAL),
        ("phong 1", Box::new(Phong(1.0)), Expectation::PHYSICAL),
        ("phong 3000", Box::new(Phong(3000.0)), Expectation::PHYSICAL),
        (
            "ggx 1",
            Box::new(Ggx { alpha: [1.0; 2] }),
            Expectation::PHYSICAL,
        ),
        (
            "ggx 0.1",
            Box::new(Ggx { alpha: [0.1; 2] }),
            Expectation::PHYSICAL,
        ),
        (
            "ggx 0.002",
            Box::new(Ggx { alpha: [0.002; 2] }),
            Expectation::PHYSICAL,
        ),
        ("brushed", Box::new(Ggx { alpha: [0.4, 0.05] }), BRUSHED),
        (
            "varnished",
            Box::new(Varnished(Ggx { alpha: [0.2; 2] })),
            Expectation::PHYSICAL,
        ),
    ];
    for (name, r, expect) in &subjects {
        let report = with_subject(name, r.as_ref(), |s| {
            check(s, expect, Effort::Quick, "right functions")
        });
        if std::env::var_os("GONIO_SHOW").is_some() {
            println!("{report}\n");
        }
        assert!(report.passed(), "{report}");
        for p in Property::ALL {
            let skipped = outcome(&report, p) == Outcome::NotApplicable;
            assert_eq!(skipped, p == Property::Linearity, "{report}");
        }
    }
}
