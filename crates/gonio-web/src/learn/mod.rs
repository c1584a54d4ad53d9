//! The figures of the page Learn: one small operation each, rows T1 to T21 of the theory.
//!
//! What a figure shows step by step, such as a sum that comes near an integral, is made here of the library's quantities; the integral itself is
//! the library's.

mod facets;
mod geometry;
mod light;
mod mirror_ball;
mod reflection;
mod sky;

use crate::answer::Answer;
use crate::complaint::Complaint;
use crate::subject::Angles;
use serde::Deserialize;
use sky::Sky;

/// A figure by its name, and what its sliders say; angles are in degrees.
#[derive(Deserialize)]
#[serde(tag = "figure", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum Figure {
    Light {
        kelvin: f64,
    },
    SolidAngle {
        half_angle: f64,
    },
    Spherical {
        theta: f64,
        phi: f64,
        r: f64,
    },
    Differential {
        theta: f64,
        phi: f64,
        dtheta: f64,
        dphi: f64,
    },
    Radiance {
        radius: f64,
        distance: f64,
        radiance: f64,
    },
    Irradiance {
        sky: Sky,
        steps: usize,
    },
    Exitance {
        function: String,
    },
    Brdf {
        function: String,
        wi: Angles,
        wo: Angles,
        half_angle: f64,
    },
    Turn {
        function: String,
        wi: Angles,
        wo: Angles,
        steps: usize,
    },
    Reflection {
        function: String,
        wo: Angles,
        lights: Vec<reflection::PointLight>,
    },
    ReflectionSky {
        function: String,
        wo: Angles,
        sky: Sky,
        steps: usize,
    },
    Fresnel {
        ior: f64,
        k: f64,
    },
    TorranceSparrow {
        roughness: f64,
        ior: f64,
        theta: f64,
    },
    MirrorBall {
        light: String,
        size: usize,
    },
}

pub(crate) fn learn(figure: Figure) -> Result<Answer, Complaint> {
    match figure {
        Figure::Light { kelvin } => light::light(kelvin),
        Figure::SolidAngle { half_angle } => geometry::solid_angle(half_angle),
        Figure::Spherical { theta, phi, r } => geometry::spherical(theta, phi, r),
        Figure::Differential {
            theta,
            phi,
            dtheta,
            dphi,
        } => geometry::differential([theta, phi], [dtheta, dphi]),
        Figure::Radiance {
            radius,
            distance,
            radiance,
        } => geometry::radiance(radius, distance, radiance),
        Figure::Irradiance { sky, steps } => sky::irradiance(sky, steps),
        Figure::Exitance { function } => reflection::exitance(&function),
        Figure::Brdf {
            function,
            wi,
            wo,
            half_angle,
        } => reflection::cone(&function, wi, wo, half_angle),
        Figure::Turn {
            function,
            wi,
            wo,
            steps,
        } => reflection::turn(&function, wi, wo, steps),
        Figure::Reflection {
            function,
            wo,
            lights,
        } => reflection::sum(&function, wo, &lights),
        Figure::ReflectionSky {
            function,
            wo,
            sky,
            steps,
        } => sky::reflection(&function, wo, sky, steps),
        Figure::Fresnel { ior, k } => facets::fresnel(ior, k),
        Figure::TorranceSparrow {
            roughness,
            ior,
            theta,
        } => facets::torrance_sparrow(roughness, ior, theta),
        Figure::MirrorBall { light, size } => mirror_ball::mirror_ball(&light, size),
    }
}

/// `value` if it is from `low` to `high`.
fn within(name: &str, value: f64, low: f64, high: f64) -> Result<f64, Complaint> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    Err(Complaint::new(format!(
        "{name} is {value}, expected {low} to {high}"
    )))
}

/// A number of steps that a page can wait for.
fn steps(count: usize, most: usize) -> Result<usize, Complaint> {
    within("the number of steps", count as f64, 1.0, most as f64).map(|_| count)
}
