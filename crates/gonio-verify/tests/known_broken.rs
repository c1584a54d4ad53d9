//! Broken reflection functions are caught, by the property that the fault belongs to.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

mod support;

use gonio_verify::{Effort, Expectation, Outcome, Property, Report, check};
use std::f64::consts::{PI, TAU};
use support::*;

fn report(name: &str, r: &dyn Reflection, expect: &Expectation) -> Report {
    let report = with_subject(name, r, |s| check(s, expect, Effort::Quick, name).unwrap());
    if std::env::var_os("GONIO_SHOW").is_some() {
        println!("{report}\n");
    }
    report
}

/// Fails exactly the properties given.
fn fails(name: &str, r: &dyn Reflection, properties: &[Property]) -> Report {
    let report = report(name, r, &Expectation::PHYSICAL);
    let failed: Vec<Property> = report.failures().map(|v| v.property).collect();
    assert_eq!(failed, properties, "{report}");
    for v in report.failures() {
        assert!(v.witness.is_some(), "{report}");
    }
    report
}

const ROUGH: Ggx = Ggx { alpha: [0.3; 2] };

#[test]
fn a_density_five_percent_too_large() {
    use Property::*;
    let pdf = |r: &Ggx, wi: V, wo: V| 1.05 * r.pdf(wi, wo);
    // Samples carry the right density: it disagrees with pdf, too.
    let broken = Broken::new(ROUGH).pdf(&pdf);
    fails(
        "pdf × 1.05",
        &broken,
        &[PdfIntegral, SampleDensity, SampleWeight],
    );
    // When sample uses the wrong density consistently, weights agree with it, but not with the albedo.
    let sample = |r: &Ggx, wo: V, u: [f64; 3]| {
        let s = r.sample(wo, u)?;
        Some(gonio_verify::SubjectSample {
            pdf: 1.05 * s.pdf,
            weight: s.weight.map(|w| w / 1.05),
            ..s
        })
    };
    let broken = Broken::new(ROUGH).pdf(&pdf).sample(&sample);
    fails(
        "consistent pdf × 1.05",
        &broken,
        &[PdfIntegral, SampleDensity, SampleWeight],
    );
}

#[test]
fn a_weight_without_its_cosine() {
    let sample = |r: &Lambertian, wo: V, u: [f64; 3]| {
        let s = r.sample(wo, u)?;
        Some(gonio_verify::SubjectSample {
            weight: s.weight.map(|w| w / s.wi.z),
            ..s
        })
    };
    let broken = Broken::new(Lambertian(0.4)).sample(&sample);
    fails("missing cosine", &broken, &[Property::SampleWeight]);
}

#[test]
fn a_density_with_the_directions_exchanged() {
    use Property::*;
    let pdf = |r: &Ggx, wi: V, wo: V| r.pdf(wo, wi);
    let broken = Broken::new(ROUGH).pdf(&pdf);
    fails(
        "exchanged",
        &broken,
        &[PdfIntegral, SampleDensity, SampleWeight],
    );
}

#[test]
fn a_distribution_of_another_width() {
    use Property::*;
    // Drawn with α = 0.32, weighed and integrated with 0.3: only the χ² test and the mean weight can know.
    let sample = |r: &Ggx, wo: V, u: [f64; 3]| {
        let s = Ggx { alpha: [0.32; 2] }.sample(wo, u)?;
        consistent(r, s.wi, wo)
    };
    let broken = Broken::new(ROUGH).sample(&sample);
    let report = report("other width", &broken, &Expectation::PHYSICAL);
    let density = report.verdict(SampleDensity).unwrap();
    assert_eq!(density.outcome, Outcome::Fail, "{report}");
}

#[test]
fn a_negative_lobe() {
    let eval = |r: &Lambertian, wi: V, wo: V| {
        // One hundredth of the directions: a cone about the y axis.
        let dip = if wi.y > 0.98 && above(wi, wo) {
            -0.5
        } else {
            0.0
        };
        r.eval(wi, wo).map(|f| f + dip)
    };
    let broken = Broken::new(Lambertian(0.5)).eval(&eval);
    let report = report("negative", &broken, &Expectation::PHYSICAL);
    let v = report.verdict(Property::NonNegative).unwrap();
    assert_eq!(v.outcome, Outcome::Fail, "{report}");
    assert!(v.witness.as_ref().unwrap().wi.unwrap().xyz[1] > 0.98);
}

#[test]
fn not_a_number_at_normal_incidence() {
    // An azimuth from x / sinθ.
    let eval = |r: &Lambertian, wi: V, wo: V| {
        let sin = (wo.x * wo.x + wo.y * wo.y).sqrt();
        r.eval(wi, wo).map(|f| f * (1.0 + 0.0 * wo.x / sin))
    };
    let broken = Broken::new(Lambertian(0.5)).eval(&eval);
    let report = report("NaN at the normal", &broken, &Expectation::PHYSICAL);
    let v = report.verdict(Property::Finite).unwrap();
    assert_eq!(v.outcome, Outcome::Fail, "{report}");
    assert_eq!(v.witness.as_ref().unwrap().wo.theta_deg, 0.0);
}

#[test]
fn not_a_number_near_one() {
    let sample = |r: &Phong, wo: V, u: [f64; 3]| {
        let mut s = r.sample(wo, u)?;
        // The square root of 1 − u in f32, with u rounded up.
        if u[0] > 1.0 - 1e-7 {
            s.weight = [f64::NAN; 3];
        }
        Some(s)
    };
    let broken = Broken::new(Phong(10.0)).sample(&sample);
    let report = fails("NaN near 1", &broken, &[Property::Finite]);
    let v = report.verdict(Property::Finite).unwrap();
    assert!(v.witness.as_ref().unwrap().u.unwrap()[0] > 0.999);
}

#[test]
fn more_light_than_came() {
    let report = fails(
        "albedo 1.1",
        &Lambertian(1.1),
        &[Property::EnergyConservation],
    );
    let v = report.verdict(Property::EnergyConservation).unwrap();
    assert!((v.figure - 1.1).abs() < 1e-6 && v.confidence.unwrap().low > 1.0999);
    // Only at grazing angles: a Fresnel-like term added to white.
    let eval = |r: &Lambertian, wi: V, wo: V| {
        let graze = 0.2 * (1.0 - wo.z.max(0.0)).powi(5) * (1.0 - wi.z.max(0.0)).powi(5);
        r.eval(wi, wo).map(|f| f * (1.0 + 20.0 * graze))
    };
    let broken = Broken::new(Lambertian(1.0)).eval(&eval);
    let report = self::report("grazing", &broken, &Expectation::PHYSICAL);
    let v = report.verdict(Property::EnergyConservation).unwrap();
    assert_eq!(v.outcome, Outcome::Fail, "{report}");
    assert!(v.witness.as_ref().unwrap().wo.theta_deg > 70.0);
}

#[test]
fn samples_below_the_horizon() {
    let pdf = |r: &Phong, wi: V, wo: V| {
        if wo.z <= 0.0 {
            return 0.0;
        }
        let cos = wi.dot(V::new(-wo.x, -wo.y, wo.z)).clamp(0.0, 1.0);
        (r.0 + 1.0) / TAU * cos.powf(r.0)
    };
    let sample = |r: &Phong, wo: V, u: [f64; 3]| {
        // The lobe of Phong, kept whole.
        let cos = (1.0 - u[0]).powf(1.0 / (r.0 + 1.0));
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (s, c) = (TAU * u[1]).sin_cos();
        let frame = gonio_num::Frame::from_normal(V::new(-wo.x, -wo.y, wo.z));
        let wi = frame.to_world(V::new(sin * c, sin * s, cos));
        let p = pdf(r, wi, wo);
        (p > 0.0).then(|| gonio_verify::SubjectSample {
            wi,
            weight: r.eval(wi, wo).map(|f| f * wi.z.abs() / p),
            pdf: p,
            delta: false,
        })
    };
    let broken = Broken::new(Phong(8.0)).pdf(&pdf).sample(&sample);
    let report = fails("below the horizon", &broken, &[Property::Horizon]);
    let v = report.verdict(Property::Horizon).unwrap();
    assert!(v.witness.as_ref().unwrap().wi.unwrap().xyz[2] < 0.0);
}

/// The fault of a rough plastic whose density kept the part of the lobe below the horizon that sampling rejects.
#[test]
fn a_density_below_the_horizon_that_is_never_drawn() {
    let pdf = |r: &Lambertian, wi: V, wo: V| {
        let lost = if wi.z < 0.0 && wo.z > 0.0 {
            0.2 / TAU
        } else {
            0.0
        };
        r.pdf(wi, wo) * 0.8 + lost
    };
    let sample = |r: &Lambertian, wo: V, u: [f64; 3]| {
        let s = r.sample(wo, u).filter(|_| u[2] < 0.8)?;
        Some(gonio_verify::SubjectSample {
            pdf: 0.8 * s.pdf,
            weight: s.weight.map(|w| w / 0.8),
            ..s
        })
    };
    let broken = Broken::new(Lambertian(0.5)).pdf(&pdf).sample(&sample);
    let report = fails(
        "pdf below the horizon",
        &broken,
        &[
            Property::Horizon,
            Property::PdfIntegral,
            Property::SampleDensity,
        ],
    );
    let v = report.verdict(Property::PdfIntegral).unwrap();
    // 1 against 0.8, known to 5σ of 40,000 draws: 0.01.
    assert!((v.figure - 0.2).abs() < 0.01, "{report}");
}

#[test]
fn a_lobe_that_is_never_drawn() {
    // Diffuse and a lobe, drawn by the lobe's density where it is large only.
    let pdf = |r: &Phong, wi: V, wo: V| {
        if r.pdf(wi, wo) > 0.05 {
            r.pdf(wi, wo)
        } else {
            0.0
        }
    };
    let eval = |r: &Phong, wi: V, wo: V| {
        let d = if above(wi, wo) { 0.2 / PI } else { 0.0 };
        r.eval(wi, wo).map(|f| 0.5 * f + d)
    };
    let sample = |r: &Phong, wo: V, u: [f64; 3]| {
        let s = r.sample(wo, u).filter(|s| s.pdf > 0.05)?;
        Some(gonio_verify::SubjectSample {
            weight: eval(r, s.wi, wo).map(|f| f * s.wi.z / s.pdf),
            ..s
        })
    };
    let broken = Broken::new(Phong(50.0))
        .eval(&eval)
        .pdf(&pdf)
        .sample(&sample);
    let report = fails("unreachable", &broken, &[Property::SampleWeight]);
    let v = report.verdict(Property::SampleWeight).unwrap();
    assert!(v.detail.contains("sampling never finds it"), "{report}");
}

#[test]
fn one_over_the_cosine_is_not_reciprocal() {
    let eval = |_: &Lambertian, wi: V, wo: V| {
        let f = if above(wi, wo) {
            0.3 * wi.z / wo.z.max(0.3)
        } else {
            0.0
        };
        [f; 3]
    };
    let broken = Broken::new(Lambertian(0.3)).eval(&eval);
    let report = report("1/cos", &broken, &Expectation::PHYSICAL);
    let v = report.verdict(Property::Reciprocity).unwrap();
    assert_eq!(v.outcome, Outcome::Fail, "{report}");
    // The worst witness is truly bad: wi grazing makes the relative difference 1.
    assert!(v.figure > 0.99, "{report}");
}

#[test]
fn brushed_metal_that_declares_isotropy() {
    let brushed = Ggx { alpha: [0.3, 0.29] };
    let report = fails("brushed", &brushed, &[Property::Isotropy]);
    assert!(report.verdict(Property::Isotropy).unwrap().figure > 0.01);
}

#[test]
fn a_declared_lack_is_reported_with_its_cost() {
    let none = Expectation {
        reciprocal: false,
        energy_conserving: false,
        isotropic: false,
    };
    let report = report("declared", &Ggx { alpha: [0.3, 0.1] }, &none);
    assert!(report.passed(), "{report}");
    let isotropy = report.verdict(Property::Isotropy).unwrap();
    assert_eq!(isotropy.outcome, Outcome::Declared);
    assert!(isotropy.figure > 0.1 && isotropy.witness.is_some());
    let energy = report.verdict(Property::EnergyConservation).unwrap();
    assert_eq!(energy.outcome, Outcome::Pass);
    assert!(energy.note.as_ref().unwrap().contains("no violation"));
    let text = report.to_string();
    assert!(
        text.contains("! declared") && text.contains("worst for isotropy"),
        "{text}"
    );
    assert!(text.contains("note on reciprocity"), "{text}");
}
