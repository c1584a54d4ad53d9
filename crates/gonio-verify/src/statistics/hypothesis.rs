//! χ², z-, t- and Kolmogorov–Smirnov tests, and the correction for many of them.

use super::Moments;
use gonio_num::Real;
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

/// A statistic and its p-value.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct TestResult {
    /// The statistic: χ², z, t or D.
    pub statistic: f64,
    /// Degrees of freedom; infinite for a z-test, the sample size for Kolmogorov–Smirnov.
    pub degrees_of_freedom: f64,
    /// Probability of a statistic at least as extreme under the hypothesis, in [0, 1]. Two-sided for z and t.
    pub p_value: f64,
}

/// Pearson's χ² test: X² = Σ (O − E)² / E against χ² with (cells − 1) degrees of freedom.
///
/// Cells that expect fewer than `min_expected` (5 is customary) are pooled, from the smallest up. One pooled cell or none
/// leaves nothing to test: p = 1. `expected` ought to add up to the sum of `observed`; where it doesn't, the test sees that
/// too. See [`chi_square_test_with_slack`].
///
/// # Panics
/// If the slices differ in length.
pub fn chi_square_test(observed: &[u64], expected: &[f64], min_expected: f64) -> TestResult {
    chi_square_test_with_slack(observed, expected, &vec![0.0; expected.len()], min_expected)
}

/// [`chi_square_test`] with expectations that are only known within ±`slack`: each |O − E| is shortened by the slack of its
/// cell, so that an error of the expectation never makes the p-value smaller than an exact expectation would.
///
/// # Panics
/// If the slices differ in length.
pub fn chi_square_test_with_slack(
    observed: &[u64],
    expected: &[f64],
    slack: &[f64],
    min_expected: f64,
) -> TestResult {
    assert!(
        observed.len() == expected.len() && slack.len() == expected.len(),
        "{} observed, {} expected counts and {} slacks",
        observed.len(),
        expected.len(),
        slack.len()
    );
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    let (mut statistic, mut cells) = (0.0, 0u64);
    let mut pool = (0.0, 0.0, 0.0);
    let mut close = |(o, e, s): (f64, f64, f64)| {
        let beyond = ((o - e).abs() - s).max(0.0);
        if beyond > 0.0 {
            statistic += beyond * beyond / e;
        }
        cells += 1;
    };
    for i in order {
        pool.0 += observed[i] as f64;
        pool.1 += expected[i].max(0.0);
        pool.2 += slack[i];
        if pool.1 >= min_expected {
            close(std::mem::take(&mut pool));
        }
    }
    // What is left expects too little even together: that is all there was.
    if pool.0 > 0.0 || pool.1 > 0.0 {
        close(pool);
    }
    let degrees_of_freedom = cells.saturating_sub(1) as f64;
    let p_value = if statistic == f64::INFINITY {
        0.0
    } else if cells < 2 {
        1.0
    } else {
        ChiSquared::new(degrees_of_freedom)
            .map(|d| d.sf(statistic))
            .expect("invariant: at least one degree of freedom")
    };
    TestResult {
        statistic,
        degrees_of_freedom,
        p_value,
    }
}

/// Two-sided z-test of a `difference` whose expectation is 0 and whose variance is known: z = difference / √variance.
///
/// Without variance only a difference of 0 agrees: p is 1 or 0.
pub fn z_test(difference: f64, variance: f64) -> TestResult {
    let statistic = if difference == 0.0 {
        0.0
    } else {
        difference / variance.max(0.0).sqrt()
    };
    TestResult {
        statistic,
        degrees_of_freedom: f64::INFINITY,
        p_value: statrs::function::erf::erfc(statistic.abs() * std::f64::consts::FRAC_1_SQRT_2),
    }
}

fn student(difference: f64, variance: f64, degrees_of_freedom: f64) -> TestResult {
    let statistic = if difference == 0.0 {
        0.0
    } else {
        difference / variance.max(0.0).sqrt()
    };
    let p_value = if statistic.is_infinite() {
        0.0
    } else {
        StudentsT::new(0.0, 1.0, degrees_of_freedom)
            .map(|d| (2.0 * d.cdf(-statistic.abs())).min(1.0))
            // Fewer than two numbers say nothing.
            .unwrap_or(1.0)
    };
    TestResult {
        statistic,
        degrees_of_freedom,
        p_value,
    }
}

/// Two-sided Student's t-test: is the mean of the numbers in `sample` `expected`? t = (mean − expected) / √(s²/n), n − 1
/// degrees of freedom. Fewer than two numbers say nothing: p = 1.
pub fn t_test(sample: &Moments, expected: f64) -> TestResult {
    if sample.count() < 2 {
        return student(0.0, 0.0, f64::NAN);
    }
    student(
        sample.mean() - expected,
        sample.variance_of_mean(),
        (sample.count() - 1) as f64,
    )
}

/// Two-sided Welch's t-test: have `a` and `b` the same mean, whatever their variances? Fewer than two numbers in either
/// say nothing: p = 1.
///
/// Source: Welch 1947, with Satterthwaite's degrees of freedom.
pub fn welch_t_test(a: &Moments, b: &Moments) -> TestResult {
    if a.count() < 2 || b.count() < 2 {
        return student(0.0, 0.0, f64::NAN);
    }
    let (va, vb) = (a.variance_of_mean(), b.variance_of_mean());
    let below = va * va / (a.count() - 1) as f64 + vb * vb / (b.count() - 1) as f64;
    let degrees_of_freedom = if below > 0.0 {
        (va + vb).powi(2) / below
    } else {
        (a.count() + b.count() - 2) as f64
    };
    student(a.mean() - b.mean(), va + vb, degrees_of_freedom)
}

/// The significance of each of `tests` independent tests so that any of them fails by chance with probability
/// `significance`: 1 − (1 − α)^(1/m). Source: Šidák 1967.
pub fn sidak(significance: f64, tests: u64) -> f64 {
    -libm::expm1(libm::log1p(-significance) / tests.max(1) as f64)
}

/// The probability that the smallest of `tests` independent p-values is at most `smallest`: 1 − (1 − p)^m.
pub fn sidak_p_value(smallest: f64, tests: u64) -> f64 {
    if smallest >= 1.0 {
        return 1.0;
    }
    -libm::expm1(libm::log1p(-smallest) * tests.max(1) as f64)
}

/// Kolmogorov–Smirnov test of numbers against the uniform distribution on [0, 1]: D = sup |F(x) − x|.
///
/// p by the asymptotic series with Stephens' correction (1970), good to a few percent from n = 8 on. Of no numbers p = 1; a
/// NaN gives p = 0.
pub fn kolmogorov_smirnov_uniform(numbers: &[f64]) -> TestResult {
    let mut sorted = numbers.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let mut d: f64 = 0.0;
    for (i, x) in sorted.iter().enumerate() {
        if x.is_nan() {
            d = 1.0;
        }
        d = d.max(x - i as f64 / n).max((i + 1) as f64 / n - x);
    }
    let root = n.sqrt();
    let lambda = (root + 0.12 + 0.11 / root) * d;
    let p_value = if numbers.is_empty() || lambda < 0.2 {
        1.0
    } else {
        let mut sum = 0.0;
        for k in 1..=100 {
            let k = f64::from(k);
            let sign = if k % 2.0 == 1.0 { 2.0 } else { -2.0 };
            let term: f64 = Real::exp(-2.0 * k * k * lambda * lambda);
            sum += sign * term;
        }
        f64::clamp(sum, 0.0, 1.0)
    };
    TestResult {
        statistic: d,
        degrees_of_freedom: n,
        p_value,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    #[test]
    fn chi_square_by_hand() {
        // A die thrown 64 times where 60 were expected: Σ (O − 10)²/10 = 0.9 + 0.1 + 0 + 0.4 + 0.1 + 0.1.
        let t = chi_square_test(&[13, 9, 10, 12, 11, 9], &[10.0; 6], 5.0);
        assert!((t.statistic - 1.6).abs() < 1e-12 && t.degrees_of_freedom == 5.0);
        // χ²₅ beyond 11.070 has probability 0.05 (any table).
        let t = ChiSquared::new(5.0).unwrap().sf(11.0705);
        assert!((t - 0.05).abs() < 1e-5);
    }

    #[test]
    fn sparse_cells_are_pooled() {
        let t = chi_square_test(&[1, 2, 3, 94], &[2.0, 2.0, 2.0, 94.0], 5.0);
        assert_eq!(t.degrees_of_freedom, 1.0);
        assert_eq!(t.statistic, 0.0);
        let t = chi_square_test(&[3], &[3.0], 5.0);
        assert_eq!(t.p_value, 1.0);
        // Observed where nothing at all is expected.
        let t = chi_square_test(&[3], &[0.0], 5.0);
        assert_eq!(t.p_value, 0.0);
    }

    #[test]
    fn slack_shortens_the_differences() {
        let (o, e) = ([120, 80], [100.0, 100.0]);
        assert_eq!(chi_square_test(&o, &e, 5.0).statistic, 8.0);
        let t = chi_square_test_with_slack(&o, &e, &[15.0, 15.0], 5.0);
        assert_eq!(t.statistic, 0.5);
    }

    #[test]
    fn known_z_and_t_values() {
        // z = 1.959964: 0.05; t with 4 degrees = 2.776445: 0.05.
        assert!((z_test(1.959_964, 1.0).p_value - 0.05).abs() < 1e-6);
        assert_eq!(z_test(0.0, 0.0).p_value, 1.0);
        assert_eq!(z_test(1e-9, 0.0).p_value, 0.0);
        let sample: Moments = [-2.0, -1.0, 0.0, 1.0, 2.0].into_iter().collect();
        let t = t_test(&sample, 2.776_445 * 0.5f64.sqrt());
        assert!((t.p_value - 0.05).abs() < 1e-6, "{t:?}");
        assert_eq!(t_test(&[1.0].into_iter().collect(), 3.0).p_value, 1.0);
        let constant: Moments = [1.0, 1.0].into_iter().collect();
        assert_eq!(t_test(&constant, 3.0).p_value, 0.0);
        assert_eq!(t_test(&constant, 1.0).p_value, 1.0);
        // Equal sizes and variances: Welch is Student with 2n − 2 = 8 degrees; t = 1/√(2·0.5) = 1.
        let shifted: Moments = [-1.0, 0.0, 1.0, 2.0, 3.0].into_iter().collect();
        let t = welch_t_test(&sample, &shifted);
        assert!((t.degrees_of_freedom - 8.0).abs() < 1e-12 && (t.statistic + 1.0).abs() < 1e-12);
        assert!((t.p_value - 0.346_594).abs() < 1e-5, "{t:?}");
    }

    #[test]
    fn sidak_and_its_inverse() {
        // 1 − 0.95^(1/10).
        assert!((sidak(0.05, 10) - 0.005_116_197).abs() < 1e-9);
        for m in [1, 7, 1_000_000] {
            assert!((sidak_p_value(sidak(1e-6, m), m) / 1e-6 - 1.0).abs() < 1e-9);
        }
    }

    /// Under the hypothesis p-values are uniform; a Kolmogorov–Smirnov test at 1e-4 says so of 500 of each test.
    #[test]
    fn p_values_are_uniform_under_the_hypothesis() {
        let mut rng = Rng::from_name("p_values_are_uniform_under_the_hypothesis");
        let (mut chi, mut t, mut welch) = (vec![], vec![], vec![]);
        for _ in 0..500 {
            let mut counts = [0u64; 16];
            for _ in 0..1600 {
                counts[(rng.next_f64() * 16.0) as usize] += 1;
            }
            chi.push(chi_square_test(&counts, &[100.0; 16], 5.0).p_value);
            let a: Moments = (0..200).map(|_| rng.next_f64()).collect();
            let b: Moments = (0..80)
                .map(|_| 0.5 + 3.0 * (rng.next_f64() - 0.5))
                .collect();
            t.push(t_test(&a, 0.5).p_value);
            welch.push(welch_t_test(&a, &b).p_value);
        }
        for p in [&chi, &t, &welch] {
            let ks = kolmogorov_smirnov_uniform(p);
            assert!(ks.p_value > 1e-4, "{ks:?}");
        }
        // The control: p-values of a wrong hypothesis are not uniform.
        let wrong: Vec<f64> = chi.iter().map(|p| p * p).collect();
        assert!(kolmogorov_smirnov_uniform(&wrong).p_value < 1e-4);
    }

    #[test]
    fn kolmogorov_smirnov_by_hand() {
        // {0.2, 0.6} against steps to 1/2 and 1: max(0.2, 0.3, 0.1, 0.4).
        assert!((kolmogorov_smirnov_uniform(&[0.2, 0.6]).statistic - 0.4).abs() < 1e-12);
        // λ = 1.3581 has p = 0.05 (Smirnov's table); n large makes the correction vanish.
        let n = 1_000_000;
        let numbers: Vec<f64> = (0..n)
            .map(|i| ((f64::from(i) + 0.5) / f64::from(n) + 1.3581e-3).min(1.0))
            .collect();
        let p = kolmogorov_smirnov_uniform(&numbers).p_value;
        assert!((p - 0.05).abs() < 1e-3, "{p}");
        assert_eq!(kolmogorov_smirnov_uniform(&[]).p_value, 1.0);
    }
}
