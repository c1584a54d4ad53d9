//! Integrals of products of spectra.

use super::{Spectrum, WavelengthRange};

impl Spectrum {
    /// ∫ S(λ) dλ over `range` \[unit of the spectrum × nm\]. See [`Spectrum::integrate_product`].
    pub fn integrate(&self, range: WavelengthRange) -> f64 {
        Self::integrate_product(&[self], range)
    }

    /// ∫ S₁(λ) S₂(λ) … dλ over `range` \[product of the units × nm\].
    ///
    /// The rule: Simpson's, between neighbouring points of all the tables together. It is exact (to rounding) for a product
    /// of up to three tables or constants, since that is piecewise cubic. If any factor is smooth (a black body, a sigmoid, a
    /// function) the interval is also cut at whole nanometres: the error falls with the fourth power of 1 nm over the scale
    /// at which the factor changes.
    ///
    /// 0 if the range, or a factor's support in it, is empty. The range must be finite.
    pub fn integrate_product(factors: &[&Spectrum], range: WavelengthRange) -> f64 {
        let [sum] = Self::integrate_with(factors, range, |lambda| {
            [factors.iter().map(|s| s.at(lambda)).product()]
        });
        sum
    }

    /// ∫ f(λ) dλ by the same rule, where `f` is made of `factors`.
    pub(crate) fn integrate_with<const N: usize>(
        factors: &[&Spectrum],
        range: WavelengthRange,
        f: impl Fn(f64) -> [f64; N],
    ) -> [f64; N] {
        let mut sum = [0.0; N];
        let range = factors
            .iter()
            .fold(range, |range, s| range.intersection(s.support()));
        if range.width_nm() <= 0.0 || !range.max_nm.is_finite() {
            return sum;
        }
        let mut cuts = vec![range.min_nm, range.max_nm];
        for s in factors {
            s.push_cuts(range, &mut cuts);
        }
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let mut left = f(cuts[0]);
        for pair in cuts.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let middle = f(0.5 * (a + b));
            let right = f(b);
            for k in 0..N {
                sum[k] += (b - a) / 6.0 * (left[k] + 4.0 * middle[k] + right[k]);
            }
            left = right;
        }
        sum
    }

    /// Where an integral over `range` should be cut.
    fn push_cuts(&self, range: WavelengthRange, cuts: &mut Vec<f64>) {
        let inside = |l: &f64| *l > range.min_nm && *l < range.max_nm;
        match self {
            Self::Constant(_) => {}
            Self::Regular(t) => {
                cuts.extend((0..t.values().len()).map(|i| t.lambda_nm(i)).filter(inside));
            }
            Self::Irregular(t) => cuts.extend(t.lambda_nm().iter().copied().filter(inside)),
            Self::BlackBody(_) | Self::Sigmoid(_) | Self::Function(_) => {
                // A range far beyond the visible one is cut into wider pieces: the cost is bounded.
                let steps = range.width_nm().ceil().min(100_000.0);
                cuts.extend(
                    (1..steps as usize)
                        .map(|i| range.min_nm + range.width_nm() * (i as f64 / steps))
                        .filter(inside),
                );
            }
            Self::Product(p) => {
                p.0.push_cuts(range, cuts);
                p.1.push_cuts(range, cuts);
            }
        }
    }
}
