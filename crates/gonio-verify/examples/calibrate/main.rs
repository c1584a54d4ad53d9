//! Is the instrument right? Checks right functions by the ten thousand and writes what came of it, and the book's page on
//! calibration.
//!
//! `cargo run --release -p gonio-verify --example calibrate -- 2400 40`: runs of each right function in short and with quick effort,
//! some minutes. Without numbers it writes the page again from what was found last.

mod page;

use gonio_verify::specimen::{calibrate, short};
use gonio_verify::{Effort, Settings};
use std::error::Error;
use std::fs;

fn main() -> Result<(), Box<dyn Error>> {
    let mut runs = Vec::new();
    for word in std::env::args().skip(1) {
        runs.push(word.parse::<u64>().map_err(|e| format!("{word}: {e}"))?);
    }
    if let [of_short, of_quick] = runs[..] {
        let progress = |done: u64, of: u64| {
            if done.is_multiple_of(of.div_ceil(100)) {
                eprint!("\r{done} of {of} suites ");
            }
        };
        let found = page::Found {
            short: calibrate(of_short, short(), &progress)?,
            quick: calibrate(of_quick, Settings::new(Effort::Quick), &progress)?,
        };
        eprintln!();
        fs::write(
            page::found_file(),
            serde_json::to_string_pretty(&found)? + "\n",
        )?;
    } else if !runs.is_empty() {
        return Err("two numbers of runs are expected: short and quick".into());
    }
    fs::write(page::page_file(), page::page()?)?;
    println!("wrote {}", page::page_file().display());
    Ok(())
}
