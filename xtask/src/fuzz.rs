//! The fuzz targets, each run for a time.
//!
//! libFuzzer needs coverage counters in the code, which stable Rust puts there through LLVM's pass (`-C passes=sancov-module`), and
//! a C++ compiler for itself. No sanitizer: the readers have no unsafe code of their own.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::Mutex;

/// Flags that put the counters in.
const INSTRUMENTATION: &str = "-C passes=sancov-module -C llvm-args=-sanitizer-coverage-level=4 \
    -C llvm-args=-sanitizer-coverage-inline-8bit-counters -C llvm-args=-sanitizer-coverage-pc-table \
    -C llvm-args=-sanitizer-coverage-trace-compares --cfg fuzzing";
/// MiB that a target may use.
const MEMORY_MB: u32 = 2048;
/// Seconds that one input may take.
const SLOWEST: u32 = 20;

/// Builds every target and runs each for `seconds`, all side by side, so that a minute for each is a minute of all checks; a crash, a
/// time-out or too much memory is an error.
pub fn run(seconds: u32) -> Result<(), String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
    let names = targets(&folder)?;
    let machine = host()?;
    let mut build = Command::new(env!("CARGO"));
    // With a target of its own the flags are not those of build scripts.
    build
        .args(["build", "--release", "--quiet", "--target", &machine])
        .current_dir(&folder)
        .env("RUSTFLAGS", INSTRUMENTATION)
        .env("CARGO_TARGET_DIR", folder.join("target"));
    match build.status() {
        Ok(status) if status.success() => {}
        Ok(_) => return Err("the fuzz targets don't build (they need a C++ compiler)".into()),
        Err(e) => return Err(format!("cargo build does not run: {e}")),
    }
    let programs = folder.join("target").join(machine).join("release");
    let failed = Mutex::new(Vec::new());
    std::thread::scope(|threads| {
        for name in &names {
            let (folder, programs, failed) = (&folder, &programs, &failed);
            threads.spawn(move || match one(folder, programs, name, seconds) {
                Ok(line) => println!("fuzz {name}: {line}"),
                Err(line) => {
                    println!("fuzz {name}: FAILED: {line}");
                    if let Ok(mut failed) = failed.lock() {
                        failed.push(name.clone());
                    }
                }
            });
        }
    });
    let failed = failed.into_inner().unwrap_or_default();
    if failed.is_empty() {
        return Ok(());
    }
    Err(format!(
        "fuzz targets that failed: {}; their inputs are in fuzz/artifacts",
        failed.join(", ")
    ))
}

/// The names of the targets: the files of their folder.
fn targets(folder: &Path) -> Result<Vec<String>, String> {
    let targets = folder.join("fuzz_targets");
    let entries = std::fs::read_dir(&targets).map_err(|e| format!("{}: {e}", targets.display()))?;
    let mut names: Vec<String> = entries
        .filter_map(|entry| {
            let path: PathBuf = entry.ok()?.path();
            let is_rust = path.extension().is_some_and(|e| e == "rs");
            is_rust.then(|| path.file_stem()?.to_str().map(str::to_owned))?
        })
        .collect();
    names.sort();
    Ok(names)
}

/// The machine's name as the compiler has it.
fn host() -> Result<String, String> {
    let output = Command::new("rustc")
        .arg("-vV")
        .output()
        .map_err(|e| format!("rustc does not run: {e}"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let host = text.lines().find_map(|l| l.strip_prefix("host: "));
    host.map(str::to_owned)
        .ok_or_else(|| format!("rustc -vV names no host: {text}"))
}

/// Runs one target; what it found new is thrown away with its scratch folder.
fn one(folder: &Path, programs: &Path, name: &str, seconds: u32) -> Result<String, String> {
    let scratch = std::env::temp_dir().join(format!("gonio-fuzz-{name}-{}", std::process::id()));
    let artifacts = folder.join("artifacts").join(name);
    for path in [&scratch, &artifacts] {
        std::fs::create_dir_all(path).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    let output = Command::new(programs.join(name))
        .arg(format!("-max_total_time={seconds}"))
        .arg(format!("-rss_limit_mb={MEMORY_MB}"))
        .arg(format!("-timeout={SLOWEST}"))
        .arg(format!("-artifact_prefix={}/", artifacts.display()))
        .args(["-max_len=8192", "-print_final_stats=1", "-seed=1"])
        .arg(&scratch)
        .arg(folder.join("corpus").join(name))
        .stdin(Stdio::null())
        .output();
    // Nobody needs it again; that it can't be removed is no failure of the target.
    let _ = std::fs::remove_dir_all(&scratch);
    let output = output.map_err(|e| format!("does not run: {e}"))?;
    summary(&output)
}

/// What libFuzzer says at its end.
fn summary(output: &Output) -> Result<String, String> {
    let text = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        let reason = text
            .lines()
            .find(|l| l.contains("ERROR") || l.contains("panicked"));
        let input = text.lines().find(|l| l.contains("Test unit written to"));
        return Err(format!(
            "{}; {}",
            reason.unwrap_or("it ended with an error").trim(),
            input.unwrap_or_default().trim()
        ));
    }
    let number = |key: &str| {
        let line = text.lines().find(|l| l.starts_with(key))?;
        line.split_whitespace().last().map(str::to_owned)
    };
    let coverage = text.lines().rev().find_map(|l| {
        let mut words = l.split_whitespace().skip_while(|w| *w != "cov:");
        words.nth(1).map(str::to_owned)
    });
    Ok(format!(
        "{} runs, {} edges, at most {} MiB",
        number("stat::number_of_executed_units:").unwrap_or("?".into()),
        coverage.unwrap_or("?".into()),
        number("stat::peak_rss_mb:").unwrap_or("?".into()),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_target_is_declared_and_has_a_corpus() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz");
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        let names = targets(&folder).unwrap();
        assert!(names.len() >= 7, "{names:?}");
        for name in names {
            assert!(manifest.contains(&format!("name = \"{name}\"")), "{name}");
            let corpus = std::fs::read_dir(folder.join("corpus").join(&name)).unwrap();
            assert!(corpus.count() > 0, "{name}");
        }
    }
}
