//! `--junit` and `--html`: verdicts as files.

use super::pictures;
use crate::cli::destination;
use crate::cli::failure::Failure;
use gonio_brdf::{Model, ModelSpec};
use gonio_report::{self as report, Document, Section};
use gonio_verify::{Expectation, Report};
use std::path::PathBuf;
use std::time::Duration;

#[derive(clap::Args)]
pub(super) struct Files {
    /// Write the verdicts as JUnit XML, which build servers show
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
    /// Write the verdicts as a page of HTML with plots, in one file
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl Files {
    /// Fails unless the files can be written.
    pub(super) fn writable(&self) -> Result<(), Failure> {
        if let (Some(junit), Some(html)) = (&self.junit, &self.html)
            && junit == html
        {
            let message = format!(
                "{}: both --junit and --html are to be written there",
                junit.display()
            );
            return Err(Failure::usage(message).with_help("give them different names"));
        }
        for file in self.junit.iter().chain(&self.html) {
            destination::writable(file)?;
        }
        Ok(())
    }

    /// Whether there is a page that shows plots.
    pub(super) fn shows_plots(&self) -> bool {
        self.html.is_some()
    }

    /// Writes them, each whole or not at all. `command` gives the same verdicts.
    pub(super) fn write(&self, sections: Vec<Section>, command: &str) -> Result<(), Failure> {
        let document = Document {
            sections,
            command: command.into(),
            version: env!("CARGO_PKG_VERSION").into(),
        };
        if let Some(file) = &self.junit {
            gonio_image::write_file(file, report::junit(&document).as_bytes())?;
        }
        if let Some(file) = &self.html {
            gonio_image::write_file(file, report::html(&document).as_bytes())?;
        }
        Ok(())
    }

    /// Writes what a build server shows of a check that ended without a verdict: nothing where the command line was at fault. The page of
    /// an earlier check is left as it is.
    pub(super) fn write_error(
        &self,
        subject: &str,
        why: &Failure,
        command: &str,
    ) -> Result<(), Failure> {
        if let Some(file) = &self.junit
            && why.code() != 2
        {
            let version = env!("CARGO_PKG_VERSION");
            let xml = report::junit_of_error(subject, why.message(), command, version);
            gonio_image::write_file(file, xml.as_bytes())?;
        }
        Ok(())
    }
}

/// What a report says of a model of the registry, with plots if they are to be shown.
pub(super) fn section(
    spec: &ModelSpec,
    report: Report,
    took: Duration,
    plots: bool,
) -> Result<Section, Failure> {
    let declares = spec.declares()?;
    let expectation = Expectation {
        reciprocal: declares.reciprocal,
        energy_conserving: declares.energy_conserving,
        isotropic: declares.isotropic,
    };
    let info = spec.info()?;
    let mut section = Section::new(report, expectation);
    section.seconds = took.as_secs_f64();
    section.facts = vec![
        ("Model".into(), format!("{}: {}", info.name, info.summary)),
        ("Source".into(), info.paper.into()),
    ];
    let values: Vec<String> = spec
        .parameters()?
        .into_iter()
        .filter_map(|p| {
            Some(format!(
                "{} = {}",
                p.name,
                shortest(&spec.value(p.name)?.to_string())
            ))
        })
        .collect();
    if !values.is_empty() {
        section.facts.push(("Parameters".into(), values.join(", ")));
    }
    if plots {
        let model: Model<f64, 3> = spec.build()?;
        section.plots = pictures::of_model(&spec.to_string(), &model, declares.relative_ior)?;
    }
    Ok(section)
}

/// A number of single precision with the digits that it needs there: 0.4, not 0.4000000059604645. Other text as it is.
fn shortest(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(x) if f64::from(x as f32) == x => (x as f32).to_string(),
        _ => value.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_they_need() {
        for (value, shown) in [
            ("0.4000000059604645", "0.4"),
            ("0.4", "0.4"),
            ("10000000", "10000000"),
            ("metal.wgsl", "metal.wgsl"),
            ("1/0.5/0", "1/0.5/0"),
        ] {
            assert_eq!(shortest(value), shown);
        }
    }
}
