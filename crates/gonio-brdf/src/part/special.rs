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
