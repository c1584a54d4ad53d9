//! The book's pictures of plots, by the library: `cargo run -p gonio --example plots` writes them.

use gonio::brdf::{Brdf, Model, ModelSpec};
use gonio::plot::{Channel, Figure, Function, Options, albedo, cartesian, lobe3d, polar, slice};
use std::error::Error;
use std::path::{Path, PathBuf};

/// Where the pictures are.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../book/src/plots")
}

/// Each picture by its name.
pub fn pictures() -> Result<Vec<(&'static str, Figure)>, Box<dyn Error>> {
    let gold = model("ggx:metal=gold,roughness=0.3")?;
    let sharp = model("ggx:metal=gold,roughness=0.05")?;
    let rough = model("ggx:metal=gold,roughness=0.6,interreflection=none")?;
    let whole = model("ggx:metal=gold,roughness=0.6")?;
    let disney = model("disney:base_color=0.5/0.2/0.1,roughness=0.4,sheen=1")?;
    let usual = Options::default();
    let rgb = Options {
        channel: Channel::Rgb,
        ..usual.clone()
    };
    Ok(vec![
        (
            "polar",
            polar(&[function("gold, roughness 0.3", &gold)], &usual)?,
        ),
        (
            "cartesian",
            cartesian(
                &[
                    function("gold, roughness 0.05", &sharp),
                    function("gold, roughness 0.3", &gold),
                    function("disney", &disney),
                ],
                &Options {
                    theta_deg: vec![45.0],
                    title: Some("Two metals and a plastic at 45°".into()),
                    ..usual.clone()
                },
            )?,
        ),
        (
            "albedo",
            albedo(
                &[
                    function("one reflection", &rough),
                    function("with interreflection", &whole),
                ],
                &Options {
                    title: Some("Gold of roughness 0.6".into()),
                    ..usual.clone()
                },
            )?,
        ),
        (
            "slice",
            slice(
                &[
                    function("gold, roughness 0.3", &gold),
                    function("disney", &disney),
                ],
                &rgb,
            )?,
        ),
        ("lobe3d", lobe3d(&[function("disney", &disney)], &rgb)?),
    ])
}

fn model(text: &str) -> Result<Model<f64, 3>, Box<dyn Error>> {
    Ok(ModelSpec::parse(text)?.build()?)
}

fn function<'a>(name: &str, model: &'a Model<f64, 3>) -> Function<'a> {
    Function::new(name, |wi, wo| model.eval(wi, wo))
}

fn main() -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder())?;
    for (name, figure) in pictures()? {
        let path = folder().join(name).with_extension("svg");
        std::fs::write(&path, figure.svg())?;
        println!("wrote {}", path.display());
    }
    Ok(())
}
