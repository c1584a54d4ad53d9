//! What the commands that make light for renderers share: a progress bar over named steps, which shows after a second, and JSON
//! files that are read again.

use crate::cli::failure::Failure;
use gonio_image::write_file;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::path::Path;
use std::time::{Duration, Instant};

/// A bar on standard error, when that is a terminal.
pub(super) struct Steps {
    bar: ProgressBar,
    start: Instant,
}

impl Steps {
    /// A bar of so many steps; hidden at first.
    pub fn new(count: usize) -> Self {
        let bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {msg}") {
            bar.set_style(style.progress_chars("━━─"));
        }
        Self {
            bar,
            start: Instant::now(),
        }
    }

    /// The next step begins.
    pub fn next(&self, name: &str) {
        if self.bar.is_hidden() && self.start.elapsed() > Duration::from_secs(1) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_message(name.to_owned());
        self.bar.inc(1);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

/// Writes a value as JSON and reads it again.
pub(super) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), Failure> {
    let name = path.display().to_string();
    let broken = |e: serde_json::Error| Failure::input(format!("{name}: it has no JSON form: {e}"));
    let text = serde_json::to_string_pretty(value).map_err(broken)?;
    write_file(path, text.as_bytes())?;
    let read = std::fs::read(path).map_err(|e| Failure::io(&name, "read it again", &e))?;
    if read == text.as_bytes() {
        return Ok(());
    }
    Err(
        Failure::input(format!("{name}: read again, it is not what was written"))
            .with_help("the disk may be full or failing: write elsewhere"),
    )
}
