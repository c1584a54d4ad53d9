//! How far a rendering is, for people and for programs, and the wish of the user to stop it.

use gonio_render::{Film, Progress, Target};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// How progress is told.
#[derive(Debug, Clone, Copy, PartialEq, clap::ValueEnum)]
pub(crate) enum ProgressKind {
    /// A bar on standard error, when that is a terminal.
    Tty,
    /// A JSON object a line, on standard error.
    Json,
    /// `openjd_progress: PERCENT` and `openjd_status: TEXT`, on standard output.
    Openjd,
}

/// Tells how far a rendering is.
pub(crate) struct Telling {
    kind: ProgressKind,
    bar: ProgressBar,
    target: Target,
    /// When a line was written last, and what came after it and is still untold.
    last: Option<Instant>,
    untold: Option<(Progress, f64)>,
}

/// The bar's resolution: it moves by the fraction of the nearest target.
const STEPS: u64 = 1000;
/// Lines are not written more often.
const LEAST_PAUSE: Duration = Duration::from_secs(1);

impl Telling {
    /// For a rendering that ends at `target`; no bar if `quiet`.
    pub fn new(kind: ProgressKind, target: Target, quiet: bool) -> Self {
        let hidden = quiet || kind != ProgressKind::Tty;
        let bar = ProgressBar::with_draw_target(
            Some(STEPS),
            if hidden {
                ProgressDrawTarget::hidden()
            } else {
                ProgressDrawTarget::stderr()
            },
        );
        if let Ok(style) = ProgressStyle::with_template("{bar:18.cyan/dim} {msg}") {
            bar.set_style(style.progress_chars("━━─"));
        }
        on_stop_request(&bar);
        Self {
            kind,
            bar,
            target,
            last: None,
            untold: None,
        }
    }

    /// Shows how far the rendering of `film` is.
    pub fn update(&mut self, progress: &Progress, film: &Film) {
        if self.kind == ProgressKind::Tty && self.bar.is_hidden() {
            return;
        }
        let noise = progress.noise.unwrap_or_else(|| film.noise());
        if self.kind == ProgressKind::Tty {
            let fraction = self.fraction(progress, noise);
            let seconds = progress.elapsed.as_secs_f64();
            self.bar.set_message(format!(
                "{} spp · {} rays/s · noise {} · {} left",
                progress.samples,
                quantity(progress.rays.total() as f64 / seconds.max(1e-9)),
                percent(noise),
                clock(left(progress, fraction)),
            ));
            self.bar.set_position((fraction * STEPS as f64) as u64);
            return;
        }
        if self.last.is_some_and(|t| t.elapsed() < LEAST_PAUSE) {
            self.untold = Some((*progress, noise));
            return;
        }
        self.say(progress, noise);
    }

    /// Takes the bar away, or says the last line.
    pub fn finish(&mut self) {
        if let Some((progress, noise)) = self.untold {
            self.say(&progress, noise);
        }
        self.bar.finish_and_clear();
    }

    /// Writes a line. Nobody may be listening: that is no reason to fail.
    fn say(&mut self, progress: &Progress, noise: f64) {
        (self.last, self.untold) = (Some(Instant::now()), None);
        let fraction = self.fraction(progress, noise);
        let _ = match self.kind {
            ProgressKind::Tty => Ok(()),
            ProgressKind::Json => {
                writeln!(std::io::stderr(), "{}", json(progress, noise, fraction))
            }
            ProgressKind::Openjd => {
                let mut out = std::io::stdout().lock();
                write!(out, "{}", openjd(progress, noise, fraction)).and_then(|()| out.flush())
            }
        };
    }

    /// How near the nearest target is, 0 to 1. The noise of a pixel falls with the root of its samples.
    fn fraction(&self, progress: &Progress, noise: f64) -> f64 {
        let by_samples = f64::from(progress.samples) / f64::from(progress.of);
        let by_time = self
            .target
            .time
            .map_or(0.0, |t| progress.elapsed.as_secs_f64() / t.as_secs_f64());
        let by_noise = self.target.noise.map_or(0.0, |n| (n / noise).powi(2));
        by_samples.max(by_time).max(by_noise).clamp(0.0, 1.0)
    }
}

/// The time that is left, at the pace so far.
fn left(progress: &Progress, fraction: f64) -> Duration {
    let seconds = progress.elapsed.as_secs_f64() * (1.0 - fraction) / fraction.max(1e-3);
    Duration::from_secs_f64(seconds.ceil().min(359_999.0))
}

fn json(progress: &Progress, noise: f64, fraction: f64) -> serde_json::Value {
    serde_json::json!({
        "event": "progress",
        "samples": progress.samples,
        "of": progress.of,
        "fraction": fraction,
        "noise": Some(noise).filter(|n| n.is_finite()),
        "rays": progress.rays.total(),
        "seconds": progress.elapsed.as_secs_f64(),
        "seconds_left": left(progress, fraction).as_secs(),
    })
}

fn openjd(progress: &Progress, noise: f64, fraction: f64) -> String {
    format!(
        "openjd_progress: {:.1}\nopenjd_status: {} samples per pixel, noise {}, {} left\n",
        100.0 * fraction,
        progress.samples,
        percent(noise),
        clock(left(progress, fraction))
    )
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
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Whether the user has asked to stop (Ctrl-C, or a termination signal).
pub(crate) fn stop_requested() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Begins to listen for the wish to stop. To wish it again is harmless: job queues do.
pub(crate) fn listen() {
    LISTENING.get_or_init(|| {
        // Without a handler the signal ends the process at once, which is the platform's default.
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                return;
            }
            if let Some(bar) = &*BAR.lock().unwrap_or_else(PoisonError::into_inner) {
                bar.println("note: stopping in good order, at the end of this pass");
            }
        });
    });
}

/// Listens, and answers the wish above `bar`.
pub(crate) fn on_stop_request(bar: &ProgressBar) {
    *BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
    listen();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_for_programs() {
        let progress = Progress {
            samples: 16,
            of: 64,
            rays: gonio_render::RayCounts {
                nearest: 700,
                shadow: 300,
            },
            elapsed: Duration::from_secs(10),
            noise: None,
        };
        let noise = f64::INFINITY;
        let line = json(&progress, noise, 0.25);
        assert_eq!(
            (&line["event"], &line["of"]),
            (&"progress".into(), &64.into())
        );
        assert_eq!(
            (&line["noise"], &line["rays"]),
            (&serde_json::Value::Null, &1000.into())
        );
        assert_eq!(
            (&line["seconds_left"], &line["fraction"]),
            (&30.into(), &0.25.into())
        );
        assert_eq!(
            openjd(&progress, noise, 0.25),
            "openjd_progress: 25.0\nopenjd_status: 16 samples per pixel, noise –, 0:30 left\n"
        );
    }

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
