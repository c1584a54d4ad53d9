//! Exported shader code computes what the model computes, in every language.
//!
//! The text itself is run: WGSL and GLSL by the evaluator of shaders, HLSL, MSL and OSL by a C++ compiler with a header that defines
//! what those languages have and C++ lacks.

// Helpers of tests are tests.
#![allow(clippy::unwrap_used)]

mod compiled;
mod evaluated;
mod written;

use gonio_brdf::export::{Export, Style, obstacle};
use gonio_brdf::record::FunctionKind;
use gonio_brdf::{Brdf, Model, ModelSpec};
use gonio_num::Vec3;
use gonio_num::expr::Language;
use gonio_radiometry::sequence::Rng;

/// Pairs of directions for each model.
const COUNT: usize = 48;
/// Numbers that go in: wi, wo, xi.
const INPUTS: usize = 9;
/// Numbers that come out: f, the density, and of a sample wi, weight, density and whether it is discrete.
const OUTPUTS: usize = 12;

/// All that is exported: the showcase without what can't be.
fn showcase() -> Vec<ModelSpec> {
    let mut all = gonio_brdf::showcase();
    all.retain(|spec| obstacle(spec).is_none());
    all
}

fn text(export: &Export<'_>, language: Language, name: &str) -> String {
    let style = Style {
        language,
        functions: &FunctionKind::ALL,
        name,
        command: "gonio brdf export",
    };
    export.text(&style).unwrap()
}

/// Pairs in all directions, and pairs near mirror reflection, where the lobes are.
fn inputs(name: &str) -> Vec<[f32; INPUTS]> {
    let mut rng = Rng::from_name(name);
    let mut all = Vec::new();
    while all.len() < COUNT {
        let mut x = || 2.0 * rng.next_f32() - 1.0;
        let mut direction = || loop {
            let v = Vec3::new(x(), x(), x());
            if (0.1..1.0).contains(&v.length()) {
                return v.normalize();
            }
        };
        let (mut wi, mut wo) = (direction(), direction());
        if all.len() % 4 > 0 {
            // Most are seen from above.
            wo = Vec3::new(wo.x, wo.y, wo.z.abs());
        }
        if all.len() % 2 > 0 {
            wi = (Vec3::new(-wo.x, -wo.y, wo.z) + wi * 0.3).normalize();
        }
        let u = [0; 3].map(|_| rng.next_f32());
        all.push([wi.x, wi.y, wi.z, wo.x, wo.y, wo.z, u[0], u[1], u[2]]);
    }
    all
}

/// What a model gives in double and in single precision.
fn expected(spec: &ModelSpec, input: &[f32; INPUTS]) -> [[f64; OUTPUTS]; 2] {
    macro_rules! outputs {
        ($t:ty) => {{
            let model: Model<$t, 3> = spec.build().unwrap();
            let x = |k: usize| <$t>::from(input[k]);
            let wi = Vec3::new(x(0), x(1), x(2));
            let wo = Vec3::new(x(3), x(4), x(5));
            let [r, g, b] = model.eval(wi, wo);
            let s = model.sample(wo, [x(6), x(7), x(8)]);
            let [wr, wg, wb] = s.weight;
            let delta = if s.delta { 1.0 } else { 0.0 };
            [
                r,
                g,
                b,
                model.pdf(wi, wo),
                s.wi.x,
                s.wi.y,
                s.wi.z,
                wr,
                wg,
                wb,
                s.pdf,
                delta,
            ]
            .map(|x| x as f64)
        }};
    }
    #[allow(clippy::unnecessary_cast, reason = "one macro for both precisions")]
    let both = [outputs!(f64), outputs!(f32)];
    both
}

/// Where the code is not the model, if anywhere: what it gives, and what it should.
///
/// It may be off by 1e-5 of the value, and by what single precision costs the model itself there. The code's operations are the model's
/// but for parameters that are rounded once more; its elementary functions are others, a unit in the last place away. Either goes
/// through the formula as the model's own roundings do, which is measured: the difference of the model in single and in
/// double precision at this pair and at its neighbours, as at one of them the roundings may cancel.
fn difference(spec: &ModelSpec, inputs: &[[f32; INPUTS]], got: &[f32]) -> Option<String> {
    for (input, got) in inputs.iter().zip(got.chunks_exact(OUTPUTS)) {
        let [exact, single] = expected(spec, input);
        let mut loss: Vec<f64> = (0..OUTPUTS).map(|k| (exact[k] - single[k]).abs()).collect();
        let wrong = |loss: &[f64]| {
            (0..OUTPUTS).find(|k| {
                let error = (f64::from(got[*k]) - exact[*k]).abs();
                let allowed = 1e-5 * exact[*k].abs().max(1e-3) + 4.0 * loss[*k];
                error.is_nan() || error > allowed
            })
        };
        if wrong(&loss).is_none() {
            continue;
        }
        for place in 0..INPUTS {
            for up in [true, false] {
                let mut near = *input;
                near[place] = if up {
                    near[place].next_up()
                } else {
                    near[place].next_down()
                };
                let [exact, single] = expected(spec, &near);
                for k in 0..OUTPUTS {
                    loss[k] = loss[k].max((exact[k] - single[k]).abs());
                }
            }
        }
        if let Some(k) = wrong(&loss) {
            return Some(format!(
                "{spec}: output {k} for {input:?} is {}, not {} ({} in single precision; loss {:e})",
                got[k], exact[k], single[k], loss[k]
            ));
        }
    }
    None
}
