//! Running mean and variance.

/// Count, mean and second central moment of the numbers seen so far.
///
/// Source: Welford 1962 for one number; Chan, Golub & LeVeque 1979 for merging.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct Moments {
    count: u64,
    mean: f64,
    m2: f64,
}

impl Moments {
    /// The moments of no numbers.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds one number.
    #[inline]
    pub fn push(&mut self, x: f64) {
        self.count += 1;
        let before = x - self.mean;
        self.mean += before / self.count as f64;
        self.m2 += before * (x - self.mean);
    }

    /// The moments of both sets of numbers together.
    pub fn merge(self, other: Self) -> Self {
        if self.count == 0 {
            return other;
        }
        if other.count == 0 {
            return self;
        }
        let count = self.count + other.count;
        let (n, a, b) = (count as f64, self.count as f64, other.count as f64);
        let d = other.mean - self.mean;
        Self {
            count,
            mean: self.mean + d * (b / n),
            m2: self.m2 + other.m2 + d * d * (a * b / n),
        }
    }

    /// How many numbers.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Their mean; 0 of none.
    pub fn mean(&self) -> f64 {
        self.mean
    }

    /// The unbiased variance Σ(x − mean)² / (n − 1); 0 of fewer than two numbers.
    pub fn variance(&self) -> f64 {
        if self.count < 2 {
            0.0
        } else {
            self.m2 / (self.count - 1) as f64
        }
    }

    /// The variance of the mean: variance / n.
    pub fn variance_of_mean(&self) -> f64 {
        if self.count == 0 {
            0.0
        } else {
            self.variance() / self.count as f64
        }
    }
}

impl Extend<f64> for Moments {
    fn extend<I: IntoIterator<Item = f64>>(&mut self, numbers: I) {
        for x in numbers {
            self.push(x);
        }
    }
}

impl FromIterator<f64> for Moments {
    fn from_iter<I: IntoIterator<Item = f64>>(numbers: I) -> Self {
        let mut m = Self::new();
        m.extend(numbers);
        m
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn small_sample() {
        let m: Moments = [2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]
            .into_iter()
            .collect();
        assert_eq!((m.count(), m.mean()), (8, 5.0));
        assert!((m.variance() - 32.0 / 7.0).abs() < 1e-14);
        assert!((m.variance_of_mean() - 4.0 / 7.0).abs() < 1e-14);
        assert_eq!(Moments::new().variance(), 0.0);
    }

    #[test]
    fn a_large_offset_costs_no_digits() {
        // Σx² − (Σx)²/n in f64 would have lost everything: 1e9² holds 18 digits.
        let m: Moments = (0..1000).map(|i| 1e9 + f64::from(i % 2)).collect();
        assert!((m.variance() - 0.25 * 1000.0 / 999.0).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn merging_is_adding(a in prop::collection::vec(-10.0..10.0f64, 0..50), b in prop::collection::vec(-10.0..10.0f64, 0..50)) {
            let both: Moments = a.iter().chain(&b).copied().collect();
            let merged = a.iter().copied().collect::<Moments>().merge(b.iter().copied().collect());
            prop_assert_eq!(both.count(), merged.count());
            // A hundred numbers up to 10, a rounding each.
            prop_assert!((both.mean() - merged.mean()).abs() < 1e-12);
            prop_assert!((both.variance() - merged.variance()).abs() < 1e-10);
        }
    }
}
