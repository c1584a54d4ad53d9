//! How hard to look, and how large a violation may be before it is one.

use crate::statistics::sidak;

/// How hard to look.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Effort {
    /// For the tests that run at each change: some 10⁵ evaluations a property.
    Quick,
    /// For a release or a paper's table: some 10⁶ evaluations a property.
    #[default]
    Standard,
    /// For a night: some 10⁷ evaluations a property.
    Thorough,
}

/// The number format inside the subject's closures; it sets how much disagreement is only rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    /// `f32` inside.
    Single,
    /// `f64` inside.
    #[default]
    Double,
}

/// Sample counts and bounds. [`Settings::new`] gives the usual ones for an [`Effort`]; each can be changed.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Settings {
    /// The number format inside the subject.
    pub precision: Precision,
    /// Pairs of directions for the deterministic properties (reciprocity, isotropy, linearity, signs).
    pub pairs: u64,
    /// Outgoing directions for energy, densities and weights.
    pub directions: u32,
    /// Samples a direction for densities and weights.
    pub density_samples: u64,
    /// Cells of the χ² partition of the sphere (about as many; sparse ones are pooled).
    pub cells: u32,
    /// Evaluations that one integral over the sphere may take.
    pub quadrature_evaluations: u64,
    /// Probability that a statistical verdict fails although the subject is right, over all directions of the verdict.
    pub false_positive_rate: f64,
    /// Relative difference allowed between values that ought to be equal (reciprocity, isotropy, linearity).
    pub relative_bound: f64,
    /// Relative difference allowed between a sample's weight and density and those from `eval` and `pdf`.
    pub weight_bound: f64,
    /// How far a directional albedo may exceed 1.
    pub energy_bound: f64,
    /// How far a directional albedo may fall short of 1; `None`: any distance is information.
    pub loss_bound: Option<f64>,
    /// How much of a typical f the value f·|cosθi| at the horizon may be.
    pub continuity_bound: f64,
    /// Relative difference allowed between the subject and itself in single precision.
    pub single_bound: f64,
    /// How far the integral of the density may be from the sampled fraction.
    pub integral_bound: f64,
}

impl Settings {
    /// The usual settings for `effort`, in double precision.
    pub fn new(effort: Effort) -> Self {
        let (pairs, directions, density_samples, cells, quadrature_evaluations) = match effort {
            Effort::Quick => (4_000, 4, 40_000, 256, 40_000),
            Effort::Standard => (40_000, 8, 200_000, 512, 200_000),
            Effort::Thorough => (400_000, 16, 1_000_000, 1024, 1_000_000),
        };
        Self {
            precision: Precision::Double,
            pairs,
            directions,
            density_samples,
            cells,
            quadrature_evaluations,
            false_positive_rate: 1e-6,
            relative_bound: 1e-6,
            weight_bound: 1e-6,
            energy_bound: 1e-4,
            loss_bound: None,
            continuity_bound: 1e-3,
            single_bound: 1e-2,
            integral_bound: 1e-3,
        }
    }

    /// For one of `points` checks that are judged together, such as those of a sweep over parameters: some 10⁴ evaluations a
    /// property, and a chance of a false alarm that is that of [`Settings::new`] over all of them.
    pub fn glance(points: u64) -> Self {
        let usual = Self::new(Effort::Quick);
        Self {
            pairs: 1_000,
            directions: 3,
            density_samples: 8_000,
            cells: 96,
            quadrature_evaluations: 40_000,
            false_positive_rate: sidak(usual.false_positive_rate, points.max(1)),
            ..usual
        }
    }

    /// The same settings with bounds for a subject that computes in `precision`.
    ///
    /// `f32` carries 6e-8 a rounding; a sharp lobe multiplies it by the lobe's relative slope, some 10³ at
    /// alpha = 0.03: hence 1e-3 between two evaluations that ought to be equal.
    pub fn with_precision(mut self, precision: Precision) -> Self {
        self.precision = precision;
        match precision {
            Precision::Double => {
                self.relative_bound = 1e-6;
                self.weight_bound = 1e-6;
            }
            Precision::Single => {
                self.relative_bound = 1e-3;
                self.weight_bound = 1e-3;
            }
        }
        self
    }

    /// A relative size below which a number is only rounding.
    pub(crate) fn rounding(&self) -> f64 {
        match self.precision {
            Precision::Double => 1e-12,
            Precision::Single => 1e-5,
        }
    }

    /// The heights z at which a light is looked at on its way to the horizon. The last is far below the width of every lobe
    /// that the precision can carry, and above the 1e-6 or less at which code guards a division by cosθ: a guard makes a jump look as if
    /// light faded.
    pub(crate) fn sinking(&self) -> [f64; 2] {
        match self.precision {
            Precision::Double => [1e-4, 2e-6],
            Precision::Single => [1e-4, 1e-5],
        }
    }

    /// How far directions are moved, in radians, to see whether a violation is more than a point on an edge.
    pub(crate) fn nudge(&self) -> f64 {
        match self.precision {
            Precision::Double => 1e-7,
            Precision::Single => 1e-4,
        }
    }
}
