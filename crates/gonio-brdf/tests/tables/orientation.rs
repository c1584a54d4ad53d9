//! Nothing is turned or mirrored: labelled functions through every format.

use super::support::*;
use gonio_brdf::measured::{Channel, Layout, LoadOptions, Measured, Side, format, load, tabulate};
use gonio_num::Vec3;
use gonio_radiometry::sequence::Rng;

type Function = fn(Vec3<f64>, Vec3<f64>) -> f64;
type Case<'a> = (&'a str, Layout, &'a [Channel], &'a [Side], Function, f64);

/// Every axis of both directions tells apart, and the two directions from each other.
fn anisotropic(wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
    1.0 + 0.30 * wi.x + 0.17 * wi.y + 0.22 * wo.x - 0.13 * wo.y + 0.1 * wi.x * wo.y + 0.15 * wi.z
}

/// As much as half and difference angles with half a turn can tell: the same with the directions exchanged.
fn anisotropic_reciprocal(wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
    0.5 * (anisotropic(wi, wo) + anisotropic(wo, wi))
}

/// Isotropic, yet not the same mirrored, nor with the directions exchanged.
fn isotropic(wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
    let sine = wi.x * wo.y - wi.y * wo.x;
    let cosine = wi.x * wo.x + wi.y * wo.y;
    1.0 + 0.3 * wi.z + 0.1 * wo.z + 0.2 * cosine + 0.25 * sine
}

/// The part of it that is the same with the directions exchanged, and still not mirrored.
fn isotropic_reciprocal(wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
    let sine = wi.x * wo.y - wi.y * wo.x;
    let cosine = wi.x * wo.x + wi.y * wo.y;
    1.0 + 0.2 * wi.z * wo.z + 0.2 * cosine + 0.4 * sine * (wi.z - wo.z)
}

/// The part of `isotropic` that is the same mirrored.
fn isotropic_mirrored(wi: Vec3<f64>, wo: Vec3<f64>) -> f64 {
    let cosine = wi.x * wo.x + wi.y * wo.y;
    1.0 + 0.3 * wi.z + 0.1 * wo.z + 0.2 * cosine
}

/// Writes `f` in a format, reads it, and gives the largest difference over directions with z ≥ 0.25.
fn largest_difference(
    name: &str,
    layout: &Layout,
    channels: &[Channel],
    sides: &[Side],
    f: Function,
) -> f64 {
    let format = format::find(name).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("a.{}", format.extension));
    let n = channels.len();
    let mut g = |wi, wo, out: &mut [f64]| {
        for (k, x) in out.iter_mut().enumerate() {
            *x = f(wi, wo) * (1.0 + 0.5 * k as f64 / n as f64);
        }
    };
    let m = tabulate(layout, channels, sides, &mut g, &mut |_| true).unwrap();
    (format.write)(&path, &m).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    let options = LoadOptions {
        select: gonio_brdf::measured::Select::All,
        ..LoadOptions::default()
    };
    let read: Measured = load(&path, options).unwrap();
    assert_eq!(read.measurement().channels, channels);
    assert_eq!(read.sides(), sides);
    let mut rng = Rng::from_name("orientation");
    let mut worst = 0.0f64;
    for k in 0..2000 {
        let (mut wi, mut wo) = (direction(&mut rng, 0.25), direction(&mut rng, 0.25));
        let side = sides[k % sides.len()];
        if !side.from_front() {
            wi.z = -wi.z;
        }
        if !side.to_front() {
            wo.z = -wo.z;
        }
        let found = read.eval_spectrum(wi, wo);
        let mut expected = vec![0.0; n];
        for (k, x) in expected.iter_mut().enumerate() {
            *x = f(wi, wo) * (1.0 + 0.5 * k as f64 / n as f64);
        }
        for (a, b) in found.iter().zip(&expected) {
            worst = worst.max((a - b).abs());
        }
    }
    worst
}

const FRONT: &[Side] = &[Side::ReflectionFront];

/// A turn by a quarter or a mirror image would change these functions by 0.3 and more. What is left is interpolation: second differences of
/// sines over 5° to 15°, (0.26)²/8 of 0.5, or the size of a patch or square times the slope.
#[test]
fn labelled_functions_pass_unturned() {
    let wavelengths: Vec<Channel> = [450.0, 550.0, 650.0].map(Channel::Wavelength).to_vec();
    let luminance = [Channel::Luminance];
    let colours = rgb_channels();
    let xyz = [Channel::X, Channel::Y, Channel::Z];
    let utia = Layout::Grid(
        gonio_brdf::measured::Parameterization::SphericalAnisotropic,
        gonio_brdf::measured::format::utia::layout(),
    );
    let merl = half([30, 30, 24]);
    let cases: Vec<Case> = vec![
        ("merl", merl, &colours, FRONT, isotropic_reciprocal, 0.02),
        ("utia", utia, &colours, FRONT, anisotropic, 0.02),
        (
            "astm",
            spherical(19, 36),
            &wavelengths,
            FRONT,
            isotropic,
            0.02,
        ),
        (
            "astm",
            spherical_anisotropic(7, 24),
            &colours,
            FRONT,
            anisotropic,
            0.03,
        ),
        (
            "pbrt",
            mirrored(19, 19),
            &wavelengths,
            FRONT,
            isotropic_mirrored,
            0.02,
        ),
        (
            "radiance",
            klems("LBNL/Klems Full"),
            &luminance,
            &Side::ALL,
            anisotropic,
            0.15,
        ),
        (
            "radiance",
            klems("LBNL/Klems Half"),
            &xyz,
            FRONT,
            anisotropic,
            0.25,
        ),
        (
            "radiance",
            tree(3, 6),
            &luminance,
            &Side::ALL,
            isotropic,
            0.08,
        ),
        ("radiance", tree(4, 4), &xyz, FRONT, anisotropic, 0.15),
        (
            "gonio",
            half([30, 30, 24]),
            &wavelengths,
            FRONT,
            isotropic_reciprocal,
            0.02,
        ),
        (
            "gonio",
            half_anisotropic([20, 16, 24], 24),
            &colours,
            FRONT,
            anisotropic_reciprocal,
            0.03,
        ),
        (
            "gonio",
            spherical(19, 36),
            &wavelengths,
            &Side::ALL,
            isotropic,
            0.02,
        ),
        (
            "gonio",
            spherical_anisotropic(7, 24),
            &luminance,
            &Side::ALL,
            anisotropic,
            0.03,
        ),
        (
            "gonio",
            klems("LBNL/Klems Quarter"),
            &luminance,
            FRONT,
            anisotropic,
            0.35,
        ),
        ("gonio", tree(4, 3), &luminance, FRONT, anisotropic, 0.3),
    ];
    for (name, layout, channels, sides, f, bound) in cases {
        let worst = largest_difference(name, &layout, channels, sides, f);
        assert!(worst < bound, "{name} {:?}: {worst}", kind(&layout));
    }
}

fn kind(layout: &Layout) -> String {
    format!("{layout:?}").chars().take(60).collect()
}
