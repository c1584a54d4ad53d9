//! Prints values of a model at random directions as CSV, for comparison with other programs.
//!
//! `cargo run -p gonio-brdf --example dump_values -- 'ggx:alpha=0.3,metal=gold' 10000`
//!
//! Columns: wi x, y, z; wo x, y, z; f·cosθi red, green, blue; pdf; and a sample for wo: three numbers u, wi x, y, z, weight red, green,
//! blue, pdf. The directions and numbers are the same for every model: uniform on the hemisphere, rounded to single precision. For a
//! model that only mirrors, the first wi, f·cosθi and pdf are those of a sample.

use gonio_brdf::{Brdf, BrdfError, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_radiometry::{sequence::Rng, warp::around_axis};

fn main() -> Result<(), BrdfError> {
    let mut arguments = std::env::args().skip(1);
    let text = arguments.next().unwrap_or_else(|| "lambertian".into());
    let count = arguments
        .next()
        .and_then(|n| n.parse().ok())
        .unwrap_or(10_000);
    let model: Model<f64, 3> = ModelSpec::parse(&text)?.build()?;
    let mut rng = Rng::from_name("dump_values");
    let mut direction = || {
        let z = rng.next_f64().max(1e-3);
        around_axis(rng.next_f64(), (1.0 - z * z).sqrt(), z)
            .to_f32()
            .to_f64()
    };
    let mut numbers = Rng::from_name("numbers");
    for _ in 0..count {
        let (mut wi, wo): (Vec3<f64>, Vec3<f64>) = (direction(), direction());
        let (mut f, mut pdf) = model.eval_cos_and_pdf(wi, wo);
        if model.is_delta() {
            let s = model.sample(wo, [0.5; 3]);
            (wi, f, pdf) = (s.wi, s.weight, s.pdf);
        }
        let u = [0; 3].map(|_| f64::from(numbers.next_f32()));
        let s = model.sample(wo, u);
        let row = [
            &wi.to_array(),
            &wo.to_array(),
            &f,
            &[pdf][..],
            &u,
            &s.wi.to_array(),
            &s.weight,
            &[s.pdf],
        ];
        let numbers: Vec<_> = row.concat().iter().map(|x| format!("{x:e}")).collect();
        println!("{}", numbers.join(","));
    }
    Ok(())
}
