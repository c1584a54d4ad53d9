//! Small sound files of every format of measured reflection, as beginnings for the fuzz targets: `fuzz/corpus`.

use gonio_brdf::measured::{
    Adaptive, Axis, Basis, Boundary, Channel, Component, Data, Layout, Measurement, Metadata,
    Nodes, Parameterization, Scale, Side, Tables, format, tabulate,
};
use gonio_num::Vec3;
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::path::Path;

/// Format, name, layout, channels, sides.
type Case<'a> = (&'a str, &'a str, Layout, &'a [&'a str], &'a [Side]);

fn main() -> Result<(), Box<dyn Error>> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus");
    let elevations = || Axis::regular(0.0, FRAC_PI_2, 2, Boundary::Clamped);
    let turn = || Axis::regular(0.0, TAU / 3.0, 3, Boundary::Periodic(TAU));
    let half_turn = || Axis::regular(0.0, PI, 2, Boundary::Mirrored(TAU));
    let half = vec![
        Axis::new(vec![0.1, 0.9], Boundary::Clamped, Scale::SquareRoot)?,
        Axis::regular(0.4, 0.8, 2, Boundary::Clamped)?,
        Axis::regular(0.5, PI / 2.0, 2, Boundary::Periodic(PI))?,
    ];
    let merl = vec![
        Axis::new(
            vec![PI / 32.0, 9.0 * PI / 32.0],
            Boundary::Clamped,
            Scale::SquareRoot,
        )?,
        Axis::regular(PI / 8.0, PI / 4.0, 2, Boundary::Clamped)?,
        Axis::regular(PI / 4.0, PI / 2.0, 2, Boundary::Periodic(PI))?,
    ];
    let two = Basis::new("two rings", &[(45.0, 1), (90.0, 2)])?;
    let patches = Layout::Klems(two.clone(), two);
    let spherical = |axes| Layout::Grid(Parameterization::Spherical, axes);
    let tree = |rank, depth| Layout::TensorTree {
        rank,
        depth,
        tolerance: 0.0,
    };
    let rgb = ["red", "green", "blue"];
    let nm = ["450 nm", "600 nm"];
    let isotropic = spherical(vec![elevations()?, elevations()?, turn()?]);
    let mirrored = spherical(vec![elevations()?, elevations()?, half_turn()?]);
    let all = vec![elevations()?, turn()?, elevations()?, turn()?];
    let anisotropic = Layout::Grid(Parameterization::SphericalAnisotropic, all);
    let front = &[Side::ReflectionFront][..];
    let cases: Vec<Case> = vec![
        (
            "merl",
            "sound",
            Layout::Grid(Parameterization::HalfDifference, merl),
            &rgb,
            front,
        ),
        ("astm", "isotropic", isotropic.clone(), &nm, front),
        ("astm", "anisotropic", anisotropic.clone(), &rgb, front),
        ("pbrt", "sound", mirrored, &nm, front),
        (
            "radiance",
            "patches",
            patches.clone(),
            &["x", "y", "z"],
            &Side::ALL,
        ),
        ("radiance", "tree-3", tree(3, 2), &["luminance"], front),
        (
            "radiance",
            "tree-4",
            tree(4, 1),
            &["luminance", "solar"],
            front,
        ),
        (
            "gonio",
            "half",
            Layout::Grid(Parameterization::HalfDifference, half),
            &nm,
            front,
        ),
        ("gonio", "spherical", isotropic, &rgb, &Side::ALL),
        ("gonio", "anisotropic", anisotropic, &["luminance"], front),
        ("gonio", "patches", patches, &["luminance"], front),
        ("gonio", "tree", tree(3, 1), &["luminance"], front),
    ];
    for (name, file, layout, channels, sides) in cases {
        let channels: Vec<Channel> = channels.iter().map(|c| Channel::from_name(c)).collect();
        let mut f = |wi: Vec3<f64>, wo: Vec3<f64>, out: &mut [f64]| {
            for (k, x) in out.iter_mut().enumerate() {
                *x = 0.25 + 0.125 * wi.x.round() + 0.0625 * wo.y.round() + 0.5 * k as f64;
            }
        };
        let m = tabulate(&layout, &channels, sides, &mut f, &mut |_| true)?;
        let format = format::find(name).ok_or(name)?;
        for folder in [name, "any"] {
            let folder = corpus.join(folder);
            std::fs::create_dir_all(&folder)?;
            (format.write)(&folder.join(format!("{name}-{file}")), &m)?;
        }
    }
    for (file, channels, phis) in [("rgb", &rgb[..], 1), ("spectral", &nm, 3)] {
        let channels: Vec<Channel> = channels.iter().map(|c| Channel::from_name(c)).collect();
        let m = adaptive(channels, phis)?;
        for (name, folder) in [
            ("rgl", "rgl"),
            ("rgl", "any"),
            ("gonio", "gonio"),
            ("gonio", "any"),
        ] {
            let format = format::find(name).ok_or(name)?;
            let folder = corpus.join(folder);
            std::fs::create_dir_all(&folder)?;
            let adaptive = if name == "rgl" { "" } else { "adaptive-" };
            (format.write)(&folder.join(format!("{name}-{adaptive}{file}")), &m)?;
        }
    }
    // Repeated to the length of every file of this format.
    let numbers: Vec<u8> = [0.25f64, 0.5, -0.125]
        .iter()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    std::fs::create_dir_all(corpus.join("utia"))?;
    std::fs::write(
        corpus.join("utia/three-numbers"),
        [&[1], &numbers[1..]].concat(),
    )?;
    Ok(())
}

/// A small adaptive table for so many azimuths of the viewer.
fn adaptive(channels: Vec<Channel>, phis: usize) -> Result<Measurement, Box<dyn Error>> {
    let nodes = |count: usize| Nodes {
        width: 3,
        height: 2,
        values: (0..6 * count)
            .map(|k| 0.5 + 0.125 * (k % 5) as f32)
            .collect(),
    };
    let phi_i = match phis {
        1 => vec![0.0],
        _ => (0..phis)
            .map(|k| (TAU * k as f64 / (phis - 1) as f64 - PI) as f32)
            .collect(),
    };
    let one_row = |values: Vec<f32>| Nodes {
        width: 3,
        height: 1,
        values: values.into(),
    };
    let tables = Tables {
        phi_i,
        theta_i: vec![0.0, 1.5],
        ndf: one_row(vec![1.0, 0.5, 0.0]),
        sigma: one_row(vec![1.0, 0.75, 0.25]),
        vndf: nodes(2 * phis),
        luminance: nodes(2 * phis),
        jacobian: true,
    };
    let values = nodes(2 * phis * channels.len()).values;
    let data = Data::Adaptive(Adaptive::new(tables, channels.len(), values)?);
    let components = vec![Component::reflection(data)];
    Ok(Measurement::new(components, channels, Metadata::default())?)
}
