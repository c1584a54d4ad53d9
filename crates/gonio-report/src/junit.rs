//! JUnit XML, the form of test results that build servers read.

use crate::text::{certainty, escaped, figure, number, outcome, witness};
use crate::{Document, Section};
use gonio_verify::{Outcome, Verdict};

/// The verdicts as JUnit XML: a suite a reflection function, a case a property.
///
/// GitHub's and GitLab's report views and Jenkins read it. A failure has the figure, the bound and the sentence in its `message`
/// and the witness in its text; a property that is declared as lacking passes, with what that costs in `system-out`; what doesn't
/// apply is skipped.
pub fn junit(document: &Document) -> String {
    let suites = &document.sections;
    let count = |f: fn(&Section) -> usize| suites.iter().map(f).sum::<usize>();
    let seconds: f64 = suites.iter().map(|s| s.seconds).sum();
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"gonio brdf check\" tests=\"{}\" failures=\"{}\" \
         errors=\"0\" skipped=\"{}\" time=\"{seconds:.3}\">\n",
        count(tests),
        count(failures),
        count(skipped),
    );
    for section in suites {
        xml += &suite(document, section);
    }
    xml += "</testsuites>\n";
    xml
}

/// JUnit XML of a check that ended before there was a verdict, as when a program died: one suite with one case, which is an error,
/// not a failure.
pub fn junit_of_error(subject: &str, message: &str, command: &str, version: &str) -> String {
    let subject = escaped(subject);
    let class = subject.replace('.', "·");
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <testsuites name=\"gonio brdf check\" tests=\"1\" failures=\"0\" errors=\"1\" skipped=\"0\" time=\"0\">\n  \
         <testsuite name=\"{subject}\" tests=\"1\" failures=\"0\" errors=\"1\" skipped=\"0\" time=\"0\">\n    \
         <properties>\n      <property name=\"gonio\" value=\"{}\"/>\n      <property name=\"command\" value=\"{}\"/>\n    </properties>\n    \
         <testcase classname=\"{class}\" name=\"check\" time=\"0\">\n      <error type=\"check\" message=\"{}\"/>\n    </testcase>\n  \
         </testsuite>\n</testsuites>\n",
        escaped(version),
        escaped(command),
        escaped(message),
    )
}

fn tests(section: &Section) -> usize {
    section.report.verdicts.len()
}

fn failures(section: &Section) -> usize {
    section.report.failures().count()
}

fn skipped(section: &Section) -> usize {
    let verdicts = section.report.verdicts.iter();
    verdicts
        .filter(|v| v.outcome == Outcome::NotApplicable)
        .count()
}

fn suite(document: &Document, section: &Section) -> String {
    let report = &section.report;
    let mut xml = format!(
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"0\" skipped=\"{}\" time=\"{:.3}\">\n    <properties>\n",
        escaped(&report.subject),
        tests(section),
        failures(section),
        skipped(section),
        section.seconds,
    );
    let facts = [
        ("gonio", document.version.as_str()),
        ("command", document.command.as_str()),
        ("seed", report.seed_name.as_str()),
    ];
    let declared = section.facts.iter().map(|(k, v)| (k.as_str(), v.as_str()));
    for (name, value) in facts.into_iter().chain(declared) {
        xml += &format!(
            "      <property name=\"{}\" value=\"{}\"/>\n",
            escaped(name),
            escaped(value)
        );
    }
    xml += "    </properties>\n";
    // Jenkins takes what stands before the last full stop for a package: a middle dot keeps `roughness=0.3` in one piece.
    let class = escaped(&report.subject.replace('.', "·"));
    for v in &report.verdicts {
        xml += &case(&class, v);
    }
    xml += "  </testsuite>\n";
    xml
}

fn case(class: &str, v: &Verdict) -> String {
    let name = escaped(v.property.name());
    let open = format!("    <testcase classname=\"{class}\" name=\"{name}\" time=\"0\"");
    let summary = format!("{} (bound {}): {}", figure(v), number(v.bound), v.detail);
    let inner = match v.outcome {
        Outcome::Pass | Outcome::Information => return format!("{open}/>\n"),
        Outcome::NotApplicable => format!("<skipped message=\"{}\"/>", escaped(&v.detail)),
        Outcome::Declared | Outcome::Allowed => format!(
            "<system-out>{}</system-out>",
            escaped(&format!(
                "{}: {summary}\n{}",
                outcome(v.outcome),
                evidence(v)
            ))
        ),
        Outcome::Fail => format!(
            "<failure type=\"{name}\" message=\"{}\">{}</failure>",
            escaped(&summary),
            escaped(&evidence(v))
        ),
    };
    format!("{open}>\n      {inner}\n    </testcase>\n")
}

fn evidence(v: &Verdict) -> String {
    let mut text = v.witness.as_ref().map_or(String::new(), witness);
    let sure = certainty(v);
    if !sure.is_empty() {
        text += &format!("{sure}\n");
    }
    if let Some(note) = &v.note {
        text += &format!("note: {note}\n");
    }
    text
}
