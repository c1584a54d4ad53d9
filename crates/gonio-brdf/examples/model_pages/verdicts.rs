//! The verdicts on a model, as tables.

use super::words::significant;
use gonio_brdf::{ModelInfo, ModelSpec, check};
use gonio_verify::{Effort, Outcome, Property, Report, Verdict};

/// What is measured of an alias: one column each.
const OF_ALIASES: [Property; 4] = [
    Property::Reciprocity,
    Property::EnergyConservation,
    Property::Isotropy,
    Property::SampleDensity,
];

/// The section on the verdicts: all on `example`, and a row for each alias of the model.
///
/// # Errors
/// A description that cannot be built, or that fails its check, in words: a page cannot have it.
pub fn section(info: &ModelInfo, example: &ModelSpec) -> Result<String, String> {
    let report = report(example)?;
    let mut text = format!(
        "\n## Verdicts\n\n`gonio brdf check` with `--effort quick` on `{example}`; [Verification](../verification.md) says what each \
         figure is. Figures are rounded.\n\n| property | outcome | figure | bound |\n|---|---|---|---|\n"
    );
    for verdict in &report.verdicts {
        text += &row(verdict);
    }
    let mut rows = String::new();
    for alias in info.aliases.iter().filter(|a| !a.preset.is_empty()) {
        let Ok(spec) = ModelSpec::parse(alias.name) else {
            continue;
        };
        let report = self::report(&spec)?;
        rows += &format!("| `{}` |", alias.name);
        for property in OF_ALIASES {
            rows += &match report.verdict(property) {
                Some(verdict) => format!(" {} |", in_short(verdict)),
                None => " |".to_owned(),
            };
        }
        rows += "\n";
    }
    if !rows.is_empty() {
        text += "\nUnder its other names:\n\n| name |";
        for property in OF_ALIASES {
            text += &format!(" {property} |");
        }
        text += &format!("\n|---|{}\n{rows}", "---|".repeat(OF_ALIASES.len()));
    }
    Ok(text)
}

fn report(spec: &ModelSpec) -> Result<Report, String> {
    let report = check(spec, Effort::Quick).map_err(|e| format!("{spec}: {e}"))?;
    if report.passed() {
        Ok(report)
    } else {
        Err(report.to_string())
    }
}

fn row(verdict: &Verdict) -> String {
    // A p-value passes above its bound, everything else up to it.
    let bound = match (verdict.p_value.is_some(), number(verdict.bound)) {
        _ if verdict.bound.is_nan() => String::new(),
        (_, tiny) if tiny.starts_with('<') => tiny,
        (true, p) => format!("≥ {p}"),
        (false, most) => format!("≤ {most}"),
    };
    let outcome = match verdict.outcome {
        Outcome::Pass => "pass",
        Outcome::Fail => "FAIL",
        Outcome::Declared => "missing, as declared",
        Outcome::Allowed => "missing, allowed",
        Outcome::Information => "measured",
        // The detail says why, without a number.
        Outcome::NotApplicable => {
            return format!("| {} | n/a: {} | | |\n", verdict.property, verdict.detail);
        }
    };
    format!(
        "| {} | {} {outcome} | {} | {bound} |\n",
        verdict.property,
        mark(verdict.outcome),
        figure(verdict)
    )
}

fn in_short(verdict: &Verdict) -> String {
    if verdict.outcome == Outcome::NotApplicable {
        "n/a".into()
    } else {
        format!("{} {}", mark(verdict.outcome), figure(verdict))
    }
}

fn mark(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Pass => "✓",
        Outcome::Fail => "✗",
        Outcome::Declared | Outcome::Allowed => "!",
        Outcome::Information => "·",
        Outcome::NotApplicable => "n/a",
    }
}

fn figure(verdict: &Verdict) -> String {
    match verdict.p_value {
        Some(p) => format!("p = {}", significant(p, 3)),
        None => number(verdict.figure),
    }
}

/// Five digits at most; what is only rounding has none.
fn number(x: f64) -> String {
    if x > 0.0 && x < 1e-9 {
        "< 1e-9".into()
    } else {
        significant(x, 5)
    }
}
