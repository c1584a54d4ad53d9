//! How well a model samples itself: the scatter of the weights f·|cosθi|/pdf.
//!
//! `cargo run --release -p gonio-brdf --example sampling_efficiency -- ward:alpha=0.1 eon`; without a description, every model.
//!
//! For viewers at several angles: the albedo, which is the mean of the weights; their standard deviation over it; the largest
//! weight over it; and the share of draws that are lost (below the horizon). An estimator of reflected light from everywhere has
//! the second figure over √samples as its relative error; a mirror has 0. A cosine-weighted sampler of a peaked lobe has 10 or more.

use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};
use gonio_radiometry::{sequence::Rng, warp::around_axis};

const DRAWS: u32 = 200_000;

fn main() -> Result<(), BrdfError> {
    let given: Vec<String> = std::env::args().skip(1).collect();
    let specs = if given.is_empty() {
        gonio_brdf::showcase()
    } else {
        given
            .iter()
            .map(|text| ModelSpec::parse(text))
            .collect::<Result<_, _>>()?
    };
    for spec in specs {
        let model: Model<f64, 3> = spec.build()?;
        println!("{spec}");
        for theta_deg in [0.0f64, 45.0, 75.0, 85.0] {
            let theta = theta_deg.to_radians();
            let wo = around_axis(0.1, theta.sin(), theta.cos());
            let mut rng = Rng::from_name("sampling_efficiency");
            let (mut sum, mut squares, mut largest, mut lost) = (0.0, 0.0, 0.0f64, 0);
            for _ in 0..DRAWS {
                let s = model.sample(wo, [rng.next_f64(), rng.next_f64(), rng.next_f64()]);
                let weight = s.weight.iter().sum::<f64>() / 3.0;
                sum += weight;
                squares += weight * weight;
                largest = largest.max(weight);
                lost += u32::from(s.pdf == 0.0);
            }
            let n = f64::from(DRAWS);
            let mean = sum / n;
            let deviation = (squares / n - mean * mean).max(0.0).sqrt();
            println!(
                "  θo {theta_deg:2}°  albedo {mean:.4}  σ/mean {:.3}  max/mean {:.1}  lost {:.1} %",
                deviation / mean.max(1e-300),
                largest / mean.max(1e-300),
                100.0 * f64::from(lost) / n
            );
        }
    }
    Ok(())
}
