//! [`showcase`]: the registry's models in a choice of variants that are looked at together.

use crate::{Kind, ModelSpec, Value, registry};

/// A choice of at most this many words is gone through; longer ones (the metals) are data, not variants of a formula.
const MOST_WORDS: usize = 8;

/// Each model of the registry with its defaults, and with each word of each of its choices in turn: all that
/// `gonio brdf check all` looks at. Tables and shaders come from files and are left out.
pub fn showcase() -> Vec<ModelSpec> {
    let mut all: Vec<ModelSpec> = Vec::new();
    for info in registry::models() {
        let text = match info.name {
            "sum" => {
                "sum(lambertian:reflectance=0.4, mirror:reflectance=0.2, ggx:f0=0.1,roughness=0.6)"
            }
            "mix" => "mix(0.3, lambertian:reflectance=0.4, ggx:metal=gold,roughness=0.4)",
            "coat" => "coat(roughness=0.2, color=0.9/0.6/0.3, lambertian:reflectance=0.6)",
            "scaled" => "scaled(0.5, ggx:metal=copper,roughness=0.4)",
            name => name,
        };
        let Ok(base) = ModelSpec::parse(text) else {
            continue;
        };
        let mut add = |spec: ModelSpec| {
            if spec.build::<f64, 3>().is_ok() && !all.contains(&spec) {
                all.push(spec);
            }
        };
        add(base.clone());
        if info.name == "phong" {
            // As published it may reflect more than it receives: the check prints how much.
            let published = "phong:diffuse=0,specular=1,exponent=2,normalisation=published";
            ModelSpec::parse(published).into_iter().for_each(&mut add);
        }
        for parameter in info.parameters {
            let Kind::Choice { options, .. } = parameter.kind else {
                continue;
            };
            if options.len() > MOST_WORDS {
                continue;
            }
            for word in options {
                let mut spec = base.clone();
                let value = Value::Choice((*word).into());
                if Some(&value) != base.value(parameter.name).as_ref()
                    && spec.set(parameter.name, value).is_ok()
                {
                    add(spec);
                }
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_but_those_of_files_is_shown() {
        let all = showcase();
        for name in registry::names() {
            assert_eq!(
                all.iter().any(|s| s.name == name),
                !matches!(name, "table" | "shader"),
                "{name}"
            );
        }
        let distributions = all
            .iter()
            .filter(|s| s.values.contains_key("distribution"))
            .count();
        assert!(distributions >= 2, "{distributions}");
    }
}
