//! Whether a parameter has an effect beside the others.

use crate::{Brdf, Kind, Model, ModelSpec, ParameterInfo, Value};
use gonio_num::Vec3;

/// Directions wi and wo, and random numbers, that tell functions apart: most of the pairs above the surface, some across.
pub(super) fn probes() -> impl Iterator<Item = (Vec3<f32>, Vec3<f32>, [f32; 3])> {
    (0..8u8).map(|k| {
        let x = |step: f64| (0.5 + f64::from(k) * step).fract() as f32;
        let u = [0.819_172_5, 0.671_043_6, 0.549_700_5].map(x);
        let direction = |a: f32, b: f32, side: f32| {
            Vec3::new(a - 0.5, b - 0.5, side * (0.2 + 0.8 * a)).normalize()
        };
        let wi = direction(u[0], u[1], if k % 4 == 3 { -1.0 } else { 1.0 });
        (wi, direction(u[2], u[0], 1.0), u)
    })
}

/// What the model of the description is at the probes.
fn values(spec: &ModelSpec) -> Option<Vec<[f32; 3]>> {
    let model: Model<f32, 3> = spec.build().ok()?;
    Some(probes().map(|(wi, wo, _)| model.eval(wi, wo)).collect())
}

/// What the description is with another value; nothing where its other values rule that out.
fn values_with(spec: &ModelSpec, name: &str, value: Value) -> Option<Vec<[f32; 3]>> {
    let mut other = spec.clone();
    other.set(name, value).ok()?;
    values(&other)
}

/// Whether the description gives the parameter, or another value of it would make another function. Beside `metal` an index has
/// none.
pub(super) fn has_effect(spec: &ModelSpec, parameter: &ParameterInfo) -> bool {
    let across = |low: f64, high: f64| [0.0, 0.3, 0.7, 1.0].map(|t| low + (high - low) * t);
    let others = match parameter.kind {
        _ if spec.values.contains_key(parameter.name) => return true,
        Kind::Number { low, high, .. } => across(low, high).map(Value::Number),
        Kind::Colour { low, high, .. } => across(low, high).map(|x| Value::Colour([x; 3])),
        Kind::Choice { .. } | Kind::Path | Kind::Name | Kind::Models => return false,
    };
    let present = values(spec);
    others.into_iter().any(|value| {
        let other = values_with(spec, parameter.name, value);
        other.is_some() && other != present
    })
}

/// The option of a choice that the description gives, or that makes the same function as leaving it out does, which needn't be its
/// default: beside `metal` the reflectance is a conductor's. Nothing where all options make the same.
pub(super) fn option_in_effect(spec: &ModelSpec, parameter: &ParameterInfo) -> Option<String> {
    let Kind::Choice { options, .. } = parameter.kind else {
        return None;
    };
    if let Some(given) = spec.values.get(parameter.name) {
        return Some(given.to_string());
    }
    let present = values(spec);
    let default = parameter.default_value().map(|v| v.to_string());
    let (mut same, mut differs) = (None, false);
    for word in default
        .as_deref()
        .into_iter()
        .chain(options.iter().copied())
    {
        let other = values_with(spec, parameter.name, Value::Choice(word.to_owned()));
        if other == present {
            same = same.or(Some(word));
        } else if other.is_some() {
            differs = true;
        }
        if same.is_some() && differs {
            break;
        }
    }
    same.filter(|_| differs).map(str::to_owned)
}
