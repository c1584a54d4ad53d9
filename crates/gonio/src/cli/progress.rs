//! The progress bar of a rendering, and the wish of the user to stop it.

use gonio_render::{Progress, Target};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A bar on standard error, when that is a terminal.
pub(crate) struct Bar {
    bar: ProgressBar,
    target: Target,
}

/// The bar's resolution: it moves by the fraction of the nearest target.
const STEPS: u64 = 1000;

impl Bar {
    /// A bar for a rendering that ends at `target`; hidden if `quiet`.
    pub fn new(target: Target, quiet: bool) -> Self {
        let bar = ProgressBar::with_draw_target(
            Some(STEPS),
            if quiet {
                ProgressDrawTarget::hidden()
            } else {
                ProgressDrawTarget::stderr()
            },
        );
        if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {msg}") {
            bar.set_style(style.progress_chars("━━─"));
        }
        on_stop_request(&bar);
        Self { bar, target }
    }

    /// Shows how far the rendering is.
    pub fn update(&self, progress: &Progress) {
        let fraction = self.fraction(progress).clamp(0.0, 1.0);
        let seconds = progress.elapsed.as_secs_f64();
        self.bar.set_message(format!(
            "{} spp · {} rays/s · noise {} · {} left",
            progress.samples,
            quantity(progress.rays.total() as f64 / seconds.max(1e-9)),
            percent(progress.noise),
            clock(Duration::from_secs_f64(
                (seconds * (1.0 - fraction) / fraction.max(1e-3))
                    .ceil()
                    .min(359_999.0)
            )),
        ));
        self.bar.set_position((fraction * STEPS as f64) as u64);
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// How near the nearest target is, 0 to 1. The noise of a pixel falls with the root of its samples.
    fn fraction(&self, progress: &Progress) -> f64 {
        let by_samples = f64::from(progress.samples) / f64::from(progress.of);
        let by_time = self
            .target
            .time
            .map_or(0.0, |t| progress.elapsed.as_secs_f64() / t.as_secs_f64());
        let by_noise = self
            .target
            .noise
            .map_or(0.0, |n| (n / progress.noise).powi(2));
        by_samples.max(by_time).max(by_noise)
    }
}

/// `12.3 M`, `4.56 k`: three digits and a prefix.
pub(crate) fn quantity(value: f64) -> String {
    let (scaled, prefix) = match value {
        v if v >= 1e9 => (v / 1e9, " G"),
        v if v >= 1e6 => (v / 1e6, " M"),
        v if v >= 1e3 => (v / 1e3, " k"),
        v => (v, ""),
    };
    let digits = if scaled >= 100.0 {
        0
    } else if scaled >= 10.0 {
        1
    } else {
        2
    };
    format!("{scaled:.digits$}{prefix}")
}

/// A fraction as per cent, or a dash before there is one.
pub(crate) fn percent(fraction: f64) -> String {
    match 100.0 * fraction {
        p if p < 999.95 => format!("{p:.1} %"),
        p if p.is_finite() => "> 999 %".into(),
        _ => "–".into(),
    }
}

/// `0:07`, `12:34`, `1:02:03`.
pub(crate) fn clock(time: Duration) -> String {
    let s = time.as_secs();
    match s / 3600 {
        0 => format!("{}:{:02}", s / 60, s % 60),
        h => format!("{h}:{:02}:{:02}", s / 60 % 60, s % 60),
    }
}

static STOP: AtomicBool = AtomicBool::new(false);
static LISTENING: OnceLock<()> = OnceLock::new();

/// Whether the user has asked to stop (Ctrl-C, or a termination signal) since the first bar was made.
pub(crate) fn stop_requested() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Begins to listen for the wish to stop. The first one is answered above `bar`; a second one ends the process at once.
pub(crate) fn on_stop_request(bar: &ProgressBar) {
    LISTENING.get_or_init(|| {
        let bar = bar.clone();
        // Without a handler the signal ends the process at once, which is the platform's default.
        let _ = ctrlc::set_handler(move || {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(4);
            }
            bar.println(
                "note: stopping after this pass; a second Ctrl-C stops at once, without pictures",
            );
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_readable() {
        assert_eq!(quantity(12_345_678.0), "12.3 M");
        assert_eq!(quantity(4_560.0), "4.56 k");
        assert_eq!(quantity(7.0), "7.00");
        assert_eq!(percent(0.0213), "2.1 %");
        assert_eq!(percent(12.0), "> 999 %");
        assert_eq!(percent(f64::INFINITY), "–");
        assert_eq!(percent(f64::NAN), "–");
        assert_eq!(clock(Duration::from_secs(7)), "0:07");
        assert_eq!(clock(Duration::from_secs(3723)), "1:02:03");
    }
}
