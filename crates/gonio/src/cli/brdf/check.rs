//! `gonio brdf check`.

use super::exec;
use super::files::{self, Files};
use crate::cli::failure::{Failure, did_you_mean, nearest};
use crate::cli::terminal::{coloured, print, print_json, warn};
use clap::ValueEnum;
use gonio_brdf::{BrdfError, CheckOptions, Model, ModelSpec, check_with};
use gonio_report::Section;
use gonio_verify::{Effort, Outcome, Property, Report, Settings};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

pub(super) const HELP: &str = "\
Examples:
  gonio brdf check ggx:metal=gold,roughness=0.3
  gonio brdf check all --effort quick
  gonio brdf check gltf --sweep
  gonio brdf check sheen-charlie --max-loss 0.5
  gonio brdf check ggx:metal=gold --html gold.html --junit gold.xml
  gonio brdf check --exec 'python3 mine.py' --allow reciprocity

Each property has its figure, the bound that it is held to, the worst place
found (θ,φ of wi and wo in degrees), and how sure it is: n, the values looked
at; ±, the error of an integral; α, the chance that a right function fails.

Exits with 1 if a property fails that is neither declared to be missing nor
allowed.";

#[derive(clap::Args)]
#[group(id = "check")]
#[command(group = clap::ArgGroup::new("subject").required(true).args(["spec", "exec", "self_test"]))]
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
    /// Check points all over the space of the parameters that aren't given: ends, choices, and what is between
    #[arg(
        long, value_name = "POINTS", num_args = 0..=1, require_equals = true, default_missing_value = "256",
        value_parser = clap::value_parser!(u64).range(1..=1_000_000), conflicts_with_all = ["exec", "effort"]
    )]
    sweep: Option<u64>,
    /// Check the checker: functions that are right, and ones with known faults
    #[arg(long, conflicts_with_all = ["exec", "spec", "sweep", "effort", "json"])]
    self_test: bool,
    /// Properties that may be violated: reciprocity, energy, sample-density, …
    #[arg(long, value_name = "PROPERTY", value_delimiter = ',', value_parser = property)]
    allow: Vec<Property>,
    /// Fail if a directional albedo falls short of 1 by more than this
    #[arg(long, value_name = "FRACTION", value_parser = fraction)]
    max_loss: Option<f64>,
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

fn property(word: &str) -> Result<Property, String> {
    Property::find(word).ok_or_else(|| {
        let keys: Vec<String> = Property::ALL.iter().map(|p| p.key()).collect();
        match nearest(word, keys.iter().map(String::as_str)) {
            Some(near) => did_you_mean(&near),
            None => format!("properties are {}", keys.join(", ")),
        }
    })
}

fn fraction(word: &str) -> Result<f64, String> {
    match word.parse() {
        Ok(x) if (0.0..=1.0).contains(&x) => Ok(x),
        _ => Err("expected a number from 0 to 1".into()),
    }
}

impl Arguments {
    fn options(&self) -> CheckOptions<'static> {
        let effort = self.effort.into();
        CheckOptions {
            settings: Settings {
                loss_bound: self.max_loss,
                ..Settings::new(effort)
            },
            allow: self.allow.clone(),
            ..CheckOptions::new(effort)
        }
    }
}

pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.self_test {
        return super::self_test::run();
    }
    // Before any time is spent.
    arguments.files.writable()?;
    let sections = match checked_subjects(arguments) {
        Ok(sections) => sections,
        Err(failure) => {
            let subject = arguments.exec.as_ref().or(arguments.spec.as_ref());
            let subject = subject.map_or("", String::as_str);
            // What ended the check is to be said, even if the file can't be written either.
            let _ = arguments
                .files
                .write_error(subject, &failure, &again(arguments));
            return Err(failure);
        }
    };
    if arguments.exec.is_some() && !arguments.json {
        for section in &sections {
            print(&section.report.table(coloured()))?;
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

fn checked_subjects(arguments: &Arguments) -> Result<Vec<Section>, Failure> {
    match (&arguments.exec, &arguments.spec) {
        (Some(command), _) => Ok(vec![exec::check(
            command,
            arguments.exec_timeout,
            &arguments.options(),
            arguments.files.shows_plots(),
        )?]),
        (None, Some(spec)) => named(spec, arguments),
        // The parser asks for one of both.
        (None, None) => Ok(Vec::new()),
    }
}

/// Checks models of the registry, and prints each report when it is there.
fn named(text: &str, arguments: &Arguments) -> Result<Vec<Section>, Failure> {
    let specs = if text == "all" {
        gonio_brdf::showcase()
    } else {
        vec![ModelSpec::parse(text)?]
    };
    let options = arguments.options();
    let bar = Bar::new();
    if let Some(points) = arguments.sweep {
        return swept(&specs, points as usize, &options, &bar, arguments);
    }
    let mut sections = Vec::new();
    for (i, spec) in specs.iter().enumerate() {
        if spec.reads_files() {
            let model: Model<f32, 3> = spec.build()?;
            for line in model.warnings() {
                bar.0.suspend(|| warn(&line));
            }
        }
        let began = Instant::now();
        let report = checked(spec, &options, &bar, [i, specs.len()])?;
        if !arguments.json {
            let text = match specs.len() {
                1 => report.table(coloured()),
                _ => in_short(&report),
            };
            bar.0.suspend(|| print(&text))?;
        }
        let plots = arguments.files.shows_plots();
        sections.push(files::section(spec, report, began.elapsed(), plots)?);
    }
    bar.0.finish_and_clear();
    Ok(sections)
}

/// Sweeps models over their parameters; the worst of each property is its verdict.
fn swept(
    specs: &[ModelSpec],
    points: usize,
    options: &CheckOptions,
    bar: &Bar,
    arguments: &Arguments,
) -> Result<Vec<Section>, Failure> {
    let mut sections = Vec::new();
    for (i, spec) in specs.iter().enumerate() {
        bar.0.set_message(spec.to_string());
        let began = Instant::now();
        let progress = |done: u64, of: u64| {
            let part = done as f64 / of.max(1) as f64;
            bar.at((i as f64 + part) / specs.len() as f64);
        };
        let options = CheckOptions {
            progress: Some(&progress),
            ..options.clone()
        };
        let found = gonio_brdf::sweep(spec, points, &options)?;
        if !arguments.json {
            bar.0.suspend(|| print(&found.table(coloured())))?;
        }
        let report = found.report(Effort::Quick);
        let plots = arguments.files.shows_plots();
        sections.push(files::section(spec, report, began.elapsed(), plots)?);
    }
    bar.0.finish_and_clear();
    Ok(sections)
}

/// One of several checks.
fn checked(
    spec: &ModelSpec,
    options: &CheckOptions,
    bar: &Bar,
    [index, of]: [usize; 2],
) -> Result<Report, BrdfError> {
    bar.0.set_message(spec.to_string());
    let progress = |done: u64, steps: u64| {
        let part = done as f64 / steps.max(1) as f64;
        bar.at((index as f64 + part) / of as f64);
    };
    let options = CheckOptions {
        progress: Some(&progress),
        ..options.clone()
    };
    check_with(spec, &options)
}

/// A bar that is shown once a second has passed.
struct Bar(ProgressBar, Instant);

impl Bar {
    const WHOLE: u64 = 1000;

    fn new() -> Self {
        let bar = ProgressBar::with_draw_target(
            Some(Self::WHOLE),
            indicatif::ProgressDrawTarget::hidden(),
        );
        if let Ok(style) =
            ProgressStyle::with_template("{bar:18.cyan/dim} {percent:>3} % {wide_msg}")
        {
            bar.set_style(style.progress_chars("━━─"));
        }
        Self(bar, Instant::now())
    }

    /// The part that is done.
    fn at(&self, part: f64) {
        if self.0.is_hidden() && self.1.elapsed() > Duration::from_secs(1) {
            self.0
                .set_draw_target(indicatif::ProgressDrawTarget::stderr());
        }
        self.0.set_position((part * Self::WHOLE as f64) as u64);
    }
}

/// One line for what passed, the whole table for what didn't.
fn in_short(report: &Report) -> String {
    if !report.passed() {
        return report.table(coloured());
    }
    let mark = match coloured() {
        true => "\x1b[32m✓\x1b[0m",
        false => "✓",
    };
    let names = |outcome| {
        let those = report.verdicts.iter().filter(|v| v.outcome == outcome);
        those
            .map(|v| v.property.name())
            .collect::<Vec<_>>()
            .join(", ")
    };
    let mut text = format!("{mark} {}", report.subject);
    for (outcome, word) in [(Outcome::Declared, "lacks"), (Outcome::Allowed, "allowed")] {
        let names = names(outcome);
        if !names.is_empty() {
            text += &format!("\n    {word} {names}");
        }
    }
    text
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
    if let Some(effort) = arguments.effort.to_possible_value()
        && arguments.sweep.is_none()
    {
        words.extend(["--effort".into(), effort.get_name().to_owned()]);
    }
    if let Some(points) = arguments.sweep {
        words.push(format!("--sweep={points}"));
    }
    if !arguments.allow.is_empty() {
        let keys: Vec<String> = arguments.allow.iter().map(|p| p.key()).collect();
        words.extend(["--allow".into(), keys.join(",")]);
    }
    if let Some(loss) = arguments.max_loss {
        words.extend(["--max-loss".into(), loss.to_string()]);
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

    #[test]
    fn properties_are_known_by_name() {
        for p in Property::ALL {
            assert_eq!(property(&p.key()), Ok(p));
            assert_eq!(property(p.name()), Ok(p));
        }
        let e = property("reciprocty").unwrap_err();
        assert!(e.contains("'reciprocity'"), "{e}");
        assert!(property("xyz").unwrap_err().contains("sample-density"));
    }
}
