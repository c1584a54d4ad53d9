//! How often what is right fails: many seeded runs, and what they say of the rate.

use super::{Specimen, right};
use crate::statistics::clopper_pearson_upper;
use crate::{Effort, Progress, Property, Settings, SubjectFailed};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// The outcome of [`calibrate`].
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Calibration {
    /// Suites run: one check of one right function with a seed of its own.
    pub runs: u64,
    /// The suites that failed: the function, the seed's number, the property.
    pub alarms: Vec<(String, u64, String)>,
    /// The p-values of all density tests in order.
    #[serde(skip)]
    pub p_values: Vec<f64>,
    /// How many p-values there are, and how many of them are below 0.01.
    pub p_count: [u64; 2],
    /// The median p-value.
    pub p_median: f64,
}

impl Calibration {
    /// The suites that failed.
    pub fn failures(&self) -> u64 {
        self.alarms.len() as u64
    }

    /// The rate of false alarms is below this with a confidence of 95 % (Clopper and Pearson 1934).
    pub fn upper_bound(&self) -> f64 {
        clopper_pearson_upper(self.failures(), self.runs, 0.05)
    }
}

/// Counts of a short suite: the tests are those of every effort, with fewer looks, and so is their designed rate of false alarms.
pub fn short() -> Settings {
    Settings {
        pairs: 100,
        directions: 2,
        density_samples: 4000,
        cells: 64,
        quadrature_evaluations: 40_000,
        ..Settings::new(Effort::Quick)
    }
}

/// Checks each right function `runs` times, each time with another seed.
///
/// # Errors
/// Never: they always answer.
pub fn calibrate(
    runs: u64,
    settings: Settings,
    progress: &Progress,
) -> Result<Calibration, SubjectFailed> {
    let specimens = right();
    let done = std::sync::atomic::AtomicU64::new(0);
    let of = runs * specimens.len() as u64;
    let suites: Vec<(&Specimen, u64)> = (0..runs)
        .flat_map(|run| specimens.iter().map(move |s| (s, run)))
        .collect();
    let reports = suites.par_iter().map(|(specimen, run)| {
        let report = specimen.check(settings, &format!("{}, run {run}", specimen.name))?;
        progress(
            1 + done.fetch_add(1, std::sync::atomic::Ordering::Relaxed),
            of,
        );
        let failure = report.failures().next().map(|v| v.property);
        let density = report.verdict(Property::SampleDensity);
        Ok((failure, density.and_then(|v| v.p_value)))
    });
    let found = reports.collect::<Result<Vec<_>, SubjectFailed>>()?;
    let mut p_values: Vec<f64> = found.iter().filter_map(|(_, p)| *p).collect();
    p_values.sort_by(f64::total_cmp);
    let alarms = suites.iter().zip(&found).filter_map(|((s, run), (f, _))| {
        f.map(|property| (s.name.to_owned(), *run, property.key()))
    });
    Ok(Calibration {
        runs: of,
        alarms: alarms.collect(),
        p_count: [
            p_values.len() as u64,
            p_values.partition_point(|p| *p < 0.01) as u64,
        ],
        p_median: p_values
            .get(p_values.len() / 2)
            .copied()
            .unwrap_or(f64::NAN),
        p_values,
    })
}
