//! Functions that keep their digits near 0, where the plain composition would cancel.

use gonio_num::Real;

/// ln(1 + x) for x ≥ −1/2, to rounding error also for tiny x.
#[inline(always)]
pub(crate) fn ln_1p<R: Real>(x: R) -> R {
    // With z = x / (2 + x): ln(1 + x) = 2 artanh z = 2 (z + z³/3 + z⁵/5 + …); |x| < 0.1 leaves z¹³/13 < 1e-17.
    let z = x / (R::lit(2.0) + x);
    let z2 = z * z;
    let series = R::lit(1.0 / 11.0) * z2 + R::lit(1.0 / 9.0);
    let series = series * z2 + R::lit(1.0 / 7.0);
    let series = series * z2 + R::lit(0.2);
    let series = series * z2 + R::lit(1.0 / 3.0);
    let near = R::lit(2.0) * z * (series * z2 + R::one());
    let far = (R::one() + x).max(R::lit(1e-37)).ln();
    R::select(x.abs().lt(R::lit(0.1)), near, far)
}

/// eˣ − 1, to rounding error also for tiny x.
#[inline(always)]
pub(crate) fn exp_m1<R: Real>(x: R) -> R {
    // Taylor series to x¹¹/11!: |x| < 0.25 leaves 0.25¹²/12! < 2e-16 of x.
    let mut series = R::lit(1.0 / 11.0);
    for n in (2..=10).rev() {
        series = (series * x + R::one()) * R::lit(1.0 / n as f64);
    }
    let near = x * (series * x + R::one());
    R::select(x.abs().lt(R::lit(0.25)), near, x.exp() - R::one())
}

/// (eˣ − 1)/x, 1 at x = 0.
#[inline(always)]
pub(crate) fn exp_m1_over<R: Real>(x: R) -> R {
    let small = x.abs().lt(R::lit(1e-30));
    R::select(small, R::one(), exp_m1(x) / R::select(small, R::one(), x))
}

/// ln Γ(x) for x > 0, to about 1e-14.
pub(crate) fn ln_gamma<R: Real>(x: R) -> R {
    // Γ(x) = Γ(x + 8)/(x (x + 1) … (x + 7)); Stirling's series from 8 on leaves 1/(1188 · 8⁹) < 1e-11 of its last term.
    let mut product = R::one();
    let mut z = x;
    for _ in 0..8 {
        product = product * z;
        z = z + R::one();
    }
    let half_log = R::lit(0.918_938_533_204_672_7); // ln √2π
    (z - R::lit(0.5)) * z.ln() - z + half_log + stirling(z) - product.ln()
}

/// Euler's beta function B(a, b) for a, b ≥ 1, to about 1e-9, in single precision to 1e-6 also for large arguments.
#[inline(always)]
pub(crate) fn beta<R: Real>(a: R, b: R) -> R {
    // Four times B(a, b) = B(a + 1, b + 1) (a + b)(a + b + 1)/(a b), then Stirling's series, whose large terms cancel in the logarithms.
    let (mut a, mut b, mut factor) = (a, b, R::one());
    for _ in 0..4 {
        let sum = a + b;
        factor = factor * (sum * (sum + R::one()) / (a * b));
        a = a + R::one();
        b = b + R::one();
    }
    let sum = a + b;
    let powers = a * ln_1p(b / a) + b * ln_1p(a / b);
    let series = stirling(a) + stirling(b) - stirling(sum);
    let root = (R::lit(std::f64::consts::TAU) * (sum / (a * b))).sqrt();
    factor * root * (series - powers).exp()
}

/// ln Γ(x) − (x − 1/2) ln x + x − ln √2π for x ≥ 5.
#[inline(always)]
fn stirling<R: Real>(x: R) -> R {
    let over = x.recip();
    let square = over * over;
    let series = R::lit(-1.0 / 1680.0) * square + R::lit(1.0 / 1260.0);
    let series = series * square - R::lit(1.0 / 360.0);
    (series * square + R::lit(1.0 / 12.0)) * over
}

/// ∫ f from `low` to `high` by Gauss–Legendre quadrature with 16 nodes in each of `panels` equal panels.
pub(crate) fn integral<R: Real>(low: f64, high: f64, panels: u32, mut f: impl FnMut(R) -> R) -> R {
    let width = (high - low) / f64::from(panels);
    let mut sum = R::zero();
    for panel in 0..panels {
        for (node, weight) in GAUSS_LEGENDRE_16 {
            for side in [-0.5, 0.5] {
                let x = low + width * (f64::from(panel) + 0.5 + side * node);
                sum = sum + f(R::lit(x)) * R::lit(weight * width);
            }
        }
    }
    sum
}

/// Positive nodes on [−1, 1], with their weights already halved for [0, 1], of Gauss–Legendre quadrature with 16 points.
pub(crate) const GAUSS_LEGENDRE_16: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.094_725_305_227_534_25),
    (0.281_603_550_779_258_9, 0.091_301_707_522_461_79),
    (0.458_016_777_657_227_4, 0.084_578_259_697_501_27),
    (0.617_876_244_402_643_7, 0.074_797_994_408_288_37),
    (0.755_404_408_355_003, 0.062_314_485_627_766_94),
    (0.865_631_202_387_831_7, 0.047_579_255_841_246_39),
    (0.944_575_023_073_232_6, 0.031_126_761_969_323_95),
    (0.989_400_934_991_649_9, 0.013_576_229_705_877_05),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadrature_is_exact_for_polynomials_of_degree_31() {
        let sum: f64 = integral(-1.0, 2.0, 1, |x: f64| x.powi(31));
        // (2³² − 1)/32; sixteen terms of up to 2³¹ are summed.
        assert!((sum / ((2f64.powi(32) - 1.0) / 32.0) - 1.0).abs() < 1e-13);
        assert!((integral::<f64>(0.0, 1.0, 3, |x| x.exp()) - 1f64.exp_m1()).abs() < 1e-15);
    }

    #[test]
    fn ln_gamma_at_halves_and_wholes() {
        let pi = std::f64::consts::PI;
        for (x, gamma) in [
            (0.5, pi.sqrt()),
            (1.0, 1.0),
            (1.5, 0.5 * pi.sqrt()),
            (6.0, 120.0),
        ] {
            assert!((ln_gamma(x) - f64::ln(gamma)).abs() < 1e-11, "{x}");
        }
        // Γ(0.1) = 9.513 507 698 668 732.
        assert!((ln_gamma(0.1f64) - 9.513_507_698_668_732f64.ln()).abs() < 1e-11);
    }

    #[test]
    fn beta_at_wholes_and_far_out() {
        // B(a, b) = (a − 1)! (b − 1)!/(a + b − 1)!.
        for (a, b, value) in [
            (1.0, 1.0, 1.0),
            (2.0, 3.0, 1.0 / 12.0),
            (1.0, 9.0, 1.0 / 9.0),
        ] {
            assert!((beta(a, b) / value - 1.0).abs() < 1e-9, "{a} {b}");
        }
        // B(1, b) = 1/b, B(2, b) = 1/(b (b + 1)).
        for b in [7.0f32, 300.0, 1e4] {
            assert!((beta(1.0, b) * b - 1.0).abs() < 1e-5, "{b}");
            assert!((beta(b, 2.0) * b * (b + 1.0) - 1.0).abs() < 1e-5, "{b}");
        }
    }

    #[test]
    fn exp_m1_over_is_smooth_at_0() {
        assert_eq!(exp_m1_over(0.0f64), 1.0);
        for x in [1e-14, 1e-11, 1e-3, 2.0, -30.0] {
            assert!((exp_m1_over(x) / (f64::exp_m1(x) / x) - 1.0).abs() < 3e-15);
        }
    }

    #[test]
    fn agree_with_the_standard_library_to_a_few_roundings() {
        for k in -40..40 {
            let x = 0.49 * f64::from(k) / 40.0;
            for x in [x, x * 1e-3, x * 1e-9] {
                assert!((ln_1p(x) - x.ln_1p()).abs() <= 3e-15 * x.abs(), "{x}");
                assert!((exp_m1(x) - x.exp_m1()).abs() <= 3e-15 * x.abs(), "{x}");
            }
        }
        for x in [1.0, 50.0, 1e12] {
            assert!((ln_1p(x) / f64::ln_1p(x) - 1.0).abs() < 1e-15);
            assert!((exp_m1(-x) / f64::exp_m1(-x) - 1.0).abs() < 1e-15);
        }
    }
}
