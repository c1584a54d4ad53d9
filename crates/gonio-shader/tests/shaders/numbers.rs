//! The same shader over other numbers.

use super::{load, near};
use gonio_num::dual::Dual;
use gonio_num::lanes::Lanes;
use gonio_num::{Real, Vec3};

/// A microfacet reflection with branches and a loop, all of it differentiable where it is asked.
const TEXT: &str = "
override roughness: f32 = 0.4; // 0.05..1 perceptual roughness
override f0: f32 = 0.8; // 0..1 reflection at normal incidence
fn sqr(x: f32) -> f32 { return x * x; }
fn eval(wi: vec3f, wo: vec3f) -> vec3f {
    if wi.z <= 0.0 || wo.z <= 0.0 { return vec3f(0.0); }
    let a2 = sqr(sqr(roughness));
    let h = normalize(wi + wo);
    let d = a2 / (3.14159265 * sqr(1.0 + (a2 - 1.0) * sqr(h.z)));
    var g = 0.0;
    for (var i = 0; i < 2; i++) {
        let c = select(wo.z, wi.z, i == 0);
        g += select(wi.z, wo.z, i == 0) * sqrt(a2 + (1.0 - a2) * sqr(c));
    }
    let f = vec3f(f0, f0 * 0.5, 0.04) + (1.0 - f0) * pow(1.0 - dot(wi, h), 5.0);
    return f * d * 0.5 / g + exp2(-3.0 * roughness) * 0.1;
}";

fn direction(theta: f64, phi: f64) -> [f64; 3] {
    [
        theta.sin() * phi.cos(),
        theta.sin() * phi.sin(),
        theta.cos(),
    ]
}

fn vector<R: Real>(w: [f64; 3]) -> Vec3<R> {
    Vec3::new(R::lit(w[0]), R::lit(w[1]), R::lit(w[2]))
}

fn pairs() -> Vec<([f64; 3], [f64; 3])> {
    let mut all = Vec::new();
    for i in 0..7 {
        for o in 0..5 {
            let wi = direction(0.1 + 0.25 * f64::from(i), 0.9 * f64::from(o));
            let wo = direction(0.05 + 0.35 * f64::from(o), -0.3);
            all.push((wi, wo));
        }
    }
    all
}

#[test]
fn f32_agrees_with_f64() {
    let shader = load("test.wgsl", TEXT).unwrap();
    for (wi, wo) in pairs() {
        let double = shader.eval(&[0.4, 0.8], vector::<f64>(wi), vector(wo));
        let single = shader.eval(&[0.4, 0.8], vector::<f32>(wi), vector(wo));
        for k in 0..3 {
            // Some twenty roundings of 6e-8, and the cancellation in 1 + (a² − 1) h.z², which the small a² makes 40 times larger.
            assert!(
                near(f64::from(single[k]), double[k], 1e-4),
                "{single:?} {double:?}"
            );
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let shader = load("test.wgsl", TEXT).unwrap();
    type D = Dual<f64, 2>;
    let step = 1e-5;
    for (wi, wo) in pairs() {
        let parameters = [D::variable(0.4, 0), D::variable(0.8, 1)];
        let duals = shader.eval(&parameters, vector::<D>(wi), vector(wo));
        let at = |r: f64, f0: f64| shader.eval(&[r, f0], vector::<f64>(wi), vector(wo));
        let value = at(0.4, 0.8);
        let by = [
            [at(0.4 + step, 0.8), at(0.4 - step, 0.8)],
            [at(0.4, 0.8 + step), at(0.4, 0.8 - step)],
        ];
        for k in 0..3 {
            assert_eq!(duals[k].value, value[k]);
            for (p, [high, low]) in by.iter().enumerate() {
                let difference = (high[k] - low[k]) / (2.0 * step);
                // The error of a central difference: h² f‴/6, where f‴ is below 1e3 f, and 1e-16/h of rounding.
                assert!(
                    near(
                        duals[k].partials[p],
                        difference,
                        1e-6 + 1e-7 * value[k].abs()
                    ),
                    "{} {difference}",
                    duals[k].partials[p]
                );
            }
        }
    }
}

#[test]
fn lanes_are_bit_equal_to_f32() {
    let shader = load("test.wgsl", TEXT).unwrap();
    let pairs = pairs();
    let mut wi = Vec3::new(Lanes::<64>::zero(), Lanes::zero(), Lanes::zero());
    let mut wo = wi;
    for (k, (i, o)) in pairs.iter().enumerate() {
        (wi.x.0[k], wi.y.0[k], wi.z.0[k]) = (i[0] as f32, i[1] as f32, i[2] as f32);
        (wo.x.0[k], wo.y.0[k], wo.z.0[k]) = (o[0] as f32, o[1] as f32, o[2] as f32);
    }
    let all = shader.eval(&[Lanes::splat(0.4), Lanes::splat(0.8)], wi, wo);
    for (k, &(i, o)) in pairs.iter().enumerate() {
        let one = shader.eval(&[0.4, 0.8], vector::<f32>(i), vector(o));
        for c in 0..3 {
            assert_eq!(all[c].0[k].to_bits(), one[c].to_bits());
        }
    }
}
