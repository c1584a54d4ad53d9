//! `gonio brdf check --exec`: a reflection function that another program evaluates.

use super::pictures;
use crate::cli::failure::Failure;
use crate::cli::terminal::say;
use gonio_brdf::CheckOptions;
use gonio_exec::{Killer, Process, Remote};
use gonio_report::Section;
use gonio_verify::{Checker, Precision, Subject};
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};

/// The longest time that can be asked for, in seconds: a day.
const LONGEST: f64 = 86_400.0;

/// Reads a number of seconds.
pub(super) fn seconds(text: &str) -> Result<Duration, String> {
    match text.parse::<f64>() {
        Ok(s) if s > 0.0 && s <= LONGEST => Ok(Duration::from_secs_f64(s)),
        _ => Err(format!("expected seconds, above 0 and at most {LONGEST}")),
    }
}

/// Checks what the process that `command` starts evaluates, with plots if they are to be shown; each answer may take `limit`.
pub(super) fn check(
    command: &str,
    limit: Duration,
    options: &CheckOptions,
    plots: bool,
) -> Result<Section, Failure> {
    let began = Instant::now();
    let process = Process::start_with(command, limit, end_on_interrupt)?;
    let hello = process.hello().clone();
    let name = hello.description();
    let bar = ProgressBar::new_spinner();
    if let Ok(style) = ProgressStyle::with_template("{spinner:.cyan} {elapsed} {wide_msg}") {
        bar.set_style(style);
    }
    bar.set_message(name.clone());
    bar.enable_steady_tick(Duration::from_millis(120));

    let remote = Remote::new(process);
    let subject = Subject::batched(name.clone(), &remote);
    let settings = options.settings.with_precision(hello.precision);
    let report = Checker::new(&subject, &hello.expectation, options.effort)
        .settings(settings)
        .allow(&options.allow)
        .run(&name);
    let drawn = match plots && report.is_ok() {
        true => pictures::of_reflection(&name, &remote)?,
        false => Vec::new(),
    };
    bar.finish_and_clear();
    // It knows more of what went wrong than the check does.
    remote.finish()?;
    let report = report.map_err(gonio_brdf::BrdfError::from)?;

    let mut section = Section::new(report, hello.expectation);
    section.plots = drawn;
    section.seconds = began.elapsed().as_secs_f64();
    section.facts = vec![("Program".into(), command.trim().into())];
    for (key, value) in &hello.parameters {
        section.facts.push((key.clone(), value.clone()));
    }
    let precision = match hello.precision {
        Precision::Single => "single",
        Precision::Double => "double",
    };
    section.facts.push(("Precision".into(), precision.into()));
    if let Some([r, g, b]) = hello.relative_ior {
        let n = if r == g && g == b {
            r.to_string()
        } else {
            format!("{r}/{g}/{b}")
        };
        section
            .facts
            .push(("Transmits, index of refraction".into(), n));
    }
    Ok(section)
}

/// Ends the process with the command. It is in a process group of its own, which Ctrl-C doesn't reach.
fn end_on_interrupt(killer: Killer) {
    // If there is a handler already, the end of its input ends a process that keeps to the protocol.
    let _ = ctrlc::set_handler(move || {
        killer.kill();
        say("error", "interrupted: there is no verdict");
        say("help", "run it again");
        std::process::exit(4);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seconds_are_positive_and_few() {
        assert_eq!(seconds("1.5"), Ok(Duration::from_millis(1500)));
        for text in ["0", "-1", "nan", "inf", "1e9", "", "soon", "10s"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
