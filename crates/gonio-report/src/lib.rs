//! Verdicts as files for others: JUnit XML for a build server ([`junit`]), and a page of HTML for people ([`html()`]).

mod diagram;
mod html;
mod junit;
#[cfg(test)]
mod tests;
mod text;

pub use html::html;
pub use junit::{junit, junit_of_error};

use gonio_verify::{Expectation, Report};

/// The verdicts on one reflection function, with what a reader wants to know beside them.
#[derive(Debug, Clone)]
pub struct Section {
    /// The verdicts.
    pub report: Report,
    /// What the function declares of itself.
    pub expectation: Expectation,
    /// Its parameters and other facts, each with a name, in this order.
    pub facts: Vec<(String, String)>,
    /// Pictures of the function: SVG elements, each with its caption.
    pub plots: Vec<Plot>,
    /// Seconds that the check took; 0 where a report has to be the same each time.
    pub seconds: f64,
}

/// A picture.
#[derive(Debug, Clone)]
pub struct Plot {
    /// What it shows.
    pub caption: String,
    /// An `<svg>` element.
    pub svg: String,
}

/// What was checked, and how that is done again.
#[derive(Debug, Clone)]
pub struct Document {
    /// One a reflection function.
    pub sections: Vec<Section>,
    /// The command line that gives this report.
    pub command: String,
    /// The version of Gonio.
    pub version: String,
}

impl Section {
    /// The verdicts alone.
    pub fn new(report: Report, expectation: Expectation) -> Self {
        Self {
            report,
            expectation,
            facts: Vec::new(),
            plots: Vec::new(),
            seconds: 0.0,
        }
    }
}

impl Document {
    /// Whether nothing failed.
    pub fn passed(&self) -> bool {
        self.sections.iter().all(|s| s.report.passed())
    }
}

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
