use super::*;
use crate::colour::{RgbSpace, rgb_of_reflectance};
use crate::spectrum::{Illuminant, Spectrum};

fn back(sigmoid: SigmoidPolynomial) -> [f64; 3] {
    let light = Illuminant::D65.spectrum();
    rgb_of_reflectance(&Spectrum::Sigmoid(sigmoid), &light, &RgbSpace::SRGB)
}

fn largest_difference(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max)
}

/// A grid over the unit cube, corners included.
fn grid(n: usize) -> impl Iterator<Item = [f64; 3]> {
    (0..n * n * n).map(move |i| [i / (n * n), i / n % n, i % n].map(|k| k as f64 / (n - 1) as f64))
}

#[test]
fn colours_of_srgb_return() {
    // Both sides integrate smooth spectra by 1 nm; edges as sharp as 1 nm only occur at the corners.
    let solver = Solver::srgb();
    let mut worst = (0.0, [0.0; 3]);
    let mut evaluations = (0, 0);
    for rgb in grid(6) {
        let fit = solver.solve(rgb);
        let error = largest_difference(back(fit.sigmoid), rgb);
        if error > worst.0 {
            worst = (error, rgb);
        }
        eprintln!(
            "{rgb:?} {error:.2e} {:.2e} {} {:?}",
            fit.delta_e, fit.evaluations, fit.sigmoid.coefficients
        );
        evaluations = (
            evaluations.0 + fit.evaluations,
            evaluations.1.max(fit.evaluations),
        );
    }
    eprintln!("{worst:?} {evaluations:?}");
    assert!(worst.0 < 1e-3, "{worst:?}");
}
