//! Ctrl-C: the pass is finished, the pictures are written, and the exit code is 4.

#![cfg(unix)]

use crate::support::{Place, said};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Before the command listens, a signal ends it at once. Linux tells which signals a process handles; elsewhere a while has
/// to be enough.
pub fn wait_until_it_listens(process: u32) {
    if !cfg!(target_os = "linux") {
        std::thread::sleep(Duration::from_secs(5));
        return;
    }
    let handles_interrupts = || {
        let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
        let mask = status.lines().find_map(|l| l.strip_prefix("SigCgt:"))?;
        let mask = u64::from_str_radix(mask.trim(), 16).ok()?;
        // Signal 2, SIGINT, is bit 1, and signal 15, SIGTERM, bit 14.
        Some(mask & (1 << 1) != 0 && mask & (1 << 14) != 0)
    };
    while handles_interrupts() == Some(false) {
        std::thread::sleep(Duration::from_millis(10));
    }
}

/// Sends a signal to a long rendering once it runs.
fn interrupted_by(signal: &str) {
    let place = Place::new();
    let arguments = [
        "render", "--size", "16x16", "--time", "600s", "-o", "a.exr", "-o", "a.png", "--json",
    ];
    let mut command = place.command(&arguments);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = command.spawn().unwrap();
    let start = Instant::now();
    wait_until_it_listens(child.id());
    let status = Command::new("kill")
        .args([signal, &child.id().to_string()])
        .status()
        .unwrap();
    assert!(status.success());
    let said = said(child.wait_with_output().unwrap(), &arguments);
    assert!(start.elapsed() < Duration::from_secs(300));
    assert_eq!(said.code, 4, "{said:?}");
    assert!(
        said.err.starts_with("error: interrupted after "),
        "{said:?}"
    );
    let summary: serde_json::Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(summary["stopped_by"], "interrupted");
    let samples = summary["samples_per_pixel"].to_string();
    assert!(said.err.contains(&format!("--spp {samples}")), "{said:?}");
    // What there is, is whole: the same command with that many samples gives the same files.
    let (exr, png) = (place.read("a.exr"), place.read("a.png"));
    place.good(&[
        "render", "--size", "16x16", "--spp", &samples, "-o", "a.exr", "-o", "a.png",
    ]);
    assert!(exr == place.read("a.exr") && png == place.read("a.png"));
    assert_eq!(place.files().len(), 2);
}

#[test]
fn ctrl_c_ends_a_rendering_in_good_order() {
    interrupted_by("-INT");
}

#[test]
fn so_does_the_signal_of_a_job_queue() {
    interrupted_by("-TERM");
}
