//! Right reflection functions pass: no false alarms.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

use gonio_verify::specimen::{self, Each, Frosted, Ggx, Lambertian, Mirror, Phong, Pointwise};
use gonio_verify::{
    Checker, Effort, Expectation, Outcome, Precision, Property, Reflection, Report, Settings,
    Subject, SubjectFailed, check,
};

type V = gonio_num::Vec3<f64>;

fn outcome(r: &Report, p: Property) -> Outcome {
    r.verdict(p).expect("every property has a verdict").outcome
}

fn with_subject<T>(name: &str, r: &dyn Pointwise, body: impl FnOnce(&Subject) -> T) -> T {
    body(&Subject::batched(name, &Each(r)))
}

#[test]
fn right_functions_pass_whole() {
    for specimen in specimen::right() {
        let report = specimen.quick().unwrap();
        if std::env::var_os("GONIO_SHOW").is_some() {
            println!("{report}\n");
        }
        assert!(report.passed(), "{report}");
        for p in Property::ALL {
            let skipped = outcome(&report, p) == Outcome::NotApplicable;
            let of_a_mirror = ["pdf integral", "sample density"].contains(&p.name());
            let expected = match p {
                Property::Linearity | Property::SinglePrecision => true,
                Property::Horizon => specimen.relative_ior.is_some(),
                _ => of_a_mirror && specimen.name == "a mirror",
            };
            assert_eq!(skipped, expected, "{report}");
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
    let subject = Subject::new("eval only", &eval);
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
    let subject = Subject::new("f32", &eval)
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
    let subject = Subject::new("leaf", &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    let run = |s: &Subject| check(s, &Expectation::PHYSICAL, Effort::Quick, "leaf").unwrap();
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
    let subject = Subject::new("diffuse and specular", &sum);
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
/// The statistical verdicts fail by chance with probability 1e-6 at most each: with four of them and 170 suites, one false alarm in
/// some 1500 runs of this test would be within the design; none is expected. The p-values of the χ² test are seen too: they
/// must not be small more often than uniform ones. The example `calibrate` does it by the ten thousand.
#[test]
fn calibration_no_false_alarms() {
    let found = specimen::calibrate(10, specimen::short(), &|_, _| {}).unwrap();
    assert_eq!(found.failures(), 0, "{found:?}");
    let p_values = &found.p_values;
    let small = p_values.iter().filter(|p| **p < 0.01).count() as f64;
    // Of n uniform p-values n/100 are below 0.01; as many more as this have probability 1e-6 (Poisson, 5σ and a skewness of
    // its own at small n: 300 give 3 and 17).
    let expected = 0.01 * p_values.len() as f64;
    assert!(small < expected + 5.0 * expected.sqrt() + 5.0, "{small}");
    // The test isn't blunt either: the median of p-values of exact expectations is 1/2, and slack may not lift it far.
    let median = p_values[p_values.len() / 2];
    assert!(median < 0.75, "{median}");
}

/// What stops answering gives no verdict, whichever property meets it.
#[test]
fn a_subject_that_fails_ends_the_check() {
    struct Mortal(std::sync::atomic::AtomicU64, u64);
    impl Reflection for Mortal {
        fn eval(&self, wi: &[V], wo: &[V], f: &mut [[f64; 3]]) -> Result<(), SubjectFailed> {
            let asked = self.0.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            match asked < self.1 {
                true => Each(&Lambertian(0.5)).eval(wi, wo, f),
                false => Err(SubjectFailed::new("the process ended with status 3")),
            }
        }
    }
    for life in [0, 1, 5, 20] {
        let mortal = Mortal(0.into(), life);
        let subject = Subject::batched("mortal", &mortal);
        let error = check(&subject, &Expectation::PHYSICAL, Effort::Quick, "mortal").unwrap_err();
        assert_eq!(error.to_string(), "the process ended with status 3");
        // Each thread of the check may have one more question on its way.
        let asked = mortal.0.into_inner();
        assert!(asked <= life + 64, "{asked} of {life}");
    }
    let immortal = Mortal(0.into(), u64::MAX);
    let subject = Subject::batched("immortal", &immortal);
    assert!(check(&subject, &Expectation::PHYSICAL, Effort::Quick, "mortal").is_ok());
}

#[test]
fn what_is_allowed_does_not_fail() {
    let run = |allowed: &[Property]| {
        with_subject("bright", &Lambertian(1.1), |s| {
            Checker::new(s, &Expectation::PHYSICAL, Effort::Quick)
                .allow(allowed)
                .run("bright")
                .unwrap()
        })
    };
    assert!(!run(&[Property::Reciprocity]).passed());
    let report = run(&[Property::EnergyConservation]);
    assert!(report.passed(), "{report}");
    let energy = report.verdict(Property::EnergyConservation).unwrap();
    assert_eq!(energy.outcome, Outcome::Allowed);
    assert!(report.to_string().contains("! allow"), "{report}");
}

#[test]
fn progress_comes_to_its_end() {
    let seen = std::sync::Mutex::new(Vec::new());
    with_subject("diffuse", &Lambertian(0.5), |s| {
        Checker::new(s, &Expectation::PHYSICAL, Effort::Quick)
            .progress(&|done, of| seen.lock().unwrap().push((done, of)))
            .run("progress")
            .unwrap()
    });
    let mut seen = seen.into_inner().unwrap();
    seen.sort();
    let of = seen.len() as u64;
    let expected: Vec<(u64, u64)> = (1..=of).map(|k| (k, of)).collect();
    assert_eq!(seen, expected);
}

/// Ward's first model grows as 1/√cosθ, and its reflected light fades all the same; a floor under the cosine fades, too.
#[test]
fn growth_towards_grazing_is_no_jump() {
    for power in [0.25, 0.5, 0.9] {
        let eval = |wi: V, wo: V| {
            let f = 0.1 / (wi.z * wo.z).max(1e-300).powf(power);
            [if wi.z > 0.0 && wo.z > 0.0 { f } else { 0.0 }; 3]
        };
        let subject = Subject::new("growing", &eval);
        let report = check(&subject, &Expectation::PHYSICAL, Effort::Quick, "growing").unwrap();
        assert_eq!(
            outcome(&report, Property::Continuity),
            Outcome::Pass,
            "{report}"
        );
    }
}
