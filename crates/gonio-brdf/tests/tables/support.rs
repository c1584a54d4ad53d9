//! Tables made of models.

use gonio_brdf::measured::{
    Axis, Basis, Boundary, Channel, Layout, LoadOptions, Measured, Measurement, Parameterization,
    Scale, Side, tabulate,
};
use gonio_brdf::model::table::Table;
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;
use gonio_verify::{Effort, Expectation, Report, Subject, SubjectSample};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;
use std::sync::Arc;

pub fn model(text: &str) -> Model<f64, 3> {
    ModelSpec::parse(text).unwrap().build().unwrap()
}

pub fn rgb() -> Vec<Channel> {
    vec![Channel::Red, Channel::Green, Channel::Blue]
}

/// The model as a table of RGB.
pub fn table(layout: &Layout, text: &str) -> Measurement {
    let model = model(text);
    let mut f = |wi, wo, out: &mut [f64]| out.copy_from_slice(&model.eval(wi, wo));
    tabulate(
        layout,
        &rgb(),
        &[Side::ReflectionFront],
        &mut f,
        &mut |_| true,
    )
    .unwrap()
}

pub fn ready(measurement: Measurement) -> Measured {
    Measured::new(Path::new("test"), measurement, LoadOptions::default()).unwrap()
}

fn half_axes(n: [usize; 3]) -> [Axis; 3] {
    let centres = |n: usize| (0..n).map(move |k| (k as f64 + 0.5) / n as f64);
    let theta_h = centres(n[0]).map(|x| x * x * FRAC_PI_2).collect();
    [
        Axis::new(theta_h, Boundary::Clamped, Scale::SquareRoot).unwrap(),
        Axis::regular(
            FRAC_PI_2 / (2 * n[1]) as f64,
            FRAC_PI_2 / n[1] as f64,
            n[1],
            Boundary::Clamped,
        )
        .unwrap(),
        Axis::regular(
            PI / (2 * n[2]) as f64,
            PI / n[2] as f64,
            n[2],
            Boundary::Periodic(PI),
        )
        .unwrap(),
    ]
}

/// Half and difference angles with so many nodes.
pub fn half(n: [usize; 3]) -> Layout {
    Layout::Grid(Parameterization::HalfDifference, half_axes(n).to_vec())
}

pub fn half_anisotropic(n: [usize; 3], phi: usize) -> Layout {
    let [h, d, p] = half_axes(n);
    let phi = Axis::regular(0.0, TAU / phi as f64, phi, Boundary::Periodic(TAU)).unwrap();
    Layout::Grid(
        Parameterization::HalfDifferenceAnisotropic,
        vec![h, phi, d, p],
    )
}

fn elevations(n: usize) -> Axis {
    Axis::regular(0.0, FRAC_PI_2 / (n - 1) as f64, n, Boundary::Clamped).unwrap()
}

fn azimuths(n: usize) -> Axis {
    Axis::regular(0.0, TAU / n as f64, n, Boundary::Periodic(TAU)).unwrap()
}

pub fn spherical(theta: usize, phi: usize) -> Layout {
    let axes = vec![elevations(theta), elevations(theta), azimuths(phi)];
    Layout::Grid(Parameterization::Spherical, axes)
}

pub fn spherical_anisotropic(theta: usize, phi: usize) -> Layout {
    let axes = vec![
        elevations(theta),
        azimuths(phi),
        elevations(theta),
        azimuths(phi),
    ];
    Layout::Grid(Parameterization::SphericalAnisotropic, axes)
}

pub fn klems(name: &str) -> Layout {
    let basis = Basis::known(name).unwrap();
    Layout::Klems(basis.clone(), basis)
}

pub fn tree(rank: u32, depth: u32) -> Layout {
    Layout::TensorTree {
        rank,
        depth,
        tolerance: 0.0,
    }
}

/// A direction whose z is at least `least`.
pub fn direction(rng: &mut Rng, least: f64) -> Vec3<f64> {
    let z = least + (1.0 - least) * rng.next_f64();
    let phi = TAU * rng.next_f64();
    let s = (1.0 - z * z).sqrt();
    Vec3::new(s * phi.cos(), s * phi.sin(), z)
}

/// Everything that gonio-verify checks of a table, against what its layout declares.
pub fn verified(name: &str, data: Measured, effort: Effort) -> Report {
    let reflects_only = !data.transmits();
    let expectation = Expectation {
        reciprocal: data.is_reciprocal(),
        energy_conserving: false,
        isotropic: data.is_isotropic(),
    };
    let table: Table<f64, 3> = Table::new(Arc::new(data));
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
    let mut subject = Subject::new(name, &eval)
        .with_pdf(&pdf)
        .with_sample(&sample);
    if !reflects_only {
        subject = subject.transmitting([1.0; 3]);
    }
    gonio_verify::check(&subject, &expectation, effort, name).unwrap()
}

/// Mean and relative standard deviation of the luminous weights of samples for `wo`, lost ones counted as 0.
pub fn weights(data: &Arc<Measured>, wo: Vec3<f64>, n: usize) -> (f64, f64) {
    let table: Table<f64, 3> = Table::new(Arc::clone(data));
    let mut rng = Rng::from_name("weights");
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..n {
        let u = [rng.next_f64(), rng.next_f64(), rng.next_f64()];
        let [r, g, b] = table.sample(wo, u).weight;
        let w = 0.212_639 * r + 0.715_169 * g + 0.072_192 * b;
        sum += w;
        squares += w * w;
    }
    let mean = sum / n as f64;
    (
        mean,
        (squares / n as f64 - mean * mean).max(0.0).sqrt() / mean,
    )
}

pub fn rgb_channels() -> [Channel; 3] {
    [Channel::Red, Channel::Green, Channel::Blue]
}

/// θi, θo and |φo − φi|, with nodes at both ends.
pub fn mirrored(theta: usize, delta: usize) -> Layout {
    let delta =
        Axis::regular(0.0, PI / (delta - 1) as f64, delta, Boundary::Mirrored(TAU)).unwrap();
    let axes = vec![elevations(theta), elevations(theta), delta];
    Layout::Grid(Parameterization::Spherical, axes)
}
