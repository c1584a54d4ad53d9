//! What reports say of fast chains against the exact one, `--reference`.

#![allow(clippy::unwrap_used)]

use gonio_env::{Environment, Layout};
use gonio_ibl::bundle::{Options, Report, write};
use gonio_ibl::{Method, Target};
use gonio_image::{CubeMap, Image, TexelFormat};

const WIDTH: usize = 64;

/// A sky over a chequered floor with a sun of a few texels.
fn sky() -> Environment {
    let image = Image::from_fn(WIDTH, WIDTH / 2, |x, y| match (x, y) {
        (40..42, 8..10) => [30.0, 28.0, 25.0],
        (_, 0..16) => [0.4, 0.6, 1.0 - y as f32 / 40.0],
        _ => [0.1 + 0.2 * ((x / 4 + y / 4) % 2) as f32, 0.2, 0.1],
    });
    Environment::from_image(image, Layout::LatLong)
        .unwrap()
        // By four texels, so that sums over texels are whole.
        .rotated_deg(22.5)
}

fn chain(method: Method, check: usize) -> (Report, Vec<Vec<[f32; 3]>>) {
    let folder = tempfile::tempdir().unwrap();
    let options = Options {
        target: Target::Filament,
        size: 16,
        method,
        check,
        diffuse_size: 16,
        table_size: 2,
        format: TexelFormat::Float,
        ..Options::default()
    };
    let report = write(&sky(), &options, folder.path(), &mut |_| ()).unwrap();
    let cube = CubeMap::read(&folder.path().join("specular.ktx2")).unwrap();
    let levels = cube
        .levels
        .iter()
        .map(|faces| faces.iter().flat_map(|f| f.pixels.clone()).collect())
        .collect();
    (report, levels)
}

fn difference(found: &[[f32; 3]], exact: &[[f32; 3]]) -> (f64, f64, f64) {
    let (mut mean, mut bias, mut largest) = (0.0, 0.0, 0.0_f64);
    for (a, b) in found.iter().flatten().zip(exact.iter().flatten()) {
        let e = f64::from(*a) / f64::from(*b) - 1.0;
        mean += e.abs();
        bias += e;
        largest = largest.max(e.abs());
    }
    let n = (3 * exact.len()) as f64;
    (mean / n, bias / n, largest)
}

/// Every texel is compared, so that the report's error of the fast chain is that of the two files, to the rounding of single precision.
#[test]
fn reported_errors_are_those_against_the_reference_chain() {
    let all = 6 * 16 * 16;
    let (fast, found) = chain(Method::Tree(1.0), all);
    let (exact, truth) = chain(Method::Exact, all);
    assert_eq!(found.len(), 5);
    for (k, level) in fast.levels.iter().enumerate().skip(1) {
        let error = level.error.unwrap();
        let (mean, bias, largest) = difference(&found[k], &truth[k]);
        assert_eq!(error.texels, truth[k].len());
        for (reported, direct) in [
            (error.mean, mean),
            (error.bias, bias),
            (error.largest, largest),
        ] {
            assert!((reported - direct).abs() < 3e-6, "{k}: {reported} {direct}");
        }
        // The coarse tree does err, or nothing would be compared.
        assert!(mean > 1e-5, "{k}: {mean}");
        // The reference against itself.
        let same = exact.levels[k].error.unwrap();
        assert!(same.largest < 3e-6, "{k}: {same:?}");
        // Negative control: the next level is not this one.
        let other = (k % 4) + 1;
        let texels = truth[k].len().min(truth[other].len());
        let (wrong, ..) = difference(&truth[other][..texels], &truth[k][..texels]);
        assert!((wrong - error.mean).abs() > 1e-2, "{k}: {wrong}");
    }
    // Level 0 is the picture in both.
    assert_eq!(found[0], truth[0]);
}
