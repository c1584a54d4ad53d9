//! Puts the explorer's page into the program, when it is built: each file of `web/dist`, compressed. Without that folder the program
//! is built all the same, and `gonio explore` says what is missing.

use flate2::{Compression, write::GzEncoder};
use std::error::Error;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

fn main() -> Result<(), Box<dyn Error>> {
    let manifest = PathBuf::from(std::env::var("CARGO_MANIFEST_DIR")?);
    let out = PathBuf::from(std::env::var("OUT_DIR")?);
    let web = manifest.join("../../web");
    let site = web.join("dist");
    if web.join("package.json").is_file() && !site.exists() {
        // Cargo runs this again at every build while a path that it is to watch is missing, and builds everything after it anew.
        // An empty folder can be watched. Where it can't be made, nothing else is lost.
        let _ = fs::create_dir(&site);
    }
    println!("cargo:rerun-if-changed=build.rs");
    if site.exists() {
        println!("cargo:rerun-if-changed={}", site.display());
    }
    let mut names = Vec::new();
    if site.join("index.html").is_file() {
        collect(&site, "", &mut names)?;
    }
    names.sort();
    let mut table = String::from("&[\n");
    for (number, name) in names.iter().enumerate() {
        let bytes = fs::read(site.join(name))?;
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(&bytes)?;
        let compressed = encoder.finish()?;
        // What hardly shrinks, such as fonts, is kept as it is.
        let gzip = compressed.len() < bytes.len() / 20 * 19;
        let file = format!("site-{number}");
        fs::write(out.join(&file), if gzip { &compressed } else { &bytes })?;
        writeln!(
            table,
            "    ({name:?}, {gzip}, include_bytes!(concat!(env!(\"OUT_DIR\"), \"/{file}\"))),"
        )?;
    }
    table += "]\n";
    fs::write(out.join("site.rs"), table)?;
    Ok(())
}

/// The names of all files below `folder`, with `/` between their parts.
fn collect(folder: &Path, prefix: &str, names: &mut Vec<String>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name
            .to_str()
            .ok_or_else(|| format!("{}: its name is not UTF-8", entry.path().display()))?;
        match entry.file_type()?.is_dir() {
            true => collect(&entry.path(), &format!("{prefix}{name}/"), names)?,
            false => names.push(format!("{prefix}{name}")),
        }
    }
    Ok(())
}
