//! `bench peers`: speed, error, rays and memory beside other renderers', in one run.

use crate::call;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What can be left out: the names of the parts.
pub const PARTS: [&str; 4] = ["scenes", "error", "start", "rays"];

/// Runs these parts, all if none is named, in a virtual environment under `target/peers`, which is made if need be.
pub fn run(parts: &[&str]) -> Result<(), String> {
    if let Some(unknown) = parts.iter().find(|p| !PARTS.contains(p)) {
        return Err(format!(
            "`{unknown}`: expected some of {}",
            PARTS.join(", ")
        ));
    }
    let wanted = |part| parts.is_empty() || parts.contains(&part);
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .ok_or("this crate lies in no folder")?;
    let folder = root.join("target/peers");
    let python = environment(root, &folder)?;
    call(
        Command::new("cargo")
            .args(["build", "--release", "--package", "gonio"])
            .current_dir(root),
    )?;
    for (part, script) in [
        ("scenes", "bench_scenes.py"),
        ("error", "bench_error.py"),
        ("start", "bench_start.py"),
    ] {
        if !wanted(part) {
            continue;
        }
        println!("\n== {part}");
        let mut command = Command::new(&python);
        command
            .arg(root.join("benches/peers").join(script))
            .arg("--gonio")
            .arg(root.join("target/release/gonio"))
            .arg("--work")
            .arg(folder.join(part))
            .current_dir(root);
        if part == "error" {
            command.arg("--denoise");
        }
        if let Some(library) = llvm() {
            command.env("DRJIT_LIBLLVM_PATH", library);
        }
        call(&mut command)?;
    }
    if wanted("rays") {
        println!("\n== rays");
        let embree = found(&folder.join("venv"), "libembree4").ok_or(
            "the package `embreex` brings no libembree4 for this machine: install Embree 4, and set GONIO_EMBREE yourself",
        )?;
        call(
            Command::new("cargo")
                .args(["bench", "--package", "gonio-scene", "--bench", "embree"])
                .env("GONIO_EMBREE", embree)
                .current_dir(root),
        )?;
    }
    Ok(())
}

/// The interpreter of the virtual environment, made with what `requirements.txt` names where there is none, or names more now.
fn environment(root: &Path, folder: &Path) -> Result<PathBuf, String> {
    let python = folder.join("venv/bin/python");
    let (wanted, done) = (
        root.join("benches/peers/requirements.txt"),
        folder.join("venv/installed"),
    );
    let packages =
        std::fs::read_to_string(&wanted).map_err(|e| format!("{}: {e}", wanted.display()))?;
    if std::fs::read_to_string(&done).ok() != Some(packages.clone()) {
        std::fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        call(
            Command::new("python3")
                .args(["-m", "venv"])
                .arg(folder.join("venv")),
        )?;
        call(
            Command::new(&python)
                .args(["-m", "pip", "install", "--quiet", "-r"])
                .arg(&wanted),
        )?;
        std::fs::write(&done, packages).map_err(|e| format!("{}: {e}", done.display()))?;
    }
    Ok(python)
}

/// The libLLVM for Mitsuba's variants: 14 is refused, 15 and 16 end the process.
fn llvm() -> Option<PathBuf> {
    if let Some(set) = std::env::var_os("DRJIT_LIBLLVM_PATH") {
        return Some(set.into());
    }
    let folders = ["/usr/lib/x86_64-linux-gnu", "/usr/lib/aarch64-linux-gnu"];
    let versions = (17..=21).rev();
    let library = versions
        .flat_map(|v| folders.map(|f| PathBuf::from(format!("{f}/libLLVM.so.{v}.1"))))
        .find(|path| path.exists());
    if library.is_none() {
        println!(
            "no libLLVM from 17 to 21 was found: Mitsuba needs one (`apt-get install libllvm19`, or set DRJIT_LIBLLVM_PATH)"
        );
    }
    library
}

/// The first file below `folder` whose name begins so.
fn found(folder: &Path, prefix: &str) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?;
    let mut folders = Vec::new();
    for entry in entries.flatten() {
        let path = entry.path();
        if entry.file_name().to_string_lossy().starts_with(prefix) {
            return Some(path);
        }
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            folders.push(path);
        }
    }
    folders.iter().find_map(|f| found(f, prefix))
}
