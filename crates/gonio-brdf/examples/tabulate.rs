//! Writes the tables that microfacet models look values up in: Smith's masking where it has no closed form, and directional albedos and losses for
//! interreflection and layers.
//!
//! `cargo run --release -p gonio-brdf --example tabulate -- masking crates/gonio-brdf/src/part/masking.bin`, then the same
//! with `albedo`, `boundary` and `gloss`, which are computed from the first, and with `charlie_albedo`.

use gonio_brdf::part::{albedo, boundary_loss, charlie_albedo, gloss, masking_table};
use std::io::Write as _;

fn main() -> std::io::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let (Some(what), Some(path)) = (arguments.next(), arguments.next()) else {
        eprintln!("usage: tabulate masking|albedo|boundary|gloss|charlie_albedo FILE");
        std::process::exit(2);
    };
    let numbers: Vec<f32> = match what.as_str() {
        "masking" => masking_table::SHAPES
            .into_iter()
            .flat_map(masking_table::tabulate)
            .collect(),
        "albedo" => albedo::combinations()
            .flat_map(|(shape, masking)| albedo::tabulate(shape, masking))
            .collect(),
        "boundary" => boundary_loss::surfaces()
            .into_iter()
            .flat_map(boundary_loss::tabulate)
            .collect(),
        "gloss" => gloss::tabulate(),
        "charlie_albedo" => charlie_albedo::tabulate(),
        other => {
            eprintln!(
                "unknown table `{other}`: masking, albedo, boundary, gloss or charlie_albedo"
            );
            std::process::exit(2);
        }
    };
    let temporary = format!("{path}.partial");
    let mut file = std::fs::File::create(&temporary)?;
    for x in &numbers {
        file.write_all(&x.to_le_bytes())?;
    }
    file.sync_all()?;
    std::fs::rename(&temporary, &path)?;
    println!("{path}: {} numbers", numbers.len());
    Ok(())
}
