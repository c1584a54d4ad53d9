//! What the command says: results to standard output, the rest to standard error.

use super::failure::Failure;
use std::io::{ErrorKind, IsTerminal, Write};

/// Prints to standard output; a reader that closes the pipe early (`| head`) ends the output, not the command.
///
/// # Errors
/// If the text can't be written for another reason, such as a full disk.
pub(super) fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    let end = if text.ends_with('\n') { "" } else { "\n" };
    out.write_all(text.as_bytes())
        .and_then(|()| out.write_all(end.as_bytes()))
        .and_then(|()| out.flush())
        .or_else(|e| match e.kind() {
            ErrorKind::BrokenPipe => Ok(()),
            _ => Err(Failure::io("standard output", "write", &e)),
        })
}

/// Whether standard output takes colours: a terminal, unless `NO_COLOR` is set (no-color.org).
pub(super) fn coloured() -> bool {
    let asked_not_to = std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    std::io::stdout().is_terminal() && !asked_not_to
}

/// Prints a value as indented JSON.
pub(super) fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value)
        .map_err(|e| Failure::input(format!("the result has no JSON form: {e}")))?;
    print(&text)
}

/// A `warning:` on standard error: the result may not be what was meant.
pub(super) fn warn(text: &str) {
    say("warning", text);
}

/// A `note:` on standard error: a choice that was made for the user.
pub(super) fn note(text: &str) {
    say("note", text);
}

/// A line on standard error. Nobody may be listening there: that is no reason to fail.
pub(super) fn say(kind: &str, text: &str) {
    let _ = writeln!(std::io::stderr(), "{kind}: {text}");
}

/// A line of what another program said, on standard error.
pub(super) fn quote(line: &str) {
    let _ = writeln!(std::io::stderr(), "  | {line}");
}

/// A number with seven significant digits, without an exponent where it reads well.
pub(super) fn significant(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let magnitude = value.abs().log10().floor() as i32;
    if (-4..7).contains(&magnitude) {
        format!("{value:.*}", (6 - magnitude).max(0) as usize)
    } else {
        format!("{value:.6e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seven_digits() {
        assert_eq!(significant(std::f64::consts::PI), "3.141593");
        assert_eq!(significant(1234.56789), "1234.568");
        assert_eq!(significant(0.00012345678), "0.0001234568");
        assert_eq!(significant(1.5e12), "1.500000e12");
        assert_eq!(significant(0.0), "0");
        assert_eq!(significant(f64::INFINITY), "inf");
    }
}
