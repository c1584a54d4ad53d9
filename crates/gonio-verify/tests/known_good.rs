//! Right reflection functions pass: no false alarms.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

mod support;

use gonio_verify::{Checker, Effort, Expectation, Outcome, Precision, Property, Settings, check};
use support::*;

/// Declares that f depends on which of the two directions is which.
const ONE_WAY: Expectation = Expectation {
    reciprocal: false,
    ..Expectation::PHYSICAL
};

const BRUSHED: Expectation = Expectation {
    isotropic: false,
    ..Expectation::PHYSICAL
};

fn outcome(r: &gonio_verify::Report, p: Property) -> Outcome {
    r.verdict(p).expect("every property has a verdict").outcome
}

#[test]
fn right_functions_pass_whole() {
    let ggx = |alpha: f64| Ggx { alpha: [alpha; 2] };
    let subjects: Vec<(&str, Box<dyn Reflection>, Expectation)> = vec![
        (
            "lambertian",
            Box::new(Lambertian(1.0)),
            Expectation::PHYSICAL,
        ),
        ("black", Box::new(Lambertian(0.0)), Expectation::PHYSICAL),
        ("phong 1", Box::new(Phong(1.0)), Expectation::PHYSICAL),
        ("phong 3000", Box::new(Phong(3000.0)), Expectation::PHYSICAL),
        ("ggx 1", Box::new(ggx(1.0)), Expectation::PHYSICAL),
        ("ggx 0.1", Box::new(ggx(0.1)), Expectation::PHYSICAL),
        ("ggx 0.002", Box::new(ggx(0.002)), Expectation::PHYSICAL),
        ("ggx 1e-5", Box::new(ggx(1e-5)), Expectation::PHYSICAL),
        ("brushed", Box::new(Ggx { alpha: [0.4, 0.05] }), BRUSHED),
        (
            "varnished",
            Box::new(Varnished(ggx(0.2))),
            Expectation::PHYSICAL,
        ),
        (
            "drawn by the cosine",
            Box::new(CosineDrawn(ggx(0.01))),
            Expectation::PHYSICAL,
        ),
        (
            "rarely drawn lobe",
            Box::new(Coated(0.001, ggx(0.003))),
            Expectation::PHYSICAL,
        ),
        ("bands", Box::new(Bands), ONE_WAY),
    ];
    for (name, r, expect) in &subjects {
        let report = with_subject(name, r.as_ref(), |s| {
            check(s, expect, Effort::Quick, "right functions").unwrap()
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

#[test]
fn a_mirror_has_no_density_to_check() {
    let report = with_subject("mirror", &Mirror(1.0), |s| {
        check(s, &Expectation::PHYSICAL, Effort::Quick, "mirror").unwrap()
    });
    assert!(report.passed(), "{report}");
    for p in [Property::PdfIntegral, Property::SampleDensity] {
        assert_eq!(outcome(&report, p), Outcome::NotApplicable);
    }
    let energy = report.verdict(Property::EnergyConservation).unwrap();
    assert_eq!(energy.figure, 1.0);
    // The control: a mirror that makes energy.
    let report = with_subject("bright mirror", &Mirror(1.01), |s| {
        check(s, &Expectation::PHYSICAL, Effort::Quick, "mirror").unwrap()
    });
    assert_eq!(
        outcome(&report, Property::EnergyConservation),
        Outcome::Fail
    );
}

#[test]
fn without_pdf_and_sample_the_rest_is_still_checked() {
    let ggx = Ggx { alpha: [0.05; 2] };
    let eval = |wi: V, wo: V| ggx.eval(wi, wo);
    let subject = gonio_verify::Subject::new("eval only", &eval);
    let report = check(&subject, &Expectation::PHYSICAL, Effort::Quick, "eval only").unwrap();
    assert!(report.passed(), "{report}");
    // The quadrature finds the lobe without a sampler: the albedo at normal incidence of α = 0.05 is above 0.99.
    let energy = report.verdict(Property::EnergyConservation).unwrap();
    assert!((0.99..=1.0).contains(&energy.figure), "{report}");
    for p in [
        Property::PdfIntegral,
        Property::SampleDensity,
        Property::SampleWeight,
    ] {
        assert_eq!(outcome(&report, p), Outcome::NotApplicable);
    }
}

#[test]
fn single_precision_inside_passes_with_its_bounds() {
    let ggx = Ggx { alpha: [0.1; 2] };
    let round = |w: V| w.to_f32().to_f64();
    let eval = |wi: V, wo: V| ggx.eval(round(wi), round(wo)).map(|f| f64::from(f as f32));
    let pdf = |wi: V, wo: V| f64::from(ggx.pdf(round(wi), round(wo)) as f32);
    let sample = |wo: V, u: [f64; 3]| {
        let s = ggx.sample(
            round(wo),
            u.map(|u| f64::from((u * 16_777_216.0).floor() as f32 / 16_777_216.0)),
        )?;
        Some(gonio_verify::SubjectSample {
            wi: round(s.wi),
            weight: s.weight.map(|w| f64::from(w as f32)),
            pdf: f64::from(s.pdf as f32),
            delta: false,
        })
    };
    let subject = gonio_verify::Subject::new("f32", &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    let settings = Settings::new(Effort::Quick).with_precision(Precision::Single);
    let report = Checker::new(&subject, &Expectation::PHYSICAL, Effort::Quick)
        .settings(settings)
        .run("single precision")
        .unwrap();
    assert!(report.passed(), "{report}");
    // The control: the bounds of double precision see the rounding.
    let report = check(
        &subject,
        &Expectation::PHYSICAL,
        Effort::Quick,
        "single precision",
    )
    .unwrap();
    assert!(!report.passed(), "{report}");
}

#[test]
fn the_same_seed_gives_the_same_report() {
    let run = |seed: &str| {
        with_subject("ggx", &Ggx { alpha: [0.3; 2] }, |s| {
            check(s, &Expectation::PHYSICAL, Effort::Quick, seed).unwrap()
        })
    };
    let a = run("a");
    // Witnesses of properties without a violation and figures included.
    assert_eq!(format!("{a:?}"), format!("{:?}", run("a")));
    assert_ne!(format!("{a:?}"), format!("{:?}", run("b")));
}

#[test]
fn a_leaf_may_transmit() {
    // Half of the light to either side, from either side.
    let eval = |_: V, _: V| [0.5 / std::f64::consts::PI; 3];
    let pdf = |wi: V, _: V| 0.5 * wi.z.abs() / std::f64::consts::PI;
    let sample = |_: V, u: [f64; 3]| {
        let up = V::new(0.0, 0.0, 1.0);
        let mut s = Lambertian(1.0).sample(up, u)?;
        s.wi.z *= if u[2] < 0.5 { 1.0 } else { -1.0 };
        s.pdf *= 0.5;
        s.weight = [1.0; 3];
        Some(s)
    };
    let subject = gonio_verify::Subject::new("leaf", &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    let run = |s: &gonio_verify::Subject| {
        check(s, &Expectation::PHYSICAL, Effort::Quick, "leaf").unwrap()
    };
    let report = run(&subject.clone().transmitting([1.0; 3]));
    assert!(report.passed(), "{report}");
    assert_eq!(outcome(&report, Property::Horizon), Outcome::NotApplicable);
    let energy = report.verdict(Property::EnergyConservation).unwrap();
    assert!((energy.figure - 1.0).abs() < 1e-4, "{report}");
    // The control: a surface that claims only to reflect.
    assert_eq!(outcome(&run(&subject), Property::Horizon), Outcome::Fail);
}

#[test]
fn a_boundary_scales_radiance() {
    for ior in [[1.5; 3], [0.7, 0.75, 0.8]] {
        let boundary = Frosted { ior, scaled: true };
        let report = with_subject("frosted", &boundary, |s| {
            let s = s.clone().transmitting(ior);
            check(&s, &Expectation::PHYSICAL, Effort::Quick, "frosted").unwrap()
        });
        assert!(report.passed(), "{report}");
        let energy = report.verdict(Property::EnergyConservation).unwrap();
        assert!((energy.figure - 1.0).abs() < 1e-4, "{report}");
    }
    // The control: without the factor n(ωr)² it is not reciprocal, and towards the rarer side it makes energy.
    let forgetful = Frosted {
        ior: [0.7; 3],
        scaled: false,
    };
    let report = with_subject("unscaled", &forgetful, |s| {
        let s = s.clone().transmitting([0.7; 3]);
        check(&s, &Expectation::PHYSICAL, Effort::Quick, "frosted").unwrap()
    });
    for p in [Property::Reciprocity, Property::EnergyConservation] {
        assert_eq!(outcome(&report, p), Outcome::Fail, "{report}");
    }
}

#[test]
fn components_add_up() {
    let (diffuse, lobe) = (Lambertian(0.3), Phong(20.0));
    let d = |wi: V, wo: V| diffuse.eval(wi, wo);
    let p = |wi: V, wo: V| lobe.eval(wi, wo).map(|f| 0.5 * f);
    let sum = |wi: V, wo: V| {
        let (a, b) = (d(wi, wo), p(wi, wo));
        [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
    };
    let subject = gonio_verify::Subject::new("diffuse and specular", &sum);
    let both: [&gonio_verify::EvalFn; 2] = [&d, &p];
    let run = |components| {
        Checker::new(&subject, &Expectation::PHYSICAL, Effort::Quick)
            .components(components)
            .run("components")
            .unwrap()
    };
    assert_eq!(outcome(&run(&both), Property::Linearity), Outcome::Pass);
    assert_eq!(
        outcome(&run(&both[..1]), Property::Linearity),
        Outcome::Fail
    );
}

/// Many short runs of right functions: none may fail.
///
/// The three statistical verdicts and the furnace's each fail by chance with probability 1e-6 at most: in 320 runs × 4 × 1e-6,
/// so one false alarm in some 800 runs of this test would be within the design; none is expected. The p-values of the
/// χ² test are seen too: they must not be small more often than uniform ones. `GONIO_CALIBRATION_RUNS` (40, for each of
/// eight functions) makes it longer.
#[test]
fn calibration_no_false_alarms() {
    let settings = Settings {
        pairs: 100,
        directions: 2,
        density_samples: 4000,
        cells: 64,
        quadrature_evaluations: 40_000,
        ..Settings::new(Effort::Quick)
    };
    let subjects: Vec<(&str, Box<dyn Reflection>, Expectation)> = vec![
        (
            "lambertian",
            Box::new(Lambertian(1.0)),
            Expectation::PHYSICAL,
        ),
        ("phong", Box::new(Phong(30.0)), Expectation::PHYSICAL),
        (
            "ggx",
            Box::new(Ggx { alpha: [0.03; 2] }),
            Expectation::PHYSICAL,
        ),
        ("brushed", Box::new(Ggx { alpha: [0.5, 0.1] }), BRUSHED),
        (
            "varnished",
            Box::new(Varnished(Ggx { alpha: [0.3; 2] })),
            Expectation::PHYSICAL,
        ),
        ("bands", Box::new(Bands), ONE_WAY),
        (
            "rarely drawn lobe",
            Box::new(Coated(0.01, Ggx { alpha: [0.01; 2] })),
            Expectation::PHYSICAL,
        ),
        (
            "lobe at grazing",
            Box::new(Ggx { alpha: [0.002; 2] }),
            Expectation::PHYSICAL,
        ),
    ];
    let runs: usize = std::env::var("GONIO_CALIBRATION_RUNS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(40);
    let mut p_values = Vec::new();
    for (name, r, expect) in &subjects {
        let before = p_values.len();
        for run in 0..runs {
            let report = with_subject(name, r.as_ref(), |s| {
                Checker::new(s, expect, Effort::Quick)
                    .settings(settings)
                    .run(format!("calibration {run}"))
                    .unwrap()
            });
            assert!(report.passed(), "run {run}: {report}");
            let density = report.verdict(Property::SampleDensity).unwrap();
            p_values.push(density.p_value.unwrap());
        }
        let mut own = p_values[before..].to_vec();
        own.sort_by(f64::total_cmp);
        eprintln!("{name}: median p-value {:.2}", own[own.len() / 2]);
    }
    let small = p_values.iter().filter(|p| **p < 0.01).count();
    eprintln!("{} runs, {small} p-values below 0.01", p_values.len());
    // Of n uniform p-values n/100 are below 0.01; as many more as this have probability 1e-6 (Poisson, 5σ and a skewness of
    // its own at small n: 320 give 3.2 and 17).
    let expected = 0.01 * p_values.len() as f64;
    assert!(
        (small as f64) < expected + 5.0 * expected.sqrt() + 5.0,
        "{small}"
    );
    // The test isn't blunt either: the median of p-values of exact expectations is 1/2, and slack may not lift it far.
    p_values.sort_by(f64::total_cmp);
    eprintln!("median p {}", p_values[p_values.len() / 2]);
    assert!(
        p_values[p_values.len() / 2] < 0.75,
        "{}",
        p_values[p_values.len() / 2]
    );
}
