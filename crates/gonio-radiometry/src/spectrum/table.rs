//! Tabulated spectra, linear between their points.

use super::WavelengthRange;
use crate::RadiometryError;

/// What a table is beyond its first and last point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Beyond {
    /// The value of the nearest point: what CIE 15 recommends where a measurement ends.
    Nearest,
    /// Zero: for sensitivities, and light that is known to end.
    Zero,
}

const POINTS: &str =
    "one or more points with finite values at finite, positive, strictly increasing wavelengths";

fn error(found: String) -> RadiometryError {
    RadiometryError::SpectrumPoints {
        found,
        expected: POINTS,
    }
}

fn check_values(values: &[f64]) -> Result<(), RadiometryError> {
    if values.is_empty() {
        return Err(error("no points".to_owned()));
    }
    match values.iter().position(|v| !v.is_finite()) {
        Some(i) => Err(error(format!("the value {} at point {i}", values[i]))),
        None => Ok(()),
    }
}

/// a at t = 0, b at t = 1; exact at both ends.
fn mix(a: f64, b: f64, t: f64) -> f64 {
    (1.0 - t) * a + t * b
}

/// Points at equal steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Regular {
    first_nm: f64,
    step_nm: f64,
    values: Vec<f64>,
    beyond: Beyond,
}

impl Regular {
    /// Points at `first_nm`, `first_nm + step_nm` …
    ///
    /// # Errors
    /// If there are no values, if one isn't finite, or if `first_nm` or `step_nm` isn't positive and finite.
    pub fn new(
        first_nm: f64,
        step_nm: f64,
        values: Vec<f64>,
        beyond: Beyond,
    ) -> Result<Self, RadiometryError> {
        check_values(&values)?;
        if !(first_nm.is_finite() && first_nm > 0.0) {
            return Err(error(format!("a first wavelength of {first_nm} nm")));
        }
        if !(step_nm.is_finite() && step_nm > 0.0) {
            return Err(error(format!("steps of {step_nm} nm")));
        }
        Ok(Self {
            first_nm,
            step_nm,
            values,
            beyond,
        })
    }

    /// The value at `lambda_nm`. O(1).
    pub fn at(&self, lambda_nm: f64) -> f64 {
        let last = self.values.len() - 1;
        let x = (lambda_nm - self.first_nm) / self.step_nm;
        if !(0.0..=last as f64).contains(&x) {
            return match self.beyond {
                Beyond::Zero => 0.0,
                Beyond::Nearest if x > 0.0 => self.values[last],
                Beyond::Nearest => self.values[0],
            };
        }
        let i = (x as usize).min(last.saturating_sub(1));
        mix(self.values[i], self.values[(i + 1).min(last)], x - i as f64)
    }

    /// The wavelength of point `i`.
    pub fn lambda_nm(&self, i: usize) -> f64 {
        self.first_nm + self.step_nm * i as f64
    }

    /// The values of the points.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// From the first point to the last.
    pub fn range(&self) -> WavelengthRange {
        WavelengthRange {
            min_nm: self.first_nm,
            max_nm: self.lambda_nm(self.values.len() - 1),
        }
    }

    /// What it is beyond its ends.
    pub fn beyond(&self) -> Beyond {
        self.beyond
    }
}

/// Points at any wavelengths.
#[derive(Debug, Clone, PartialEq)]
pub struct Irregular {
    lambda_nm: Vec<f64>,
    values: Vec<f64>,
    beyond: Beyond,
}

impl Irregular {
    /// Points at `lambda_nm`.
    ///
    /// # Errors
    /// If there are no points, if the two lengths differ, if the wavelengths aren't positive and strictly increasing, or if a
    /// number isn't finite.
    pub fn new(
        lambda_nm: Vec<f64>,
        values: Vec<f64>,
        beyond: Beyond,
    ) -> Result<Self, RadiometryError> {
        if lambda_nm.len() != values.len() {
            return Err(error(format!(
                "{} wavelengths and {} values",
                lambda_nm.len(),
                values.len()
            )));
        }
        check_values(&values)?;
        let mut previous = 0.0;
        for (i, &l) in lambda_nm.iter().enumerate() {
            if !(l.is_finite() && l > previous) {
                return Err(error(format!(
                    "the wavelength {l} nm at point {i}, after {previous} nm"
                )));
            }
            previous = l;
        }
        Ok(Self {
            lambda_nm,
            values,
            beyond,
        })
    }

    /// The value at `lambda_nm`. O(log points).
    pub fn at(&self, lambda_nm: f64) -> f64 {
        let last = self.values.len() - 1;
        let after = self.lambda_nm.partition_point(|&l| l <= lambda_nm);
        if after == 0 || after > last {
            let on_end = lambda_nm == self.lambda_nm[last];
            return match self.beyond {
                Beyond::Zero if !on_end => 0.0,
                _ if after == 0 => self.values[0],
                _ => self.values[last],
            };
        }
        let (a, b) = (self.lambda_nm[after - 1], self.lambda_nm[after]);
        mix(
            self.values[after - 1],
            self.values[after],
            (lambda_nm - a) / (b - a),
        )
    }

    /// The wavelengths of the points \[nm\], strictly increasing.
    pub fn lambda_nm(&self) -> &[f64] {
        &self.lambda_nm
    }

    /// The values of the points.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// From the first point to the last.
    pub fn range(&self) -> WavelengthRange {
        WavelengthRange {
            min_nm: self.lambda_nm[0],
            max_nm: self.lambda_nm[self.lambda_nm.len() - 1],
        }
    }

    /// What it is beyond its ends.
    pub fn beyond(&self) -> Beyond {
        self.beyond
    }
}
