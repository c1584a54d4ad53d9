//! Each kind of plot of functions that are written here: `cargo run -p gonio-plot --example gallery -- FOLDER`.

use gonio_num::Vec3;
use gonio_plot::{
    Channel, Draw, Figure, Function, Options, PlotError, albedo, cartesian, difference, lobe3d,
    polar, slice, sphere,
};
use std::f64::consts::PI;
use std::path::Path;

/// A rough metal: GGX with Smith's masking and Schlick's Fresnel term.
fn metal(roughness: f64, f0: [f64; 3]) -> impl Fn(Vec3<f64>, Vec3<f64>) -> [f64; 3] {
    move |wi, wo| {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return [0.0; 3];
        }
        let a2 = roughness.powi(4);
        let h = (wi + wo).normalize();
        let d = a2 / (PI * (h.z * h.z * (a2 - 1.0) + 1.0).powi(2));
        let lambda = |w: Vec3<f64>| (a2 + (1.0 - a2) * w.z * w.z).sqrt();
        let v = 0.5 / (wi.z * lambda(wo) + wo.z * lambda(wi));
        let fifth = (1.0 - wi.dot(h)).powi(5);
        f0.map(|f0| d * v * (f0 + (1.0 - f0) * fifth))
    }
}

/// A pane of glass without absorption: two Dirac deltas.
fn pane(wo: Vec3<f64>, u: [f64; 3]) -> Option<Draw> {
    let r = 0.04 + 0.96 * (1.0 - wo.z.abs()).powi(5);
    let r = 2.0 * r / (1.0 + r);
    let (wi, share) = if u[2] < r {
        (Vec3::new(-wo.x, -wo.y, wo.z), r)
    } else {
        (-wo, 1.0 - r)
    };
    Some(Draw {
        wi,
        weight: [1.0; 3],
        probability: share,
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    let write =
        |name: &str, figure: Result<Figure, PlotError>| -> Result<(), Box<dyn std::error::Error>> {
            let figure = figure?;
            let path = Path::new(&folder).join(name);
            std::fs::write(path.with_extension("svg"), figure.svg())?;
            std::fs::write(path.with_extension("png"), figure.png(1.0)?)?;
            println!("{name}: {} bytes of SVG", figure.svg().len());
            Ok(())
        };
    let paint = || {
        Function::new("paint", |wi, wo| {
            [if wi.z > 0.0 && wo.z > 0.0 {
                0.8 / PI
            } else {
                0.0
            }; 3]
        })
    };
    let gold = |roughness| {
        let name = format!("gold, roughness {roughness}");
        Function::new(name, metal(roughness, [1.0, 0.78, 0.34]))
    };
    let glass = || {
        Function::new("pane", |_, _| [0.0; 3])
            .with_discrete(pane)
            .transmitting([1.0; 3])
    };
    let usual = Options::default();
    let cosine = Options {
        cosine: true,
        ..usual.clone()
    };
    let rgb = Options {
        channel: Channel::Rgb,
        ..usual.clone()
    };
    write("polar-paint", polar(&[paint()], &cosine))?;
    write("polar-gold", polar(&[gold(0.4)], &usual))?;
    write("polar-sharp", polar(&[gold(0.02)], &usual))?;
    write("polar-pane", polar(&[glass()], &usual))?;
    write(
        "polar-several",
        polar(&[paint(), gold(0.3), gold(0.5)], &usual),
    )?;
    write("polar-rgb", polar(&[gold(0.4)], &rgb))?;
    write(
        "polar-rgb-several",
        polar(&[gold(0.3), gold(0.6), paint()], &rgb),
    )?;
    write("cartesian-gold", cartesian(&[gold(0.4)], &usual))?;
    write("cartesian-sharp", cartesian(&[gold(0.02)], &usual))?;
    write(
        "cartesian-several",
        cartesian(&[paint(), gold(0.3), gold(0.5)], &usual),
    )?;
    write("cartesian-pane", cartesian(&[glass()], &usual))?;
    write("albedo-gold", albedo(&[gold(0.6)], &usual))?;
    write("albedo-rgb", albedo(&[gold(0.6)], &rgb))?;
    write(
        "albedo-several",
        albedo(&[paint(), gold(0.1), gold(0.5), gold(1.0)], &usual),
    )?;
    write("albedo-pane", albedo(&[glass()], &usual))?;
    write("slice-gold", slice(&[gold(0.4)], &usual))?;
    write(
        "slice-several",
        slice(&[paint(), gold(0.1), gold(0.3), gold(0.6)], &rgb),
    )?;
    write("difference", difference(&[gold(0.3), gold(0.35)], &usual))?;
    write("sphere-gold", sphere(&[gold(0.4)], &usual))?;
    write(
        "sphere-several",
        sphere(&[paint(), gold(0.1), gold(0.3), gold(0.6)], &usual),
    )?;
    write("lobe3d-gold", lobe3d(&[gold(0.4)], &usual))?;
    write("lobe3d-paint", lobe3d(&[paint()], &cosine))?;
    write(
        "lobe3d-several",
        lobe3d(&[paint(), gold(0.02), gold(0.3), gold(0.6)], &rgb),
    )?;
    Ok(())
}
