//! Descriptions over the whole registry, for the tests.

#![allow(dead_code, reason = "each test file uses a part")]

use gonio_brdf::{Kind, ModelInfo, ModelSpec, Value, registry};
use gonio_radiometry::sequence::Rng;

/// The model with the parameters that it can't do without.
pub fn base(info: &ModelInfo) -> Option<ModelSpec> {
    let text = match info.name {
        "sum" => "sum(lambertian:reflectance=0.4, mirror:0.2, ggx:f0=0.1,roughness=0.6)".to_owned(),
        "mix" => "mix(0.3/0.5/0.8, mirror:0.2, ggx:f0=0.3,roughness=0.6)".to_owned(),
        "coat" => {
            "coat(roughness=0.4, ior=1.6, color=0.9/0.6/0.3, lambertian:0.3/0.6/0.8)".to_owned()
        }
        "scaled" => "scaled(0.2/0.5/0.8, phong:exponent=12)".to_owned(),
        "shader" => concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../examples/shaders/ggx.wgsl"
        )
        .to_owned(),
        // A table comes from a file: it has tests of its own.
        "table" => return None,
        name => name.to_owned(),
    };
    Some(ModelSpec::parse(&text).unwrap())
}

/// Some values of a parameter, ends and interior.
fn values(kind: &Kind) -> Vec<Value> {
    let between = |low: f64, high: f64, t: f64| {
        // Wide ranges are walked by factors.
        let x = if high > 50.0 * low.max(1.0) {
            low + (1.0 + high - low).powf(t) - 1.0
        } else {
            low + (high - low) * t
        };
        // Rounding may put an end outside.
        x.clamp(low, high)
    };
    match *kind {
        Kind::Number { low, high, .. } => [0.0, 0.15, 0.5, 0.8, 1.0]
            .map(|t| Value::Number(between(low, high, t)))
            .to_vec(),
        Kind::Colour { low, high, .. } => {
            let at = |t| between(low, high, t);
            vec![
                Value::Colour([low; 3]),
                Value::Colour([at(0.2), at(0.5), at(0.9)]),
                Value::Colour([at(0.7), at(0.1), at(0.3)]),
                Value::Colour([high; 3]),
            ]
        }
        Kind::Choice { options, .. } => {
            options.iter().map(|o| Value::Choice((*o).into())).collect()
        }
        Kind::Path | Kind::Name | Kind::Models => Vec::new(),
    }
}

/// Each model with its defaults, and with each value of each parameter in turn.
pub fn one_at_a_time() -> Vec<ModelSpec> {
    let mut all = Vec::new();
    for info in registry::models() {
        let Some(base) = base(info) else { continue };
        all.push(base.clone());
        for p in info.parameters {
            for value in values(&p.kind) {
                let mut spec = base.clone();
                spec.set(p.name, value.clone()).unwrap();
                // A parameter that comes in pairs gets its partner.
                for (key, partner) in [("alpha_x", "alpha_y"), ("eta", "k"), ("k", "eta")] {
                    if p.name == key {
                        spec.set(partner, Value::Number(0.25)).unwrap();
                    }
                }
                if spec.build::<f64, 3>().is_ok() {
                    all.push(spec);
                }
            }
        }
    }
    all
}

/// `count` descriptions of each model with every parameter drawn at random; contradictory ones are drawn again.
pub fn random(name: &str, count: usize) -> Vec<ModelSpec> {
    let mut all = Vec::new();
    for info in registry::models() {
        let Some(base) = base(info) else { continue };
        // Each model has its own numbers: another model in the registry doesn't change them.
        let mut rng = Rng::from_name(&format!("{name} {}", info.name));
        let mut made = 0;
        while made < count {
            let mut spec = base.clone();
            for p in info.parameters {
                let options = values(&p.kind);
                // Half of the parameters keep their defaults, so that contradictions stay rare.
                if options.is_empty() || rng.next_f64() < 0.5 {
                    continue;
                }
                let k = (rng.next_f64() * options.len() as f64) as usize;
                spec.set(p.name, options[k].clone()).unwrap();
            }
            if spec.build::<f64, 3>().is_ok() {
                all.push(spec);
                made += 1;
            }
        }
    }
    all
}
