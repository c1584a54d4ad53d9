//! `web`: the explorer as a site of static files, in `web/dist`.

use crate::{call, licenses};
use std::path::Path;
use std::process::Command;

/// What the library is compiled for.
const TARGET: &str = "wasm32-wasip1";

/// Builds the library for browsers and the page around it.
///
/// # Errors
/// If a tool is missing or fails; the message says how to get it.
pub fn run() -> Result<(), String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .ok_or("this crate lies in no folder")?;
    library(root)?;
    page(root)
}

/// The library, in `web/public/gonio.wasm`.
///
/// # Errors
/// As [`run`].
fn library(root: &Path) -> Result<(), String> {
    // Where there is no rustup, the distribution may have brought the target.
    if let Ok(status) = Command::new("rustup")
        .args(["target", "add", TARGET])
        .status()
        && !status.success()
    {
        return Err(format!(
            "rustup could not add the target {TARGET}: see its message above"
        ));
    }
    call(
        Command::new("cargo")
            .args([
                "build",
                "--profile",
                "web",
                "--target",
                TARGET,
                "--package",
                "gonio-web",
            ])
            // Vectors of 128 bits are in every browser since 2023.
            .env(
                "CARGO_TARGET_WASM32_WASIP1_RUSTFLAGS",
                "-C target-feature=+simd128",
            )
            .current_dir(root),
    )?;
    let built = root.join("target").join(TARGET).join("web/gonio_web.wasm");
    let public = root.join("web/public");
    copy(&built, &public.join("gonio.wasm"))?;
    // Beside the page's sources: its build puts it into `licenses.txt`, after what the page's packages bring.
    let texts = licenses::of(root, "gonio-web", TARGET)?;
    let file = root.join("web/crates.licenses.txt");
    std::fs::write(&file, texts).map_err(|e| format!("{}: {e}", file.display()))?;
    for file in ["scene.toml", "ball.glb", "stand.glb", "sunset.hdr"] {
        let from = root.join("assets/preview").join(file);
        copy(&from, &public.join("preview").join(file))?;
    }
    Ok(())
}

/// The page, in `web/dist`.
fn page(root: &Path) -> Result<(), String> {
    let folder = root.join("web");
    let npm = |arguments: &[&str]| {
        let mut command = Command::new("npm");
        command
            .args(arguments)
            .env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1")
            .current_dir(&folder);
        call(&mut command).map_err(|e| {
            format!("{e}\nthe page is built by Node 20 or newer with npm: see https://nodejs.org")
        })
    };
    npm(&["ci", "--no-audit", "--no-fund"])?;
    npm(&["run", "build"])?;
    println!(
        "{}: a site that any web server can host; `cargo build` puts it into `gonio explore`",
        folder.join("dist").display()
    );
    Ok(())
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let failed = |e: std::io::Error| format!("{} to {}: {e}", from.display(), to.display());
    if let Some(folder) = to.parent() {
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    std::fs::copy(from, to).map(|_| ()).map_err(failed)
}
