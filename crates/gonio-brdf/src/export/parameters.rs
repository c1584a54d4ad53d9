//! Which of a model's parameters a reader of the exported code may change.

use super::effect::{has_effect, probes};
use super::header::{COLUMNS, wrapped};
use crate::record::{FunctionKind, Named, recorded};
use crate::{Brdf, BrdfError, Kind, Model, ModelInfo, ModelSpec, ParameterInfo, Value};
use gonio_num::expr::{Expr, Parameter};

/// A parameter may add this many operations to the code that draws a direction. More are those of a quadrature that its value goes
/// through when the model is built.
const MOST_ADDED: usize = 250;

/// A parameter of a model, or of a part of it.
#[derive(Debug, Clone)]
struct Candidate {
    /// The way to the part: at each composite, which of its models.
    path: Vec<usize>,
    /// The part's entry in the registry.
    info: &'static ModelInfo,
    /// Its place among the part's parameters.
    index: usize,
    /// What it is called in the code.
    name: String,
    value: [f64; 3],
}

impl Candidate {
    fn parameter(&self) -> &'static ParameterInfo {
        &self.info.parameters[self.index]
    }

    /// As it is written in a description.
    fn label(&self) -> String {
        format!("{}={}", self.name, Value::Colour(self.value))
    }

    fn is_colour(&self) -> bool {
        matches!(self.parameter().kind, Kind::Colour { .. })
    }
}

/// The parameters that stand in the code by name.
#[derive(Debug, Default)]
pub(super) struct Editable {
    chosen: Vec<Candidate>,
    /// Those that can't but have an effect, as they are written in a description.
    pub left_out: Vec<String>,
    /// Whether there are others, which are 0.
    pub switched_off: bool,
}

impl Editable {
    /// Those of the model that `spec` describes. A parameter that was not given and is 0 switches something off: it is left out, so
    /// that what is off takes no code.
    pub fn of(spec: &ModelSpec, model: &Model<f32, 3>) -> Result<Self, BrdfError> {
        let mut candidates = Vec::new();
        let mut found = Self {
            switched_off: collect(spec, &[], "", &mut candidates)?,
            ..Self::default()
        };
        let plain = recorded(model, FunctionKind::Sample, "f", &found)?.operations();
        let mut small = Vec::new();
        for candidate in candidates {
            let alone = Self::with(vec![candidate.clone()]);
            let with = recorded(model, FunctionKind::Sample, "f", &alone)?.operations();
            if with <= plain + MOST_ADDED {
                small.push(candidate);
            } else {
                found.leave_out(spec, &candidate);
            }
        }
        // Together, and if that isn't the model, those that are, one by one.
        found.chosen = small.clone();
        if !found.keeps(model)? {
            found.chosen.clear();
            for candidate in small {
                found.chosen.push(candidate);
                if !found.keeps(model)?
                    && let Some(without) = found.chosen.pop()
                {
                    found.leave_out(spec, &without);
                }
            }
        }
        Ok(found)
    }

    fn leave_out(&mut self, spec: &ModelSpec, candidate: &Candidate) {
        if has_effect(part(spec, &candidate.path), candidate.parameter()) {
            self.left_out.push(candidate.label());
        }
    }

    fn with(chosen: Vec<Candidate>) -> Self {
        Self {
            chosen,
            ..Self::default()
        }
    }

    /// Whether the function with these parameters set to their values is the model. It isn't where one of them rules out another that
    /// was given, as a roughness does a slope scale.
    fn keeps(&self, model: &Model<f32, 3>) -> Result<bool, BrdfError> {
        let eval = recorded(model, FunctionKind::Eval, "f", self)?;
        let pdf = recorded(model, FunctionKind::Pdf, "f", self)?;
        let sample = recorded(model, FunctionKind::Sample, "f", self)?;
        // What a parameter that is rounded once more may change.
        let same = |a: f32, b: f32| (a - b).abs() <= 1e-5 * b.abs().max(1e-3);
        for (wi, wo, u) in probes() {
            let pair = [wi.x, wi.y, wi.z, wo.x, wo.y, wo.z];
            let drawn = model.sample(wo, u);
            let mut expected = model.eval(wi, wo).to_vec();
            expected.push(model.pdf(wi, wo));
            expected.extend(drawn.wi.to_array());
            expected.extend(drawn.weight);
            expected.push(drawn.pdf);
            let mut got = eval.evaluate(&pair);
            got.extend(pdf.evaluate(&pair));
            got.extend(sample.evaluate(&[wo.x, wo.y, wo.z, u[0], u[1], u[2]]));
            if expected.iter().zip(&got).any(|(a, b)| !same(*a, *b)) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Their names.
    pub fn names(&self) -> Vec<&str> {
        self.chosen.iter().map(|c| c.name.as_str()).collect()
    }

    /// The comment on the parameter of this name: meaning, range and unit.
    pub fn comment(&self, name: &str) -> Vec<String> {
        let Some(candidate) = self.chosen.iter().find(|c| c.name == name) else {
            return Vec::new();
        };
        let parameter = candidate.parameter();
        let range = match parameter.kind {
            Kind::Number {
                low, high, unit, ..
            } => format!("{low} to {high}{unit}"),
            Kind::Colour { low, high, .. } => format!("linear RGB, each {low} to {high}"),
            _ => String::new(),
        };
        let text = format!("{} ({range})", parameter.meaning);
        wrapped(&text, COLUMNS - 3, "")
    }
}

impl Named for Editable {
    fn parameters(&self) -> Vec<Parameter> {
        let parameter = |c: &Candidate| {
            let new = if c.is_colour() {
                Parameter::colour(&c.name)
            } else {
                Parameter::scalar(&c.name)
            };
            new.fixed(c.value.map(|x| x as f32))
        };
        self.chosen.iter().map(parameter).collect()
    }

    fn set(&self, model: &mut Model<Expr, 3>, value: &dyn Fn(&str, bool) -> [Expr; 3]) {
        for c in &self.chosen {
            let value = value(&c.name, c.is_colour());
            set(model, &c.path, c.parameter().name, value);
        }
    }
}

/// The part of a description that `path` leads to.
fn part<'s>(spec: &'s ModelSpec, path: &[usize]) -> &'s ModelSpec {
    let Some((k, rest)) = path.split_first() else {
        return spec;
    };
    let inner = spec.values.values().find_map(|value| match value {
        Value::Models(models) => models.get(*k),
        _ => None,
    });
    part(inner.expect("invariant: the path was made from it"), rest)
}

/// Sets a parameter of the part of a model that `path` leads to.
fn set(model: &mut Model<Expr, 3>, path: &[usize], name: &str, value: [Expr; 3]) {
    let Some((k, rest)) = path.split_first() else {
        return model.set(name, value);
    };
    match model {
        Model::Sum(sum) => set(&mut sum.parts[*k], rest, name, value),
        Model::Mix(mix) => set(&mut mix.parts[*k], rest, name, value),
        Model::Scaled(scaled) => set(&mut scaled.of, rest, name, value),
        Model::Coat(coat) => {
            set(coat.base_mut(), rest, name, value);
            coat.update();
        }
        _ => unreachable!("invariant: only these are described by other models"),
    }
}

/// The parameters of a description and of its parts; whether there are others, which are 0.
fn collect(
    spec: &ModelSpec,
    path: &[usize],
    prefix: &str,
    all: &mut Vec<Candidate>,
) -> Result<bool, BrdfError> {
    let info = spec.info()?;
    let mut off = false;
    for (index, parameter) in info.parameters.iter().enumerate() {
        let value = match spec.value(parameter.name) {
            Some(Value::Number(x)) => [x; 3],
            Some(Value::Colour(c)) => c,
            _ => continue,
        };
        if !spec.values.contains_key(parameter.name) && value == [0.0; 3] {
            off = true;
            continue;
        }
        all.push(Candidate {
            path: path.to_vec(),
            info,
            index,
            name: format!("{prefix}{}", parameter.name),
            value,
        });
    }
    for value in spec.values.values() {
        let Value::Models(models) = value else {
            continue;
        };
        for (k, part) in models.iter().enumerate() {
            let twins = models.iter().filter(|m| m.name == part.name).count();
            let mut name = part.name.replace('-', "_");
            if twins > 1 {
                name += &(k + 1).to_string();
            }
            let mut inner = path.to_vec();
            inner.push(k);
            off |= collect(part, &inner, &format!("{prefix}{name}_"), all)?;
        }
    }
    Ok(off)
}
