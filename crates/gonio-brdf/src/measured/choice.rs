//! Choosing an index with given probabilities.

/// Cumulative probabilities of the indices 0 … n − 1.
#[derive(Debug, Clone)]
pub(crate) struct Choice {
    /// P(index < k) for k = 0 … n; first 0, last 1.
    cumulative: Vec<f64>,
}

impl Choice {
    /// Probabilities proportional to `weights` ≥ 0, of which at least one is positive.
    pub(crate) fn new(weights: impl Iterator<Item = f64>) -> Self {
        let mut cumulative = vec![0.0];
        let mut sum = 0.0;
        for w in weights {
            sum += w;
            cumulative.push(sum);
        }
        for c in &mut cumulative {
            *c /= sum;
        }
        Self { cumulative }
    }

    /// The index that `u` in [0, 1) falls on, and where in its interval, [0, 1).
    pub(crate) fn sample(&self, u: f64) -> (usize, f64) {
        let last = self.cumulative.len() - 2;
        let k = self.cumulative.partition_point(|c| *c <= u);
        let k = k.saturating_sub(1).min(last);
        let rest = (u - self.cumulative[k]) / self.probability(k).max(1e-300);
        (k, rest.clamp(0.0, 1.0 - f64::EPSILON))
    }

    /// Probability of index `k`.
    pub(crate) fn probability(&self, k: usize) -> f64 {
        self.cumulative[k + 1] - self.cumulative[k]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_have_their_probabilities() {
        let c = Choice::new([1.0, 0.0, 3.0].into_iter());
        assert_eq!(c.sample(0.0).0, 0);
        assert_eq!(c.sample(0.249).0, 0);
        assert_eq!(c.sample(0.25).0, 2);
        assert_eq!(c.sample(1.0 - f64::EPSILON).0, 2);
        assert!((c.sample(0.625).1 - 0.5).abs() < 1e-15);
        assert_eq!(c.probability(1), 0.0);
    }
}
