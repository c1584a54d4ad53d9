//! What is drawn of functions: values, lobes, curves, slices, albedos, balls, and the command's own plots.

use crate::answer::{Answer, colours, largest};
use crate::complaint::Complaint;
use crate::subject::{Angles, Subject};
use gonio_brdf::Brdf;
use gonio_plot::numbers::{self, Factors};
use gonio_plot::{Function, Options, ScaleKind};
use serde::Deserialize;
use serde_json::json;
use std::sync::Arc;

/// Pixels of a picture along each side at most.
const MOST_SIDE: usize = 2048;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Evaluate {
    function: String,
    wi: Angles,
    wo: Angles,
}

/// f, f·|cosθi| and the density of sampling for a pair of directions, under the names of `gonio brdf eval --json`.
pub(crate) fn evaluate(of: Evaluate) -> Result<Answer, Complaint> {
    let subject = Subject::open(&of.function)?;
    let (wi, wo) = (of.wi.direction(), of.wo.direction());
    let answer = json!({
        "f_per_sr": subject.model.eval(wi, wo),
        "f_cos_per_sr": subject.model.eval_cos(wi, wo),
        "pdf_per_sr": subject.model.pdf(wi, wo),
    });
    subject.sound()?;
    Ok(Answer::new(answer, Vec::new()))
}

/// A function under light from one direction.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Lobe {
    function: String,
    wi: Angles,
    scale: String,
    cosine: bool,
    #[serde(default)]
    quick: bool,
}

pub(crate) fn lobe(of: Lobe) -> Result<Answer, Complaint> {
    let subject = Subject::open(&of.function)?;
    let kind: ScaleKind = of.scale.parse()?;
    let f = subject.function();
    let lobe = numbers::lobe_surface(&f, of.wi.direction(), of.cosine, kind, of.quick);
    subject.sound()?;
    let spikes = lobe.spikes.iter().flat_map(|s| [s.wo.to_array(), s.share]);
    let directions = lobe.directions.iter().map(|d| d.to_array());
    Ok(Answer::new(
        json!({ "largest": largest(&lobe.values) }),
        vec![
            ("directions", colours(directions)),
            ("spikes", colours(spikes)),
            // Whole numbers below 2²⁴ are exact.
            (
                "triangles",
                lobe.triangles.iter().flatten().map(|k| *k as f32).collect(),
            ),
            ("values", colours(lobe.values)),
        ],
    ))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Curve {
    function: String,
    wi: Angles,
    cosine: bool,
}

pub(crate) fn curve(of: Curve) -> Result<Answer, Complaint> {
    let subject = Subject::open(&of.function)?;
    // The plane's azimuth is that of the side away from the light.
    let phi = of.wi.phi - 180.0;
    let curve = numbers::plane_curve(&subject.function(), of.wi.theta, phi, of.cosine)?;
    subject.sound()?;
    let values: Vec<[f64; 3]> = curve.points.iter().map(|p| p.1).collect();
    let angles = curve.points.iter().map(|p| p.0 as f32).collect();
    let spike = |(angle, share): &(f64, [f64; 3])| {
        let [r, g, b] = share.map(|x| x as f32);
        [*angle as f32, r, g, b]
    };
    Ok(Answer::new(
        json!({ "largest": largest(&values) }),
        vec![
            ("angles", angles),
            ("spikes", curve.spikes.iter().flat_map(spike).collect()),
            ("values", colours(values)),
        ],
    ))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Hemisphere {
    function: String,
    wi: Angles,
    size: usize,
    cosine: bool,
}

pub(crate) fn hemisphere(of: Hemisphere) -> Result<Answer, Complaint> {
    let size = side(of.size)?;
    let subject = Subject::open(&of.function)?;
    let values =
        numbers::hemisphere_values(&subject.function(), of.wi.direction(), of.cosine, size);
    subject.sound()?;
    Ok(picture(values))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Slice {
    function: String,
    phi_d: f64,
}

pub(crate) fn slice(of: Slice) -> Result<Answer, Complaint> {
    let subject = Subject::open(&of.function)?;
    let values = numbers::slice_values(&subject.function(), of.phi_d);
    subject.sound()?;
    Ok(Answer::new(
        json!({ "side": numbers::SLICE_SIDE, "largest": largest(&values) }),
        vec![("values", colours(values))],
    ))
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Albedo {
    function: String,
    thetas: Vec<f64>,
    phi: f64,
}

pub(crate) fn albedo(of: Albedo) -> Result<Answer, Complaint> {
    let subject = Subject::open(&of.function)?;
    if let Some(theta) = of.thetas.iter().find(|t| !(0.0..90.0).contains(*t)) {
        let message = format!("an angle is {theta}°, expected angles from 0° to 90°, but not 90°");
        return Err(Complaint::new(message));
    }
    let f = subject.function();
    let all: Vec<_> = (of.thetas.iter())
        .map(|t| numbers::directional_albedo(&f, *t, of.phi))
        .collect();
    subject.sound()?;
    let error = all.iter().map(|a| a.error).fold(0.0, f64::max);
    Ok(Answer::new(
        json!({ "error": error }),
        vec![
            ("reflected", colours(all.iter().map(|a| a.reflected))),
            ("total", colours(all.iter().map(|a| a.total))),
        ],
    ))
}

/// As [`Factors`].
#[derive(Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
pub(crate) struct Switches {
    pub light: bool,
    pub brdf: bool,
    pub cosine: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Ball {
    function: String,
    light: Angles,
    size: usize,
    factors: Switches,
}

pub(crate) fn ball(of: Ball) -> Result<Answer, Complaint> {
    let size = side(of.size)?;
    let subject = Subject::open(&of.function)?;
    let factors = Factors {
        light: of.factors.light,
        brdf: of.factors.brdf,
        cosine: of.factors.cosine,
    };
    let light = of.light.direction();
    let values = numbers::ball_values(&subject.function(), light, 0.0, size, factors);
    subject.sound()?;
    Ok(picture(values))
}

/// The side of a picture, if it is not too large.
pub(crate) fn side(size: usize) -> Result<usize, Complaint> {
    if (1..=MOST_SIDE).contains(&size) {
        return Ok(size);
    }
    let message = format!("a picture is {size} pixels wide or high, expected 1 to {MOST_SIDE}");
    Err(Complaint::new(message))
}

fn picture(values: Vec<[f64; 3]>) -> Answer {
    Answer::new(
        json!({ "largest": largest(&values) }),
        vec![("values", colours(values))],
    )
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Plot {
    functions: Vec<String>,
    kind: String,
    theta: Vec<f64>,
    phi: f64,
    scale: String,
    channel: String,
    cosine: bool,
    #[serde(default = "ninety")]
    phi_d: f64,
}

fn ninety() -> f64 {
    90.0
}

/// The plot that the command writes.
pub(crate) fn plot(of: Plot) -> Result<Answer, Complaint> {
    let subjects: Vec<Arc<Subject>> = (of.functions.iter())
        .map(|text| Subject::open(text))
        .collect::<Result<_, _>>()?;
    let functions: Vec<Function<'_>> = subjects.iter().map(|s| s.function()).collect();
    let options = Options {
        theta_deg: of.theta,
        phi_deg: of.phi,
        channel: of.channel.parse()?,
        scale: of.scale.parse()?,
        cosine: of.cosine,
        phi_d_deg: of.phi_d,
        ..Options::default()
    };
    let draw = match of.kind.as_str() {
        "polar" => gonio_plot::polar,
        "cartesian" => gonio_plot::cartesian,
        "albedo" => gonio_plot::albedo,
        "slice" => gonio_plot::slice,
        "lobe3d" => gonio_plot::lobe3d,
        "sphere" => gonio_plot::sphere,
        "difference" => gonio_plot::difference,
        other => return Err(Complaint::new(format!("there is no plot `{other}`"))),
    };
    let figure = draw(&functions, &options)?;
    for subject in &subjects {
        subject.sound()?;
    }
    Ok(Answer::new(
        json!({ "svg": figure.svg(), "notes": figure.notes() }),
        Vec::new(),
    ))
}
