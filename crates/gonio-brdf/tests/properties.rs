//! Properties of every model of the registry, over a grid of parameters and directions.

// Helpers of tests are tests, and colours are short arrays walked side by side.
#![allow(clippy::unwrap_used, clippy::needless_range_loop)]

mod common;

use gonio_brdf::{Brdf, Model, ModelSpec, Number, registry};
use gonio_num::{Vec3, dual::Dual};
use gonio_radiometry::sequence::Rng;
use std::cell::Cell;

/// Unit directions above the horizon: normal, grazing, and random.
fn directions(name: &str, count: usize) -> Vec<Vec3<f32>> {
    let mut rng = Rng::from_name(name);
    let mut all = vec![
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(0.6, 0.0, 0.8),
        Vec3::new(-0.6, 0.0, 0.8),
        Vec3::new(0.999_999, 0.0, 1.4e-3),
        Vec3::new(-0.999_999, 0.0, 1.4e-3),
    ];
    while all.len() < count {
        let mut x = || 2.0 * rng.next_f64() - 1.0;
        let v = Vec3::new(x(), x(), x().abs());
        if v.length() < 1.0 && v.z > 0.05 * v.length() {
            all.push(v.normalize().to_f32());
        }
    }
    all
}

/// Directions where formulas break: exactly grazing, below the horizon, nearly so, and not quite unit.
fn adversarial() -> Vec<Vec3<f32>> {
    let tiny = f32::MIN_POSITIVE;
    vec![
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(1.0, 0.0, 0.0),
        Vec3::new(-1.0, 0.0, 0.0),
        Vec3::new(0.0, 1.0, -0.0),
        Vec3::new(1.0, 0.0, tiny),
        Vec3::new(-1.0, 0.0, tiny),
        Vec3::new(0.0, -1.0, 1e-7),
        Vec3::new(1.0, 0.0, 1e-30),
        Vec3::new(-1.0, 0.0, 1e-30),
        Vec3::new(1.0, 0.0, -1e-30),
        Vec3::new(0.0, 0.0, -1.0),
        Vec3::new(0.6, 0.0, -0.8),
        Vec3::new(1e-20, 0.0, 1.0),
        Vec3::new(0.0, -1e-4, 1.0),
        Vec3::new(0.6, 0.0, 0.800_000_1),
    ]
}

/// The directions, and for what also transmits their images on the other side of the surface.
fn on_all_sides(spec: &ModelSpec, above: &[Vec3<f32>]) -> Vec<Vec3<f32>> {
    let mut all = above.to_vec();
    if spec.declares().unwrap().relative_ior.is_some() {
        all.extend(above.iter().map(|w| Vec3::new(w.x, w.y, -w.z)));
    }
    all
}

fn specs() -> Vec<ModelSpec> {
    let mut all = common::one_at_a_time();
    all.extend(common::random("properties", 20));
    all
}

#[test]
fn registry_is_the_folder() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/model");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .unwrap()
        .map(|f| f.unwrap().path())
        .map(|p| p.file_stem().unwrap().to_string_lossy().replace('_', "-"))
        .filter(|name| name != "mod")
        .collect();
    files.sort();
    let mut names = registry::names();
    names.sort_unstable();
    assert_eq!(files, names);
    for info in registry::models() {
        assert!(!info.paper.is_empty() && !info.summary.is_empty());
    }
}

#[test]
fn finite_non_negative_and_zero_below_the_horizon() {
    fn run<R: Number + Into<f64>>(spec: &ModelSpec, convert: impl Fn(Vec3<f32>) -> Vec3<R>) {
        let model: Model<R, 3> = spec.build().unwrap();
        let through = model.transmits();
        let all: Vec<_> = adversarial()
            .into_iter()
            .chain(directions("finite", 9))
            .collect();
        let ends = [0.0, 1e-7, 0.5, f64::from(1.0 - f32::EPSILON / 2.0)];
        for &o in &all {
            let wo = convert(o);
            for &i in &all {
                let wi = convert(i);
                let f = model.eval(wi, wo);
                let pdf: f64 = model.pdf(wi, wo).into();
                let (f_cos, density) = model.eval_cos_and_pdf(wi, wo);
                let separate = model.eval_cos(wi, wo).map(Into::<f64>::into);
                assert_eq!(f_cos.map(Into::into), separate, "{spec}: {i:?} {o:?}");
                assert_eq!(density.into(), pdf, "{spec}: {i:?} {o:?}");
                for x in f {
                    let x: f64 = x.into();
                    assert!(x.is_finite() && x >= 0.0, "{spec}: f = {x} at {i:?} {o:?}");
                    let seen = through || (i.z > 0.0 && o.z > 0.0);
                    assert!(x == 0.0 || seen, "{spec}: {i:?} {o:?}");
                }
                assert!(
                    pdf.is_finite() && pdf >= 0.0,
                    "{spec}: pdf = {pdf} at {i:?} {o:?}"
                );
            }
            for u0 in ends {
                for u1 in ends {
                    for u2 in ends {
                        let s = model.sample(wo, [R::lit(u0), R::lit(u1), R::lit(u2)]);
                        let (pdf, z): (f64, f64) = (s.pdf.into(), s.wi.z.into());
                        let length: f64 = s.wi.length().into();
                        assert!(
                            pdf.is_finite() && pdf >= 0.0,
                            "{spec}: {o:?} {u0} {u1} {u2}"
                        );
                        assert!(
                            pdf == 0.0 || through || (z > 0.0 && o.z > 0.0),
                            "{spec}: {o:?} {u0} {u1} {u2}"
                        );
                        assert!(
                            (length - 1.0).abs() < 1e-4,
                            "{spec}: {length} {o:?} {u0} {u1}"
                        );
                        for w in s.weight {
                            let w: f64 = w.into();
                            assert!(
                                w.is_finite() && w >= 0.0,
                                "{spec}: {w} {o:?} {u0} {u1} {u2}"
                            );
                        }
                    }
                }
            }
        }
    }
    for spec in specs() {
        run::<f64>(&spec, Vec3::to_f64);
        run::<f32>(&spec, |v| v);
    }
}

#[test]
fn reciprocal_where_declared() {
    let all = directions("reciprocity", 16);
    for spec in specs() {
        if !spec.declares().unwrap().reciprocal {
            continue;
        }
        let (double, single): (Model<f64, 3>, Model<f32, 3>) =
            (spec.build().unwrap(), spec.build().unwrap());
        let all = on_all_sides(&spec, &all);
        // n(ωi)² f(ωi, ωr), with n the index of refraction of the side of ωi.
        let basic = |f: [f64; 3], wi: Vec3<f32>| {
            let n = double.relative_ior();
            [0, 1, 2].map(|k| f[k] * if wi.z < 0.0 { n[k] * n[k] } else { 1.0 })
        };
        for &a in &all {
            for &b in &all {
                let f = basic(single.eval(a, b).map(f64::from), a);
                let g = basic(single.eval(b, a).map(f64::from), b);
                let (x, y) = (a.to_f64(), b.to_f64());
                let (p, q) = (basic(double.eval(x, y), a), basic(double.eval(y, x), b));
                for k in 0..3 {
                    assert!(
                        (p[k] - q[k]).abs() <= 1e-10 * (p[k] + q[k]),
                        "{spec} {a:?} {b:?}"
                    );
                    // Below 1e-30 single precision soon has no digits left.
                    assert!(
                        (f[k] - g[k]).abs() <= 1e-4 * (f[k] + g[k]) + 1e-30,
                        "{spec} {a:?} {b:?}"
                    );
                }
            }
        }
    }
}

/// What a model says of the other side when it is built is what its description declares.
#[test]
fn the_other_side_is_as_declared() {
    for spec in specs() {
        let model: Model<f64, 3> = spec.build().unwrap();
        let declared = spec.declares().unwrap().relative_ior;
        assert_eq!(declared.is_some(), model.transmits(), "{spec}");
        assert_eq!(declared.unwrap_or([1.0; 3]), model.relative_ior(), "{spec}");
        assert!(model.absorption().iter().all(|x| *x >= 0.0), "{spec}");
    }
}

/// The control: a toon shader must be caught by the comparison above.
#[test]
fn reciprocity_can_fail() {
    let toon: Model<f64, 3> = ModelSpec::parse("toon").unwrap().build().unwrap();
    let (a, b) = (Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.6, 0.0, 0.8));
    assert_ne!(toon.eval(a, b), toon.eval(b, a));
}

/// f32 gives f64's value but for 1e-4 of it and for what a change of the inputs by their own rounding (3e-7) makes.
#[test]
fn single_precision_agrees_with_double() {
    let all = directions("precision", 14);
    for spec in specs() {
        let (double, single): (Model<f64, 3>, Model<f32, 3>) =
            (spec.build().unwrap(), spec.build().unwrap());
        let all = on_all_sides(&spec, &all);
        for &i in &all {
            for &o in &all {
                let f = single.eval(i, o);
                let (wi, wo) = (i.to_f64(), o.to_f64());
                let g = double.eval(wi, wo);
                let mut slack = [0.0f64; 3];
                for axis in 0..3 {
                    for step in [-3e-7, 3e-7] {
                        let mut moved = wi.to_array();
                        moved[axis] += step;
                        let moved = double.eval(moved.into(), wo);
                        for k in 0..3 {
                            slack[k] += (moved[k] - g[k]).abs();
                        }
                    }
                }
                for k in 0..3 {
                    // A power of 1e-38 is lost in single precision; factors of up to 1e13 stand beside it.
                    let allowed = 1e-4 * g[k] + 2.0 * slack[k] + 1e-25;
                    let difference = (f64::from(f[k]) - g[k]).abs();
                    assert!(
                        difference <= allowed,
                        "{spec} {i:?} {o:?}: {} {}",
                        f[k],
                        g[k]
                    );
                }
            }
        }
    }
}

/// Derivatives by each number of the model, and by the direction, against central differences.
#[test]
fn duals_are_derivatives() {
    // Step and tolerance: rounding 1e-16/1e-6 and curvature (1e-6)² leave 1e-9 of the scale of f's own changes.
    let step = 1e-6;
    let pairs = [
        (Vec3::new(0.3, 0.2, 0.8), Vec3::new(-0.4, 0.1, 0.7)),
        (Vec3::new(0.7, -0.3, 0.4), Vec3::new(0.1, 0.5, 0.6)),
    ];
    for spec in common::one_at_a_time()
        .into_iter()
        .chain(common::random("duals", 6))
    {
        // Steps have no derivative.
        if spec.name == "toon" {
            continue;
        }
        let model: Model<f64, 3> = spec.build().unwrap();
        let count = Cell::new(0);
        model.cast(&|x: f64| {
            count.set(count.get() + 1);
            x
        });
        let numbers = count.get();
        for (wi, wo) in pairs {
            let (wi, wo) = (wi.normalize(), wo.normalize());
            for n in 0..=numbers {
                // Number `n` of the model varies; after the last one, the direction.
                let at = Cell::new(0);
                let pick = || {
                    at.set(at.get() + 1);
                    at.get() == n + 1
                };
                let dual = model.cast(&|x: f64| {
                    if pick() {
                        Dual::<f64, 1>::variable(x, 0)
                    } else {
                        Dual::constant(x)
                    }
                });
                let d = |v: Vec3<f64>, slope: f64| {
                    let mut x = Vec3::new(
                        Dual::constant(v.x),
                        Dual::constant(v.y),
                        Dual::constant(v.z),
                    );
                    x.x.partials[0] = slope;
                    x
                };
                let turn = if n == numbers { 1.0 } else { 0.0 };
                let f = dual.eval(d(wi, turn), d(wo, 0.0));
                let mut sides = [[0.0; 3]; 2];
                let mut curvature = [0.0f64; 3];
                let centre = model.eval(wi, wo);
                for (side, sign) in sides.iter_mut().zip([-1.0, 1.0]) {
                    at.set(0);
                    let moved = model.cast(&|x: f64| if pick() { x + sign * step } else { x });
                    let mut w = wi;
                    w.x += turn * sign * step;
                    *side = moved.eval(w, wo);
                }
                for k in 0..3 {
                    curvature[k] = (sides[0][k] + sides[1][k] - 2.0 * centre[k]).abs() / step;
                    let slope = (sides[1][k] - sides[0][k]) / (2.0 * step);
                    let scale = f[k].partials[0].abs() + centre[k].abs() + 1e-6;
                    let allowed = 1e-6 * scale + curvature[k];
                    let difference = (f[k].partials[0] - slope).abs();
                    assert!(
                        difference <= allowed,
                        "{spec}, number {n} of {numbers}: {} against {slope}",
                        f[k].partials[0]
                    );
                    assert_eq!(f[k].value, centre[k], "{spec}");
                }
            }
        }
    }
}

/// A parameter that a texture sets gives what building with that value gives.
#[test]
fn setting_a_parameter_is_building_with_it() {
    use gonio_brdf::{Kind, ParameterSlot, Value};
    let (wi, wo) = (Vec3::new(0.36, 0.48, 0.8), Vec3::new(-0.6, 0.0, 0.8));
    for info in registry::models() {
        let Some(base) = common::base(info) else {
            continue;
        };
        let has = |name: &str| info.parameters.iter().any(|p| p.name == name);
        for p in info.parameters {
            let (value, given) = match p.kind {
                Kind::Number { low, high, .. } => {
                    let x = if high > 100.0 {
                        7.0
                    } else {
                        (low + 0.375 * (high - low)).floor().max(0.375)
                    };
                    (Value::Number(x), [x as f32; 3])
                }
                Kind::Colour { low, high, .. } => {
                    let c = [0.25, 0.5, 0.75].map(|x: f64| x.clamp(low, high));
                    (Value::Colour(c), c.map(|x| x as f32))
                }
                _ => {
                    assert!(ParameterSlot::find(info.name, p.name).is_err());
                    continue;
                }
            };
            // Values that only another choice uses, or that come in pairs.
            let mut before = base.clone();
            match p.name {
                "ior" if has("fresnel") => before.set_text("fresnel", "dielectric").unwrap(),
                "f0" if has("fresnel") => before.set_text("fresnel", "schlick").unwrap(),
                "f82" => before.set_text("fresnel", "f82-tint").unwrap(),
                "film_thickness_nm" | "film_ior" => {
                    before.set_text("fresnel", "thin-film").unwrap();
                }
                "gamma" => before.set_text("distribution", "student-t").unwrap(),
                "p" if has("distribution") => before.set_text("distribution", "sgd").unwrap(),
                "c" if has("distribution") => before.set_text("distribution", "abc").unwrap(),
                "eta" | "k" => {
                    before.set_text("eta", "2").unwrap();
                    before.set_text("k", "3").unwrap();
                }
                "alpha_x" | "alpha_y" => {
                    before.set_text("alpha_x", "0.5").unwrap();
                    before.set_text("alpha_y", "0.25").unwrap();
                }
                "rotation_deg" => {
                    let has = |name| info.parameters.iter().any(|p| p.name == name);
                    let key = ["anisotropy", "anisotropic"].into_iter().find(|k| has(*k));
                    before.set_text(key.unwrap(), "0.5").unwrap();
                }
                "subsurface" => before.set_text("version", "2012").unwrap(),
                _ => {}
            }
            let mut after = before.clone();
            after.set(p.name, value).unwrap();
            let mut model: Model<f32, 3> = before.build().unwrap();
            model.set_parameter(ParameterSlot::find(info.name, p.name).unwrap(), given);
            let built: Model<f32, 3> = after.build().unwrap();
            let (f, g) = (model.eval(wi, wo), built.eval(wi, wo));
            let pdf = (model.pdf(wi, wo), built.pdf(wi, wo));
            for k in 0..3 {
                assert!(
                    (f[k] - g[k]).abs() <= 1e-5 * g[k].max(0.1),
                    "{info:?} {}: {f:?} {g:?}",
                    p.name
                );
            }
            assert!(
                (pdf.0 - pdf.1).abs() <= 1e-5 * pdf.1.max(0.1),
                "{} {}: {pdf:?}",
                info.name,
                p.name
            );
        }
    }
}
