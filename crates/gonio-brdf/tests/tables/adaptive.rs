//! Adaptive tables, made here.

use super::support::*;
use gonio_brdf::Brdf;
use gonio_brdf::measured::{
    Adaptive, Channel, Component, Data, LoadOptions, Measured, Measurement, Metadata, Nodes,
    Repair, Tables,
};
use gonio_brdf::model::table::Table;
use gonio_num::Vec3;
use gonio_num::lanes::Lanes;
use gonio_radiometry::direction::spherical_direction;
use gonio_radiometry::sequence::Rng;
use gonio_verify::Effort;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;
use std::sync::Arc;

const ALPHA: f64 = 0.5;

/// GGX: D, and σ in closed form.
fn density(h: Vec3<f64>) -> f64 {
    let a2 = ALPHA * ALPHA;
    let t = h.z * h.z * (a2 - 1.0) + 1.0;
    a2 / (PI * t * t)
}

fn projected_area(w: Vec3<f64>) -> f64 {
    let s2 = w.x * w.x + w.y * w.y;
    0.5 * (w.z + (w.z * w.z + ALPHA * ALPHA * s2).sqrt())
}

/// The direction at a point of the unit square.
fn on_square(x: f64, y: f64) -> Vec3<f64> {
    spherical_direction(FRAC_PI_2 * x * x, TAU * (y - 0.5))
}

fn nodes(width: usize, height: usize, mut f: impl FnMut(f64, f64) -> f64) -> Nodes {
    let mut values = Vec::new();
    for j in 0..height {
        for i in 0..width {
            let x = i as f64 / (width - 1) as f64;
            let y = j as f64 / (height.max(2) - 1) as f64;
            values.push(f(x, y) as f32);
        }
    }
    Nodes {
        width,
        height,
        values: values.into(),
    }
}

fn stacked(all: Vec<Nodes>) -> Nodes {
    Nodes {
        width: all[0].width,
        height: all[0].height,
        values: all.iter().flat_map(|n| n.values.to_vec()).collect(),
    }
}

/// The viewers of a kind: azimuths and elevations.
fn viewers(kind: &str) -> (Vec<f32>, Vec<f32>) {
    let thetas = vec![0.0, 0.4, 0.8, 1.2, FRAC_PI_2 as f32];
    let phis = |n: usize, span: f64| {
        (0..n)
            .map(|k| (span * k as f64 / (n - 1) as f64 - PI) as f32)
            .collect()
    };
    match kind {
        "isotropic" => (vec![0.0], thetas),
        "one elevation" => (vec![0.0], vec![0.0]),
        "anisotropic" => (phis(9, TAU), thetas),
        "half" => (phis(5, PI), thetas),
        _ => (phis(3, FRAC_PI_2), thetas),
    }
}

pub const KINDS: [&str; 5] = [
    "isotropic",
    "one elevation",
    "anisotropic",
    "half",
    "quarter",
];

/// Tables of a rough material, with values `c(slice, channel, x, y)` and their mean as luminance.
pub fn adaptive(
    kind: &str,
    channels: &[Channel],
    jacobian: bool,
    mut c: impl FnMut(usize, usize, f64, f64) -> f64,
) -> Measurement {
    let (phi_i, theta_i) = viewers(kind);
    let (mut vndf, mut luminance, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut slice = 0;
    for phi in &phi_i {
        for theta in &theta_i {
            let around = if phi_i.len() > 1 {
                f64::from(*phi)
            } else {
                0.0
            };
            let wo = spherical_direction(f64::from(*theta), around);
            vndf.push(nodes(24, 17, |x, y| {
                let h = on_square(x, y);
                // Per area of the square: sinθ dθ dφ = sinθ πx 2π dA.
                density(h) * wo.dot(h).max(0.0) * (FRAC_PI_2 * x * x).sin() * x
            }));
            let mut mean = vec![0.0; 8 * 6];
            for channel in 0..channels.len() {
                let of_channel = nodes(8, 6, |x, y| c(slice, channel, x, y));
                for (sum, v) in mean.iter_mut().zip(of_channel.values.iter()) {
                    *sum += f64::from(*v);
                }
                values.extend(of_channel.values.to_vec());
            }
            let mut mean = mean.into_iter();
            luminance.push(nodes(8, 6, |_, _| mean.next().unwrap_or_default()));
            slice += 1;
        }
    }
    let tables = Tables {
        phi_i,
        theta_i,
        ndf: nodes(32, 1, |x, _| density(on_square(x, 0.5))),
        sigma: nodes(32, 2, |x, _| projected_area(on_square(x, 0.5))),
        vndf: stacked(vndf),
        luminance: stacked(luminance),
        jacobian,
    };
    let data = Adaptive::new(tables, channels.len(), values).unwrap();
    let components = vec![Component::reflection(Data::Adaptive(data))];
    let metadata = Metadata {
        description: "made here".into(),
        ..Metadata::default()
    };
    Measurement::new(components, channels.to_vec(), metadata).unwrap()
}

pub fn spectrum() -> Vec<Channel> {
    (0..5)
        .map(|k| Channel::Wavelength(420.0 + 60.0 * f64::from(k)))
        .collect()
}

/// Values that vary everywhere.
pub fn varied(slice: usize, channel: usize, x: f64, y: f64) -> f64 {
    let turn = 0.7 * slice as f64 + 0.4 * channel as f64;
    0.6 + 0.3 * (3.0 * x + turn).sin() * (TAU * y + turn).cos()
}

/// Values that are the same over the square need no square: f = c / cosθi, times D/4σ if that is left out of them. They may vary with the
/// viewer's elevation, linearly between the measured ones.
#[test]
fn constant_squares_have_closed_forms() {
    for kind in KINDS {
        let thetas = viewers(kind).1;
        for channels in [rgb(), spectrum()] {
            for jacobian in [false, true] {
                let c = |slice: usize, channel: usize, _: f64, _: f64| {
                    0.25 + 0.1 * (slice % thetas.len()) as f64 + 0.05 * channel as f64
                };
                let data = ready(adaptive(kind, &channels, jacobian, c));
                let mut rng = Rng::from_name(kind);
                for _ in 0..200 {
                    let (wi, wo) = (direction(&mut rng, 0.02), direction(&mut rng, 0.02));
                    let theta = f64::from(wo.z.acos() as f32);
                    let k = thetas.partition_point(|t| f64::from(*t) <= theta);
                    let place = if thetas.len() == 1 {
                        0.0
                    } else {
                        let (a, b) = (f64::from(thetas[k - 1]), f64::from(thetas[k]));
                        (k - 1) as f64 + (theta - a) / (b - a)
                    };
                    let scale = if jacobian {
                        let h = (wi + wo).normalize();
                        density(h) / (4.0 * projected_area(wo))
                    } else {
                        1.0
                    };
                    let found = data.eval_spectrum(wi, wo);
                    assert_eq!(found.len(), channels.len());
                    for (channel, x) in found.iter().enumerate() {
                        let c = 0.25 + 0.1 * place + 0.05 * channel as f64;
                        let expected = c * scale / wi.z;
                        // D and σ are linear over 32 nodes: an eighth of their second difference is below 1.5 %.
                        let bound = if jacobian { 0.015 } else { 1e-6 };
                        assert!(
                            (x - expected).abs() < bound * expected,
                            "{kind} {wi:?} {wo:?}: {x} {expected}"
                        );
                    }
                    if channels.len() == 3 {
                        let rgb = data.eval(wi, wo);
                        for k in 0..3 {
                            // One is of numbers rounded to single precision.
                            assert!((rgb[k] - found[k]).abs() < 1e-6 * found[k]);
                        }
                    }
                }
            }
        }
    }
}

/// A spectrum's colour is that of the spectrum that is evaluated.
#[test]
fn spectra_have_their_colours() {
    let channels = spectrum();
    let data = ready(adaptive("anisotropic", &channels, true, varied));
    let to_rgb = gonio_brdf::measured::ToRgb::new(&channels);
    let mut rng = Rng::from_name("colours");
    for _ in 0..300 {
        let (wi, wo) = (direction(&mut rng, 0.05), direction(&mut rng, 0.05));
        let expected = to_rgb.apply(&data.eval_spectrum(wi, wo));
        let found = data.eval(wi, wo);
        let largest = expected.iter().copied().fold(0.0, f64::max);
        for k in 0..3 {
            let expected = expected[k].max(0.0);
            assert!((found[k] - expected).abs() < 2e-6 * largest, "{found:?}");
        }
    }
}

#[test]
fn sampling_and_declarations_hold() {
    for (kind, channels) in [
        ("isotropic", rgb()),
        ("one elevation", spectrum()),
        ("anisotropic", rgb()),
        ("quarter", spectrum()),
    ] {
        let data = ready(adaptive(kind, &channels, true, varied));
        assert_eq!(
            data.is_isotropic(),
            !matches!(kind, "anisotropic" | "quarter")
        );
        let report = verified(kind, data, Effort::Quick);
        assert!(report.passed(), "{report}");
    }
}

/// A density that is 5 % off is found.
#[test]
fn a_wrong_density_is_noticed() {
    let data = ready(adaptive("isotropic", &rgb(), true, varied));
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
        isotropic: true,
        ..Default::default()
    };
    assert!(
        !gonio_verify::check(&subject, &expectation, Effort::Quick, "wrong")
            .unwrap()
            .passed()
    );
}

/// The integral of the density, and the share of draws that are below the horizon.
///
/// The integral is over half vectors, on which the density is smooth within the cells of `width`×`height` nodes: at the centres of equal
/// parts of each cell, some 500 or more along each axis, with dωi = 4 (ωo·ωh) dωh.
fn integral_and_lost(data: &Measured, wo: Vec3<f64>, [width, height]: [usize; 2]) -> (f64, f64) {
    let parts = |nodes: usize| (nodes - 1) * 500_usize.div_ceil(nodes - 1).max(8);
    let (w, h) = (parts(width), parts(height));
    let turn = wo.y.atan2(wo.x);
    let mut integral = 0.0;
    for j in 0..h {
        for i in 0..w {
            let (x, y) = ((i as f64 + 0.5) / w as f64, (j as f64 + 0.5) / h as f64);
            let theta = FRAC_PI_2 * x * x;
            let around = if data.is_isotropic() { turn } else { 0.0 };
            let half = spherical_direction(theta, TAU * (y - 0.5) + around);
            let cos = wo.dot(half);
            let wi = wo.reflect(half);
            if cos > 0.0 && wi.z > 0.0 {
                let solid = theta.sin() * PI * x * TAU / (w * h) as f64;
                integral += data.pdf(wi, wo) * 4.0 * cos * solid;
            }
        }
    }
    let n = 500;
    let mut lost = 0;
    for k in 0..n * n {
        let at = |k: usize| (k as f64 + 0.5) / n as f64;
        let wi = data.sample(wo, [at(k / n), at(k % n), 0.5]);
        lost += usize::from(wi.z <= 0.0);
    }
    (integral, lost as f64 / (n * n) as f64)
}

/// What the density lacks to the integral 1 is exactly the probability of drawing a direction below the horizon. 1e-3: the horizon cuts
/// cells of the quadrature.
pub fn check_integrals(name: &str, data: &Measured, nodes: [usize; 2], angles: &[f64]) {
    for deg in angles {
        let wo = spherical_direction(deg.to_radians(), 0.4);
        let (integral, lost) = integral_and_lost(data, wo, nodes);
        assert!(
            (integral + lost - 1.0).abs() < 1e-3,
            "{name} {deg}°: {integral} + {lost}"
        );
    }
}

#[test]
fn densities_integrate_to_one() {
    for kind in ["isotropic", "anisotropic"] {
        let data = ready(adaptive(kind, &rgb(), true, varied));
        let angles = [0.0, 10.0, 33.0, 50.0, 75.0, 85.0, 89.0];
        check_integrals(kind, &data, [24, 17], &angles);
    }
}

/// Negative numbers stay where they count as 0: only what they interpolate to is cut off.
#[test]
fn negative_numbers_are_counted_and_interpolated() {
    let negative = |_: usize, _: usize, x: f64, _: f64| x - 0.5;
    let made = adaptive("isotropic", &rgb(), false, negative);
    let data = ready(made.clone());
    assert_eq!(data.found().negative, 5 * 3 * 4 * 6);
    assert_eq!(data.measurement(), &made);
    assert!(data.warnings()[0].contains("360 of 720 values are negative"));
    let mut rng = Rng::from_name("negative");
    let mut dark = 0;
    for _ in 0..500 {
        let (wi, wo) = (direction(&mut rng, 0.1), direction(&mut rng, 0.1));
        let [r, g, b] = data.eval(wi, wo);
        assert!(r >= 0.0 && r == g && g == b);
        dark += u32::from(r == 0.0);
    }
    assert!(dark > 50, "{dark}");
    let with = |negative| {
        let options = LoadOptions {
            negative,
            ..LoadOptions::default()
        };
        Measured::new(Path::new("test"), made.clone(), options)
    };
    let filled = with(Repair::Fill).unwrap();
    let values = filled.measurement().components[0].data.values().clone();
    assert!(values.iter().all(|v| *v > 0.0));
    let error = with(Repair::Refuse).unwrap_err().to_string();
    assert!(
        error.contains("direction 0 of the viewer, row 0, column 0, channel 0"),
        "{error}"
    );
}

#[test]
fn lanes_and_single_numbers_read_the_same() {
    const N: usize = 4;
    let data = ready(adaptive("half", &rgb(), true, varied));
    let mut rng = Rng::from_name("lanes");
    for _ in 0..40 {
        let mut draw =
            || -> Vec<Vec3<f32>> { (0..N).map(|_| direction(&mut rng, -0.2).to_f32()).collect() };
        let (wi, wo) = (draw(), draw());
        let lanes = |v: &[Vec3<f32>]| Vec3::<Lanes<N>>::gather(v, v[0]);
        let (f, pdf) = data.eval_and_pdf(lanes(&wi), lanes(&wo));
        for k in 0..N {
            let (single, single_pdf) = (data.eval(wi[k], wo[k]), data.pdf(wi[k], wo[k]));
            assert_eq!(single_pdf.to_bits(), pdf.0[k].to_bits());
            for c in 0..3 {
                assert_eq!(single[c].to_bits(), f[c].0[k].to_bits());
            }
        }
    }
}
