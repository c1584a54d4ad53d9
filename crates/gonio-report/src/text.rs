//! Words and numbers in markup.

use gonio_verify::{Outcome, Verdict, Witness};
use std::fmt::Write;

/// `text` as the content or an attribute of an XML or HTML element. Characters that XML 1.0 can't hold become U+FFFD.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            '\t' | '\n' => out.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// A number in at most nine characters or so: plain near 1, with an exponent elsewhere.
pub(crate) fn number(x: f64) -> String {
    if x.is_nan() {
        return "–".into();
    }
    if x.is_infinite() {
        return if x > 0.0 { "∞" } else { "−∞" }.into();
    }
    if x == 0.0 {
        return "0".into();
    }
    let plain = if (1e-3..1e5).contains(&x.abs()) {
        let text = format!("{x:.5}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{x:.2e}")
    };
    plain.replace('-', "−")
}

/// The figure of a verdict.
pub(crate) fn figure(v: &Verdict) -> String {
    match v.p_value {
        Some(p) => format!("p = {}", number(p)),
        None => number(v.figure),
    }
}

/// How an outcome is called.
pub(crate) fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Pass => "pass",
        Outcome::Fail => "FAIL",
        Outcome::Declared => "declared",
        Outcome::Allowed => "allowed",
        Outcome::Information => "measured",
        Outcome::NotApplicable => "n/a",
    }
}

/// How sure a verdict is, in words.
pub(crate) fn certainty(v: &Verdict) -> String {
    let mut words = String::new();
    if let Some(c) = v.confidence {
        words = format!("in [{}, {}]", number(c.low), number(c.high));
        words += &match c.level < 1.0 {
            true => format!(" with confidence 1 − {}", number(1.0 - c.level)),
            false => " by quadrature".into(),
        };
    }
    if v.false_positive_rate > 0.0 {
        if !words.is_empty() {
            words += "; ";
        }
        words += &format!("false alarm: {}", number(v.false_positive_rate));
    }
    words
}

/// A witness in lines of text, with all digits.
pub(crate) fn witness(w: &Witness) -> String {
    let mut text = format!("wo  {}\n", w.wo);
    // Writing to a string can't fail.
    if let Some(wi) = &w.wi {
        let _ = writeln!(text, "wi  {wi}");
    }
    if let Some(u) = w.u {
        let _ = writeln!(text, "u   {u:?}");
    }
    for value in &w.values {
        let _ = writeln!(text, "{} = {}", value.name, value.value);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_is_escaped() {
        assert_eq!(
            escaped("<a href=\"x\">&'\u{1b}\u{ffff}\tθ\n"),
            "&lt;a href=&quot;x&quot;&gt;&amp;&#39;\u{fffd}\u{fffd}\tθ\n"
        );
    }

    #[test]
    fn numbers_are_short() {
        let texts = [
            (0.0, "0"),
            (1.0, "1"),
            (0.123456, "0.12346"),
            (-2.5, "−2.5"),
            (1e-6, "1.00e−6"),
            (123456.0, "1.23e5"),
            (f64::NAN, "–"),
            (f64::NEG_INFINITY, "−∞"),
        ];
        for (x, text) in texts {
            assert_eq!(number(x), text);
        }
    }
}
