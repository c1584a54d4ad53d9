//! [`Discrete`], a choice among finitely many things.

use super::cdf::{self, Cdf};
use crate::RadiometryError;

/// A choice of index i with probability ∝ weight i.
///
/// By inversion of the cumulative sum (not an alias table), so that the choice is monotone in u: stratified u stay
/// stratified, and the rest of u can be used again.
///
/// ```
/// use gonio_radiometry::warp::Discrete;
/// let lights = Discrete::new(&[1.0, 0.0, 3.0])?;
/// let (index, probability, rest) = lights.sample(0.625);
/// assert_eq!((index, probability, rest), (2, 0.75, 0.5));
/// # Ok::<(), gonio_radiometry::RadiometryError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Discrete {
    starts: Box<[u32]>,
    last: u32,
    sum: f64,
}

impl Discrete {
    /// The choice by these weights, in any unit.
    ///
    /// # Errors
    /// [`RadiometryError::TableShape`] for none or more than 2²⁴ weights, [`RadiometryError::TableEntry`] for one that is
    /// negative or not finite, [`RadiometryError::TableAllZero`] if all are zero.
    pub fn new(weights: &[f32]) -> Result<Self, RadiometryError> {
        cdf::check(weights, weights.len(), 1)?;
        let mut starts = vec![0; weights.len()].into_boxed_slice();
        let (sum, last) = cdf::accumulate(weights.iter().map(|&w| w.into()), &mut starts);
        if sum == 0.0 {
            return Err(RadiometryError::TableAllZero {
                entries: weights.len(),
            });
        }
        Ok(Self { starts, last, sum })
    }

    fn cdf(&self) -> Cdf<'_> {
        Cdf {
            starts: &self.starts,
            last: self.last,
        }
    }

    /// The index that u in [0, 1) chooses, its probability, and u remapped to [0, 1): the place of u within the interval of
    /// that index, with as many digits fewer as the choice used. An index of weight 0 is never chosen.
    pub fn sample(&self, u: f32) -> (usize, f32, f32) {
        self.sample_fine(u.into())
    }

    /// [`Discrete::sample`] with more digits: an index whose probability is less than 2⁻²⁴ is chosen as often as it should be.
    pub fn sample_fine(&self, u: f64) -> (usize, f32, f32) {
        let (index, within) = self.cdf().find(u);
        let rest = (within as f32).min(cdf::LARGEST_BELOW_ONE);
        (index, self.probability(index), rest)
    }

    /// The probability of the index; 0 past the end. It is exactly the one that is sampled: a multiple of 2⁻³² (rounded to
    /// `f32`), at least 2⁻³² for a positive weight.
    pub fn probability(&self, index: usize) -> f32 {
        (self.cdf().units(index) as f64 / cdf::UNITS as f64) as f32
    }

    /// The u in [0, 1) that chooses `index` and is remapped to `rest`, for an index below [`len`](Self::len).
    pub fn inverse(&self, index: usize, rest: f32) -> f32 {
        self.cdf().point(index, rest.into())
    }

    /// The sum of the weights.
    pub fn sum(&self) -> f64 {
        self.sum
    }

    /// The number of weights, at least 1.
    #[allow(clippy::len_without_is_empty)] // never empty
    pub fn len(&self) -> usize {
        self.starts.len()
    }
}
