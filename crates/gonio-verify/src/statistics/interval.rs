//! Quantiles and intervals.

use statrs::distribution::{ContinuousCDF, Normal};

/// z with P(Z > z) = `tail` for a standard normal Z: 1.645 at 0.05, 4.753 at 1e-6.
///
/// - `tail`: a probability in (0, 1); −∞ at 1, ∞ at 0.
pub fn normal_quantile(tail: f64) -> f64 {
    if tail <= 0.0 {
        f64::INFINITY
    } else if tail >= 1.0 {
        f64::NEG_INFINITY
    } else {
        // By symmetry, since the lower tail keeps its digits.
        -Normal::standard().inverse_cdf(tail)
    }
}

/// Wilson's score interval for a probability of which `hits` in `trials` were seen; each end is exceeded with
/// probability `tail`. (0, 1) of no trials.
///
/// Source: Wilson 1927, "Probable inference, the law of succession, and statistical inference".
pub fn wilson_interval(hits: u64, trials: u64, tail: f64) -> (f64, f64) {
    if trials == 0 {
        return (0.0, 1.0);
    }
    let (n, z) = (trials as f64, normal_quantile(tail));
    let (p, z2) = (hits as f64 / n, z * z);
    let centre = (p + 0.5 * z2 / n) / (1.0 + z2 / n);
    let half = z / (1.0 + z2 / n) * (p * (1.0 - p) / n + 0.25 * z2 / (n * n)).sqrt();
    ((centre - half).max(0.0), (centre + half).min(1.0))
}

/// The exact upper bound of a probability of which `hits` in `trials` were seen: with a larger one, so few would be seen with
/// probability `tail` at most. 1 of no trials.
///
/// The p with P(X ≤ hits) = `tail` for a binomial X, or I(p; hits + 1, trials − hits) = 1 − `tail`.
/// Source: Clopper & Pearson 1934, "The use of confidence or fiducial limits illustrated in the case of the binomial".
pub fn clopper_pearson_upper(hits: u64, trials: u64, tail: f64) -> f64 {
    if hits >= trials {
        return 1.0;
    }
    let (n, k) = (trials as f64, hits as f64);
    if hits == 0 {
        return 1.0 - gonio_num::Real::powf(tail, 1.0 / n);
    }
    let (mut low, mut high) = (k / n, 1.0);
    // Each step halves the interval: down to the last digits.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if statrs::function::beta::beta_reg(k + 1.0, n - k, middle) < 1.0 - tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// How far the mean of `n` independent numbers may be from its expectation, but for probability `tail` (both sides
/// together): t with 2 exp(−n t² / (2σ² + 2Wt/3)) = tail.
///
/// - `variance`: σ² of one number; `range`: W, the most that a number differs from its expectation.
///
/// Unlike a multiple of the standard error seen in the sample, it holds for any n and for heavy tails, when σ and W are
/// those of the distribution.
/// Source: Bernstein 1924; Boucheron, Lugosi & Massart 2013, "Concentration Inequalities", corollary 2.11.
pub fn bernstein_deviation(variance: f64, range: f64, n: u64, tail: f64) -> f64 {
    if n == 0 {
        return f64::INFINITY;
    }
    let n = n as f64;
    let l: f64 = gonio_num::Real::ln(2.0 / tail);
    let lw = l * range / 3.0;
    (lw + (lw * lw + 2.0 * n * variance * l).sqrt()) / n
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_radiometry::sequence::Rng;

    #[test]
    fn the_exact_bound_is_exact() {
        // None of n: 1 − 0.05^(1/n), the "rule of three".
        assert!((clopper_pearson_upper(0, 30_000, 0.05) / (2.9957 / 30_000.0) - 1.0).abs() < 1e-3);
        // P(X ≤ 1) = (1 − p)^10 + 10 p (1 − p)^9 = 0.05 at p = 0.394163.
        assert!((clopper_pearson_upper(1, 10, 0.05) - 0.394_163).abs() < 1e-6);
        assert_eq!(clopper_pearson_upper(5, 5, 0.05), 1.0);
        assert_eq!(clopper_pearson_upper(0, 0, 0.05), 1.0);
    }

    #[test]
    fn known_quantiles() {
        // Abramowitz & Stegun, table 26.5 and 26.6.
        for (tail, z) in [(0.5, 0.0), (0.05, 1.644_853_627), (1e-6, 4.753_424_309)] {
            assert!((normal_quantile(tail) - z).abs() < 1e-7);
        }
        assert_eq!(normal_quantile(0.0), f64::INFINITY);
    }

    #[test]
    fn wilson_at_the_ends() {
        let (low, high) = wilson_interval(0, 1000, 1e-6);
        // z²/(n + z²).
        assert!(low == 0.0 && (high - 22.595 / 1022.595).abs() < 1e-5);
        assert_eq!(wilson_interval(0, 0, 0.1), (0.0, 1.0));
        let (low, high) = wilson_interval(1000, 1000, 0.01);
        assert!(low > 0.99 && high > 1.0 - 1e-12);
    }

    #[test]
    fn bernstein_covers_a_rare_large_weight() {
        // X = 100 with probability 1/100: mean 1, variance 99, range 99. With n = 50 the sample is often all zero and
        // its own standard error 0; the bound must hold at 1e-2 in all but 1 % of the runs, 20 of 2000; 45 is 5.5 σ.
        let mut rng = Rng::from_name("bernstein_covers_a_rare_large_weight");
        let bound = bernstein_deviation(99.0, 99.0, 50, 1e-2);
        let mut outside = 0;
        for _ in 0..2000 {
            let mean = (0..50)
                .map(|_| if rng.next_f64() < 0.01 { 2.0 } else { 0.0 })
                .sum::<f64>();
            outside += u32::from((mean - 1.0).abs() > bound);
        }
        assert!(outside <= 45, "{outside}");
        // It is no idle bound: with many numbers it shrinks to a small multiple of σ/√n.
        let many = bernstein_deviation(99.0, 99.0, 1_000_000, 1e-2);
        assert!(many < 4.0 * (99.0f64 / 1e6).sqrt());
    }
}
