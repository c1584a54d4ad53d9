//! Writes the directional-albedo tables behind the interreflection of `torrance-sparrow`.
//!
//! `cargo run --release -p gonio-brdf --example tabulate_albedo -- crates/gonio-brdf/src/part/albedo.bin`

use gonio_brdf::part::albedo::{COMBINATIONS, tabulate};
use std::io::Write as _;

fn main() -> std::io::Result<()> {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: tabulate_albedo FILE");
        std::process::exit(2);
    };
    let threads: Vec<_> = COMBINATIONS
        .into_iter()
        .map(|(shape, masking)| std::thread::spawn(move || tabulate(shape, masking)))
        .collect();
    let mut bytes = Vec::new();
    for thread in threads {
        for x in thread.join().expect("invariant: quadrature does not panic") {
            bytes.extend_from_slice(&x.to_le_bytes());
        }
    }
    let temporary = format!("{path}.partial");
    let mut file = std::fs::File::create(&temporary)?;
    file.write_all(&bytes)?;
    file.sync_all()?;
    std::fs::rename(&temporary, &path)?;
    println!("{path}: {} bytes", bytes.len());
    Ok(())
}
