//! Prints the channels of a measurement at random directions as CSV, for comparison with other programs.
//!
//! `cargo run -p gonio-brdf --example dump_spectrum -- table.bsdf 10000`
//!
//! Columns: wi x, y, z; wo x, y, z; f·cosθi of each channel. The directions are those of `dump_values`. The first row has the channels' names.

use gonio_brdf::BrdfError;
use gonio_brdf::measured::{LoadOptions, load};
use gonio_radiometry::{sequence::Rng, warp::around_axis};
use std::path::PathBuf;

fn main() -> Result<(), BrdfError> {
    let mut arguments = std::env::args().skip(1);
    let path: PathBuf = arguments.next().unwrap_or_default().into();
    let count = arguments
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(10_000);
    let table = load(&path, LoadOptions::default())?;
    let names = table.measurement().channels.iter().map(ToString::to_string);
    println!("{}", names.collect::<Vec<_>>().join(","));
    let mut rng = Rng::from_name("dump_values");
    let mut direction = || {
        let z = rng.next_f64().max(1e-3);
        around_axis(rng.next_f64(), (1.0 - z * z).sqrt(), z)
            .to_f32()
            .to_f64()
    };
    for _ in 0..count {
        let (wi, wo) = (direction(), direction());
        let mut row = [wi.to_array(), wo.to_array()].concat();
        row.extend(table.eval_spectrum(wi, wo).iter().map(|f| f * wi.z));
        let columns: Vec<_> = row.iter().map(|x| format!("{x:e}")).collect();
        println!("{}", columns.join(","));
    }
    Ok(())
}
