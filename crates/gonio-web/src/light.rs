//! Light from far away, by its words.

use crate::answer::{Answer, colours, largest};
use crate::complaint::Complaint;
use crate::plots::side;
use gonio_env::{Environment, LoadOptions};
use gonio_num::Vec3;
use gonio_radiometry::direction::spherical_direction;
use serde::Deserialize;
use serde_json::json;
use std::f64::consts::{PI, TAU};
use std::sync::{Mutex, PoisonError};

/// The light that was asked for last: each part of a picture asks again.
static LAST: Mutex<Option<(String, Environment)>> = Mutex::new(None);

/// A panorama's file, `sky:…` or `uniform:…`. Unsound texels are replaced, as `panorama` says.
pub(crate) fn environment(words: &str) -> Result<Environment, Complaint> {
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((known, environment)) = &*last
        && known == words
    {
        return Ok(environment.clone());
    }
    let environment = Environment::parse(words, &LoadOptions::default())?;
    *last = Some((words.into(), environment.clone()));
    Ok(environment)
}

/// Forgets it.
pub(crate) fn forget() {
    *LAST.lock().unwrap_or_else(PoisonError::into_inner) = None;
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Panorama {
    light: String,
    width: usize,
    height: usize,
}

/// The radiance at the centres of `width` × `height` pixels of a panorama, rows from the zenith down, −z in the middle.
pub(crate) fn panorama(of: Panorama) -> Result<Answer, Complaint> {
    let (width, height) = (side(of.width)?, side(of.height)?);
    let environment = environment(&of.light)?;
    let mut values = Vec::with_capacity(width * height);
    for k in 0..width * height {
        let u = ((k % width) as f64 + 0.5) / width as f64;
        let v = ((k / width) as f64 + 0.5) / height as f64;
        // From the local frame, z up, to the world: y up, the middle of the panorama at −z, +x a quarter turn to the right.
        let w = spherical_direction(PI * v, TAU * (u - 0.5));
        let d = Vec3::new(w.y, w.z, -w.x).to_f32();
        values.push(environment.radiance(d).map(f64::from));
    }
    Ok(Answer::new(
        json!({ "largest": largest(&values) }),
        vec![("values", colours(values))],
    ))
}
