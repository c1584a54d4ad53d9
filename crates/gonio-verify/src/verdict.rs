//! What a check found.

use gonio_num::{Real, Vec3};
use serde::Serialize;

/// What is checked of a reflection function.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Property {
    /// Every returned number is finite, at random and at adversarial inputs.
    Finite,
    /// f, pdf and weight ≥ 0.
    NonNegative,
    /// A function that only reflects is exactly 0 below the horizon, and draws nothing there.
    Horizon,
    /// f·|cosθi| falls to 0 as the light sinks to the horizon.
    Continuity,
    /// f(ωi→ωr) = f(ωr→ωi).
    Reciprocity,
    /// Directional albedo ≤ 1.
    EnergyConservation,
    /// How far the directional albedo falls short of 1.
    EnergyLoss,
    /// f depends on φi − φr only.
    Isotropy,
    /// f is the sum of its components.
    Linearity,
    /// ∫ pdf = 1 − the fraction of draws that give nothing.
    PdfIntegral,
    /// Drawn directions are distributed as pdf says (χ²).
    SampleDensity,
    /// weight = f·|cosθi| / pdf, the returned density = pdf, and every direction that reflects can be drawn.
    SampleWeight,
    /// The same function in single precision gives the same values.
    SinglePrecision,
    /// What is declared as lacking is lacking.
    Declarations,
}

impl Property {
    /// All properties, in the order of a report.
    pub const ALL: [Self; 14] = [
        Self::Finite,
        Self::NonNegative,
        Self::Horizon,
        Self::Continuity,
        Self::Reciprocity,
        Self::EnergyConservation,
        Self::EnergyLoss,
        Self::Isotropy,
        Self::Linearity,
        Self::PdfIntegral,
        Self::SampleDensity,
        Self::SampleWeight,
        Self::SinglePrecision,
        Self::Declarations,
    ];

    /// The property in plain words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finite => "finite",
            Self::NonNegative => "non-negative",
            Self::Horizon => "horizon",
            Self::Continuity => "continuity",
            Self::Reciprocity => "reciprocity",
            Self::EnergyConservation => "energy",
            Self::EnergyLoss => "energy loss",
            Self::Isotropy => "isotropy",
            Self::Linearity => "linearity",
            Self::PdfIntegral => "pdf integral",
            Self::SampleDensity => "sample density",
            Self::SampleWeight => "sample weight",
            Self::SinglePrecision => "single precision",
            Self::Declarations => "declarations",
        }
    }

    /// The property as one word, as a command line has it: [`Property::name`] with hyphens.
    pub fn key(self) -> String {
        self.name().replace(' ', "-")
    }

    /// The property of this [key](Property::key) or name.
    pub fn find(word: &str) -> Option<Self> {
        let word = word.trim().to_lowercase().replace([' ', '_'], "-");
        Self::ALL.into_iter().find(|p| p.key() == word)
    }
}

impl std::fmt::Display for Property {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}

/// How a property came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// No violation found.
    Pass,
    /// Violated, and not declared.
    Fail,
    /// Violated, and the one who asked allows it.
    Allowed,
    /// Violated as declared; the figure is what it costs.
    Declared,
    /// Measured, and held to no bound.
    Information,
    /// Not checked; the detail says why.
    NotApplicable,
}

/// A direction with its angles, for people and for JSON.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Direction {
    /// Cartesian, local frame, normal +z.
    pub xyz: [f64; 3],
    /// Angle from the normal in degrees, [0, 180].
    pub theta_deg: f64,
    /// Azimuth from +x in degrees, (−180, 180].
    pub phi_deg: f64,
}

impl From<Vec3<f64>> for Direction {
    fn from(w: Vec3<f64>) -> Self {
        let sin = (w.x * w.x + w.y * w.y).sqrt();
        Self {
            xyz: w.to_array(),
            theta_deg: Real::atan2(sin, w.z).to_degrees(),
            phi_deg: Real::atan2(w.y, w.x).to_degrees(),
        }
    }
}

impl Direction {
    /// The direction as a vector.
    pub fn vector(&self) -> Vec3<f64> {
        self.xyz.into()
    }
}

impl std::fmt::Display for Direction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [x, y, z] = self.xyz;
        write!(
            f,
            "θ {:.4}° φ {:.4}° ({x:.9}, {y:.9}, {z:.9})",
            self.theta_deg, self.phi_deg
        )
    }
}

/// A named number beside a witness.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Value {
    /// What the number is.
    pub name: String,
    /// The number; JSON has `null` where it isn't finite.
    pub value: f64,
}

/// Where to look: the worst place found, enough to reproduce it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Witness {
    /// Towards the light, where one is concerned.
    pub wi: Option<Direction>,
    /// Towards the viewer.
    pub wo: Direction,
    /// The numbers given to `sample`, where it is concerned.
    pub u: Option<[f64; 3]>,
    /// What was found there.
    pub values: Vec<Value>,
}

impl Witness {
    /// A witness at an outgoing direction.
    pub fn at(wo: Vec3<f64>) -> Self {
        Self {
            wi: None,
            wo: wo.into(),
            u: None,
            values: Vec::new(),
        }
    }

    /// A witness at a pair of directions.
    pub fn pair(wi: Vec3<f64>, wo: Vec3<f64>) -> Self {
        Self {
            wi: Some(wi.into()),
            ..Self::at(wo)
        }
    }

    /// Adds the numbers given to `sample`.
    pub fn drawn(mut self, u: [f64; 3]) -> Self {
        self.u = Some(u);
        self
    }

    /// Adds a named number.
    pub fn value(mut self, name: impl Into<String>, value: f64) -> Self {
        self.values.push(Value {
            name: name.into(),
            value,
        });
        self
    }
}

/// An interval that holds the true value with probability `level` (1: surely, as far as the stated error bound holds).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Probability that the interval holds the true value.
    pub level: f64,
}

/// What was found of one property.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// The property.
    pub property: Property,
    /// How it came out.
    pub outcome: Outcome,
    /// The size of the worst violation or the quantity looked at; the detail says which. NaN where nothing was measured.
    pub figure: f64,
    /// The largest figure that isn't a violation (for the density test the smallest p-value that passes).
    pub bound: f64,
    /// Where the true figure lies, when the figure is estimated.
    pub confidence: Option<Interval>,
    /// Probability of a figure this large under a right subject, corrected for the number of directions.
    pub p_value: Option<f64>,
    /// The worst place found.
    pub witness: Option<Witness>,
    /// Evaluations and samples taken.
    pub samples: u64,
    /// Designed probability that a right subject fails. 0: no chance is involved, and the bound is above what rounding
    /// and quadrature can make.
    pub false_positive_rate: f64,
    /// One sentence.
    pub detail: String,
    /// Something worth knowing that isn't a verdict.
    pub note: Option<String>,
}

impl Verdict {
    /// A verdict that isn't given, and why.
    pub fn not_applicable(property: Property, why: impl Into<String>) -> Self {
        Self {
            property,
            outcome: Outcome::NotApplicable,
            figure: f64::NAN,
            bound: f64::NAN,
            confidence: None,
            p_value: None,
            witness: None,
            samples: 0,
            false_positive_rate: 0.0,
            detail: why.into(),
            note: None,
        }
    }

    /// A passing verdict without chance, to be filled in.
    pub(crate) fn passing(property: Property, figure: f64, bound: f64, samples: u64) -> Self {
        Self {
            property,
            outcome: Outcome::Pass,
            figure,
            bound,
            confidence: None,
            p_value: None,
            witness: None,
            samples,
            false_positive_rate: 0.0,
            detail: String::new(),
            note: None,
        }
    }

    /// Whether it was found violated, be that a failure, declared or allowed.
    pub fn violated(&self) -> bool {
        matches!(
            self.outcome,
            Outcome::Fail | Outcome::Declared | Outcome::Allowed
        )
    }

    /// Sets the outcome from whether the property is violated and whether it was declared to hold.
    pub(crate) fn judge(mut self, violated: bool, declared_to_hold: bool) -> Self {
        self.outcome = match (violated, declared_to_hold) {
            (false, _) => Outcome::Pass,
            (true, true) => Outcome::Fail,
            (true, false) => Outcome::Declared,
        };
        self
    }
}
