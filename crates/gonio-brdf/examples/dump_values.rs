//! Prints values of a model at random directions as CSV, for comparison with other programs.
//!
//! `cargo run -p gonio-brdf --example dump_values -- 'ggx:alpha=0.3,metal=gold' 10000`
//!
//! Columns: wi x, y, z; wo x, y, z; f·|cosθi| red, green, blue; pdf; u. The directions are uniform on the hemisphere, for a model that
//! transmits on the sphere, and rounded to single precision. For a model of discrete directions wi, f·|cosθi| over the density, and
//! the probability are those of a sample, drawn with u, which is 0.001 and 0.999 in turn.

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
    let through = model.transmits();
    let mut direction = || {
        let mut z = rng.next_f64().max(1e-3);
        if through && rng.next_f64() < 0.5 {
            z = -z;
        }
        around_axis(rng.next_f64(), (1.0 - z * z).sqrt(), z)
            .to_f32()
            .to_f64()
    };
    for k in 0..count {
        let u = if k % 2 == 0 { 0.001 } else { 0.999 };
        let (mut wi, wo): (Vec3<f64>, Vec3<f64>) = (direction(), direction());
        let (mut f, mut pdf) = model.eval_cos_and_pdf(wi, wo);
        if model.is_delta() {
            let s = model.sample(wo, [0.5, 0.5, u]);
            (wi, f, pdf) = (s.wi, s.weight, s.pdf);
        }
        let row = [wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, f[0], f[1], f[2], pdf, u];
        println!("{}", row.map(|x| format!("{x:e}")).join(","));
    }
    Ok(())
}
