//! [`sweep`], a model held to what it declares over its whole space of parameters.

use crate::check::{CheckOptions, check_with};
use crate::{BrdfError, Kind, ModelSpec, ParameterInfo, Value};
use gonio_verify::{Axis, Effort, Point, Range, Setting, Settings, SweepReport, points};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// The parameters of a description that are left to their defaults, with all that they may be. What the description gives stays as it
/// is, and so do the models that a composite is made of, and files.
///
/// # Errors
/// If there is no such model.
pub fn space(spec: &ModelSpec) -> Result<Vec<Axis>, BrdfError> {
    let free = |p: &&'static ParameterInfo| !spec.values.contains_key(p.name);
    let axis = |p: &ParameterInfo| {
        let range = match p.kind {
            Kind::Number { low, high, .. } => Range::Numbers {
                low,
                high,
                components: 1,
            },
            Kind::Colour { low, high, .. } => Range::Numbers {
                low,
                high,
                components: 3,
            },
            Kind::Choice { options, .. } => {
                Range::Words(options.iter().map(|w| (*w).to_owned()).collect())
            }
            Kind::Path | Kind::Name | Kind::Models => return None,
        };
        Some(Axis {
            name: p.name.to_owned(),
            range,
            optional: p.default_value().is_none(),
        })
    };
    // A shader's own parameters are among them.
    let parameters = spec.parameters()?;
    Ok(parameters
        .into_iter()
        .filter(free)
        .filter_map(axis)
        .collect())
}

/// The description with the values of `point`.
fn at(spec: &ModelSpec, axes: &[Axis], point: &Point) -> Result<ModelSpec, BrdfError> {
    let mut spec = spec.clone();
    for (axis, setting) in axes.iter().zip(point) {
        let value = match setting {
            None => continue,
            Some(Setting::Word(word)) => Value::Choice(word.clone()),
            Some(Setting::Numbers(n)) => match n[..] {
                [r, g, b] => Value::Colour([r, g, b]),
                _ => Value::Number(n[0]),
            },
        };
        spec.set(&axis.name, value)?;
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
    let axes = space(spec)?;
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
        let result = at(spec, &axes, point).and_then(|spec| {
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
    let mut found = SweepReport::new(spec.to_string(), axes.clone());
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
