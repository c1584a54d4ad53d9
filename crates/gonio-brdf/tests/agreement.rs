//! The same bits from single calls, from lanes under each instruction set, and from the recorded graph; and the recorded WGSL is
//! valid.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

mod common;

use gonio_brdf::batch::{Directions, Samples, eval_and_pdf_on, eval_on, pdf_on, sample_on};
use gonio_brdf::record::{record_eval, record_pdf, record_sample};
use gonio_brdf::{Brdf, Model};
use gonio_num::Vec3;
use gonio_num::dispatch::InstructionSet;
use gonio_radiometry::sequence::Rng;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// Not a multiple of any number of lanes: the tail is covered too.
const COUNT: usize = 37;

struct Inputs {
    wi: [Vec<f32>; 3],
    wo: [Vec<f32>; 3],
    u: [Vec<f32>; 3],
}

fn inputs(name: &str) -> Inputs {
    let mut rng = Rng::from_name(name);
    let mut directions = |first: Vec3<f32>| {
        let mut out = [vec![first.x], vec![first.y], vec![first.z]];
        while out[0].len() < COUNT {
            let mut x = || 2.0 * rng.next_f32() - 1.0;
            let v = Vec3::new(x(), x(), x());
            // Some are below the horizon.
            if v.length() < 1.0 && v.length() > 0.1 {
                let v = v.normalize();
                for (out, x) in out.iter_mut().zip([v.x, v.y, v.z + 0.3]) {
                    out.push(x);
                }
            }
        }
        out
    };
    let (wi, wo) = (
        directions(Vec3::new(0.0, 0.0, 1.0)),
        directions(Vec3::new(1.0, 0.0, 1e-30)),
    );
    let u = std::array::from_fn(|_| (0..COUNT).map(|_| rng.next_f32()).collect());
    Inputs { wi, wo, u }
}

fn view(v: &[Vec<f32>; 3]) -> Directions<'_> {
    Directions {
        x: &v[0],
        y: &v[1],
        z: &v[2],
    }
}

fn at(v: &[Vec<f32>; 3], k: usize) -> Vec3<f32> {
    Vec3::new(v[0][k], v[1][k], v[2][k])
}

#[test]
fn lanes_have_the_bits_of_single_calls() {
    let inputs = inputs("lanes");
    for spec in common::one_at_a_time()
        .into_iter()
        .chain(common::random("lanes", 5))
    {
        let model: Model<f32, 3> = spec.build().unwrap();
        for set in InstructionSet::ALL {
            if !set.is_available() {
                eprintln!("skipped: this machine has no {}", set.name());
                continue;
            }
            let mut f = vec![vec![0.0; COUNT]; 3];
            let [r, g, b] = f.as_mut_slice() else {
                unreachable!()
            };
            eval_on(set, &model, view(&inputs.wi), view(&inputs.wo), [r, g, b]);
            let mut pdf = vec![0.0; COUNT];
            pdf_on(set, &model, view(&inputs.wi), view(&inputs.wo), &mut pdf);
            let mut both = vec![vec![0.0f32; COUNT]; 4];
            let [r, g, b, density] = both.as_mut_slice() else {
                unreachable!()
            };
            let (wi, wo) = (view(&inputs.wi), view(&inputs.wo));
            eval_and_pdf_on(set, &model, wi, wo, [r, g, b], density);
            for (together, alone) in both.iter().zip(f.iter().chain([&pdf])) {
                let bits = |v: &[f32]| v.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
                assert_eq!(bits(together), bits(alone), "{spec} {set:?}");
            }
            let mut drawn = vec![vec![0.0f32; COUNT]; 7];
            let mut delta = vec![false; COUNT];
            let [x, y, z, wr, wg, wb, density] = drawn.as_mut_slice() else {
                unreachable!()
            };
            let samples = Samples {
                wi: [x, y, z],
                weight: [wr, wg, wb],
                pdf: density,
                delta: &mut delta,
            };
            let u = [&inputs.u[0][..], &inputs.u[1], &inputs.u[2]];
            sample_on(set, &model, view(&inputs.wo), u, samples);
            for k in 0..COUNT {
                let (wi, wo) = (at(&inputs.wi, k), at(&inputs.wo, k));
                let expected = model.eval(wi, wo);
                let s = model.sample(wo, at(&inputs.u, k).to_array());
                for c in 0..3 {
                    assert_eq!(
                        f[c][k].to_bits(),
                        expected[c].to_bits(),
                        "{spec} {set:?} {k}"
                    );
                    assert_eq!(
                        drawn[c][k].to_bits(),
                        s.wi[c].to_bits(),
                        "{spec} {set:?} {k}"
                    );
                    assert_eq!(
                        drawn[3 + c][k].to_bits(),
                        s.weight[c].to_bits(),
                        "{spec} {set:?} {k}"
                    );
                }
                assert_eq!(
                    pdf[k].to_bits(),
                    model.pdf(wi, wo).to_bits(),
                    "{spec} {set:?} {k}"
                );
                assert_eq!(drawn[6][k].to_bits(), s.pdf.to_bits(), "{spec} {set:?} {k}");
                assert_eq!(delta[k], s.delta, "{spec} {set:?} {k}");
            }
        }
    }
}

fn assert_valid(wgsl: &str) {
    let module = naga::front::wgsl::parse_str(wgsl)
        .unwrap_or_else(|e| panic!("{}\n{wgsl}", e.emit_to_string(wgsl)));
    Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|e| panic!("{}\n{wgsl}", e.emit_to_string(wgsl)));
}

#[test]
fn recorded_functions_are_valid_and_have_the_same_bits() {
    let inputs = inputs("record");
    for spec in common::one_at_a_time() {
        let model: Model<f32, 3> = spec.build().unwrap();
        if !model.is_recordable() {
            assert!(record_eval(&model, "brdf_eval").is_err(), "{spec}");
            continue;
        }
        let eval = record_eval(&model, "brdf_eval").unwrap();
        let pdf = record_pdf(&model, "brdf_pdf").unwrap();
        let sample = record_sample(&model, "brdf_sample").unwrap();
        for function in [&eval, &pdf, &sample] {
            assert_valid(&function.wgsl());
        }
        for k in 0..COUNT {
            let (wi, wo, u) = (at(&inputs.wi, k), at(&inputs.wo, k), at(&inputs.u, k));
            let both = [wi.x, wi.y, wi.z, wo.x, wo.y, wo.z];
            assert_eq!(eval.evaluate(&both), model.eval(wi, wo), "{spec} {k}");
            assert_eq!(pdf.evaluate(&both), [model.pdf(wi, wo)], "{spec} {k}");
            let s = model.sample(wo, u.to_array());
            let drawn = sample.evaluate(&[wo.x, wo.y, wo.z, u.x, u.y, u.z]);
            assert_eq!(drawn[..3], s.wi.to_array(), "{spec} {k}");
            assert_eq!(drawn[3..6], s.weight, "{spec} {k}");
            assert_eq!(
                drawn[6..],
                [s.pdf, f32::from(u8::from(s.delta))],
                "{spec} {k}"
            );
        }
    }
}
