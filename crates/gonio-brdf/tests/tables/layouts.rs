//! Each layout: near its model, sampled exactly, the same over lanes.

use super::support::*;
use gonio_brdf::Brdf;
use gonio_brdf::measured::{
    Layout, LoadOptions, Measured, Missing, Repair, Select, Side, tabulate,
};
use gonio_brdf::model::table::Table;
use gonio_num::Vec3;
use gonio_num::dual::Dual;
use gonio_num::lanes::Lanes;
use gonio_radiometry::direction::spherical_direction;
use gonio_radiometry::sequence::Rng;
use gonio_verify::Effort;
use std::path::Path;
use std::sync::Arc;

fn layouts() -> Vec<(&'static str, Layout, &'static str)> {
    vec![
        ("half", half([32, 16, 12]), "ggx:roughness=0.5,metal=gold"),
        (
            "half-anisotropic",
            half_anisotropic([20, 10, 8], 16),
            "ggx:alpha_x=0.3,alpha_y=0.6",
        ),
        (
            "spherical",
            spherical(19, 36),
            "ggx:roughness=0.6,metal=copper",
        ),
        (
            "spherical-anisotropic",
            spherical_anisotropic(7, 16),
            "ggx:alpha_x=0.4,alpha_y=0.8",
        ),
        (
            "klems",
            klems("LBNL/Klems Quarter"),
            "ggx:roughness=0.7,metal=gold",
        ),
        ("tree-3", tree(3, 5), "ggx:roughness=0.6,metal=gold"),
        (
            "tree-4",
            tree(4, 3),
            "ggx:alpha_x=0.4,alpha_y=0.8,metal=gold",
        ),
    ]
}

#[test]
fn sampling_and_declarations_hold() {
    for (name, layout, text) in layouts() {
        let report = verified(name, ready(table(&layout, text)), Effort::Quick);
        assert!(report.passed(), "{report}");
    }
}

/// The samplers follow f·cosθi: the relative spread of the weights, lost samples included, is that of what is constant in a cell. Patches and
/// squares have none in luminance, and these models are grey or tinted the same everywhere but for Fresnel's effect.
#[test]
fn weights_vary_little() {
    for (name, layout, text) in layouts() {
        let data = Arc::new(ready(table(&layout, text)));
        let bound = match name {
            "klems" | "tree-3" | "tree-4" => 1e-3,
            "spherical" | "half" => 0.2,
            // Fewer viewers than a highlight that turns and is cut off by the horizon would like.
            _ => 0.5,
        };
        for theta in [0.0f64, 20.0, 45.0, 65.0, 80.0] {
            let wo: Vec3<f64> = spherical_direction(theta.to_radians(), 0.3);
            let (mean, spread) = weights(&data, wo, 10_000);
            assert!(
                mean > 0.0 && spread < bound,
                "{name} {theta}: {mean:.4} ± {spread:.4}"
            );
        }
    }
}

/// A density that is 5 % off is found: what the test above would miss is smaller.
#[test]
fn a_wrong_density_is_noticed() {
    let data = ready(table(&half([16, 8, 6]), "ggx:roughness=0.6"));
    let table: Table<f64, 3> = Table::new(Arc::new(data));
    let eval = |wi: Vec3<f64>, wo: Vec3<f64>| table.eval(wi, wo);
    let pdf = |wi: Vec3<f64>, wo: Vec3<f64>| 1.05 * table.pdf(wi, wo);
    let sample = |wo: Vec3<f64>, u: [f64; 3]| {
        let s = table.sample(wo, u);
        (s.pdf > 0.0).then_some(gonio_verify::SubjectSample {
            wi: s.wi,
            weight: s.weight,
            pdf: s.pdf,
            delta: s.delta,
        })
    };
    let subject = gonio_verify::Subject::new("wrong", &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    let expectation = gonio_verify::Expectation {
        energy_conserving: false,
        ..Default::default()
    };
    assert!(
        !gonio_verify::check(&subject, &expectation, Effort::Quick, "wrong")
            .unwrap()
            .passed()
    );
}

/// At a node the interpolant is the model; half-way between nodes it is off by an eighth of the second difference. These tables have
/// steps of 2° (θd), 4.5° (θi, θo) and 5° to 10° in azimuth where lobes are some 30° wide: (step/width)²/8 is below 2 %, and
/// a few times that where several axes add up or f has a peak.
#[test]
fn tables_are_near_their_models() {
    for (layout, text, least, bound) in [
        (
            half([60, 45, 36]),
            "ggx:roughness=0.6,metal=gold",
            0.1,
            0.02,
        ),
        (spherical(31, 72), "ggx:roughness=0.7,metal=gold", 0.3, 0.05),
        (
            half_anisotropic([40, 20, 18], 36),
            "ggx:alpha_x=0.4,alpha_y=0.6",
            0.2,
            0.08,
        ),
    ] {
        let truth = model(text);
        let table = ready(table(&layout, text));
        let mut rng = Rng::from_name("near");
        for _ in 0..2000 {
            let (wi, wo) = (direction(&mut rng, least), direction(&mut rng, least));
            let (f, g) = (table.eval(wi, wo), truth.eval(wi, wo));
            for k in 0..3 {
                assert!(
                    (f[k] - g[k]).abs() < bound * g[k] + 1e-3,
                    "{text} {wi:?} {wo:?}: {f:?} {g:?}"
                );
            }
        }
    }
}

#[test]
fn interpolation_is_continuous() {
    for (name, layout, text) in layouts() {
        if name.starts_with("tree") || name == "klems" {
            continue;
        }
        let data = ready(table(&layout, text));
        let mut rng = Rng::from_name("continuous");
        for _ in 0..500 {
            let (wi, wo) = (direction(&mut rng, 0.3), direction(&mut rng, 0.3));
            // On the border of azimuth too.
            let wi =
                Vec3::new(wi.x, if rng.next_f64() < 0.5 { 0.0 } else { wi.y }, wi.z).normalize();
            let moved = Vec3::new(wi.x, wi.y - 1e-9, wi.z);
            let (f, g) = (data.eval(wi, wo), data.eval(moved, wo));
            assert!(
                (f[0] - g[0]).abs() < 1e-5 * (1.0 + f[0]),
                "{name} {wi:?} {wo:?} {f:?} {g:?}"
            );
        }
    }
}

/// Each lane has the bits of a single call. (Not through `batch`: that would compile every model here.)
#[test]
fn lanes_and_single_numbers_read_the_same() {
    const N: usize = 8;
    for (name, layout, text) in layouts() {
        let data = ready(table(&layout, text));
        let mut rng = Rng::from_name("lanes");
        for step in 0..40 {
            let least = if step % 3 == 0 { -1.0 } else { 0.0 };
            let mut draw = || -> Vec<Vec3<f32>> {
                (0..N)
                    .map(|_| direction(&mut rng, least).to_f32())
                    .collect()
            };
            let (wi, wo, u) = (draw(), draw(), draw());
            let lanes = |v: &[Vec3<f32>]| Vec3::<Lanes<N>>::gather(v, v[0]);
            let (li, lo) = (lanes(&wi), lanes(&wo));
            // Numbers in [0, 1), one for each lane.
            let unit = |k: usize| u[k].x.abs().min(0.999_999);
            let lu = [0, 1, 2].map(|shift| {
                let mut x = Lanes([0.0; N]);
                for k in 0..N {
                    x.0[k] = unit((k + shift) % N);
                }
                x
            });
            let (f, pdf, drawn) = (data.eval(li, lo), data.pdf(li, lo), data.sample(lo, lu));
            for k in 0..N {
                let single = data.eval(wi[k], wo[k]);
                for c in 0..3 {
                    assert_eq!(
                        single[c].to_bits(),
                        f[c].0[k].to_bits(),
                        "{name} {:?} {:?}",
                        wi[k],
                        wo[k]
                    );
                }
                assert_eq!(
                    data.pdf(wi[k], wo[k]).to_bits(),
                    pdf.0[k].to_bits(),
                    "{name}"
                );
                let u = [0, 1, 2].map(|shift| unit((k + shift) % N));
                assert_eq!(
                    data.sample(wo[k], u),
                    drawn.extract(k),
                    "{name} {:?}",
                    wo[k]
                );
            }
        }
    }
}

/// Derivatives of the interpolant are its slopes within a cell.
#[test]
fn derivatives_are_slopes() {
    for (name, layout, text) in layouts() {
        let data = ready(table(&layout, text));
        let mut rng = Rng::from_name("slopes");
        for _ in 0..100 {
            let (wi, wo) = (direction(&mut rng, 0.2), direction(&mut rng, 0.2));
            let dual = |v: Vec3<f64>| {
                Vec3::new(
                    Dual::<f64, 1>::constant(v.x),
                    Dual::constant(v.y),
                    Dual::constant(v.z),
                )
            };
            let mut moving = dual(wi);
            moving.x = Dual::variable(wi.x, 0);
            let d = data.eval(moving, dual(wo))[0].partials[0];
            let h = 1e-7;
            let at = |x: f64| data.eval(Vec3::new(wi.x + x, wi.y, wi.z), wo)[0];
            let (left, middle, right) = (at(-h), at(0.0), at(h));
            // Where a border lies between, the slopes of both sides differ.
            let (a, b) = ((middle - left) / h, (right - middle) / h);
            if (a - b).abs() < 1e-4 * (1.0 + a.abs()) {
                assert!(
                    (d - a).abs() < 1e-3 * (1.0 + a.abs()),
                    "{name} {wi:?} {wo:?}: {d} {a} {b}"
                );
            }
            assert!(d.is_finite());
        }
    }
}

/// Single precision finds another cell only next to a border, and otherwise rounds by some 1e-6 of the coordinate times the slope.
#[test]
fn single_precision_agrees() {
    for (name, layout, text) in layouts() {
        let data = ready(table(&layout, text));
        let mut rng = Rng::from_name("single");
        let mut apart = 0;
        for _ in 0..1000 {
            let (wi, wo) = (direction(&mut rng, 0.05), direction(&mut rng, 0.05));
            let f = data.eval(wi, wo)[1];
            let g = f64::from(data.eval(wi.to_f32(), wo.to_f32())[1]);
            apart += u32::from((f - g).abs() > 2e-4 * (f + 0.01));
        }
        assert!(apart <= 2, "{name}: {apart} of 1000 pairs differ");
    }
}

#[test]
fn every_side_is_evaluated_where_it_belongs() {
    let value = |wi: Vec3<f64>, wo: Vec3<f64>| match (wi.z > 0.0, wo.z > 0.0) {
        (true, true) => 0.1 + 0.02 * wi.x,
        (false, false) => 0.2 + 0.02 * wi.x,
        (true, false) => 0.3,
        (false, true) => 0.4,
    };
    let mut f = |wi, wo, out: &mut [f64]| out.fill(value(wi, wo));
    let layout = klems("LBNL/Klems Quarter");
    let m = tabulate(&layout, &rgb(), &Side::ALL, &mut f, &mut |_| true).unwrap();
    let with = |select| {
        let options = LoadOptions {
            select,
            ..LoadOptions::default()
        };
        Measured::new(Path::new("test"), m.clone(), options).unwrap()
    };
    let up: Vec3<f64> = Vec3::new(0.0, 0.6, 0.8);
    let down: Vec3<f64> = Vec3::new(0.0, 0.6, -0.8);
    let all = with(Select::All);
    for (wi, wo, expected) in [
        (up, up, 0.1),
        (down, down, 0.2),
        (up, down, 0.3),
        (down, up, 0.4),
    ] {
        assert!(
            (all.eval(wi, wo)[0] - expected).abs() < 1e-6,
            "{wi:?} {wo:?}"
        );
    }
    assert!(all.transmits() && all.found().unused.is_empty());
    let front = with(Select::Front);
    assert_eq!(front.sides(), [Side::ReflectionFront]);
    assert_eq!(front.eval(up, down)[0], 0.0);
    assert_eq!(front.found().unused.len(), 3);
    let through = with(Select::One(Side::TransmissionFront));
    assert!((through.eval(up, down)[0] - 0.3).abs() < 1e-6);
    assert_eq!(through.eval(down, up)[0], 0.0);
    // The back is looked at from the front, turned over about y: x becomes −x.
    let back = with(Select::One(Side::ReflectionBack));
    let right: Vec3<f64> = Vec3::new(0.8, 0.0, 0.6);
    let left = Vec3::new(-0.8, 0.0, 0.6);
    assert!(back.eval(right, up)[0] < back.eval(left, up)[0]);
    assert!((back.eval(up, up)[0] - 0.2).abs() < 1e-6);
    let report = verified("all sides", all, Effort::Quick);
    assert!(report.passed(), "{report}");
}

#[test]
fn negative_and_missing_values_are_replaced_and_counted() {
    let mut m = table(&spherical(5, 8), "lambertian:0.5");
    let gonio_brdf::measured::Data::Grid(grid) = &m.components[0].data else {
        panic!()
    };
    let mut values = grid.values().to_vec();
    values[3 * 8] = -1.0;
    values[3 * 70 + 1] = f32::NAN;
    values[3 * 70 + 2] = f32::NAN;
    let axes = grid.axes().to_vec();
    m.components[0].data = gonio_brdf::measured::Data::Grid(
        gonio_brdf::measured::Grid::new(grid.parameterization(), axes, 3, values).unwrap(),
    );
    let with = |negative, missing| {
        let options = LoadOptions {
            negative,
            missing: Missing(missing),
            ..LoadOptions::default()
        };
        Measured::new(Path::new("test"), m.clone(), options)
    };
    let zero = with(Repair::Zero, Repair::Fill).unwrap();
    let found = zero.found();
    assert_eq!(
        (found.negative, found.missing, found.values),
        (1, 2, 3 * 200)
    );
    assert_eq!(found.first_negative.as_deref(), Some("node [0, 1, 0]"));
    let values = zero.measurement().components[0].data.values();
    let half = (0.5 / std::f64::consts::PI) as f32;
    assert_eq!(values[3 * 8], 0.0);
    // Filled from neighbours that are all the same.
    assert!((values[3 * 70 + 1] - half).abs() < 1e-7);
    let warnings = zero.warnings();
    assert!(
        warnings[0].contains("1 of 600 values is negative") && warnings[1].contains("2 of 600"),
        "{warnings:?}"
    );
    let filled = with(Repair::Fill, Repair::Fill).unwrap();
    assert!((filled.measurement().components[0].data.values()[3 * 8] - half).abs() < 1e-7);
    for (options, word) in [
        ((Repair::Refuse, Repair::Fill), "-1"),
        ((Repair::Zero, Repair::Refuse), "NaN"),
    ] {
        let error = with(options.0, options.1).unwrap_err().to_string();
        assert!(error.contains(word) && error.contains("node"), "{error}");
    }
}

#[test]
fn black_tables_are_harmless() {
    for (_, layout, _) in layouts() {
        let data = Arc::new(ready(table(&layout, "lambertian:0")));
        let table: Table<f64, 3> = Table::new(data);
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let s = table.sample(wo, [0.3, 0.6, 0.9]);
        assert!(s.pdf > 0.0 && s.weight == [0.0; 3]);
        assert_eq!(table.pdf(s.wi, wo), s.pdf);
    }
}

/// A spectral table gives its spectrum, and the colour of it under D65.
#[test]
fn spectra_are_kept() {
    use gonio_brdf::measured::Channel;
    use gonio_radiometry::colour::{RgbSpace, rgb_of_reflectance};
    use gonio_radiometry::spectrum::{Illuminant, Spectrum};
    let nm: Vec<f64> = (0..31).map(|k| f64::from(400 + 10 * k)).collect();
    let channels: Vec<Channel> = nm.iter().map(|nm| Channel::Wavelength(*nm)).collect();
    let reflectance = |nm: f64| 0.2 + 0.6 * (nm - 400.0) / 300.0;
    let mut f = |_, _, out: &mut [f64]| {
        for (x, nm) in out.iter_mut().zip(&nm) {
            *x = reflectance(*nm);
        }
    };
    let m = tabulate(
        &half([4, 3, 2]),
        &channels,
        &[Side::ReflectionFront],
        &mut f,
        &mut |_| true,
    )
    .unwrap();
    let data = ready(m);
    let (wi, wo) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8));
    let spectrum = data.eval_spectrum(wi, wo);
    for (x, nm) in spectrum.iter().zip(&nm) {
        assert!((x - reflectance(*nm)).abs() < 1e-6);
    }
    assert_eq!(
        data.eval_spectrum(wi, Vec3::new(0.0, 0.6, -0.8)),
        vec![0.0; 31]
    );
    let truth =
        Spectrum::irregular(nm.clone(), nm.iter().map(|nm| reflectance(*nm)).collect()).unwrap();
    let truth = rgb_of_reflectance(&truth, &Illuminant::D65.spectrum(), &RgbSpace::SRGB);
    let rgb = data.eval(wi, wo);
    for k in 0..3 {
        assert!((rgb[k] - truth[k]).abs() < 1e-5, "{rgb:?} {truth:?}");
    }
    assert!(!data.is_grey());
}
