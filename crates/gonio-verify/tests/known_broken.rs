//! Broken reflection functions are caught where they are broken, and nothing else is blamed. (That each fault is caught by its property
//! is what the book's page says, and its test holds it true.)

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

use gonio_num::{Real, Vec3};
use gonio_verify::specimen::{self, Caught, Ggx, Lambertian, Specimen, right};
use gonio_verify::{Effort, Expectation, Outcome, Property, Subject, check};
use std::f64::consts::PI;

/// Looks at a specimen; `GONIO_SHOW` prints the report.
fn look(specimen: &Specimen) -> Caught {
    let caught = Caught::of(specimen).unwrap();
    if std::env::var_os("GONIO_SHOW").is_some() {
        println!("{}\n", caught.report);
    }
    caught
}

/// The fault stands alone where it can: nothing else is blamed.
#[test]
fn what_is_right_beside_a_fault_is_not_blamed() {
    for (name, others) in [
        ("albedo 1.01", &[][..]),
        ("weight without its cosine", &[]),
        ("brushed metal that is declared isotropic", &[]),
        ("a diffuse part that is never drawn", &[]),
        (
            "1/(cosθi cosθo) without masking: a jump at the horizon",
            &[],
        ),
        (
            "a density 5 % too large",
            &[Property::SampleDensity, Property::SampleWeight],
        ),
    ] {
        let all = specimen::broken();
        let specimen = all.iter().find(|s| s.name == name).unwrap();
        let caught = look(specimen);
        assert_eq!(caught.others(), others, "{}", caught.report);
    }
}

#[test]
fn witnesses_point_at_the_fault() {
    let all = specimen::broken();
    let witness = |name: &str| {
        let specimen = all.iter().find(|s| s.name.starts_with(name)).unwrap();
        let caught = look(specimen);
        caught.verdict().unwrap().witness.clone().unwrap()
    };
    assert_eq!(witness("an azimuth from x/sinθ").wo.theta_deg, 0.0);
    assert!(witness("√(1 − u)").u.unwrap()[0] > 0.999);
    assert!(witness("a dip below zero").wi.unwrap().xyz[1] > 0.98);
    assert!(witness("draws below the horizon").wi.unwrap().xyz[2] < 0.0);
    assert!(witness("diffuse kept at 1 − F0").wo.theta_deg > 70.0);
    assert!(witness("1/(cosθi cosθo)").wi.unwrap().theta_deg > 89.999);
}

#[test]
fn figures_are_known() {
    let albedo = Specimen::right("albedo 1.1", Lambertian(1.1))
        .quick()
        .unwrap();
    let v = albedo.verdict(Property::EnergyConservation).unwrap();
    assert!((v.figure - 1.1).abs() < 1e-6 && v.confidence.unwrap().low > 1.0999);
    let loss = albedo.verdict(Property::EnergyLoss).unwrap();
    // The third channel has a quarter.
    assert!((loss.figure - (1.0 - 0.275)).abs() < 1e-6, "{albedo}");
    assert_eq!(loss.outcome, Outcome::Information);
    assert_eq!(right().len(), 17);
}

#[test]
fn a_declared_lack_is_reported_with_its_cost() {
    let none = Expectation {
        reciprocal: false,
        energy_conserving: false,
        isotropic: false,
    };
    let specimen = Specimen {
        expect: none,
        ..Specimen::right("declared", Ggx { alpha: [0.3, 0.1] })
    };
    let report = look(&specimen).report;
    assert!(report.passed(), "{report}");
    let isotropy = report.verdict(Property::Isotropy).unwrap();
    assert_eq!(isotropy.outcome, Outcome::Declared);
    assert!(isotropy.figure > 0.1 && isotropy.witness.is_some());
    // What is declared as lacking and holds is too cautious; what lacks isn't.
    let declarations = report.verdict(Property::Declarations).unwrap();
    assert_eq!(declarations.outcome, Outcome::Information);
    assert_eq!(declarations.figure, 2.0);
    assert!(
        declarations.detail.contains("reciprocity, energy"),
        "{report}"
    );
    assert!(report.to_string().contains("! lacks isotropy"), "{report}");
}

/// An albedo above 1 between the angles that are looked at first (…, 32.9°, 47.1°, …), where it is 0.93 and below.
#[test]
fn energy_between_two_angles_is_found() {
    let albedo = |wo: Vec3<f64>| {
        let theta: f64 = wo.z.min(1.0);
        let off = (Real::acos(theta).to_degrees() - 38.0) / 4.0;
        let bump: f64 = Real::exp(-off * off);
        0.9 + 0.15 * bump
    };
    for theta in [32.9f64, 47.1] {
        let z: f64 = Real::cos(theta.to_radians());
        assert!(albedo(Vec3::new(0.0, 0.0, z)) < 0.94);
    }
    let eval = |wi: Vec3<f64>, wo: Vec3<f64>| match wi.z > 0.0 && wo.z > 0.0 {
        true => [albedo(wo) / PI; 3],
        false => [0.0; 3],
    };
    let subject = Subject::new("a bump at 38°", &eval);
    let report = check(&subject, &Expectation::PHYSICAL, Effort::Quick, "bump").unwrap();
    let v = report.verdict(Property::EnergyConservation).unwrap();
    assert!(v.outcome == Outcome::Fail && v.figure > 1.0, "{report}");
}
