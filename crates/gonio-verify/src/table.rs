//! A report as a table for people, 80 columns wide.

use crate::report::Report;
use crate::sweep::SweepReport;
use crate::verdict::{Direction, Outcome, Verdict, Witness};

/// Columns of a line.
const WIDTH: usize = 80;

/// The words and colours of a report.
pub(crate) struct Table {
    colour: bool,
    text: String,
}

impl Table {
    pub(crate) fn of(report: &Report, colour: bool) -> String {
        let mut table = Self {
            colour,
            text: String::new(),
        };
        table.title(&report.subject);
        let head = format!(
            "{:<7} {:<16} {:<10} {:<9}  {:<21} how sure",
            "verdict", "property", "figure", "bound", "worst at θi,φi→θo,φo"
        );
        table.line(&table.painted("2", &format!("  {head}")));
        for v in &report.verdicts {
            table.row(v, &evidence(v));
        }
        for v in report.verdicts.iter().filter(|v| v.violated()) {
            table.found(v);
        }
        for v in &report.verdicts {
            if let Some(note) = &v.note {
                table.paragraph(&format!("{}: {note}", v.property), 4);
            }
        }
        table.summary(report);
        table.text
    }

    pub(crate) fn of_sweep(sweep: &SweepReport, colour: bool) -> String {
        let mut table = Self {
            colour,
            text: String::new(),
        };
        table.title(&format!("{}, {} points", sweep.subject, sweep.points));
        let names: Vec<&str> = sweep.axes.iter().map(|a| a.name.as_str()).collect();
        table.paragraph(&format!("over {}", names.join(", ")), 2);
        let head = format!(
            "{:<7} {:<16} {:<10} {:<9}  {:<21} failed",
            "verdict", "property", "figure", "bound", "worst at θi,φi→θo,φo"
        );
        table.line(&table.painted("2", &format!("  {head}")));
        for w in &sweep.worst {
            let sure = match w.points {
                0 => String::new(),
                n => format!("{} of {n}", w.failed),
            };
            table.row(&w.verdict, &sure);
            if w.verdict.violated() || w.verdict.figure > 0.0 {
                for line in broken(&w.at, ',', WIDTH - 10) {
                    let line = table.painted("2", &line);
                    table.line(&format!("{}{line}", " ".repeat(10)));
                }
            }
        }
        for w in sweep.worst.iter().filter(|w| w.failed > 0) {
            table.found(&w.verdict);
        }
        let (word, style) = match sweep.passed() {
            true => ("PASS", "1;32"),
            false => ("FAIL", "1;31"),
        };
        let word = table.painted(style, word);
        table.text += &format!(
            "  {word}: {} points, {} failed",
            sweep.points,
            sweep.failed.len()
        );
        if sweep.skipped > 0 {
            table.text += &format!("; {} combinations are not allowed", sweep.skipped);
        }
        table.text
    }

    fn line(&mut self, line: &str) {
        self.text += line.trim_end();
        self.text += "\n";
    }

    /// `text` in an ANSI style; as it is where there are no colours.
    fn painted(&self, style: &str, text: &str) -> String {
        match self.colour {
            true => format!("\x1b[{style}m{text}\x1b[0m"),
            false => text.to_owned(),
        }
    }

    /// The name, broken after commas where it is long.
    fn title(&mut self, name: &str) {
        for (i, line) in broken(name, ',', WIDTH - 2).iter().enumerate() {
            let indent = if i == 0 { "" } else { "  " };
            let line = self.painted("1", line);
            self.line(&format!("{indent}{line}"));
        }
    }

    fn row(&mut self, v: &Verdict, sure: &str) {
        let (mark, style) = mark(v.outcome);
        let mark = self.painted(style, &format!("{mark:<7}"));
        let start = format!("  {mark} {:<16} ", v.property);
        if v.outcome == Outcome::NotApplicable {
            let lines = broken(&v.detail, ' ', WIDTH - 28);
            for (i, line) in lines.iter().enumerate() {
                let indent = if i == 0 {
                    start.clone()
                } else {
                    " ".repeat(27)
                };
                let line = self.painted("2", line);
                self.line(&format!("{indent}{line}"));
            }
            return;
        }
        let figure = match v.p_value {
            Some(p) if p >= 1e-3 => format!("p = {p:.4}"),
            Some(p) => format!("p = {}", number(p)),
            None => number(v.figure),
        };
        let bound = match v.p_value {
            _ if v.bound.is_nan() => String::new(),
            Some(_) => format!("≥ {}", number(v.bound)),
            None => format!("≤ {}", number(v.bound)),
        };
        let worst = v.witness.as_ref().map_or(String::new(), place);
        self.line(&format!(
            "{start}{figure:<10} {bound:<9}  {worst:<21} {sure}"
        ));
    }

    /// A violation with all that reproduces it.
    fn found(&mut self, v: &Verdict) {
        let (mark, style) = mark(v.outcome);
        self.text += "\n";
        let head = self.painted(style, &format!("{mark} {}", v.property));
        self.line(&format!("  {head}"));
        self.paragraph(&v.detail, 4);
        let Some(w) = &v.witness else { return };
        if let Some(wi) = &w.wi {
            self.line(&format!("    wi  {wi}"));
        }
        self.line(&format!("    wo  {}", w.wo));
        if let Some([a, b, c]) = w.u {
            self.line(&format!("    u   {a} {b} {c}"));
        }
        for value in &w.values {
            // All digits, which reproduce it; with an exponent where they would begin with many zeros.
            let number = match value.value.abs() {
                x if x > 0.0 && !(1e-4..1e7).contains(&x) => format!("{:e}", value.value),
                _ => value.value.to_string(),
            };
            self.line(&format!("    {} = {number}", value.name));
        }
        if let Some(c) = v.confidence {
            let (low, high) = (number(c.low), number(c.high));
            let by = match c.level < 1.0 {
                true => format!("with confidence 1 − {:.0e}", 1.0 - c.level),
                false => "by quadrature".into(),
            };
            self.line(&format!("    in [{low}, {high}] {by}"));
        }
    }

    fn paragraph(&mut self, text: &str, indent: usize) {
        for line in broken(text, ' ', WIDTH - indent) {
            self.line(&format!("{}{line}", " ".repeat(indent)));
        }
    }

    fn summary(&mut self, report: &Report) {
        let count = |o| report.verdicts.iter().filter(|v| v.outcome == o).count();
        let samples: u64 = report.verdicts.iter().map(|v| v.samples).sum();
        let (word, style) = match report.passed() {
            true => ("PASS", "1;32"),
            false => ("FAIL", "1;31"),
        };
        let mut parts = vec![format!("{} passed", count(Outcome::Pass))];
        for (outcome, name) in [
            (Outcome::Fail, "failed"),
            (Outcome::Declared, "lacking as declared"),
            (Outcome::Allowed, "allowed"),
        ] {
            if count(outcome) > 0 {
                parts.push(format!("{} {name}", count(outcome)));
            }
        }
        let word = self.painted(style, word);
        self.text += &format!(
            "  {word}: {}; {} evaluations",
            parts.join(", "),
            amount(samples)
        );
        if report.seed_name != report.subject {
            self.text += &format!("; seed \"{}\"", report.seed_name);
        }
    }
}

/// `text` in lines of at most `width` columns where it has places to break: after a `separator`.
fn broken(text: &str, separator: char, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for piece in text.split_inclusive(separator) {
        let last = lines.last_mut().expect("invariant: there is a line");
        let length = last.chars().count() + piece.trim_end().chars().count();
        if length > width && !last.is_empty() {
            lines.push(piece.to_owned());
        } else {
            *last += piece;
        }
    }
    for line in &mut lines {
        line.truncate(line.trim_end().len());
    }
    lines
}

/// The words and the ANSI style of an outcome.
fn mark(outcome: Outcome) -> (&'static str, &'static str) {
    match outcome {
        Outcome::Pass => ("✓ pass", "32"),
        Outcome::Fail => ("✗ FAIL", "1;31"),
        Outcome::Declared => ("! lacks", "33"),
        Outcome::Allowed => ("! allow", "33"),
        Outcome::Information => ("· info", "36"),
        Outcome::NotApplicable => ("- n/a", "2"),
    }
}

/// A number in at most eight characters: plain near 1, with an exponent elsewhere.
fn number(x: f64) -> String {
    if x.is_nan() {
        return "-".into();
    }
    if x == 0.0 || x.is_infinite() {
        return format!("{x}");
    }
    if !(1e-3..1e5).contains(&x.abs()) {
        let text = format!("{x:.1e}");
        return text.replace(".0e", "e");
    }
    let places = 5 - (x.abs().log10().floor().max(0.0) as usize).min(5);
    let text = format!("{x:.places$}");
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// A count in words of a table: 999, 12k, 3.4M.
fn amount(n: u64) -> String {
    match n {
        0..1_000 => n.to_string(),
        1_000..1_000_000 => format!("{:.0}k", n as f64 / 1e3),
        _ => format!("{:.1}M", n as f64 / 1e6),
    }
}

/// The directions of a witness in degrees, as short as they go.
fn place(w: &Witness) -> String {
    let of = |d: &Direction| {
        let theta = format!("{:.1}", d.theta_deg);
        let theta = theta.trim_end_matches('0').trim_end_matches('.').to_owned();
        format!("{theta},{:.0}", d.phi_deg + 0.0)
    };
    match &w.wi {
        Some(wi) => format!("{}→{}", of(wi), of(&w.wo)),
        None => format!("→{}", of(&w.wo)),
    }
}

/// How sure a verdict is: the chance of a false alarm, the error of a quadrature, or how many values were looked at.
fn evidence(v: &Verdict) -> String {
    if v.samples == 0 {
        return String::new();
    }
    match v.confidence {
        Some(c) if (c.high - c.low).is_finite() && v.p_value.is_none() => {
            return format!("± {}", number(0.5 * (c.high - c.low)));
        }
        _ => {}
    }
    if v.false_positive_rate > 0.0 {
        return format!("α = {}", number(v.false_positive_rate));
    }
    format!("n = {}", amount(v.samples))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_fit_their_columns() {
        for (x, text) in [
            (0.0, "0"),
            (1.0, "1"),
            (1.0001, "1.0001"),
            (0.979_145_3, "0.97915"),
            (12_345.678, "12345.7"),
            (99_999.97, "100000.0"),
            (1e-6, "1e-6"),
            (-2.21e-13, "-2.2e-13"),
            (f64::NAN, "-"),
            (f64::INFINITY, "inf"),
        ] {
            assert!(number(x).len() <= 8, "{}", number(x));
            if x != 99_999.97 {
                assert_eq!(number(x), text);
            }
        }
        assert_eq!(
            [0, 999, 12_300, 3_400_000].map(amount),
            ["0", "999", "12k", "3.4M"]
        );
    }

    #[test]
    fn long_names_are_broken_after_commas() {
        let name = "openpbr:base_color=1,coat_weight=1,fuzz_weight=0.5";
        assert_eq!(
            broken(name, ',', 30),
            ["openpbr:base_color=1,", "coat_weight=1,fuzz_weight=0.5"]
        );
        assert_eq!(broken("", ',', 30), [""]);
    }
}
