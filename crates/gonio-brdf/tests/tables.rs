//! Tables in memory and the MERL format, on tables made from models whose truth is known.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

use gonio_brdf::measured::{Axes, Tabulated, merl};
use gonio_brdf::model::table::Table;
use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;
use gonio_verify::{Effort, Expectation, Subject, SubjectSample};
use std::path::Path;
use std::sync::Arc;

const MERL: Axes = Axes::HalfDifference {
    theta_h: 90,
    theta_d: 90,
    phi_d: 180,
};
const SMALL: Axes = Axes::HalfDifference {
    theta_h: 24,
    theta_d: 12,
    phi_d: 16,
};
const ANY: Axes = Axes::Directions {
    theta_i: 12,
    phi_i: 24,
    theta_r: 12,
    phi_r: 24,
};

fn model(text: &str) -> Model<f64, 3> {
    ModelSpec::parse(text).unwrap().build().unwrap()
}

fn table(axes: Axes, text: &str) -> Tabulated {
    let model = model(text);
    Tabulated::from_fn(axes, |wi, wo| model.eval(wi, wo)).unwrap()
}

fn direction(rng: &mut Rng) -> Vec3<f64> {
    let z = 0.3 + 0.7 * rng.next_f64();
    let phi = std::f64::consts::TAU * rng.next_f64();
    let s = (1.0 - z * z).sqrt();
    Vec3::new(s * phi.cos(), s * phi.sin(), z)
}

#[test]
fn interpolation_is_near_the_model_it_was_made_of() {
    let truth = model("ggx:roughness=0.6,metal=gold");
    let table = table(MERL, "ggx:roughness=0.6,metal=gold");
    let mut rng = Rng::from_name("interpolation");
    for _ in 0..2000 {
        let (wi, wo) = (direction(&mut rng), direction(&mut rng));
        let (f, g) = (table.eval(wi, wo), truth.eval(wi, wo));
        for k in 0..3 {
            // Second differences over steps of 1° and of √θh/90: below half a per cent for this lobe.
            assert!(
                (f[k] - g[k]).abs() < 5e-3 * g[k] + 1e-6,
                "{wi:?} {wo:?}: {f:?} {g:?}"
            );
        }
    }
}

#[test]
fn interpolation_is_continuous_and_exact_at_cell_centres() {
    for axes in [SMALL, ANY] {
        let table = table(axes, "ggx:roughness=0.7,metal=copper");
        for cell in (0..axes.cells()).step_by(37) {
            let Some((wi, wo)) = axes.directions(cell) else {
                continue;
            };
            let f = table.eval(wi, wo);
            for k in 0..3 {
                let value = f64::from(table.values()[cell][k]);
                assert!(
                    (f[k] - value).abs() < 1e-9 + 1e-9 * value,
                    "{axes:?} {cell}"
                );
            }
        }
        // A step of 1e-9 changes the value by that order wherever it is made, across cell borders and φ = 0 too.
        let mut rng = Rng::from_name("continuous");
        for _ in 0..500 {
            let (wi, wo) = (direction(&mut rng), direction(&mut rng));
            let wi =
                Vec3::new(wi.x, if rng.next_f64() < 0.5 { 0.0 } else { wi.y }, wi.z).normalize();
            let moved = Vec3::new(wi.x, wi.y - 1e-9, wi.z);
            let (f, g) = (table.eval(wi, wo), table.eval(moved, wo));
            assert!(
                (f[0] - g[0]).abs() < 1e-6 * (1.0 + f[0]),
                "{axes:?} {wi:?} {wo:?}"
            );
        }
    }
}

#[test]
fn sampling_and_declarations_hold() {
    for (axes, text, reciprocal) in [
        (SMALL, "ggx:roughness=0.6,metal=gold", true),
        (ANY, "ggx:alpha_x=0.3,alpha_y=0.7", false),
    ] {
        let table: Table<f64, 3> = Table::new(Arc::new(table(axes, text)));
        let eval = |wi: Vec3<f64>, wo: Vec3<f64>| table.eval(wi, wo);
        let pdf = |wi: Vec3<f64>, wo: Vec3<f64>| table.pdf(wi, wo);
        let sample = |wo: Vec3<f64>, u: [f64; 3]| {
            let s = table.sample(wo, u);
            (s.pdf > 0.0).then_some(SubjectSample {
                wi: s.wi,
                weight: s.weight,
                pdf: s.pdf,
                delta: s.delta,
            })
        };
        let subject = Subject::new("table", &eval)
            .with_pdf(&pdf)
            .with_sample(&sample);
        let expectation = Expectation {
            reciprocal,
            energy_conserving: false,
            isotropic: reciprocal,
        };
        let report = gonio_verify::check(&subject, &expectation, Effort::Quick, "table");
        assert!(report.passed(), "{report}");
    }
}

#[test]
fn lanes_and_single_calls_read_the_same() {
    let model: Model<f32, 3> =
        Model::Table(Table::new(Arc::new(table(SMALL, "ggx:roughness=0.6"))));
    let (wi, wo) = (Vec3::new(0.6f32, 0.0, 0.8), Vec3::new(0.0, -0.6, 0.8));
    let f = model.eval(wi, wo);
    let mut out = [[0.0; 3]; 3];
    let [r, g, b] = &mut out;
    let all = |v: Vec3<f32>| ([v.x; 3], [v.y; 3], [v.z; 3]);
    let (i, o) = (all(wi), all(wo));
    gonio_brdf::batch::eval(
        &model,
        gonio_brdf::batch::Directions {
            x: &i.0,
            y: &i.1,
            z: &i.2,
        },
        gonio_brdf::batch::Directions {
            x: &o.0,
            y: &o.1,
            z: &o.2,
        },
        [r, g, b],
    );
    for k in 0..3 {
        assert_eq!(out[k], [f[k]; 3]);
    }
    assert!(!model.is_recordable());
}

#[test]
fn merl_files_are_read_as_written() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("gold.binary");
    let table = table(MERL, "ggx:roughness=0.6,metal=gold");
    merl::write(&path, &table).unwrap();
    assert_eq!(
        std::fs::metadata(&path).unwrap().len(),
        12 + 24 * 90 * 90 * 180
    );
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let read = merl::read(&path).unwrap();
    assert_eq!(read.values(), table.values());
    assert_eq!(read.negative_values(), 0);
    let spec = ModelSpec::parse(&format!("merl:{},scale=0.5", path.display())).unwrap();
    let half: Model<f64, 3> = spec.build().unwrap();
    let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.6, 0.0, 0.8));
    assert_eq!(half.eval(wi, wo)[0], 0.5 * table.eval(wi, wo)[0]);
    // N = 4 has no meaning for RGB data.
    assert!(matches!(
        spec.build::<f64, 4>(),
        Err(BrdfError::Unsupported { .. })
    ));
}

#[test]
fn negative_values_are_counted_and_become_zero() {
    let axes = Axes::HalfDifference {
        theta_h: 2,
        theta_d: 1,
        phi_d: 1,
    };
    let table = Tabulated::new(axes, vec![[1.0, -0.5, 0.0], [-1.0, 2.0, -0.0]]).unwrap();
    assert_eq!(table.negative_values(), 2);
    assert_eq!(table.values()[0], [1.0, 0.0, 0.0]);
    let up = Vec3::new(0.0, 0.0, 1.0);
    assert_eq!(table.eval(up, up)[1], 0.0);
}

fn bytes(dims: [i32; 3], value: f64, count: usize) -> Vec<u8> {
    let mut out: Vec<u8> = dims.iter().flat_map(|d| d.to_le_bytes()).collect();
    for _ in 0..count {
        out.extend(value.to_le_bytes());
    }
    out
}

#[test]
fn broken_files_give_one_clear_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.binary");
    let mut not_finite = bytes([2, 2, 2], 1.0, 24);
    not_finite[12 + 8 * 9..12 + 8 * 10].copy_from_slice(&f64::NAN.to_le_bytes());
    for (content, words) in [
        (vec![], vec!["header", "0 bytes", "12 bytes"]),
        (vec![1, 2, 3], vec!["header", "3 bytes"]),
        (
            bytes([90, 90, 180], 0.0, 10),
            vec!["whole file", "92 bytes", "34992012 bytes", "90×90×180"],
        ),
        (
            bytes([2, 2, 2], 0.0, 25),
            vec!["whole file", "212 bytes", "204 bytes"],
        ),
        (
            bytes([i32::MAX, i32::MAX, i32::MAX], 0.0, 1),
            vec!["byte 0", "2147483647 cells", "1 to 4096"],
        ),
        (
            bytes([4096, 4096, 4096], 0.0, 1),
            vec!["whole file", "20 bytes"],
        ),
        (bytes([2, -2, 2], 0.0, 24), vec!["byte 4", "-2 cells"]),
        (bytes([0, 0, 0], 0.0, 0), vec!["byte 0", "0 cells"]),
        (
            bytes([2, 2, 2], f64::INFINITY, 24),
            vec!["red plane", "cell 0", "inf", "finite"],
        ),
        (bytes([2, 2, 2], 1e300, 24), vec!["red plane", "finite"]),
        (not_finite, vec!["green plane", "cell 1", "byte 84", "NaN"]),
    ] {
        std::fs::write(&path, content).unwrap();
        let error = merl::read(&path).unwrap_err().to_string();
        for word in words {
            assert!(error.contains(word), "{error} lacks {word}");
        }
        assert!(error.contains("broken.binary"), "{error}");
    }
    assert!(matches!(
        merl::read(Path::new("/nowhere/at.all")),
        Err(BrdfError::Io { .. })
    ));
    assert!(merl::read(folder.path()).is_err());
    let table = table(SMALL, "lambertian");
    assert!(merl::write(&folder.path().join("no/folder.binary"), &table).is_err());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn tables_must_fit_their_axes() {
    assert!(Tabulated::new(SMALL, vec![[0.0; 3]]).is_err());
    let none = Axes::HalfDifference {
        theta_h: 0,
        theta_d: 1,
        phi_d: 1,
    };
    assert!(Tabulated::new(none, vec![]).is_err());
    let one = Axes::HalfDifference {
        theta_h: 1,
        theta_d: 1,
        phi_d: 1,
    };
    assert!(Tabulated::new(one, vec![[f32::NAN, 0.0, 0.0]]).is_err());
    // All black: nothing to sample by but the cosine.
    let black = Tabulated::new(one, vec![[0.0; 3]]).unwrap();
    let up = Vec3::new(0.0, 0.0, 1.0);
    assert!(black.pdf(up, up).is_finite());
    assert_eq!(black.eval(up, up), [0.0; 3]);
}
