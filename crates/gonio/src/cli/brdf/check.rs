//! `gonio brdf check`.

use super::exec;
use super::files::{self, Files};
use crate::cli::failure::Failure;
use crate::cli::terminal::{print, print_json, warn};
use clap::ValueEnum;
use gonio_brdf::{Model, ModelSpec};
use gonio_report::Section;
use gonio_verify::{Effort, Report};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

pub(super) const HELP: &str = "Examples:\n  gonio brdf check all\n  gonio brdf check phong:exponent=20 --effort thorough\n  \
    gonio brdf check ggx:metal=gold --html gold.html --junit gold.xml\n  gonio brdf check --exec 'python3 mine.py'\n\n\
    Exits with 1 if a property fails that is not declared to be missing.";

#[derive(clap::Args)]
#[group(id = "check")]
#[command(group = clap::ArgGroup::new("subject").required(true).args(["spec", "exec"]))]
pub(in crate::cli) struct Arguments {
    /// NAME, NAME:key=value,…, or all
    #[arg(conflicts_with = "exec")]
    pub(in crate::cli) spec: Option<String>,
    /// Check the function that this program evaluates, see the book's "Functions in other programs"
    #[arg(long, value_name = "COMMAND")]
    exec: Option<String>,
    /// Seconds that an answer of the program may take
    #[arg(long, value_name = "SECONDS", default_value = "60", conflicts_with = "spec", value_parser = exec::seconds)]
    exec_timeout: Duration,
    /// How hard to look
    #[arg(long, value_enum, default_value_t = EffortName::Standard)]
    effort: EffortName,
    /// Print the reports as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    files: Files,
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
    // Before any time is spent.
    arguments.files.writable()?;
    let sections = match (&arguments.exec, &arguments.spec) {
        (Some(command), _) => vec![exec::check(
            command,
            arguments.exec_timeout,
            arguments.effort.into(),
        )?],
        (None, Some(spec)) => named(spec, arguments)?,
        // The parser asks for one of both.
        (None, None) => Vec::new(),
    };
    if arguments.exec.is_some() && !arguments.json {
        for section in &sections {
            print(&format!("{}\n", section.report))?;
        }
    }
    let reports: Vec<Report> = sections.iter().map(|s| s.report.clone()).collect();
    if arguments.json {
        print_json(&reports)?;
    }
    arguments.files.write(sections, &again(arguments))?;
    judged(&reports)?;
    if !arguments.json && reports.len() > 1 {
        print(&format!("{} reflection functions passed", reports.len()))?;
    }
    Ok(())
}

/// Checks models of the registry, and prints each report when it is there.
fn named(text: &str, arguments: &Arguments) -> Result<Vec<Section>, Failure> {
    let specs = if text == "all" {
        gonio_brdf::showcase()
    } else {
        vec![ModelSpec::parse(text)?]
    };
    let bar = ProgressBar::new(specs.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {pos}/{len} {wide_msg}") {
        bar.set_style(style.progress_chars("━━─"));
    }
    let mut sections = Vec::new();
    for spec in &specs {
        if spec.reads_files() {
            let model: Model<f32, 3> = spec.build()?;
            for line in model.warnings() {
                bar.suspend(|| warn(&line));
            }
        }
        bar.set_message(spec.to_string());
        bar.tick();
        let began = Instant::now();
        let report = gonio_brdf::check(spec, arguments.effort.into())?;
        if !arguments.json {
            bar.suspend(|| print(&format!("{report}\n\n")))?;
        }
        sections.push(files::section(spec, report, began.elapsed())?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(sections)
}

/// The command line that gives the same verdicts.
fn again(arguments: &Arguments) -> String {
    let mut words = vec!["gonio".to_owned(), "brdf".into(), "check".into()];
    if let Some(spec) = &arguments.spec {
        words.push(quoted(spec));
    }
    if let Some(command) = &arguments.exec {
        words.extend(["--exec".into(), quoted(command)]);
    }
    if let Some(effort) = arguments.effort.to_possible_value() {
        words.extend(["--effort".into(), effort.get_name().to_owned()]);
    }
    words.join(" ")
}

/// A word as a shell takes it for one.
fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,@%+".contains(c);
    match !word.is_empty() && word.chars().all(plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
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

    #[test]
    fn words_are_quoted_for_a_shell() {
        assert_eq!(
            quoted("ggx:roughness=0.3,metal=gold"),
            "ggx:roughness=0.3,metal=gold"
        );
        assert_eq!(quoted("sum(a, b)"), "'sum(a, b)'");
        assert_eq!(quoted("it's"), "'it'\\''s'");
        assert_eq!(quoted(""), "''");
    }

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
