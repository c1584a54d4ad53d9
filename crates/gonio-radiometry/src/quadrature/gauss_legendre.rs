//! [`GaussLegendre`] quadrature.

use gonio_num::Real;
use std::f64::consts::PI;

/// The n-point Gauss–Legendre rule: ∫₋₁¹ f ≈ Σ wᵢ f(xᵢ), exact for polynomials of degree up to 2n − 1.
///
/// ```
/// use gonio_radiometry::quadrature::GaussLegendre;
/// let rule = GaussLegendre::new(3);
/// let [integral] = rule.integrate(0.0, 2.0, |x| [x * x * x]);
/// assert!((integral - 4.0).abs() < 1e-14);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct GaussLegendre {
    nodes: Vec<f64>,
    weights: Vec<f64>,
}

impl GaussLegendre {
    /// The rule of `n` nodes, each found by Newton's method on the Legendre polynomial Pₙ, to the last digit or two;
    /// O(n²) operations.
    ///
    /// # Panics
    /// If n is 0.
    pub fn new(n: usize) -> Self {
        assert!(n > 0, "a quadrature rule needs at least one node");
        let mut nodes = vec![0.0; n];
        let mut weights = vec![0.0; n];
        for i in 0..n.div_ceil(2) {
            // Tricomi's approximation, good enough that Newton's method converges to the right root.
            let mut x = Real::cos(PI * (i as f64 + 0.75) / (n as f64 + 0.5));
            for _ in 0..100 {
                let (p, derivative) = legendre(n, x);
                let step = p / derivative;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            if 2 * i + 1 == n {
                x = 0.0;
            }
            let (_, derivative) = legendre(n, x);
            let weight = 2.0 / ((1.0 - x * x) * derivative * derivative);
            nodes[i] = -x;
            nodes[n - 1 - i] = x;
            weights[i] = weight;
            weights[n - 1 - i] = weight;
        }
        Self { nodes, weights }
    }

    /// The nodes in (−1, 1), rising; symmetric about 0.
    pub fn nodes(&self) -> &[f64] {
        &self.nodes
    }

    /// The weights, positive, whose sum is 2.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The rule moved to [a, b]: (node, weight) pairs, rising from a to b; b < a gives negative weights.
    pub fn on(&self, a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> + Clone + '_ {
        let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
        let pairs = self.nodes.iter().zip(&self.weights);
        pairs.map(move |(x, w)| (centre + half * x, half * w))
    }

    /// ∫ f over [a, b]; with b < a its negative.
    pub fn integrate<const N: usize>(
        &self,
        a: f64,
        b: f64,
        mut f: impl FnMut(f64) -> [f64; N],
    ) -> [f64; N] {
        let mut sum = [0.0; N];
        for (x, weight) in self.on(a, b) {
            let values = f(x);
            for (s, v) in sum.iter_mut().zip(values) {
                *s += weight * v;
            }
        }
        sum
    }
}

/// Pₙ(x) and its derivative, for |x| < 1, by Bonnet's recursion.
fn legendre(n: usize, x: f64) -> (f64, f64) {
    let (mut previous, mut p) = (0.0, 1.0);
    for k in 0..n {
        let k = k as f64;
        let next = ((2.0 * k + 1.0) * x * p - k * previous) / (k + 1.0);
        previous = p;
        p = next;
    }
    (p, n as f64 * (x * p - previous) / (x * x - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_small_rules_are_the_published_ones() {
        let two = GaussLegendre::new(2);
        assert!((two.nodes()[1] - (1.0f64 / 3.0).sqrt()).abs() < 1e-15);
        assert_eq!(GaussLegendre::new(1).nodes(), [0.0]);
        assert!((GaussLegendre::new(1).weights()[0] - 2.0).abs() < 1e-15);
        // Abramowitz and Stegun, table 25.4.
        let five = GaussLegendre::new(5);
        let nodes = [0.0, 0.538_469_310_105_683, 0.906_179_845_938_664];
        let weights = [
            0.568_888_888_888_889,
            0.478_628_670_499_366,
            0.236_926_885_056_189,
        ];
        for i in 0..3 {
            assert!((five.nodes()[2 + i] - nodes[i]).abs() < 1e-14);
            assert!((five.weights()[2 - i] - weights[i]).abs() < 1e-14);
        }
    }

    /// Exact to rounding up to degree 2n − 1, and not beyond: the negative control.
    #[test]
    fn exact_to_degree_two_n_minus_one() {
        for n in [1, 2, 3, 7, 16, 33] {
            let rule = GaussLegendre::new(n);
            for degree in 0..2 * n {
                let [found] = rule.integrate(0.0, 1.0, |x| [x.powi(degree as i32)]);
                assert!(
                    (found - 1.0 / (degree + 1) as f64).abs() < 1e-14,
                    "{n} {degree}"
                );
            }
            if n <= 7 {
                let [beyond] = rule.integrate(-1.0, 1.0, |x| [x.powi(2 * n as i32)]);
                assert!((beyond - 2.0 / (2 * n + 1) as f64).abs() > 1e-8, "{n}");
            }
        }
    }

    #[test]
    fn large_rules_are_sound() {
        for n in [100, 501, 2000] {
            let rule = GaussLegendre::new(n);
            assert!((rule.weights().iter().sum::<f64>() - 2.0).abs() < 1e-12);
            assert!(rule.nodes().windows(2).all(|w| w[0] < w[1]));
            assert!(rule.nodes()[0] > -1.0 && rule.weights().iter().all(|&w| w > 0.0));
        }
    }

    #[test]
    #[should_panic(expected = "at least one node")]
    fn a_rule_without_nodes_is_refused() {
        let _ = GaussLegendre::new(0);
    }
}
