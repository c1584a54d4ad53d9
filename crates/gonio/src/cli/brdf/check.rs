//! `gonio brdf check`.

use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json, warn};
use gonio_brdf::{Model, ModelSpec};
use gonio_verify::{Effort, Report};
use indicatif::{ProgressBar, ProgressStyle};

pub(super) const HELP: &str = "Examples:\n  gonio brdf check all\n  gonio brdf check phong:exponent=20 --effort thorough\n\n\
    Exits with 1 if a property fails that is not declared to be missing.";

#[derive(clap::Args)]
pub(in crate::cli) struct Arguments {
    /// NAME, NAME:key=value,…, or all
    pub(in crate::cli) spec: String,
    /// How hard to look
    #[arg(long, value_enum, default_value_t = EffortName::Standard)]
    effort: EffortName,
    /// Print the reports as JSON
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub(in crate::cli) enum EffortName {
    /// About a tenth of a second a model
    Quick,
    /// About a second a model
    Standard,
    /// About ten seconds a model
    Thorough,
}

impl From<EffortName> for Effort {
    fn from(name: EffortName) -> Self {
        match name {
            EffortName::Quick => Self::Quick,
            EffortName::Standard => Self::Standard,
            EffortName::Thorough => Self::Thorough,
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { spec, effort, json } = arguments;
    let (text, effort, json) = (spec.as_str(), Effort::from(*effort), *json);
    let specs = if text == "all" {
        gonio_brdf::showcase()
    } else {
        vec![ModelSpec::parse(text)?]
    };
    let bar = ProgressBar::new(specs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {pos}/{len} {wide_msg}") {
        bar.set_style(style.progress_chars("━━─"));
    }
    let mut reports: Vec<Report> = Vec::new();
    for spec in &specs {
        if spec.reads_files() {
            let model: Model<f32, 3> = spec.build()?;
            for line in model.warnings() {
                bar.suspend(|| warn(&line));
            }
        }
        bar.set_message(spec.to_string());
        bar.tick();
        let report = gonio_brdf::check(spec, effort)?;
        if !json {
            bar.suspend(|| print(&format!("{report}\n\n")))?;
        }
        reports.push(report);
        bar.inc(1);
    }
    bar.finish_and_clear();
    if json {
        print_json(&reports)?;
    }
    judged(&reports)?;
    if !json && reports.len() > 1 {
        print(&format!("{} reflection functions passed", reports.len()))?;
    }
    Ok(())
}

/// Fails if a report says that its subject is not as declared.
fn judged(reports: &[Report]) -> Result<(), Failure> {
    let failed: Vec<&str> = reports
        .iter()
        .filter(|r| !r.passed())
        .map(|r| r.subject.as_str())
        .collect();
    if failed.is_empty() {
        return Ok(());
    }
    Err(
        Failure::verification(format!("not as declared: {}", failed.join(", "))).with_help(
            "each property that failed is shown above with the directions it is worst for",
        ),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use gonio_num::Vec3;
    use gonio_verify::{Expectation, Subject};

    /// No model of the registry is other than it declares, so a closure is: a diffuse surface of albedo 2.
    #[test]
    fn a_verdict_that_fails_exits_with_1() {
        let report = |albedo: f64| {
            let eval = |wi: Vec3<f64>, wo: Vec3<f64>| match wi.z > 0.0 && wo.z > 0.0 {
                true => [albedo / std::f64::consts::PI; 3],
                false => [0.0; 3],
            };
            let subject = Subject::new("diffuse", &eval);
            gonio_verify::check(
                &subject,
                &Expectation::default(),
                Effort::Quick,
                "exit code",
            )
            .unwrap()
        };
        assert_eq!(judged(&[report(0.5)]), Ok(()));
        let failure = judged(&[report(0.5), report(2.0)]).unwrap_err();
        assert_eq!(failure.code(), 1);
    }
}
