//! [`sweep`], a model held to what it declares over its whole space of parameters.

use crate::check::{CheckOptions, check_with};
use crate::{BrdfError, Kind, ModelSpec, ParameterInfo, Value};
use gonio_verify::{Axis, Effort, Point, Range, Setting, Settings, SweepReport, points};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// A free parameter, of the description itself or of a model that it is made of.
struct Place {
    /// At each composite on the way, which of its models.
    path: Vec<usize>,
    /// The parameter's name there.
    key: &'static str,
    axis: Axis,
}

/// The parameters of a description that are left to their defaults, and of the models that it is made of, with all that they may be.
/// What the description gives stays as it is, and so do files. A part's parameter is named after it: `lambertian.reflectance`, with
/// a number if the part has a twin, as in `ggx2.roughness`.
///
/// # Errors
/// If there is no such model.
pub fn space(spec: &ModelSpec) -> Result<Vec<Axis>, BrdfError> {
    Ok(places(spec)?.into_iter().map(|p| p.axis).collect())
}

fn places(spec: &ModelSpec) -> Result<Vec<Place>, BrdfError> {
    let mut all = Vec::new();
    collect(spec, &[], "", &mut all)?;
    Ok(all)
}

fn collect(
    spec: &ModelSpec,
    path: &[usize],
    prefix: &str,
    all: &mut Vec<Place>,
) -> Result<(), BrdfError> {
    let free = |p: &&'static ParameterInfo| !spec.values.contains_key(p.name);
    // A shader's own parameters are among them.
    for p in spec.parameters()?.into_iter().filter(free) {
        let numbers = |low, high, components| Range::Numbers {
            low,
            high,
            components,
        };
        let range = match p.kind {
            Kind::Number { low, high, .. } => numbers(low, high, 1),
            Kind::Colour { low, high, .. } => numbers(low, high, 3),
            Kind::Choice { options, .. } => {
                Range::Words(options.iter().map(|w| (*w).to_owned()).collect())
            }
            Kind::Path | Kind::Name | Kind::Models => continue,
        };
        all.push(Place {
            path: path.to_vec(),
            key: p.name,
            axis: Axis {
                name: format!("{prefix}{}", p.name),
                range,
                optional: p.default_value().is_none(),
            },
        });
    }
    for models in spec.values.values().filter_map(parts) {
        for (k, part) in models.iter().enumerate() {
            let twins = models.iter().filter(|m| m.name == part.name).count();
            let number = if twins > 1 {
                (k + 1).to_string()
            } else {
                String::new()
            };
            let inner = [path, &[k]].concat();
            collect(
                part,
                &inner,
                &format!("{prefix}{}{number}.", part.name),
                all,
            )?;
        }
    }
    Ok(())
}

fn parts(value: &Value) -> Option<&Vec<ModelSpec>> {
    match value {
        Value::Models(models) => Some(models),
        _ => None,
    }
}

/// The model that `path` leads to.
fn part_mut<'s>(spec: &'s mut ModelSpec, path: &[usize]) -> &'s mut ModelSpec {
    let Some((k, rest)) = path.split_first() else {
        return spec;
    };
    let inner = spec.values.values_mut().find_map(|value| match value {
        Value::Models(models) => models.get_mut(*k),
        _ => None,
    });
    part_mut(inner.expect("invariant: the path was made from it"), rest)
}

/// The description with the values of `point`.
fn at(spec: &ModelSpec, places: &[Place], point: &Point) -> Result<ModelSpec, BrdfError> {
    let mut spec = spec.clone();
    for (place, setting) in places.iter().zip(point) {
        let value = match setting {
            None => continue,
            Some(Setting::Word(word)) => Value::Choice(word.clone()),
            Some(Setting::Numbers(n)) => match n[..] {
                [r, g, b] => Value::Colour([r, g, b]),
                _ => Value::Number(n[0]),
            },
        };
        part_mut(&mut spec, &place.path).set(place.key, value)?;
    }
    Ok(spec)
}

/// Checks the model at `count` points of its [`space`]: the ends of each parameter, each choice, the corners of small spaces, and the
/// interior. Each point is looked at shortly, and again with quick effort before it fails; the chance of a false alarm is that
/// of one check, over all points together. Values that exclude each other are left out and counted.
///
/// The settings of `options` but for its bounds are not used; its progress is told of points.
///
/// # Errors
/// If the model cannot be built as it is described, or at no point.
pub fn sweep(
    spec: &ModelSpec,
    count: usize,
    options: &CheckOptions,
) -> Result<SweepReport, BrdfError> {
    let places = places(spec)?;
    let axes: Vec<Axis> = places.iter().map(|p| p.axis.clone()).collect();
    // What is wrong with the description itself is to be said, and not to be left out point by point.
    if spec
        .parameters()?
        .iter()
        .all(|p| p.default_value().is_some())
    {
        spec.build::<f64, 3>()?;
    }
    let all = points(&axes, count.max(1));
    let bounds = Settings {
        loss_bound: options.settings.loss_bound,
        ..Settings::glance(all.len() as u64)
    };
    let harder = Settings {
        false_positive_rate: bounds.false_positive_rate,
        loss_bound: bounds.loss_bound,
        ..Settings::new(Effort::Quick)
    };
    let done = AtomicU64::new(0);
    let checked = |point: &Point| {
        let result = at(spec, &places, point).and_then(|spec| {
            let look = |settings| {
                let options = CheckOptions {
                    effort: Effort::Quick,
                    settings,
                    allow: options.allow.clone(),
                    progress: None,
                };
                check_with(&spec, &options)
            };
            let mut report = look(bounds)?;
            if !report.passed() {
                report = look(harder)?;
            }
            Ok((spec.to_string(), report))
        });
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        if let Some(progress) = options.progress {
            progress(done, all.len() as u64);
        }
        result
    };
    let reports: Vec<_> = all.par_iter().map(checked).collect();
    let mut found = SweepReport::new(spec.to_string(), axes);
    let mut last = None;
    for result in reports {
        match result {
            Ok((at, report)) => found.add(&at, &report),
            // These parameters exclude each other.
            Err(e @ (BrdfError::Parameter { .. } | BrdfError::Unsupported { .. })) => {
                found.skipped += 1;
                last = Some(e);
            }
            Err(e) => return Err(e),
        }
    }
    match last {
        Some(e) if found.points == 0 => Err(e),
        _ => Ok(found),
    }
}
