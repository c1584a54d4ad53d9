//! The exact chain, `--reference`, against quadrature of its own, and what reports say of fast chains against the exact one.

#![allow(clippy::unwrap_used)]

use gonio_env::{Environment, Layout};
use gonio_ibl::bundle::{Options, Report, write};
use gonio_ibl::harmonics::directions;
use gonio_ibl::{Kernel, Maps, Method, Target};
use gonio_image::{CubeMap, Image, TexelFormat};
use gonio_num::{Real, Vec3};
use std::f64::consts::{PI, TAU};

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

/// Σ D(θh) cos θ L over points of the interpolated picture, `split` along each side of a texel, in double precision; the kernel from the definition: with
/// n = v, cos²θh = (1 + cos θ)/2, D = α²/(π (cos²θh (α² − 1) + 1)²).
fn quadrature(env: &Environment, alpha: f64, axis: Vec3<f64>, split: usize) -> [f64; 3] {
    let (w, h) = (WIDTH * split, WIDTH / 2 * split);
    let (mut sum, mut all) = ([0.0; 3], 0.0);
    for y in 0..h {
        let theta = PI * (y as f64 + 0.5) / h as f64;
        for x in 0..w {
            let (s, c) = Real::sin_cos(TAU * (x as f64 + 0.5) / w as f64 - PI);
            let d = Vec3::new(
                Real::sin(theta) * s,
                Real::cos(theta),
                -Real::sin(theta) * c,
            );
            let cos = d.dot(axis);
            if cos <= 0.0 {
                continue;
            }
            let a2 = alpha * alpha;
            let weight =
                a2 / (0.5 * (1.0 + cos) * (a2 - 1.0) + 1.0).powi(2) * cos * Real::sin(theta);
            let rgb = env.radiance(d.to_f32());
            for k in 0..3 {
                sum[k] += weight * f64::from(rgb[k]);
            }
            all += weight;
        }
    }
    sum.map(|s| s / all)
}

/// The midpoint rule errs by C h² for points h apart: halving h takes three quarters of the error away, so that two sums tell what they converge
/// to, to a quarter of their difference; for even splits, as otherwise points lie where the interpolation bends. Changes of 3e-6 are the single precision of
/// the radiance, and a light of single texels is seen to 5e-6 by nodes of Gauss and Legendre an eighth of a texel apart.
#[test]
fn the_reference_is_what_refined_quadrature_converges_to() {
    let env = sky();
    for roughness in [0.45, 0.7, 1.0] {
        let kernel = Kernel::ggx(roughness).unwrap();
        let maps = Maps::new(&env, kernel.width(), Method::Exact);
        let axes: Vec<Vec3<f64>> = directions(5).collect();
        let block: Vec<Vec3<f32>> = axes.iter().map(|d| d.to_f32()).collect();
        let found = maps.means(&kernel, &[block], Method::Exact).remove(0);
        let alpha = roughness * roughness;
        for (axis, found) in axes.iter().zip(found) {
            let [coarse, middle, fine] = [2, 4, 8].map(|n| quadrature(&env, alpha, *axis, n));
            // A kernel a tenth wider, the negative control.
            let wider = quadrature(&env, 1.1 * alpha, *axis, 4);
            let mut told = 0.0_f64;
            for k in 0..3 {
                let first = (coarse[k] / middle[k] - 1.0).abs();
                let second = (middle[k] / fine[k] - 1.0).abs();
                assert!(
                    second < (0.375 * first).max(3e-6),
                    "{roughness}: {first} {second}"
                );
                assert!(second < 2.5e-4, "{roughness}: {second}");
                let limit = fine[k] + (fine[k] - middle[k]) / 3.0;
                let off = (f64::from(found[k]) / limit - 1.0).abs();
                let allowed = 5e-6 + 0.25 * second;
                assert!(off < allowed, "{roughness}: {off} {allowed}");
                told = told.max((f64::from(found[k]) / wider[k] - 1.0).abs());
            }
            assert!(told > 2e-3, "{roughness}: {told}");
        }
    }
}
