//! Compares two pictures and writes where they differ: `cargo run --example compare -- PICTURE REFERENCE [HEATMAP]`.

use gonio_image::{Image, difference};
use std::path::Path;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let [picture, reference, rest @ ..] = names.as_slice() else {
        return Err("usage: compare PICTURE REFERENCE [HEATMAP]".into());
    };
    let d = difference::compare(
        &Image::read(Path::new(picture))?,
        &Image::read(Path::new(reference))?,
    )?;
    println!("RMSE          {:.6}", d.rmse);
    println!("relative MSE  {:.6}", d.relative_mse);
    println!("PSNR          {:.2} dB (peak {})", d.psnr_db, d.peak);
    println!("FLIP          {:.6} ({:?})", d.flip_mean, d.flip);
    println!("largest       {:?}", d.largest);
    if let Some(heatmap) = rest.first() {
        difference::heatmap(&d).write(Path::new(heatmap))?;
    }
    Ok(())
}
